#include <pybind11/stl.h>

#include <algorithm>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "streamlines/evenly_spaced.h"

namespace stormfield::bindings {
namespace {

/// Python's EvenStreamlines: with the mesh, for positions.
struct EvenStreamlinesHandle {
  std::shared_ptr<MeshHandle> mesh;
  EvenStreamlines lines;
};
using StreamlinesJob = Job<std::shared_ptr<const EvenStreamlinesHandle>>;

GivenCurve givenCurve(const TriangleMesh& mesh, const py::handle& item) {
  const auto parts = py::cast<py::tuple>(item);
  if (parts.size() != 4) throw InputError("a given curve is (faces, barycentric, closed, against_flow)");
  return {inputSurfacePoints(mesh, parts[0], parts[1]), parts[2].cast<bool>(), parts[3].cast<bool>()};
}

std::shared_ptr<StreamlinesJob> start(const FieldHandle& field, double distance, const py::iterable& curves,
                                      bool fixedPoints, double minimalSpeed) {
  StreamlineFeatures features;
  for (const py::handle curve : curves) features.curves.push_back(givenCurve(field.mesh->mesh(), curve));
  const EvenSpacing spacing{distance, minimalSpeed};
  return std::make_shared<StreamlinesJob>(
      [mesh = field.mesh, values = field.field, features = std::move(features), spacing, fixedPoints](Progress& p) {
        StreamlineFeatures all = features;
        if (fixedPoints) all.fixedPoints = findFixedPoints(values);
        return std::make_shared<const EvenStreamlinesHandle>(
            EvenStreamlinesHandle{mesh, placeStreamlines(*mesh->flatFaces(), values, spacing, all, &p)});
      });
}

Points positions(const MeshHandle& mesh, const std::vector<SurfacePoint>& points) {
  Points result(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.row(static_cast<Eigen::Index>(i)) = position(mesh.mesh(), points[i]);
  }
  return result;
}

}  // namespace

void bind_streamlines(py::module_& m) {
  py::class_<EvenStreamlinesHandle, std::shared_ptr<EvenStreamlinesHandle>>(
      m, "EvenStreamlines", py::module_local(),
      "Evenly spaced streamlines. Line i has the points offsets[i]:offsets[i + 1], in the direction of the flow; "
      "closed\n"
      "lines do not repeat their first point. Immutable.")
      .def("__len__", [](const EvenStreamlinesHandle& self) { return self.lines.closed.size(); })
      .def_property_readonly(
          "offsets",
          [](const EvenStreamlinesHandle& self) {
            return copied(std::vector<std::int64_t>(self.lines.offsets.begin(), self.lines.offsets.end()));
          },
          "(k + 1,) int64.")
      .def_property_readonly(
          "points",
          [](const EvenStreamlinesHandle& self) { return fromPoints(positions(*self.mesh, self.lines.points)); },
          "(p, 3) float64, mesh units.")
      .def_property_readonly(
          "faces",
          [](const EvenStreamlinesHandle& self) {
            std::vector<Index> faces;
            for (const SurfacePoint& p : self.lines.points) faces.push_back(p.face);
            return copied(faces);
          },
          "(p,) int32.")
      .def_property_readonly(
          "barycentric",
          [](const EvenStreamlinesHandle& self) {
            Points result(static_cast<Eigen::Index>(self.lines.points.size()), 3);
            for (std::size_t i = 0; i < self.lines.points.size(); ++i) {
              result.row(static_cast<Eigen::Index>(i)) = self.lines.points[i].barycentric;
            }
            return fromPoints(result);
          },
          "(p, 3) float64, coordinates in the faces.")
      .def_property_readonly(
          "arc", [](const EvenStreamlinesHandle& self) { return copied(self.lines.arc); },
          "(p,) float64, length along the line, mesh units.")
      .def_property_readonly(
          "speed", [](const EvenStreamlinesHandle& self) { return copied(self.lines.speed); },
          "(p,) float64, mesh units per second.")
      .def_property_readonly(
          "taper", [](const EvenStreamlinesHandle& self) { return copied(self.lines.taper); },
          "(p,) float64, 0..1: a factor for the width, falling at ends and where lines come near each other.")
      .def_property_readonly(
          "closed",
          [](const EvenStreamlinesHandle& self) {
            py::array_t<bool> result(static_cast<py::ssize_t>(self.lines.closed.size()));
            std::copy(self.lines.closed.begin(), self.lines.closed.end(), result.mutable_data());
            return result;
          },
          "(k,) bool.")
      .def_property_readonly(
          "given", [](const EvenStreamlinesHandle& self) { return copied(self.lines.given); },
          "(k,) int32, the given curve that the line is, -1 for the others.")
      .def_property_readonly(
          "quiet_area", [](const EvenStreamlinesHandle& self) { return self.lines.quietArea; },
          "Part of the surface, 0..1, where the field stands still.")
      .def_property_readonly(
          "gaps", [](const EvenStreamlinesHandle& self) { return fromPoints(positions(*self.mesh, self.lines.gaps)); },
          "(g, 3) float64, places where no line could be drawn although the field flows; mostly none.");

  bindJob<StreamlinesJob>(m, "StreamlinesJob", "Placement of evenly spaced streamlines; result() is EvenStreamlines.",
                          [](const std::shared_ptr<const EvenStreamlinesHandle>& result) {
                            return std::const_pointer_cast<EvenStreamlinesHandle>(result);
                          });
  m.def(
      "start_evenly_spaced_streamlines", &start, py::arg("field"), py::arg("distance"), py::kw_only(),
      py::arg("curves") = py::tuple(), py::arg("fixed_points") = true,
      py::arg("minimal_speed") = EvenSpacing{}.minimalSpeed,
      "Evenly spaced streamlines of a VectorField, topology first (thesis 3.4) -> StreamlinesJob.\n\n"
      "distance: between lines, mesh units. curves: known streamlines that the others leave room, each (faces (k,)\n"
      "int32, barycentric (k, 3) float64, closed, against_flow), from the end that stays; orbits before separatrices.\n"
      "fixed_points: whether lines begin around them. minimal_speed: part of the fastest vertex's speed that counts\n"
      "as standing still. The same result for any number of threads. Raises InputError and Cancelled.");
}

}  // namespace stormfield::bindings
