#include <pybind11/stl.h>

#include <algorithm>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "bindings/surface_points.h"
#include "streamlines/topology_features.h"

namespace stormfield::bindings {
namespace {

/// Python's EvenStreamlines: with the mesh, for positions.
struct EvenStreamlinesHandle {
  std::shared_ptr<MeshHandle> mesh;
  EvenStreamlines lines;
  std::vector<Index> roles;
};

/// What a line is. The numbers are those of Python's roles.
enum class LineRole : Index { Between = 0, Closed = 1, WithFlow = 2, AgainstFlow = 3 };

LineRole role(const GivenCurve& curve) {
  return curve.closed ? LineRole::Closed : curve.againstFlow ? LineRole::AgainstFlow : LineRole::WithFlow;
}

/// (faces, barycentric, closed, against_flow) of each curve.
using KnownCurves = py::typing::Iterable<py::typing::Tuple<ArrayArgument<Index>, ArrayArgument<double>, bool, bool>>;

using EvenStreamlinesPointer = std::shared_ptr<const EvenStreamlinesHandle>;

GivenCurve givenCurve(const TriangleMesh& mesh, const py::handle& item) {
  const auto fields = py::cast<py::tuple>(item);
  if (fields.size() != 4) throw InputError("a given curve is (faces, barycentric, closed, against_flow)");
  return {.points = inputSurfacePoints(mesh, fields[0], fields[1]),
          .closed = fields[2].cast<bool>(),
          .againstFlow = fields[3].cast<bool>()};
}

/// Fraction of the progress that the topology stands for.
constexpr double kTopology = 0.4;

Work<EvenStreamlinesPointer> prepare(const FieldHandle& field, double distance, bool topology,
                                     const KnownCurves& curves, double minSpeed) {
  std::vector<GivenCurve> given;
  for (const py::handle curve : curves) given.push_back(givenCurve(field.mesh->mesh(), curve));
  const EvenSpacing spacing{distance, minSpeed};
  return [mesh = field.mesh, values = field.field, given = std::move(given), spacing, topology](Progress& progress) {
    const FlatFaces& faces = *mesh->flatFaces();
    checkSpacing(mesh->mesh(), spacing);
    StreamlineFeatures features;
    if (topology) {
      progress.range(0.0, kTopology);
      features = featuresOf(findTopology(faces, values, {}, &progress));
      progress.range(kTopology, 1.0);
    } else {
      features.fixedPoints = findFixedPoints(values);
    }
    features.curves.insert(features.curves.begin(), given.begin(), given.end());
    EvenStreamlines lines = placeStreamlines(faces, values, spacing, features, &progress);
    std::vector<Index> roles;
    for (const Index i : lines.given) {
      roles.push_back(static_cast<Index>(i == kNone ? LineRole::Between : role(features.curves[i])));
    }
    return std::make_shared<const EvenStreamlinesHandle>(
        EvenStreamlinesHandle{mesh, std::move(lines), std::move(roles)});
  };
}

}  // namespace

void bind_streamlines(py::module_& m) {
  py::class_<EvenStreamlinesHandle, std::shared_ptr<EvenStreamlinesHandle>> streamlines(
      m, "EvenStreamlines", py::module_local(),
      "Evenly spaced streamlines. Line i has the points offsets[i]:offsets[i + 1], in the direction of the flow; "
      "closed\n"
      "lines do not repeat their first point. Immutable.");
  bindLinePoints(streamlines, &EvenStreamlinesHandle::lines);
  streamlines.def("__len__", [](const EvenStreamlinesHandle& self) { return self.lines.closed.size(); })
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
          "roles", [](const EvenStreamlinesHandle& self) { return copied(self.roles); },
          "(k,) int32: 0 a line between, 1 a periodic orbit (or closed given curve), 2 a separatrix that leaves its "
          "saddle\n"
          "(or a curve with the flow), 3 one that enters its saddle (or a curve against the flow).")
      .def_property_readonly(
          "quiet_area", [](const EvenStreamlinesHandle& self) { return self.lines.quietArea; },
          "Fraction of the surface where the field is still.")
      .def_property_readonly(
          "gaps", [](const EvenStreamlinesHandle& self) { return positionsOf(self.mesh->mesh(), self.lines.gaps); },
          "(g, 3) float64, places where no line could be drawn although the field flows; mostly none.");

  bindJob<EvenStreamlinesPointer>(
      m, "StreamlinesJob", "Evenly spaced streamlines that are being placed.",
      [](const EvenStreamlinesPointer& result) { return std::const_pointer_cast<EvenStreamlinesHandle>(result); })
      .def(m, "evenly_spaced_streamlines", &prepare,
           "Evenly spaced streamlines of a VectorField, topology first (thesis 3.4) -> EvenStreamlines.\n\n"
           "distance: between lines, mesh units. topology: whether the field's periodic orbits and separatrices are\n"
           "found and drawn first; given is then their number after the curves: orbits, then separatrices. Without,\n"
           "lines begin around fixed points. curves: more known streamlines that the others leave room, each (faces\n"
           "(k,) int32, barycentric (k, 3) float64, closed, against_flow), from the end that stays. min_speed: "
           "fraction\n"
           "of the fastest vertex's speed below which the field counts as still. The same result for any number of "
           "threads.\n"
           "Raises InputError and Cancelled.",
           py::arg("field"), py::arg("distance"), py::kw_only(), py::arg("topology") = true,
           py::arg("curves") = py::tuple(), py::arg("min_speed") = EvenSpacing().minSpeed);
}

}  // namespace stormfield::bindings
