#include <pybind11/stl.h>
#include <tbb/parallel_for.h>

#include <limits>

#include "bindings/bindings.h"
#include "tracing/pathline.h"
#include "tracing/streamline.h"

namespace stormfield::bindings {
namespace {

constexpr const char* kStopReasons[] = {"time", "length", "minimal_speed", "boundary", "step_limit", "visitor"};

/// Python's Traces: with the mesh, for positions.
struct TracesHandle {
  std::shared_ptr<MeshHandle> mesh;
  Traces traces;
};

template <typename Choice>
Choice oneOf(const std::string& given, const char* what, const std::pair<const char*, Choice> (&choices)[2]) {
  for (const auto& [name, choice] : choices) {
    if (given == name) return choice;
  }
  throw InputError(message(what, " '", given, "'; choose ", choices[0].first, " or ", choices[1].first));
}

TraceOptions makeOptions(const std::string& direction, double maximalTime, double maximalLength, double tolerance,
                         double minimalSpeed, const std::string& boundary, Index maximalSteps) {
  TraceOptions options;
  options.direction =
      oneOf<Direction>(direction, "direction", {{"forward", Direction::Forward}, {"backward", Direction::Backward}});
  options.boundary =
      oneOf<BoundaryRule>(boundary, "boundary", {{"stop", BoundaryRule::Stop}, {"slide", BoundaryRule::Slide}});
  options.maximalTime = maximalTime;
  options.maximalLength = maximalLength;
  options.tolerance = tolerance;
  options.minimalSpeed = minimalSpeed;
  options.maximalSteps = maximalSteps;
  return options;
}

TracesHandle streamlines(const FieldHandle& field, const py::object& faces, const py::object& barycentric,
                         const std::string& direction, double maximalTime, double maximalLength, double tolerance,
                         double minimalSpeed, const std::string& boundary, Index maximalSteps,
                         const std::shared_ptr<Progress>& progress) {
  const TraceOptions options =
      makeOptions(direction, maximalTime, maximalLength, tolerance, minimalSpeed, boundary, maximalSteps);
  const auto seeds = inputSurfacePoints(field.mesh->mesh(), faces, barycentric);
  const py::gil_scoped_release release;
  return {field.mesh, traceStreamlines(*field.mesh->flatFaces(), field.field, seeds, options, progress.get())};
}

/// One number for all seeds, or one per seed.
std::vector<double> perSeed(const py::object& argument, const char* name, std::size_t count) {
  if (py::isinstance<py::array>(argument)) {
    return toVector(inputArray<double>(argument, name, {static_cast<py::ssize_t>(count)}));
  }
  return std::vector<double>(count, argument.cast<double>());
}

TracesHandle pathlines(const ParameterizedFieldHandle& field, const py::object& times, const py::object& lambdas,
                       const py::object& faces, const py::object& barycentric, const py::object& start,
                       const py::object& duration, double speed, const std::string& direction, double maximalLength,
                       double tolerance, const std::string& boundary, Index maximalSteps,
                       const std::shared_ptr<Progress>& progress) {
  const TraceOptions options =
      makeOptions(direction, TraceOptions{}.maximalTime, maximalLength, tolerance, 0.0, boundary, maximalSteps);
  const auto t = inputArray<double>(times, "times", {kAny});
  const LambdaTrack track{toVector(t), toVector(inputArray<double>(lambdas, "lambdas", {t.shape(0)}))};
  const auto points = inputSurfacePoints(field.mesh->mesh(), faces, barycentric);
  const auto starts = perSeed(start, "start", points.size()), durations = perSeed(duration, "duration", points.size());
  std::vector<PathlineSeed> seeds(points.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = {points[i], starts[i], durations[i]};
  const py::gil_scoped_release release;
  const UnsteadyField flow(*field.mesh->flatFaces(), field.field, track, speed);
  return {field.mesh, tracePathlines(flow, seeds, options, progress.get())};
}

py::array_t<double> positions(const TracesHandle& self) {
  Points result(static_cast<Eigen::Index>(self.traces.points.size()), 3);
  tbb::parallel_for(std::size_t{0}, self.traces.points.size(), [&](std::size_t i) {
    result.row(static_cast<Eigen::Index>(i)) = position(self.mesh->mesh(), self.traces.points[i]);
  });
  return fromPoints(result);
}

/// An array with one element per point or per trace.
template <typename T, typename Items, typename Get>
py::array_t<T> each(const Items& items, const Get& get) {
  py::array_t<T> result(static_cast<py::ssize_t>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) result.mutable_at(static_cast<py::ssize_t>(i)) = get(items[i]);
  return result;
}

}  // namespace

void bind_tracing(py::module_& m) {
  py::class_<TracesHandle>(
      m, "Traces", py::module_local(),
      "Curves on the surface. Trace i has the points offsets[i]:offsets[i + 1], from its seed to its "
      "end,\none per edge crossing and integration step. Immutable.")
      .def("__len__", [](const TracesHandle& self) { return self.traces.ends.size(); })
      .def_property_readonly(
          "offsets",
          [](const TracesHandle& self) {
            return each<std::int64_t>(self.traces.offsets, [](std::size_t i) { return static_cast<std::int64_t>(i); });
          },
          "(k + 1,) int64.")
      .def_property_readonly("points", &positions, "(p, 3) float64, positions in mesh units.")
      .def_property_readonly(
          "faces",
          [](const TracesHandle& self) {
            return each<Index>(self.traces.points, [](const SurfacePoint& p) { return p.face; });
          },
          "(p,) int32.")
      .def_property_readonly(
          "barycentric",
          [](const TracesHandle& self) {
            Points result(static_cast<Eigen::Index>(self.traces.points.size()), 3);
            for (std::size_t i = 0; i < self.traces.points.size(); ++i) {
              result.row(static_cast<Eigen::Index>(i)) = self.traces.points[i].barycentric;
            }
            return fromPoints(result);
          },
          "(p, 3) float64, coordinates in the faces.")
      .def_property_readonly(
          "times", [](const TracesHandle& self) { return copied(self.traces.times); },
          "(p,) float64, seconds since the seed, positive in either direction.")
      .def_property_readonly(
          "lengths",
          [](const TracesHandle& self) {
            return each<double>(self.traces.ends, [](const TraceEnd& end) { return end.length; });
          },
          "(k,) float64, length of each trace in mesh units.")
      .def_property_readonly(
          "reasons",
          [](const TracesHandle& self) {
            py::list result;
            for (const TraceEnd& end : self.traces.ends) result.append(kStopReasons[static_cast<int>(end.reason)]);
            return result;
          },
          "list of k str, why each trace ends: time, length, minimal_speed (a fixed point is near), boundary, "
          "step_limit.");

  const double infinity = std::numeric_limits<double>::infinity();
  const TraceOptions defaults;
  m.def(
      "trace_streamlines", &streamlines, py::arg("field"), py::arg("faces"), py::arg("barycentric"), py::kw_only(),
      py::arg("direction") = "forward", py::arg("maximal_time") = infinity, py::arg("maximal_length") = infinity,
      py::arg("tolerance") = defaults.tolerance, py::arg("minimal_speed") = defaults.minimalSpeed,
      py::arg("boundary") = "stop", py::arg("maximal_steps") = defaults.maximalSteps,
      py::arg("progress") = std::shared_ptr<Progress>(),
      "Streamlines of a VectorField through seeds: faces (k,) int32, barycentric (k, 3) float64 -> Traces.\n\n"
      "direction: forward or backward. maximal_time: seconds. maximal_length: mesh units. tolerance: largest "
      "estimated\n"
      "error of a step in mean edge lengths. minimal_speed: part of the fastest vertex's speed at which a trace ends.\n"
      "boundary: stop, or slide along it. Runs in parallel with the same result for any number of threads.\n"
      "Raises InputError (naming the seed or option) and Cancelled.");
  m.def(
      "trace_pathlines", &pathlines, py::arg("field"), py::arg("times"), py::arg("lambdas"), py::arg("faces"),
      py::arg("barycentric"), py::arg("start"), py::arg("duration"), py::kw_only(), py::arg("speed") = 1.0,
      py::arg("direction") = "forward", py::arg("maximal_length") = infinity, py::arg("tolerance") = defaults.tolerance,
      py::arg("boundary") = "stop", py::arg("maximal_steps") = defaults.maximalSteps,
      py::arg("progress") = std::shared_ptr<Progress>(),
      "Pathlines of a ParameterizedField along lambda(t): times (s,) seconds, increasing, with lambdas (s,), linear\n"
      "between and constant outside. start and duration: seconds, one number or (k,) float64; backward traces go from\n"
      "start to earlier times. speed: factor on the field. The rest as in trace_streamlines. -> Traces.");
}

}  // namespace stormfield::bindings
