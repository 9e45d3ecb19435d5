#include "bindings/bindings.h"
#include "bindings/job.h"

namespace stormfield::bindings {
namespace {

using Handle = std::shared_ptr<MeshHandle>;

Work<Handle> prepareMesh(const ArrayArgument<double>& vertices, const ArrayArgument<Index>& triangles) {
  return [arrays = inputMesh(vertices, triangles)](Progress& progress) {
    auto handle = builtMesh(arrays, progress);
    handle->flatFaces();
    progress.check();
    return handle;
  };
}

}  // namespace

void bind_mesh_job(py::module_& m) {
  bindJob<Handle>(m, "MeshJob", "A mesh that is being built on a thread of its own.",
                  [](const Handle& handle) { return handle; })
      .defStart(m, "triangle_mesh", &prepareMesh,
                "TriangleMesh(vertices, triangles), with all that tracing needs of it.\n\n"
                "vertices: (n, 3) float64, mesh units; triangles: (m, 3) int32. The build has few stages, and stops\n"
                "between them: a caller that must not wait keeps the cancelled job until it is done. Memory: that of\n"
                "the mesh and a copy of the arrays. Raises what TriangleMesh raises.",
                py::arg("vertices"), py::arg("triangles"));
}

}  // namespace stormfield::bindings
