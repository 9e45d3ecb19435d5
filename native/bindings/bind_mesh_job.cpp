#include "bindings/bindings.h"
#include "bindings/job.h"

namespace stormfield::bindings {
namespace {

using Handle = std::shared_ptr<MeshHandle>;

std::shared_ptr<Job<Handle>> startMesh(const py::object& vertices, const py::object& triangles,
                                       const std::shared_ptr<Progress>& progress) {
  const auto v = inputArray<double>(vertices, "vertices", {kAny, 3});
  const auto t = inputArray<Index>(triangles, "triangles", {kAny, 3});
  Points points = toPoints(v);
  Triangles faces = Eigen::Map<const Triangles>(t.data(), t.shape(0), 3);
  auto work = [points = std::move(points), faces = std::move(faces)](Progress& p) {
    auto mesh = std::make_shared<const TriangleMesh>(points, faces);
    p.check();
    p.report(0.6);
    auto handle = std::make_shared<MeshHandle>(std::move(mesh));
    p.check();
    p.report(0.8);
    handle->flatFaces();
    p.check();
    return handle;
  };
  return std::make_shared<Job<Handle>>(work, progress);
}

}  // namespace

void bind_mesh_job(py::module_& m) {
  bindJob<Job<Handle>>(m, "MeshJob", "A mesh that is being built on a thread of its own.",
                       [](const Handle& handle) { return handle; });
  m.def("start_mesh", &startMesh, py::arg("vertices"), py::arg("triangles"),
        py::arg("progress") = std::shared_ptr<Progress>(),
        "TriangleMesh(vertices, triangles), with all that tracing needs of it, on a thread of its own -> MeshJob.\n"
        "result() raises what TriangleMesh raises. The build has few stages, and stops between them: a caller that\n"
        "must not wait keeps the cancelled job until it is done. Memory: that of the mesh and a copy of the arrays.");
}

}  // namespace stormfield::bindings
