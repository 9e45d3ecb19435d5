// What the binding files share: one bind_* function per folder of the core, and the objects that Python holds.
//
// Every handle is immutable after construction, so that methods may release the GIL.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "bindings/arrays.h"
#include "bindings/words.h"
#include "field/parameterized_field.h"
#include "mesh/closest_point.h"
#include "texture/stream_function.h"
#include "topology/topology.h"
#include "tracing/flat_faces.h"

namespace stormfield::bindings {

void bind_base(py::module_& m);
void bind_mesh(py::module_& m);
void bind_mesh_job(py::module_& m);
void bind_field(py::module_& m);
void bind_tracing(py::module_& m);
void bind_topology(py::module_& m);
void bind_edit(py::module_& m);
void bind_transform(py::module_& m);
void bind_tracking(py::module_& m);
void bind_morse(py::module_& m);
void bind_morse_maps(py::module_& m);
void bind_design(py::module_& m);
void bind_streamlines(py::module_& m);
void bind_solver(py::module_& m);
void bind_texture(py::module_& m);
void bind_io(py::module_& m);

/// Python's TriangleMesh: the mesh, its charts and, from their first use on, its tree for closest points, its faces laid
/// out for tracing and its factor for stream functions.
class MeshHandle {
 public:
  explicit MeshHandle(std::shared_ptr<const TriangleMesh> mesh);

  const TriangleMesh& mesh() const { return charts_->mesh(); }
  const std::shared_ptr<const VertexCharts>& charts() const { return charts_; }
  const ClosestPointQuery& closestPoints() const;
  const std::shared_ptr<const FlatFaces>& flatFaces() const;
  const StreamFunctionSolver& streamFunctions() const;

 private:
  std::shared_ptr<const VertexCharts> charts_;
  mutable std::once_flag built_, unfolded_, factorized_;
  mutable std::optional<ClosestPointQuery> query_;
  mutable std::shared_ptr<const FlatFaces> flatFaces_;
  mutable std::optional<StreamFunctionSolver> streamFunctions_;
};

/// Arrays vertices (n, 3) float64 and triangles (m, 3) int32, and the mesh and charts of them.
struct MeshArrays {
  Points points;
  Triangles triangles;
};
MeshArrays inputMesh(const ArrayArgument<double>& vertices, const ArrayArgument<Index>& triangles);
std::shared_ptr<MeshHandle> builtMesh(const MeshArrays& arrays, Progress& progress);

/// Python's VectorField and ParameterizedField: with the mesh object they were made on. Jobs share the latter.
struct FieldHandle {
  std::shared_ptr<MeshHandle> mesh;
  VectorField field;
};
struct ParameterizedFieldHandle {
  std::shared_ptr<MeshHandle> mesh;
  ParameterizedField field;
};

/// Python's Topology.
struct TopologyHandle {
  std::shared_ptr<MeshHandle> mesh;
  std::shared_ptr<const Topology> topology;
};

/// (kind, number).
using EntityTuple = py::typing::Tuple<EntityKind, std::optional<Index>>;
EntityTuple entityTuple(const EntityRef& entity);

/// Arrays faces (k,) int32 and barycentric (k, 3) float64 as checked surface points.
std::vector<SurfacePoint> inputSurfacePoints(const TriangleMesh& mesh, const ArrayArgument<Index>& faces,
                                             const ArrayArgument<double>& barycentric);

}  // namespace stormfield::bindings
