#include <tbb/parallel_for.h>

#include <cmath>

#include "bindings/bindings.h"

namespace stormfield::bindings {
namespace {

std::shared_ptr<MeshHandle> makeMesh(const ArrayArgument<double>& vertices, const ArrayArgument<Index>& triangles,
                                     const std::shared_ptr<Progress>& progress) {
  const MeshArrays arrays = inputMesh(vertices, triangles);
  const py::gil_scoped_release release;
  Progress own;
  return builtMesh(arrays, progress ? *progress : own);
}

py::typing::Tuple<py::array_t<Index>, py::array_t<double>, py::array_t<double>> closestPoints(
    const MeshHandle& self, const ArrayArgument<double>& points) {
  const Points queries = toPoints(inputArray<double>(points, "points", {kAny, 3}));
  std::vector<ClosestPoint> found;
  {
    const py::gil_scoped_release release;
    found = self.closestPoints().closest(queries);
  }
  const auto count = static_cast<py::ssize_t>(found.size());
  py::array_t<Index> faces(count);
  py::array_t<double> barycentric({count, py::ssize_t{3}}), distances(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    faces.mutable_at(i) = found[i].point.face;
    for (int k = 0; k < 3; ++k) barycentric.mutable_at(i, k) = found[i].point.barycentric[k];
    distances.mutable_at(i) = found[i].distance;
  }
  return py::make_tuple(faces, barycentric, distances);
}

py::array_t<double> positions(const MeshHandle& self, const ArrayArgument<Index>& faces,
                              const ArrayArgument<double>& barycentric) {
  const auto where = inputSurfacePoints(self.mesh(), faces, barycentric);
  Points result(static_cast<Eigen::Index>(where.size()), 3);
  for (std::size_t i = 0; i < where.size(); ++i) result.row(i) = position(self.mesh(), where[i]);
  return fromPoints(result);
}

py::array_t<Complex> toTangent(const MeshHandle& self, const ArrayArgument<double>& vectors) {
  const Index n = self.mesh().vertexCount();
  const auto input = inputArray<double>(vectors, "vectors", {kLeading, n, 3});
  py::array_t<Complex> result(std::vector<py::ssize_t>(input.shape(), input.shape() + input.ndim() - 1));
  const double* from = input.data();
  Complex* to = result.mutable_data();
  const auto count = static_cast<std::size_t>(result.size());
  const py::gil_scoped_release release;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    to[i] = self.charts()->toTangent(static_cast<Index>(i % n), Eigen::Map<const Vec3>(from + 3 * i));
  });
  return result;
}

py::array_t<double> toSpace(const MeshHandle& self, const ArrayArgument<Complex>& values) {
  const Index n = self.mesh().vertexCount();
  const auto input = inputArray<Complex>(values, "values", {kLeading, n});
  std::vector<py::ssize_t> shape(input.shape(), input.shape() + input.ndim());
  shape.push_back(3);
  py::array_t<double> result(shape);
  const Complex* from = input.data();
  double* to = result.mutable_data();
  const auto count = static_cast<std::size_t>(input.size());
  const py::gil_scoped_release release;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    Eigen::Map<Vec3>(to + 3 * i) = self.charts()->toSpace(static_cast<Index>(i % n), from[i]);
  });
  return result;
}

py::array_t<double> faceAreas(const MeshHandle& self) {
  const TriangleMesh& mesh = self.mesh();
  py::array_t<double> result(mesh.faceCount());
  double* to = result.mutable_data();
  for (Index f = 0; f < mesh.faceCount(); ++f) to[f] = mesh.faceArea(f);
  return result;
}

py::array_t<double> faceNormals(const MeshHandle& self) {
  const TriangleMesh& mesh = self.mesh();
  Points result(mesh.faceCount(), 3);
  for (Index f = 0; f < mesh.faceCount(); ++f) result.row(f) = mesh.faceNormal(f);
  return fromPoints(result);
}

py::array_t<Index> components(const MeshHandle& self) {
  py::array_t<Index> result(self.mesh().vertexCount());
  for (Index v = 0; v < self.mesh().vertexCount(); ++v) result.mutable_at(v) = self.mesh().component(v);
  return result;
}

}  // namespace

MeshHandle::MeshHandle(std::shared_ptr<const TriangleMesh> mesh)
    : charts_(std::make_shared<const VertexCharts>(std::move(mesh))) {}

MeshArrays inputMesh(const ArrayArgument<double>& vertices, const ArrayArgument<Index>& triangles) {
  const auto v = inputArray<double>(vertices, "vertices", {kAny, 3});
  const auto t = inputArray<Index>(triangles, "triangles", {kAny, 3});
  return {toPoints(v), Eigen::Map<const Triangles>(t.data(), t.shape(0), 3)};
}

std::shared_ptr<MeshHandle> builtMesh(const MeshArrays& arrays, Progress& progress) {
  auto mesh = std::make_shared<const TriangleMesh>(arrays.points, arrays.triangles);
  progress.check();
  progress.report(0.6);
  auto handle = std::make_shared<MeshHandle>(std::move(mesh));
  progress.check();
  progress.report(0.8);
  return handle;
}

const ClosestPointQuery& MeshHandle::closestPoints() const {
  std::call_once(built_, [this] { query_.emplace(charts_->meshPointer()); });
  return *query_;
}

const std::shared_ptr<const FlatFaces>& MeshHandle::flatFaces() const {
  std::call_once(unfolded_, [this] { flatFaces_ = std::make_shared<const FlatFaces>(charts_); });
  return flatFaces_;
}

const StreamFunctionSolver& MeshHandle::streamFunctions() const {
  std::call_once(factorized_, [this] { streamFunctions_.emplace(charts_); });
  return *streamFunctions_;
}

std::vector<SurfacePoint> inputSurfacePoints(const TriangleMesh& mesh, const ArrayArgument<Index>& faces,
                                             const ArrayArgument<double>& barycentric) {
  const auto f = inputArray<Index>(faces, "faces", {kAny});
  const auto b = inputArray<double>(barycentric, "barycentric", {f.shape(0), 3});
  std::vector<SurfacePoint> result(f.shape(0));
  for (py::ssize_t i = 0; i < f.shape(0); ++i) {
    result[i] = {f.at(i), {b.at(i, 0), b.at(i, 1), b.at(i, 2)}};
    if (result[i].face < 0 || result[i].face >= mesh.faceCount()) {
      throw InputError(message("faces[", i, "] is ", result[i].face, "; keep it between 0 and ", mesh.faceCount() - 1));
    }
    // Written so that a NaN fails as well.
    const Eigen::Vector3d& coordinates = result[i].barycentric;
    if (!(coordinates.minCoeff() >= -1e-6 && std::abs(coordinates.sum() - 1.0) <= 1e-6)) {
      throw InputError(message("barycentric[", i, "] is not a point of its face; give coordinates >= 0 with sum 1"));
    }
  }
  return result;
}

void bind_mesh(py::module_& m) {
  using Handle = MeshHandle;
  py::class_<Handle, std::shared_ptr<Handle>> mesh(
      m, "TriangleMesh", py::module_local(),
      "Oriented triangle 2-manifold: with or without boundary, several components, any genus. Immutable.");
  mesh.def(
      py::init(&makeMesh), py::arg("vertices"), py::arg("triangles"), py::arg("progress") = std::shared_ptr<Progress>(),
      "vertices: (n, 3) float64, mesh units; triangles: (m, 3) int32, counter-clockwise seen from outside.\n"
      "Faces that disagree with the majority of their component are flipped (flipped_face_count).\n"
      "Raises MeshError naming the element and the cure when the surface is not a manifold, InputError on arrays of\n"
      "another shape, Cancelled.");
  mesh.def_property_readonly(
      "vertices",
      [](const py::object& self) {
        const Points& p = self.cast<const Handle&>().mesh().points();
        return readOnlyView(p.data(), {p.rows(), 3}, self);
      },
      "(n, 3) float64, mesh units.");
  mesh.def_property_readonly(
      "triangles",
      [](const py::object& self) {
        const Triangles& t = self.cast<const Handle&>().mesh().triangles();
        return readOnlyView(t.data(), {t.rows(), 3}, self);
      },
      "(m, 3) int32, after the flips.");
  mesh.def_property_readonly(
      "normals",
      [](const py::object& self) {
        const Points& p = self.cast<const Handle&>().charts()->normals();
        return readOnlyView(p.data(), {p.rows(), 3}, self);
      },
      "(n, 3) float64, unit normals of the tangent planes at the vertices.");
  mesh.def_property_readonly("face_areas", &faceAreas, "(m,) float64, square mesh units.");
  mesh.def_property_readonly("face_normals", &faceNormals, "(m, 3) float64, unit normals of the triangles.");
  mesh.def_property_readonly("components", &components,
                             "(n,) int32: component of each vertex, -1 for vertices that no face uses.");

  const auto count = [&](const char* name, Index (TriangleMesh::*get)() const, const char* doc) {
    mesh.def_property_readonly(
        name, [get](const Handle& self) { return (self.mesh().*get)(); }, doc);
  };
  count("vertex_count", &TriangleMesh::vertexCount, "Vertices, used or not.");
  count("face_count", &TriangleMesh::faceCount, "Triangles.");
  count("edge_count", &TriangleMesh::edgeCount, "Edges.");
  count("component_count", &TriangleMesh::componentCount, "Connected components.");
  count("boundary_loop_count", &TriangleMesh::boundaryLoopCount, "Closed loops of boundary edges.");
  count("euler_characteristic", &TriangleMesh::eulerCharacteristic, "V - E + F over the used vertices.");
  count("flipped_face_count", &TriangleMesh::flippedFaceCount, "Faces turned to agree with their component.");
  const auto measure = [&](const char* name, double (TriangleMesh::*get)() const, const char* doc) {
    mesh.def_property_readonly(
        name, [get](const Handle& self) { return (self.mesh().*get)(); }, doc);
  };
  measure("size", &TriangleMesh::size, "Square root of the total area, mesh units.");
  measure("mean_edge_length", &TriangleMesh::meanEdgeLength, "Mesh units.");
  measure("total_area", &TriangleMesh::totalArea, "Square mesh units.");

  mesh.def("closest_points", &closestPoints, py::arg("points"),
           "points: (k, 3) float64 -> faces (k,) int32, barycentric (k, 3) float64, distances (k,) float64.\n"
           "Raises InputError on points that are not finite.");
  mesh.def("positions", &positions, py::arg("faces"), py::arg("barycentric"),
           "faces (k,) int32, barycentric (k, 3) float64 -> positions (k, 3) float64, mesh units. Raises InputError on "
           "points\n"
           "outside their faces.");
  mesh.def(
      "to_tangent", &toTangent, py::arg("vectors"),
      "vectors in space (..., n, 3) float64 -> tangent vectors (..., n) complex128 in the charts of the vertices;\n"
      "normal parts are dropped. Raises InputError on another shape.");
  mesh.def("to_space", &toSpace, py::arg("values"),
           "tangent values (..., n) complex128 -> vectors in space (..., n, 3) float64. Raises InputError on another "
           "shape.");
}

}  // namespace stormfield::bindings
