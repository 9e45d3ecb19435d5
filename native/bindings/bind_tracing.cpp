#include <pybind11/stl.h>

#include <limits>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "bindings/surface_points.h"
#include "tracing/particle_lines.h"
#include "tracing/pathline.h"
#include "tracing/streamline.h"

namespace stormfield::bindings {
namespace {

constexpr const char* kStopReasons[] = {"time", "length", "min_speed", "boundary", "step_limit", "visitor"};

/// Python's Traces and ParticleLines: with the mesh, for positions.
struct TracesHandle {
  std::shared_ptr<MeshHandle> mesh;
  Traces traces;
};
struct ParticleLinesHandle {
  std::shared_ptr<MeshHandle> mesh;
  ParticleLines lines;
};

using TracesJob = Job<std::shared_ptr<const TracesHandle>>;
using ParticleLinesJob = Job<std::shared_ptr<const std::vector<ParticleLinesHandle>>>;

template <typename Choice>
Choice oneOf(const std::string& given, const char* what, const std::pair<const char*, Choice> (&choices)[2]) {
  for (const auto& [name, choice] : choices) {
    if (given == name) return choice;
  }
  throw InputError(message(what, " '", given, "'; choose ", choices[0].first, " or ", choices[1].first));
}

TraceOptions makeOptions(const std::string& direction, double maxTime, double maxLength, double tolerance,
                         double minSpeed, const std::string& boundary, Index maxSteps) {
  TraceOptions options;
  options.direction =
      oneOf<Direction>(direction, "direction", {{"forward", Direction::Forward}, {"backward", Direction::Backward}});
  options.boundary =
      oneOf<BoundaryRule>(boundary, "boundary", {{"stop", BoundaryRule::Stop}, {"slide", BoundaryRule::Slide}});
  options.maxTime = maxTime;
  options.maxLength = maxLength;
  options.tolerance = tolerance;
  options.minSpeed = minSpeed;
  options.maxSteps = maxSteps;
  return options;
}

TracesHandle streamlines(const FieldHandle& field, const py::object& faces, const py::object& barycentric,
                         const std::string& direction, double maxTime, double maxLength, double tolerance,
                         double minSpeed, const std::string& boundary, Index maxSteps,
                         const std::shared_ptr<Progress>& progress) {
  const TraceOptions options = makeOptions(direction, maxTime, maxLength, tolerance, minSpeed, boundary, maxSteps);
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

std::shared_ptr<TracesJob> startStreamlines(const FieldHandle& field, const py::object& faces,
                                            const py::object& barycentric, const std::string& direction, double maxTime,
                                            double maxLength, double tolerance, double minSpeed,
                                            const std::string& boundary, Index maxSteps) {
  const TraceOptions options = makeOptions(direction, maxTime, maxLength, tolerance, minSpeed, boundary, maxSteps);
  const auto seeds = inputSurfacePoints(field.mesh->mesh(), faces, barycentric);
  return std::make_shared<TracesJob>([field, seeds, options](Progress& progress) {
    return std::make_shared<const TracesHandle>(
        TracesHandle{field.mesh, traceStreamlines(*field.mesh->flatFaces(), field.field, seeds, options, &progress)});
  });
}

LambdaTrack lambdaTrack(const py::object& times, const py::object& lambdas) {
  const auto t = inputArray<double>(times, "times", {kAny});
  return {toVector(t), toVector(inputArray<double>(lambdas, "lambdas", {t.shape(0)}))};
}

LineOptions lineOptions(double spacing, double interval, double tolerance, const std::string& boundary,
                        Index maxParticles) {
  LineOptions options;
  options.spacing = spacing;
  options.interval = interval;
  options.tolerance = tolerance;
  options.boundary =
      oneOf<BoundaryRule>(boundary, "boundary", {{"stop", BoundaryRule::Stop}, {"slide", BoundaryRule::Slide}});
  options.maxParticles = maxParticles;
  return options;
}

/// trace: (flow, progress) -> lines at each time.
template <typename Trace>
std::shared_ptr<ParticleLinesJob> startLines(const ParameterizedFieldHandle& field, const LambdaTrack& track,
                                             double speed, const Trace& trace) {
  return std::make_shared<ParticleLinesJob>([field, track, speed, trace](Progress& progress) {
    const UnsteadyField flow(*field.mesh->flatFaces(), field.field, track, speed);
    auto result = std::make_shared<std::vector<ParticleLinesHandle>>();
    for (ParticleLines& lines : trace(flow, progress)) result->push_back({field.mesh, std::move(lines)});
    return std::shared_ptr<const std::vector<ParticleLinesHandle>>(std::move(result));
  });
}

std::shared_ptr<ParticleLinesJob> startStreaklines(const ParameterizedFieldHandle& field, const py::object& times,
                                                   const py::object& lambdas, const py::object& faces,
                                                   const py::object& barycentric, double start, const py::object& at,
                                                   double speed, double spacing, double interval, double tolerance,
                                                   const std::string& boundary, Index maxParticles) {
  const auto seeds = inputSurfacePoints(field.mesh->mesh(), faces, barycentric);
  const auto when = toVector(inputArray<double>(at, "at", {kAny}));
  const LineOptions options = lineOptions(spacing, interval, tolerance, boundary, maxParticles);
  return startLines(field, lambdaTrack(times, lambdas), speed, [=](const UnsteadyField& flow, Progress& progress) {
    return traceStreaklines(flow, seeds, start, when, options, &progress);
  });
}

std::shared_ptr<ParticleLinesJob> startTimelines(const ParameterizedFieldHandle& field, const py::object& times,
                                                 const py::object& lambdas, const py::iterable& curves, double start,
                                                 const py::object& at, double speed, double spacing, double tolerance,
                                                 const std::string& boundary, Index maxParticles) {
  std::vector<std::vector<SurfacePoint>> given;
  for (const py::handle curve : curves) {
    const auto parts = py::cast<py::tuple>(curve);
    if (parts.size() != 2) throw InputError("a curve of a timeline is (faces, barycentric)");
    given.push_back(inputSurfacePoints(field.mesh->mesh(), parts[0], parts[1]));
  }
  const auto when = toVector(inputArray<double>(at, "at", {kAny}));
  const LineOptions options =
      lineOptions(spacing, std::numeric_limits<double>::infinity(), tolerance, boundary, maxParticles);
  return startLines(field, lambdaTrack(times, lambdas), speed, [=](const UnsteadyField& flow, Progress& progress) {
    return traceTimelines(flow, given, start, when, options, &progress);
  });
}

std::vector<PathlineSeed> pathlineSeeds(const ParameterizedFieldHandle& field, const py::object& faces,
                                        const py::object& barycentric, const py::object& start,
                                        const py::object& duration) {
  const auto points = inputSurfacePoints(field.mesh->mesh(), faces, barycentric);
  const auto starts = perSeed(start, "start", points.size()), durations = perSeed(duration, "duration", points.size());
  std::vector<PathlineSeed> seeds(points.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = {points[i], starts[i], durations[i]};
  return seeds;
}

std::shared_ptr<TracesJob> startPathlines(const ParameterizedFieldHandle& field, const py::object& times,
                                          const py::object& lambdas, const py::object& faces,
                                          const py::object& barycentric, const py::object& start,
                                          const py::object& duration, double speed, const std::string& direction,
                                          double maxLength, double tolerance, const std::string& boundary,
                                          Index maxSteps) {
  const TraceOptions options =
      makeOptions(direction, TraceOptions{}.maxTime, maxLength, tolerance, 0.0, boundary, maxSteps);
  const LambdaTrack track = lambdaTrack(times, lambdas);
  const auto seeds = pathlineSeeds(field, faces, barycentric, start, duration);
  return std::make_shared<TracesJob>([field, track, seeds, speed, options](Progress& progress) {
    const UnsteadyField flow(*field.mesh->flatFaces(), field.field, track, speed);
    return std::make_shared<const TracesHandle>(
        TracesHandle{field.mesh, tracePathlines(flow, seeds, options, &progress)});
  });
}

TracesHandle pathlines(const ParameterizedFieldHandle& field, const py::object& times, const py::object& lambdas,
                       const py::object& faces, const py::object& barycentric, const py::object& start,
                       const py::object& duration, double speed, const std::string& direction, double maxLength,
                       double tolerance, const std::string& boundary, Index maxSteps,
                       const std::shared_ptr<Progress>& progress) {
  const TraceOptions options =
      makeOptions(direction, TraceOptions{}.maxTime, maxLength, tolerance, 0.0, boundary, maxSteps);
  const LambdaTrack track = lambdaTrack(times, lambdas);
  const auto seeds = pathlineSeeds(field, faces, barycentric, start, duration);
  const py::gil_scoped_release release;
  const UnsteadyField flow(*field.mesh->flatFaces(), field.field, track, speed);
  return {field.mesh, tracePathlines(flow, seeds, options, progress.get())};
}

/// An array with one element per point or per trace.
template <typename T, typename Items, typename Get>
py::array_t<T> each(const Items& items, const Get& get) {
  py::array_t<T> result(static_cast<py::ssize_t>(items.size()));
  for (std::size_t i = 0; i < items.size(); ++i) result.mutable_at(static_cast<py::ssize_t>(i)) = get(items[i]);
  return result;
}

void bindLines(py::module_& m) {
  using Lines = ParticleLinesHandle;
  py::class_<Lines> handles(
      m, "ParticleLines", py::module_local(),
      "Streaklines or timelines at one time. Line i has the particles offsets[i]:offsets[i + 1]. Immutable.");
  bindLinePoints(handles, &Lines::lines);
  handles.def("__len__", [](const Lines& self) { return self.lines.offsets.size() - 1; })
      .def_property_readonly(
          "time", [](const Lines& self) { return self.lines.time; }, "Seconds.")
      .def_property_readonly(
          "ages", [](const Lines& self) { return copied(self.lines.ages); }, "(p,) float64, seconds since release.")
      .def_property_readonly(
          "parameters", [](const Lines& self) { return copied(self.lines.parameters); },
          "(p,) float64, increasing along a line: the time of release in seconds (streaklines), or the place along "
          "the\n"
          "given curve, k + f for the fraction f of the way from its point k to the next (timelines).")
      .def_property_readonly(
          "torn", [](const Lines& self) { return each<bool>(self.lines.torn, [](char torn) { return torn != 0; }); },
          "(p,) bool, whether the line is torn between this particle and the next.");
  bindJob<TracesJob>(m, "TracesJob", "Traces being made on the core's threads; result() is Traces.",
                     [](const std::shared_ptr<const TracesHandle>& traces) { return py::cast(*traces); });
  bindJob<ParticleLinesJob>(m, "ParticleLinesJob",
                            "Streaklines or timelines being made on the core's threads; result() is a list of\n"
                            "ParticleLines, one per time.",
                            [](const std::shared_ptr<const std::vector<Lines>>& lines) { return py::cast(*lines); });

  const double infinity = std::numeric_limits<double>::infinity();
  const TraceOptions traces;
  const LineOptions lines;
  m.def("start_streamlines", &startStreamlines, py::arg("field"), py::arg("faces"), py::arg("barycentric"),
        py::kw_only(), py::arg("direction") = "forward", py::arg("max_time") = infinity,
        py::arg("max_length") = infinity, py::arg("tolerance") = traces.tolerance,
        py::arg("min_speed") = traces.minSpeed, py::arg("boundary") = "stop", py::arg("max_steps") = traces.maxSteps,
        "As trace_streamlines, without waiting. -> TracesJob.");
  m.def("start_pathlines", &startPathlines, py::arg("field"), py::arg("times"), py::arg("lambdas"), py::arg("faces"),
        py::arg("barycentric"), py::arg("start"), py::arg("duration"), py::kw_only(), py::arg("speed") = 1.0,
        py::arg("direction") = "forward", py::arg("max_length") = infinity, py::arg("tolerance") = traces.tolerance,
        py::arg("boundary") = "stop", py::arg("max_steps") = traces.maxSteps,
        "As trace_pathlines, without waiting. -> TracesJob.");
  m.def(
      "start_streaklines", &startStreaklines, py::arg("field"), py::arg("times"), py::arg("lambdas"), py::arg("faces"),
      py::arg("barycentric"), py::arg("start"), py::arg("at"), py::kw_only(), py::arg("speed") = 1.0,
      py::arg("spacing") = infinity, py::arg("interval") = infinity, py::arg("tolerance") = lines.tolerance,
      py::arg("boundary") = "stop", py::arg("max_particles") = lines.maxParticles,
      "Streaklines of a ParameterizedField at the times `at` (f,) seconds, increasing: where the particles are that\n"
      "were released at each seed from `start` on, the oldest first (thesis 10.1.2). -> ParticleLinesJob, whose\n"
      "result is a list of f ParticleLines.\n\n"
      "times, lambdas, speed, tolerance, boundary: as in trace_pathlines. spacing: largest distance of neighbours in\n"
      "mesh units, where they are farther apart more particles are released between them. interval: largest time\n"
      "between two releases, seconds. Raises InputError, also for a line of more than max_particles.");
  m.def("start_timelines", &startTimelines, py::arg("field"), py::arg("times"), py::arg("lambdas"), py::arg("curves"),
        py::arg("start"), py::arg("at"), py::kw_only(), py::arg("speed") = 1.0, py::arg("spacing") = infinity,
        py::arg("tolerance") = lines.tolerance, py::arg("boundary") = "stop",
        py::arg("max_particles") = lines.maxParticles,
        "Timelines: where at the times `at` the particles are that lay on the curves at `start` (thesis 10.1.2).\n"
        "curves: list of (faces (k,) int32, barycentric (k, 3) float64), points joined by the shortest way. The rest\n"
        "as in start_streaklines. -> ParticleLinesJob.");
}

}  // namespace

void bind_tracing(py::module_& m) {
  py::class_<TracesHandle, std::shared_ptr<TracesHandle>> handles(
      m, "Traces", py::module_local(),
      "Curves on the surface. Trace i has the points offsets[i]:offsets[i + 1], from its seed to its "
      "end,\none per edge crossing and integration step. Immutable.");
  bindLinePoints(handles, &TracesHandle::traces);
  handles.def("__len__", [](const TracesHandle& self) { return self.traces.ends.size(); })
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
          "list of k str, why each trace ends: time, length, min_speed (a fixed point is near), boundary, "
          "step_limit.");

  const double infinity = std::numeric_limits<double>::infinity();
  const TraceOptions defaults;
  m.def("trace_streamlines", &streamlines, py::arg("field"), py::arg("faces"), py::arg("barycentric"), py::kw_only(),
        py::arg("direction") = "forward", py::arg("max_time") = infinity, py::arg("max_length") = infinity,
        py::arg("tolerance") = defaults.tolerance, py::arg("min_speed") = defaults.minSpeed,
        py::arg("boundary") = "stop", py::arg("max_steps") = defaults.maxSteps,
        py::arg("progress") = std::shared_ptr<Progress>(),
        "Streamlines of a VectorField through seeds: faces (k,) int32, barycentric (k, 3) float64 -> Traces.\n\n"
        "direction: forward or backward. max_time: seconds. max_length: mesh units. tolerance: largest "
        "estimated\n"
        "error of a step in mean edge lengths. min_speed: part of the fastest vertex's speed at which a trace ends.\n"
        "boundary: stop, or slide along it. Runs in parallel with the same result for any number of threads.\n"
        "Raises InputError (naming the seed or option) and Cancelled.");
  m.def(
      "trace_pathlines", &pathlines, py::arg("field"), py::arg("times"), py::arg("lambdas"), py::arg("faces"),
      py::arg("barycentric"), py::arg("start"), py::arg("duration"), py::kw_only(), py::arg("speed") = 1.0,
      py::arg("direction") = "forward", py::arg("max_length") = infinity, py::arg("tolerance") = defaults.tolerance,
      py::arg("boundary") = "stop", py::arg("max_steps") = defaults.maxSteps,
      py::arg("progress") = std::shared_ptr<Progress>(),
      "Pathlines of a ParameterizedField along lambda(t): times (s,) seconds, increasing, with lambdas (s,), linear\n"
      "between and constant outside. start and duration: seconds, one number or (k,) float64; backward traces go from\n"
      "start to earlier times. speed: factor on the field. The rest as in trace_streamlines. -> Traces.");

  bindLines(m);
}

}  // namespace stormfield::bindings
