#include "morse/morse_analysis.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/message.h"
#include "maps/error_bound.h"
#include "morse/detail/geometry_model.h"
#include "morse/detail/tau_models.h"
#include "morse/detail/transit_model.h"

namespace stormfield {
namespace {

using ModelPointer = std::unique_ptr<MorseModel>;

/// Runs a phase and returns its seconds.
template <typename Work>
double timed(const Work& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

void checkEpsilon(double epsilon) {
  if (epsilon >= 0.0 && std::isfinite(epsilon)) return;
  throw InputError(message("the error bound eps is ", epsilon, "; give a number >= 0"));
}

void checkSet(const MorseAnalysis& analysis, Index set) {
  const Index count = analysis.decomposition.faces.count();
  if (set < 0 || set >= count) throw InputError(message("there is no Morse set ", set, "; there are ", count));
}

void checkFlowOptions(const MorseAnalysisOptions& options) {
  if (options.epsilon > 0.0) {
    throw InputError(message("an error bound needs the geometry-based map, not '", name(options.method),
                             "'; choose the method 'geometry' or set eps to 0"));
  }
  if (options.tau && !(*options.tau > 0.0 && std::isfinite(*options.tau))) {
    throw InputError(message("tau is ", *options.tau, "; give a positive number, or none to have one found"));
  }
  if (options.tauMax && !options.refine) throw InputError("tau_max is for refinement; set refine too, or leave it out");
}

void checkOptions(const MorseAnalysisOptions& options, bool hasFaces) {
  const bool byFlow = options.method != MorseMethod::Geometry;
  checkEpsilon(options.epsilon);
  if (!byFlow && (options.tau || options.tauMax)) {
    throw InputError("the method 'geometry' has no tau; leave it out, or choose tau or spatial");
  }
  if (byFlow) checkFlowOptions(options);
  if ((byFlow || options.refine) && !(options.maxSeconds > 0.0)) {
    throw InputError(message("the limit of time is ", options.maxSeconds, " s; give a positive number"));
  }
  if ((byFlow || options.refine) && !hasFaces) {
    throw InputError("maps of the flow need the faces laid out for tracing; give them");
  }
}

TauUnit unitOf(MorseMethod method) {
  return method == MorseMethod::Spatial ? TauUnit::Length : TauUnit::Time;
}

ModelPointer refinedByTau(const std::shared_ptr<const FlatFaces>& faces,
                          const std::shared_ptr<const VectorField>& field, const MorseAnalysisOptions& options,
                          Progress& progress) {
  TauRefinementOptions refinementOptions;
  refinementOptions.map.unit = unitOf(options.method);
  refinementOptions.tauMin = options.tau;
  refinementOptions.tauMax = options.tauMax;
  refinementOptions.maxSeconds = options.maxSeconds;
  TauRefinement refinement(faces, field, refinementOptions);
  const RefinementStop stop = refinement.refine(&progress);
  return std::make_unique<TauRefinementModel>(std::move(refinement), stop);
}

ModelPointer refinedByTransits(const std::shared_ptr<const FlatFaces>& faces,
                               const std::shared_ptr<const VectorField>& field, double epsilon,
                               const MorseAnalysisOptions& options, Progress& progress) {
  /// Fraction of the progress at which sets are found whose persistence, which takes longer, follows.
  constexpr double kSetsFound = 0.1;
  TransitRefinementOptions refinementOptions;
  refinementOptions.maxSeconds = options.maxSeconds;
  refinementOptions.epsilon = epsilon;
  refinementOptions.weights = options.weights;
  const bool persistence = options.persistence.value_or(false);
  progress.range(0.0, persistence ? kSetsFound : 1.0);
  TransitRefinement refinement(faces, field, refinementOptions, &progress);
  const RefinementStop stop = refinement.refine(&progress);
  progress.range(kSetsFound, 1.0);
  return std::make_unique<TransitModel>(std::move(refinement), stop,
                                        persistence ? Persistence::Find : Persistence::Skip);
}

ModelPointer modelOf(const std::shared_ptr<const FlatFaces>& faces, const std::shared_ptr<const VectorField>& field,
                     const MorseAnalysisOptions& options, Progress& progress) {
  if (options.method != MorseMethod::Geometry) {
    if (options.refine) return refinedByTau(faces, field, options, progress);
    const TauUnit unit = unitOf(options.method);
    const double tau = options.tau ? *options.tau : startingTau(*field, unit);
    return std::make_unique<TauModel>(*faces, field, unit, tau, progress);
  }
  const double epsilon = options.relativeEpsilon ? options.epsilon * meanSpeed(*field) : options.epsilon;
  if (options.refine) return refinedByTransits(faces, field, epsilon, options, progress);
  const Persistence persistence = options.persistence.value_or(true) ? Persistence::Find : Persistence::Skip;
  return std::make_unique<GeometryModel>(field, epsilon, options.weights, persistence, progress);
}

/// The phases of an analysis: the model that makeModel() returns, its sets and their persistence.
template <typename MakeModel>
MorseAnalysis analyzed(const MakeModel& makeModel, const KeptSets& kept, Progress& progress) {
  MorseAnalysis result;
  result.kept = kept;
  ModelPointer model;
  result.seconds.map = timed([&] { model = makeModel(); });
  result.seconds.sets = timed([&] { result.decomposition = model->decomposition(kept, progress); });
  result.seconds.persistence = timed([&] {
    const auto persistence = model->findPersistence(result.decomposition, progress);
    if (!persistence) return;
    for (std::size_t s = 0; s < persistence->size(); ++s) {
      result.decomposition.sets[s].persistence = (*persistence)[s];
    }
  });
  result.model = std::move(model);
  return result;
}

}  // namespace

MorseAnalysis analyzeMorse(const std::shared_ptr<const FlatFaces>& faces, const VectorField& field,
                           const MorseAnalysisOptions& options, Progress& progress) {
  checkOptions(options, faces != nullptr);
  const auto shared = std::make_shared<const VectorField>(field);
  return analyzed([&] { return modelOf(faces, shared, options, progress); }, options.kept, progress);
}

MorseAnalysis withinEpsilon(const MorseAnalysis& analysis, double epsilon, const KeptSets& kept, Progress& progress) {
  checkEpsilon(epsilon);
  return analyzed([&] { return analysis.model->withinEpsilon(epsilon, progress); }, kept, progress);
}

MorseAnalysis withSetRefined(const std::shared_ptr<const FlatFaces>& faces, const MorseAnalysis& analysis, Index set,
                             Progress& progress) {
  checkSet(analysis, set);
  const auto refine = [&] { return analysis.model->withSetRefined(faces, analysis.decomposition, set, progress); };
  return analyzed(refine, analysis.kept, progress);
}

std::vector<Index> facesBetween(const MorseAnalysis& analysis, Index from, Index to) {
  for (const Index set : {from, to}) checkSet(analysis, set);
  return analysis.model->facesBetween(analysis.decomposition, from, to);
}

}  // namespace stormfield
