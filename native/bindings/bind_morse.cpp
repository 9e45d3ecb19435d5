#include <pybind11/stl.h>

#include <cmath>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "maps/error_bound.h"
#include "morse/morse_analysis.h"

namespace stormfield::bindings {
namespace {

using MeshPointer = std::shared_ptr<MeshHandle>;

struct MorseOutput {
  MeshPointer mesh;
  MorseAnalysis analysis;
};
using MorsePointer = std::shared_ptr<const MorseOutput>;

/// One set, with the decomposition it belongs to.
struct MorseSetView {
  MorsePointer output;
  Index set;

  const MorseSet& data() const { return output->analysis.decomposition.sets[set]; }
  const std::vector<Index>& faces() const { return output->analysis.decomposition.facesMet(set); }
};

std::vector<double> inputWeights(const std::optional<ArrayArgument<double>>& weights, Index vertices) {
  if (!weights) return {};
  return toVector(inputArray(*weights, "weights", {vertices}));
}

MorseOutput analyzed(const MeshPointer& mesh, const VectorField& field, const MorseAnalysisOptions& options,
                     Progress& progress) {
  const bool traces = options.method != MorseMethod::Geometry || options.refine;
  return {mesh, analyzeMorse(traces ? mesh->flatFaces() : nullptr, field, options, progress)};
}

Work<MorseOutput> prepareMorse(const FieldHandle& field, MorseMethod method, const std::optional<double>& tau,
                               double eps, bool relative, const std::optional<ArrayArgument<double>>& weights,
                               bool refine, const std::optional<double>& tauMax,
                               const std::optional<double>& maxSeconds, const std::optional<bool>& persistence,
                               bool keepEmpty, bool keepTrivial) {
  MorseAnalysisOptions options;
  options.method = method;
  options.tau = tau;
  options.epsilon = eps;
  options.relativeEpsilon = relative;
  options.weights = inputWeights(weights, field.mesh->mesh().vertexCount());
  options.refine = refine;
  options.tauMax = tauMax;
  if (maxSeconds) options.maxSeconds = *maxSeconds;
  options.persistence = persistence;
  options.kept = {.empty = keepEmpty, .trivial = keepTrivial};
  return [mesh = field.mesh, f = field.field, options](Progress& progress) {
    return analyzed(mesh, f, options, progress);
  };
}

Work<MorseOutput> prepareRefineSet(const MorsePointer& output, Index set) {
  return [output, set](Progress& progress) {
    return MorseOutput{output->mesh, withSetRefined(output->mesh->flatFaces(), output->analysis, set, progress)};
  };
}

MorsePointer simplified(const MorseOutput& output, double eps, const std::optional<bool>& keepTrivial) {
  const py::gil_scoped_release release;
  Progress progress;
  KeptSets kept = output.analysis.kept;
  if (keepTrivial) kept.trivial = *keepTrivial;
  return std::make_shared<const MorseOutput>(
      MorseOutput{output.mesh, withinEpsilon(output.analysis, eps, kept, progress)});
}

std::vector<MorseSetView> setsOf(const MorsePointer& output) {
  std::vector<MorseSetView> views;
  for (Index s = 0; s < output->analysis.decomposition.faces.count(); ++s) views.push_back({output, s});
  return views;
}

py::array_t<Index> edgesOf(const MorseOutput& output) {
  const auto& edges = output.analysis.decomposition.graph.edges;
  py::array_t<Index> result({static_cast<py::ssize_t>(edges.size()), py::ssize_t{2}});
  for (std::size_t i = 0; i < edges.size(); ++i) std::copy_n(edges[i].data(), 2, result.mutable_data() + 2 * i);
  return result;
}

py::array_t<Index> connectionFaces(const MorseOutput& output, Index source, Index target) {
  std::vector<Index> faces;
  {
    const py::gil_scoped_release release;
    faces = facesBetween(output.analysis, source, target);
  }
  return copied(faces);
}

py::typing::Dict<std::string, double> secondsOf(const MorseOutput& output) {
  py::typing::Dict<std::string, double> seconds;
  seconds["map"] = output.analysis.seconds.map;
  seconds["sets"] = output.analysis.seconds.sets;
  seconds["persistence"] = output.analysis.seconds.persistence;
  return seconds;
}

std::optional<double> persistenceOf(const MorseSetView& set) {
  const double value = set.data().persistence;
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

void bindSet(py::module_& m) {
  py::class_<MorseSetView>(m, "MorseSet", py::module_local(), "Faces that enclose recurrence. Immutable.")
      .def_property_readonly(
          "faces", [](const MorseSetView& s) { return copied(s.faces()); },
          "(k,) int32, ascending. Of a refined geometry-based decomposition, all faces that it meets: several sets may "
          "share one.")
      .def_property_readonly(
          "conley",
          [](const MorseSetView& s) {
            const ConleyIndex& index = s.data().index;
            return py::make_tuple(index.b0, index.b1, index.b2);
          },
          "Conley index (b0, b1, b2); an upper bound of it where upper_bound is set.")
      .def_property_readonly(
          "upper_bound", [](const MorseSetView& s) { return s.data().upperBound; },
          "Whether conley is an upper bound, as with tau maps, and not exact; of a refined decomposition with eps, "
          "whether "
          "it is that of the field only, as fixed points may leave over the surface's boundary.")
      .def_property_readonly(
          "kind", [](const MorseSetView& s) { return s.data().kind; },
          "source, sink, saddle, attracting, repelling, trivial or other, by the Conley index.")
      .def_property_readonly(
          "poincare", [](const MorseSetView& s) { return s.data().poincare; },
          "Sum of the Poincare indices inside: b0 - b1 + b2 of an exact index away from the surface's boundary.")
      .def_property_readonly(
          "outflow",
          [](const MorseSetView& s) {
            return s.output->analysis.decomposition.graph.outflow[static_cast<std::size_t>(s.set)] != 0;
          },
          "Whether flow leads from the set over the boundary of the surface.")
      .def_property_readonly("persistence", &persistenceOf,
                             "Least eps at which the set merges with another, mesh units per second (refined: up to a "
                             "factor of 2 more); None when it never does, or it was not asked for.")
      .def("__repr__", [](const MorseSetView& s) {
        const ConleyIndex& index = s.data().index;
        return message("<MorseSet ", name(s.data().kind), " (", index.b0, ", ", index.b1, ", ", index.b2, ") of ",
                       s.faces().size(), " faces>");
      });
}

void bindDecomposition(py::module_& m) {
  const MorseAnalysisOptions defaults;
  py::class_<MorseOutput, std::shared_ptr<MorseOutput>> decompositions(
      m, "MorseDecomposition", py::module_local(),
      "Morse sets, numbered by their first faces, and their order. Immutable.");
  decompositions
      .def_property_readonly(
          "sets", [](const std::shared_ptr<MorseOutput>& o) { return setsOf(o); }, "List of MorseSet.")
      .def_property_readonly(
          "face_sets", [](const MorseOutput& o) { return copied(o.analysis.decomposition.faces.setOf()); },
          "(m,) int32: per face its set, -1 for none. A face that several sets meet counts to one of them.")
      .def_property_readonly("edges", &edgesOf,
                             "(k, 2) int32: the least edges of the Morse connection graph; flow leads from the first "
                             "set to the second.")
      .def_property_readonly(
          "map_edges", [](const MorseOutput& o) { return o.analysis.decomposition.mapEdges; },
          "Edges of the combinatorial map.")
      .def_property_readonly(
          "method", [](const MorseOutput& o) { return o.analysis.model->method(); }, "geometry, tau or spatial.")
      .def_property_readonly(
          "tau",
          [](const MorseOutput& o) {
            const double tau = o.analysis.model->tau();
            return tau > 0.0 ? std::optional<double>(tau) : std::nullopt;
          },
          "Seconds (tau) or mesh units (spatial), the largest of a refinement; None for geometry.")
      .def_property_readonly(
          "taus", [](const MorseOutput& o) { return copied(o.analysis.model->taus()); },
          "(m,) float64: per face the tau of its row of the map, 0 where that is geometry-based.")
      .def_property_readonly(
          "stop", [](const MorseOutput& o) { return o.analysis.model->stop(); },
          "Why a refinement went no further: done, steps, time, memory or cancelled; None for others.")
      .def_property_readonly(
          "eps", [](const MorseOutput& o) { return o.analysis.model->epsilon(); },
          "Bound on the error of the vectors, mesh units per second.")
      .def_property_readonly(
          "upper_bound", [](const MorseOutput& o) { return o.analysis.model->method() != MorseMethod::Geometry; },
          "Whether Conley indices are upper bounds.")
      .def_property_readonly("seconds", &secondsOf, "Seconds by phase: map, sets, persistence.")
      .def(
          "simplify", &simplified, py::arg("eps"), py::arg("keep_trivial") = py::none(),
          "The decomposition that holds for every field within eps >= 0 (mesh units per second, times the weights).\n"
          "A refined one keeps its pieces of edges.\n"
          "keep_trivial: whether to keep sets of trivial index (None: as here). Raises InputError unless the method is "
          "geometry.")
      .def(
          "connection_faces", &connectionFaces, py::arg("source"), py::arg("target"),
          "(k,) int32: faces that connections from one set to another pass through, without theirs; empty without any.")
      .def("__repr__", [](const MorseOutput& o) {
        return message("<MorseDecomposition by ", name(o.analysis.model->method()), ": ",
                       o.analysis.decomposition.faces.count(), " sets>");
      });
  bindJob<MorseOutput>(m, "MorseJob", "A Morse decomposition that is being made.",
                       [](const MorseOutput& output) { return std::make_shared<MorseOutput>(output); })
      .def(decompositions, "refine_set", &prepareRefineSet,
           "One set of a refined decomposition, or of one by geometry with eps 0, refined further -> "
           "MorseDecomposition.\n\n"
           "Raises InputError for a set that does not exist and for other decompositions, and Cancelled.",
           py::arg("set"))
      .def(m, "morse", &prepareMorse,
           "The Morse decomposition of a VectorField (thesis 2.4, 6.2, 8) -> MorseDecomposition.\n\n"
           "tau: seconds, or mesh units for spatial (None: found from the field). eps: bound on the error of the "
           "vectors,\n"
           "in mesh units per second, or mean speeds with relative; geometry only, refined or not. weights: (n,) "
           "float64\n"
           ">= 0, factors of eps at the vertices. refine: whether to refine coarse sets, for at most max_seconds: tau "
           "and\n"
           "spatial by ever larger tau, from tau up to tau_max, geometry by ever smaller pieces of edges, also inside\n"
           "faces; a cancelled refinement returns the sets it has come to. persistence: whether to find when sets "
           "merge\n"
           "(None: without refine only); refined, that takes some twenty maps and is accurate to a factor of 2.\n"
           "keep_empty: keep sets that provably hold no recurrence. keep_trivial: keep sets of trivial index, whose\n"
           "recurrence (pairs that cancel) nearby fields may not have. Raises InputError and Cancelled.",
           py::arg("field"), py::arg("method") = defaults.method, py::arg("tau") = defaults.tau,
           py::arg("eps") = defaults.epsilon, py::arg("relative") = defaults.relativeEpsilon,
           py::arg("weights") = py::none(), py::arg("refine") = defaults.refine, py::arg("tau_max") = defaults.tauMax,
           py::arg("max_seconds") = py::none(), py::arg("persistence") = defaults.persistence,
           py::arg("keep_empty") = defaults.kept.empty, py::arg("keep_trivial") = defaults.kept.trivial);
}

}  // namespace

void bind_morse(py::module_& m) {
  bindSet(m);
  bindDecomposition(m);
  m.def(
      "mean_speed",
      [](const FieldHandle& field) {
        const py::gil_scoped_release release;
        return meanSpeed(field.field);
      },
      py::arg("field"), "Mean speed over the area of the surface, mesh units per second: the unit of relative bounds.");
}

}  // namespace stormfield::bindings
