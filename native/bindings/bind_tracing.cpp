#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "bindings/surface_points.h"
#include "tracing/particle_lines.h"
#include "tracing/pathline.h"
#include "tracing/streamline.h"

namespace stormfield::bindings {
namespace {

/// Python's Traces and ParticleLines: with the mesh, for positions.
struct TracesHandle {
  std::shared_ptr<MeshHandle> mesh;
  Traces traces;
};
struct ParticleLinesHandle {
  std::shared_ptr<MeshHandle> mesh;
  ParticleLines lines;
};

/// What timelines begin on: (faces, barycentric) of each curve.
using Curves = py::typing::Iterable<py::typing::Tuple<ArrayArgument<Index>, ArrayArgument<double>>>;

using TracesPointer = std::shared_ptr<const TracesHandle>;
using LinesPointer = std::shared_ptr<const std::vector<ParticleLinesHandle>>;

TraceOptions traceOptions(Direction direction, double maxTime, double maxLength, double tolerance, double minSpeed,
                          BoundaryRule boundary, Index maxSteps) {
  TraceOptions options;
  options.direction = direction;
  options.boundary = boundary;
  options.maxTime = maxTime;
  options.maxLength = maxLength;
  options.tolerance = tolerance;
  options.minSpeed = minSpeed;
  options.maxSteps = maxSteps;
  return options;
}

/// One number for all seeds, or one per seed.
std::vector<double> perSeed(const NumberOrArray<double>& argument, const char* name, std::size_t count) {
  if (py::isinstance<py::array>(argument)) {
    return toVector(inputArray<double>(argument, name, {static_cast<py::ssize_t>(count)}));
  }
  return std::vector<double>(count, argument.cast<double>());
}

Work<TracesPointer> prepareStreamlines(const FieldHandle& field, const ArrayArgument<Index>& faces,
                                       const ArrayArgument<double>& barycentric, Direction direction, double maxTime,
                                       double maxLength, double tolerance, double minSpeed, BoundaryRule boundary,
                                       Index maxSteps) {
  const TraceOptions options = traceOptions(direction, maxTime, maxLength, tolerance, minSpeed, boundary, maxSteps);
  const auto seeds = inputSurfacePoints(field.mesh->mesh(), faces, barycentric);
  return [field, seeds, options](Progress& progress) {
    return std::make_shared<const TracesHandle>(
        TracesHandle{field.mesh, traceStreamlines(*field.mesh->flatFaces(), field.field, seeds, options, &progress)});
  };
}

LambdaTrack lambdaTrack(const ArrayArgument<double>& times, const ArrayArgument<double>& lambdas) {
  const auto t = inputArray<double>(times, "times", {kAny});
  return {toVector(t), toVector(inputArray<double>(lambdas, "lambdas", {t.shape(0)}))};
}

LineOptions lineOptions(double spacing, double interval, double tolerance, BoundaryRule boundary, Index maxParticles) {
  LineOptions options;
  options.spacing = spacing;
  options.interval = interval;
  options.tolerance = tolerance;
  options.boundary = boundary;
  options.maxParticles = maxParticles;
  return options;
}

/// trace: (flow, progress) -> lines at each time.
template <typename Trace>
Work<LinesPointer> linesWork(const ParameterizedFieldHandle& field, const LambdaTrack& track, double speed,
                             const Trace& trace) {
  return [field, track, speed, trace](Progress& progress) {
    const UnsteadyField flow(*field.mesh->flatFaces(), field.field, track, speed);
    auto result = std::make_shared<std::vector<ParticleLinesHandle>>();
    for (ParticleLines& lines : trace(flow, progress)) result->push_back({field.mesh, std::move(lines)});
    return std::shared_ptr<const std::vector<ParticleLinesHandle>>(std::move(result));
  };
}

Work<LinesPointer> prepareStreaklines(const ParameterizedFieldHandle& field, const ArrayArgument<double>& times,
                                      const ArrayArgument<double>& lambdas, const ArrayArgument<Index>& faces,
                                      const ArrayArgument<double>& barycentric, double start,
                                      const ArrayArgument<double>& at, double speed, double spacing, double interval,
                                      double tolerance, BoundaryRule boundary, Index maxParticles) {
  const auto seeds = inputSurfacePoints(field.mesh->mesh(), faces, barycentric);
  const auto when = toVector(inputArray<double>(at, "at", {kAny}));
  const LineOptions options = lineOptions(spacing, interval, tolerance, boundary, maxParticles);
  return linesWork(field, lambdaTrack(times, lambdas), speed, [=](const UnsteadyField& flow, Progress& progress) {
    return traceStreaklines(flow, seeds, start, when, options, &progress);
  });
}

Work<LinesPointer> prepareTimelines(const ParameterizedFieldHandle& field, const ArrayArgument<double>& times,
                                    const ArrayArgument<double>& lambdas, const Curves& curves, double start,
                                    const ArrayArgument<double>& at, double speed, double spacing, double tolerance,
                                    BoundaryRule boundary, Index maxParticles) {
  std::vector<std::vector<SurfacePoint>> given;
  for (const py::handle curve : curves) {
    const auto parts = py::cast<py::tuple>(curve);
    if (parts.size() != 2) throw InputError("a curve of a timeline is (faces, barycentric)");
    given.push_back(inputSurfacePoints(field.mesh->mesh(), parts[0], parts[1]));
  }
  const auto when = toVector(inputArray<double>(at, "at", {kAny}));
  const LineOptions options = lineOptions(spacing, LineOptions().interval, tolerance, boundary, maxParticles);
  return linesWork(field, lambdaTrack(times, lambdas), speed, [=](const UnsteadyField& flow, Progress& progress) {
    return traceTimelines(flow, given, start, when, options, &progress);
  });
}

std::vector<PathlineSeed> pathlineSeeds(const ParameterizedFieldHandle& field, const ArrayArgument<Index>& faces,
                                        const ArrayArgument<double>& barycentric, const NumberOrArray<double>& start,
                                        const NumberOrArray<double>& duration) {
  const auto points = inputSurfacePoints(field.mesh->mesh(), faces, barycentric);
  const auto starts = perSeed(start, "start", points.size()), durations = perSeed(duration, "duration", points.size());
  std::vector<PathlineSeed> seeds(points.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) seeds[i] = {points[i], starts[i], durations[i]};
  return seeds;
}

Work<TracesPointer> preparePathlines(const ParameterizedFieldHandle& field, const ArrayArgument<double>& times,
                                     const ArrayArgument<double>& lambdas, const ArrayArgument<Index>& faces,
                                     const ArrayArgument<double>& barycentric, const NumberOrArray<double>& start,
                                     const NumberOrArray<double>& duration, double speed, Direction direction,
                                     double maxLength, double tolerance, BoundaryRule boundary, Index maxSteps) {
  const TraceOptions options =
      traceOptions(direction, TraceOptions().maxTime, maxLength, tolerance, 0.0, boundary, maxSteps);
  const LambdaTrack track = lambdaTrack(times, lambdas);
  const auto seeds = pathlineSeeds(field, faces, barycentric, start, duration);
  return [field, track, seeds, speed, options](Progress& progress) {
    const UnsteadyField flow(*field.mesh->flatFaces(), field.field, track, speed);
    return std::make_shared<const TracesHandle>(
        TracesHandle{field.mesh, tracePathlines(flow, seeds, options, &progress)});
  };
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

  const LineOptions defaults;
  bindJob<LinesPointer>(m, "ParticleLinesJob", "Streaklines or timelines that are being made.",
                        [](const LinesPointer& lines) { return *lines; })
      .def(
          m, "streaklines", &prepareStreaklines,
          "Where the particles are that were released at each seed from `start` on, at the times `at` (f,) float64,\n"
          "seconds, increasing (thesis 10.1.2) -> list of f ParticleLines, the oldest particle of a line first.\n\n"
          "field: ParameterizedField. times, lambdas (s,) float64, speed, tolerance, boundary: as in pathlines. "
          "Seeds:\n"
          "faces (k,) int32, barycentric (k, 3) float64. spacing: largest distance of neighbours in mesh units; where\n"
          "they are farther apart more particles are released between them. interval: largest time between two\n"
          "releases, seconds. Raises InputError, also for a line of more than max_particles, and Cancelled.",
          py::arg("field"), py::arg("times"), py::arg("lambdas"), py::arg("faces"), py::arg("barycentric"),
          py::arg("start"), py::arg("at"), py::kw_only(), py::arg("speed") = 1.0, py::arg("spacing") = defaults.spacing,
          py::arg("interval") = defaults.interval, py::arg("tolerance") = defaults.tolerance,
          py::arg("boundary") = defaults.boundary, py::arg("max_particles") = defaults.maxParticles)
      .def(m, "timelines", &prepareTimelines,
           "Where the particles are that lay on the curves at `start` seconds, at the times `at` (f,) float64, "
           "seconds,\n"
           "increasing (thesis 10.1.2) -> list of f ParticleLines.\n\n"
           "curves: each (faces (k,) int32, barycentric (k, 3) float64), points joined by the shortest way. times,\n"
           "lambdas (s,) float64 and the rest as in streaklines. Raises InputError and Cancelled.",
           py::arg("field"), py::arg("times"), py::arg("lambdas"), py::arg("curves"), py::arg("start"), py::arg("at"),
           py::kw_only(), py::arg("speed") = 1.0, py::arg("spacing") = defaults.spacing,
           py::arg("tolerance") = defaults.tolerance, py::arg("boundary") = defaults.boundary,
           py::arg("max_particles") = defaults.maxParticles);
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
            std::vector<StopReason> result;
            for (const TraceEnd& end : self.traces.ends) result.push_back(end.reason);
            return result;
          },
          "list of k str, why each trace ends: time, length, min_speed (a fixed point is near), boundary, "
          "step_limit.");

  const TraceOptions defaults;
  bindJob<TracesPointer>(m, "TracesJob", "Traces that are being made.",
                         [](const TracesPointer& traces) { return *traces; })
      .def(m, "streamlines", &prepareStreamlines,
           "Streamlines of a VectorField through seeds: faces (k,) int32, barycentric (k, 3) float64 -> Traces.\n\n"
           "max_time: seconds. max_length: mesh units. tolerance: largest estimated error of a step in mean edge\n"
           "lengths. min_speed: fraction of the fastest vertex's speed at which a trace ends. boundary: whether a\n"
           "trace ends on the boundary or slides along it. Runs in parallel with the same result for any number of\n"
           "threads. Raises InputError (naming the seed or option) and Cancelled.",
           py::arg("field"), py::arg("faces"), py::arg("barycentric"), py::kw_only(),
           py::arg("direction") = defaults.direction, py::arg("max_time") = defaults.maxTime,
           py::arg("max_length") = defaults.maxLength, py::arg("tolerance") = defaults.tolerance,
           py::arg("min_speed") = defaults.minSpeed, py::arg("boundary") = defaults.boundary,
           py::arg("max_steps") = defaults.maxSteps)
      .def(m, "pathlines", &preparePathlines,
           "Pathlines of a ParameterizedField along lambda(t) (thesis 10.1.2) -> Traces.\n\n"
           "times (s,) float64, seconds, increasing, with lambdas (s,) float64: linear between, constant outside. "
           "Seeds:\n"
           "faces (k,) int32, barycentric (k, 3) float64. start and duration: seconds, one number or (k,) float64;\n"
           "backward traces go from start to earlier times. speed: factor on the field. The rest as in streamlines.\n"
           "Raises InputError and Cancelled.",
           py::arg("field"), py::arg("times"), py::arg("lambdas"), py::arg("faces"), py::arg("barycentric"),
           py::arg("start"), py::arg("duration"), py::kw_only(), py::arg("speed") = 1.0,
           py::arg("direction") = defaults.direction, py::arg("max_length") = defaults.maxLength,
           py::arg("tolerance") = defaults.tolerance, py::arg("boundary") = defaults.boundary,
           py::arg("max_steps") = defaults.maxSteps);
  bindLines(m);
}

}  // namespace stormfield::bindings
