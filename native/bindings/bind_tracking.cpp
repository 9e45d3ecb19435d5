#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "tracking/persistence.h"
#include "tracking/tracking.h"

namespace stormfield {
namespace bindings {

/// What an end of a path is called depends on which one it is; in the order of PathEnd.
enum class BeginOfPath { First, Boundary, Creation };
enum class EndOfPath { Last, Boundary, Annihilation };

}  // namespace bindings

template <>
inline constexpr Words kWords<bindings::BeginOfPath>{"begin of a path", {"first", "boundary", "creation"}};
template <>
inline constexpr Words kWords<bindings::EndOfPath>{"end of a path", {"last", "boundary", "annihilation"}};

}  // namespace stormfield

namespace stormfield::bindings {
namespace {

using TrackingPointer = std::shared_ptr<const Tracking>;

/// Python's view of one path of a Tracking, which it keeps alive.
struct PathView {
  TrackingPointer tracking;
  std::size_t number;

  const TrackedPath& path() const { return tracking->paths[number]; }
};

Work<TrackingPointer> prepareTracking(const ParameterizedFieldHandle& field, double relativeTolerance,
                                      double hopfDamping, double chordTolerance) {
  const TrackingOptions options{relativeTolerance, hopfDamping, chordTolerance};
  // The work outlives the argument, so it has a copy.
  auto copy = std::make_shared<const ParameterizedField>(field.field);
  return [=](Progress& p) { return std::make_shared<const Tracking>(trackFixedPoints(*copy, options, p)); };
}

std::vector<PathView> views(const TrackingPointer& tracking) {
  std::vector<PathView> result;
  for (std::size_t i = 0; i < tracking->paths.size(); ++i) result.push_back({tracking, i});
  return result;
}

/// (k, columns) from the k samples of a path.
template <typename T, typename Get>
py::array_t<T> column(const PathView& view, py::ssize_t columns, const Get& get) {
  const auto& samples = view.path().samples;
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(samples.size())};
  if (columns > 1) shape.push_back(columns);
  py::array_t<T> result(shape);
  T* to = result.mutable_data();
  for (const PathSample& sample : samples) {
    for (py::ssize_t c = 0; c < columns; ++c) *to++ = get(sample, c);
  }
  return result;
}

std::vector<FixedPointKind> kinds(const PathView& view) {
  std::vector<FixedPointKind> result;
  for (const PathSample& sample : view.path().samples) result.push_back(sample.kind);
  return result;
}

std::vector<Index> pathsOf(const Bifurcation& event) {
  std::vector<Index> result;
  for (const Index path : event.paths) {
    if (path != kNone) result.push_back(path);
  }
  return result;
}

py::array_t<double> vectorArray(const Vec3& v) {
  return py::array_t<double>(3, v.data());
}

// Paths and bifurcations from arrays -----------------------------------------------------------------

Vec3 vectorFrom(const ArrayArgument<double>& values, const char* name) {
  const auto v = inputArray<double>(values, name, {3});
  return {v.at(0), v.at(1), v.at(2)};
}

/// A path of its own.
PathView pathFrom(int index, BeginOfPath begin, EndOfPath end, double strength, double rotation,
                  const ArrayArgument<double>& lambdas, const ArrayArgument<Index>& faces,
                  const ArrayArgument<double>& barycentric, const ArrayArgument<double>& positions,
                  const std::vector<FixedPointKind>& kinds) {
  const auto lambda = inputArray<double>(lambdas, "lambdas", {kAny});
  const py::ssize_t count = lambda.shape(0);
  const auto face = inputArray<Index>(faces, "faces", {count});
  const auto weights = inputArray<double>(barycentric, "barycentric", {count, 3});
  const auto places = inputArray<double>(positions, "positions", {count, 3});
  if (static_cast<py::ssize_t>(kinds.size()) != count) {
    throw InputError(message("a path has ", count, " lambdas and ", kinds.size(), " kinds; give as many"));
  }
  TrackedPath path;
  path.index = index;
  path.begin = static_cast<PathEnd>(begin);
  path.end = static_cast<PathEnd>(end);
  path.strength = strength;
  path.rotation = rotation;
  for (py::ssize_t i = 0; i < count; ++i) {
    const Vec3 in{weights.at(i, 0), weights.at(i, 1), weights.at(i, 2)};
    const Vec3 at{places.at(i, 0), places.at(i, 1), places.at(i, 2)};
    path.samples.push_back({lambda.at(i), {face.at(i), in}, at, kinds[i]});
  }
  return {std::make_shared<const Tracking>(makeTracking({std::move(path)}, {})), 0};
}

Bifurcation bifurcationFrom(double lambda, Index face, const ArrayArgument<double>& barycentric,
                            const ArrayArgument<double>& position, BifurcationKind kind, FixedPointKind node,
                            const std::vector<Index>& paths) {
  if (paths.empty() || paths.size() > 2) throw InputError(message("a bifurcation names ", paths.size(), " paths"));
  Bifurcation event;
  event.lambda = lambda;
  event.point = {face, vectorFrom(barycentric, "barycentric")};
  event.position = vectorFrom(position, "position");
  event.kind = kind;
  event.node = node;
  std::copy(paths.begin(), paths.end(), event.paths.begin());
  return event;
}

std::shared_ptr<Tracking> trackingFrom(const std::vector<PathView>& paths, std::vector<Bifurcation> bifurcations) {
  std::vector<TrackedPath> own;
  for (const PathView& view : paths) own.push_back(view.path());
  return std::make_shared<Tracking>(makeTracking(std::move(own), std::move(bifurcations)));
}

void bindMargins(py::module_& m) {
  py::class_<StabilityChange>(m, "StabilityChange", py::module_local(),
                              "Where the trace of the Jacobian changes its sign. Immutable.")
      .def_readonly("lam", &StabilityChange::lambda, "Where on the lambda axis, 0 to 1.")
      .def_property_readonly(
          "face", [](const StabilityChange& c) { return c.point.face; }, "Face that holds the point.")
      .def_property_readonly(
          "barycentric", [](const StabilityChange& c) { return vectorArray(c.point.barycentric); }, "(3,) float64.")
      .def_property_readonly(
          "position", [](const StabilityChange& c) { return vectorArray(c.position); }, "(3,) float64, mesh units.");
  py::class_<StabilityMargins>(m, "StabilityMargins", py::module_local(),
                               "What joining a path to its continuation needs to judge Hopf bifurcations. Signs of the "
                               "trace are\n+1, a source, -1, a sink, or 0 where there is none. Immutable.")
      .def_readonly("first", &StabilityMargins::first, "Sign of the first trace that is not zero.")
      .def_readonly("last", &StabilityMargins::last, "Sign of the last trace that is not zero.")
      .def_readonly("first_certain", &StabilityMargins::firstCertain,
                    "Sign of the first trace whose damping ratio exceeds hopf_damping.")
      .def_readonly("last_certain", &StabilityMargins::lastCertain, "Sign of the last one.")
      .def_readonly("before", &StabilityMargins::before,
                    "List of StabilityChange before the first certain sample; all where none is certain.")
      .def_readonly("after", &StabilityMargins::after, "List of StabilityChange after the last certain sample.");
}

void bindPath(py::module_& m) {
  py::class_<PathView>(m, "TrackedPath", py::module_local(), "One fixed point over lambda: k samples. Immutable.")
      .def(py::init(&pathFrom), py::kw_only(), py::arg("index"), py::arg("begin"), py::arg("end"), py::arg("strength"),
           py::arg("rotation"), py::arg("lambdas"), py::arg("faces"), py::arg("barycentric"), py::arg("positions"),
           py::arg("kinds"),
           "A path that joins others, without margins, from its n samples: lambdas (n,) float64, faces (n,) int32,\n"
           "barycentric and positions (n, 3) float64, kinds one word for each. Raises InputError for numbers\n"
           "that do not fit.")
      .def_property_readonly(
          "index", [](const PathView& v) { return v.path().index; }, "Poincare index, +1 or -1.")
      .def_property_readonly(
          "kind", [](const PathView& v) { return v.path().kind; },
          "source, sink, saddle, center or degenerate: what it is for the longest share of its life.")
      .def_property_readonly(
          "begin", [](const PathView& v) { return static_cast<BeginOfPath>(v.path().begin); },
          "first, boundary or creation.")
      .def_property_readonly(
          "end", [](const PathView& v) { return static_cast<EndOfPath>(v.path().end); },
          "last, boundary or annihilation.")
      .def_property_readonly(
          "life", [](const PathView& v) { return v.path().life(); },
          "Interval of lambda it lives through: its persistence.")
      .def_property_readonly(
          "strength", [](const PathView& v) { return v.path().strength; }, "Mean of sqrt|det J| over its life, 1/s.")
      .def_property_readonly(
          "rotation", [](const PathView& v) { return v.path().rotation; }, "Mean of the curl over its life, 1/s.")
      .def_property_readonly(
          "lambdas",
          [](const PathView& v) {
            return column<double>(v, 1, [](const PathSample& s, py::ssize_t) { return s.lambda; });
          },
          "(k,) float64, increasing.")
      .def_property_readonly(
          "positions",
          [](const PathView& v) {
            return column<double>(v, 3, [](const PathSample& s, py::ssize_t c) { return s.position[c]; });
          },
          "(k, 3) float64, mesh units.")
      .def_property_readonly(
          "faces",
          [](const PathView& v) {
            return column<Index>(v, 1, [](const PathSample& s, py::ssize_t) { return s.point.face; });
          },
          "(k,) int32.")
      .def_property_readonly(
          "barycentric",
          [](const PathView& v) {
            return column<double>(v, 3, [](const PathSample& s, py::ssize_t c) { return s.point.barycentric[c]; });
          },
          "(k, 3) float64, coordinates in the faces.")
      .def_property_readonly("kinds", &kinds, "Kind at each sample.")
      .def_property_readonly(
          "margins", [](const PathView& v) { return v.path().margins; },
          "StabilityMargins of a path of index +1, as it was tracked.")
      .def("__repr__", [](const PathView& v) {
        const TrackedPath& path = v.path();
        return message("<TrackedPath ", name(path.kind), " from ", path.samples.front().lambda, " to ",
                       path.samples.back().lambda, ">");
      });
}

void bindBifurcation(py::module_& m) {
  py::class_<Bifurcation>(m, "Bifurcation", py::module_local(), "Where the topology changes. Immutable.")
      .def(py::init(&bifurcationFrom), py::kw_only(), py::arg("lam"), py::arg("face"), py::arg("barycentric"),
           py::arg("position"), py::arg("kind"), py::arg("node"), py::arg("paths"),
           "One whose paths are numbers of a list that Tracking gets with it; barycentric and position (3,) float64.\n"
           "Raises InputError where it names no path or more than two.")
      .def_readonly("lam", &Bifurcation::lambda, "Where on the lambda axis, 0 to 1.")
      .def_property_readonly(
          "face", [](const Bifurcation& b) { return b.point.face; }, "Face that holds the point.")
      .def_property_readonly(
          "barycentric", [](const Bifurcation& b) { return vectorArray(b.point.barycentric); }, "(3,) float64.")
      .def_property_readonly(
          "position", [](const Bifurcation& b) { return vectorArray(b.position); }, "(3,) float64, mesh units.")
      .def_property_readonly(
          "kind", [](const Bifurcation& b) { return b.kind; }, "creation, annihilation or hopf.")
      .def_property_readonly(
          "node", [](const Bifurcation& b) { return b.node; },
          "Source or sink that meets the saddle; hopf: what the path becomes.")
      .def_property_readonly("paths", &pathsOf, "Numbers of the node's and the saddle's path; hopf: of one path.")
      .def("__repr__",
           [](const Bifurcation& b) { return message("<Bifurcation ", name(b.kind), " at lambda ", b.lambda, ">"); });
}

}  // namespace

void bind_tracking(py::module_& m) {
  bindMargins(m);
  bindPath(m);
  bindBifurcation(m);
  py::class_<Tracking, std::shared_ptr<Tracking>>(m, "Tracking", py::module_local(),
                                                  "The history of a field's fixed points over lambda. Immutable.")
      .def(py::init(&trackingFrom), py::arg("paths"), py::arg("bifurcations"),
           "From TrackedPaths and the Bifurcations that number them. Raises InputError that names one that does not "
           "fit.")
      .def_property_readonly(
          "paths", [](const std::shared_ptr<Tracking>& t) { return views(t); },
          "List of TrackedPath, in the order they begin.")
      .def_property_readonly(
          "bifurcations", [](const Tracking& t) { return t.bifurcations; }, "List of Bifurcation, by lambda.")
      .def(
          "persistent",
          [](const Tracking& t, double minLife, double minStrength) {
            const py::gil_scoped_release release;
            return std::make_shared<Tracking>(persistent(t, {minLife, minStrength}));
          },
          py::arg("min_life") = 0.0, py::arg("min_strength") = 0.0,
          "A Tracking without paths that live shorter than min_life (of lambda): pairs are removed together, folds "
          "become one "
          "path,\n"
          "so that the sum of indices stays; then without those weaker than min_strength (1/s).");

  const TrackingOptions defaults;
  bindJob<TrackingPointer>(m, "TrackingJob", "Tracking on a thread of its own.",
                           [](const TrackingPointer& tracking) { return std::const_pointer_cast<Tracking>(tracking); })
      .def(m, "tracking", &prepareTracking,
           "Follow every fixed point of a ParameterizedField over lambda (thesis 10.1.4) -> Tracking.\n\n"
           "relative_tolerance: as for fixed_points. hopf_damping: a Hopf bifurcation is listed once |trace| / (2\n"
           "sqrt(det)) has exceeded this on both sides. chord_tolerance: samples are added until the curves differ "
           "from\n"
           "their chords by less than this fraction of the mean edge length. Raises InputError and Cancelled.",
           py::arg("field"), py::kw_only(), py::arg("relative_tolerance") = defaults.relativeTolerance,
           py::arg("hopf_damping") = defaults.hopfDamping, py::arg("chord_tolerance") = defaults.chordTolerance);
}

}  // namespace stormfield::bindings
