#include "morse/morse_analysis.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/error.h"
#include "base/message.h"
#include "maps/tau_map.h"

namespace stormfield {
namespace {

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

TauUnit unitOf(MorseMethod method) {
  return method == MorseMethod::Spatial ? TauUnit::Length : TauUnit::Time;
}

/// Everything after the map.
void findSets(MorseAnalysis& analysis, Progress& progress) {
  MorseOptions options;
  options.keepEmpty = analysis.keepEmpty;
  options.keepTrivial = analysis.keepTrivial;
  if (analysis.bounded) {
    options.resting = fixedPointFacesWithinEpsilon(*analysis.bounded, analysis.epsilon);
  } else if (analysis.refinement) {
    for (const double tau : analysis.refinement->taus()) options.mapped.push_back(tau > 0.0 ? 1 : 0);
  } else {
    options.mapped.assign(analysis.field->mesh().faceCount(), 1);
  }
  analysis.decomposition = morseDecomposition(*analysis.field, *analysis.map, options, progress);
}

void findPersistence(MorseAnalysis& analysis) {
  if (!analysis.levels) return;
  MorseDecomposition& morse = analysis.decomposition;
  const std::vector<double> persistence = persistenceOf(*analysis.levels, morse.faces, analysis.epsilon);
  for (Index s = 0; s < morse.faces.count(); ++s) morse.sets[s].persistence = persistence[s];
}

void analyzeGeometry(MorseAnalysis& analysis, const MorseAnalysisOptions& options, Progress& progress) {
  progress.range(0.0, 0.3);
  analysis.seconds.map = timed([&] {
    analysis.bounded =
        std::make_shared<const ErrorBoundedMap>(errorBoundedMap(*analysis.field, options.weights, progress));
    analysis.map = std::make_shared<const CombinatorialMap>(mapWithinEpsilon(*analysis.bounded, analysis.epsilon));
  });
  const bool persistence = options.persistence.value_or(true);
  progress.range(0.3, persistence ? 0.4 : 1.0);
  analysis.seconds.sets = timed([&] { findSets(analysis, progress); });
  if (!persistence) return;
  progress.range(0.4, 1.0);
  analysis.seconds.persistence = timed([&] {
    analysis.levels = std::make_shared<const MergeLevels>(mergeLevels(*analysis.bounded, progress));
    findPersistence(analysis);
  });
}

void checkFlowOptions(const MorseAnalysisOptions& options) {
  if (options.epsilon > 0.0) {
    throw InputError(message("an error bound needs the geometry-based map, not '", name(options.method),
                             "'; choose the method 'geometry' or set eps to 0"));
  }
  if (options.tau && !(*options.tau > 0.0 && std::isfinite(*options.tau))) {
    throw InputError(message("tau is ", *options.tau, "; give a positive number, or none to have one found"));
  }
  if (!(options.maximalSeconds > 0.0)) {
    throw InputError(message("the limit of time is ", options.maximalSeconds, " s; give a positive number"));
  }
}

void analyzeFlow(MorseAnalysis& analysis, const FlatFaces& faces, const MorseAnalysisOptions& options,
                 Progress& progress) {
  const TauUnit unit = unitOf(options.method);
  analysis.tau = options.tau ? *options.tau : startingTau(*analysis.field, unit);
  progress.range(0.0, 0.9);
  analysis.seconds.map = timed([&] {
    TauMapOptions tauOptions;
    tauOptions.unit = unit;
    analysis.map =
        std::make_shared<const CombinatorialMap>(tauMap(faces, *analysis.field, analysis.tau, tauOptions, &progress));
  });
  progress.range(0.9, 1.0);
  analysis.seconds.sets = timed([&] { findSets(analysis, progress); });
}

RefinementOptions refinementOptions(const MorseAnalysisOptions& options) {
  RefinementOptions result;
  result.map.unit = unitOf(options.method);
  result.tauMin = options.tau;
  result.tauMax = options.tauMax;
  result.maximalSeconds = options.maximalSeconds;
  return result;
}

/// Map and sets of what a refinement has come to, also when it was cancelled.
void takeRefinement(MorseAnalysis& analysis, std::shared_ptr<const MorseRefinement> refinement) {
  analysis.refinement = std::move(refinement);
  analysis.map = std::make_shared<const CombinatorialMap>(analysis.refinement->map());
  const std::vector<double>& taus = analysis.refinement->taus();
  analysis.tau = *std::max_element(taus.begin(), taus.end());
  Progress own;
  analysis.seconds.sets = timed([&] { findSets(analysis, own); });
}

void analyzeByRefinement(MorseAnalysis& analysis, const std::shared_ptr<const FlatFaces>& faces,
                         const MorseAnalysisOptions& options, Progress& progress) {
  const auto refinement = std::make_shared<MorseRefinement>(faces, analysis.field, refinementOptions(options));
  analysis.seconds.map = timed([&] { analysis.stop = refinement->refine(&progress); });
  takeRefinement(analysis, refinement);
}

/// The sets of what a refinement has come to, also when it was cancelled, and their persistence, which is left out
/// then.
void takeTransits(MorseAnalysis& analysis, std::shared_ptr<const TransitRefinement> transits, Progress& progress) {
  analysis.transits = std::move(transits);
  Progress own;
  analysis.seconds.sets = timed([&] {
    TransitDecomposition found = analysis.transits->decomposition(analysis.keepEmpty, analysis.keepTrivial, own);
    analysis.decomposition = std::move(found.morse);
    analysis.map = std::make_shared<const CombinatorialMap>(std::move(found.map));
    analysis.nodes = std::move(found.nodes);
  });
  if (!analysis.transitPersistence || progress.cancelled()) return;
  analysis.seconds.persistence = timed([&] {
    try {
      const std::vector<double> persistence = transitPersistence(*analysis.transits, analysis.nodes, progress);
      for (std::size_t s = 0; s < persistence.size(); ++s) {
        analysis.decomposition.sets[s].persistence = persistence[s];
      }
    } catch (const Cancelled&) {
      analysis.stop = RefinementStop::Cancelled;
    }
  });
}

void analyzeByTransits(MorseAnalysis& analysis, const std::shared_ptr<const FlatFaces>& faces,
                       const MorseAnalysisOptions& options, Progress& progress) {
  if (!(options.maximalSeconds > 0.0)) {
    throw InputError(message("the limit of time is ", options.maximalSeconds, " s; give a positive number"));
  }
  TransitOptions transitOptions;
  transitOptions.maximalSeconds = options.maximalSeconds;
  transitOptions.epsilon = analysis.epsilon;
  transitOptions.weights = options.weights;
  analysis.transitPersistence = options.persistence.value_or(false);
  progress.range(0.0, analysis.transitPersistence ? 0.1 : 1.0);
  std::shared_ptr<TransitRefinement> transits;
  analysis.seconds.map = timed([&] {
    transits = std::make_shared<TransitRefinement>(faces, analysis.field, transitOptions, &progress);
    analysis.stop = transits->refine(&progress);
  });
  progress.range(0.1, 1.0);
  takeTransits(analysis, transits, progress);
}

}  // namespace

const char* name(MorseMethod method) {
  switch (method) {
    case MorseMethod::Tau:
      return "tau";
    case MorseMethod::Spatial:
      return "spatial";
    case MorseMethod::Geometry:
      break;
  }
  return "geometry";
}

MorseMethod morseMethod(const std::string& word) {
  for (const MorseMethod method : {MorseMethod::Geometry, MorseMethod::Tau, MorseMethod::Spatial}) {
    if (word == name(method)) return method;
  }
  throw InputError(message("there is no Morse method '", word, "'; choose geometry, tau or spatial"));
}

const char* name(RefinementStop stop) {
  switch (stop) {
    case RefinementStop::Steps:
      return "steps";
    case RefinementStop::Time:
      return "time";
    case RefinementStop::Memory:
      return "memory";
    case RefinementStop::Cancelled:
      return "cancelled";
    case RefinementStop::Done:
      break;
  }
  return "done";
}

MorseAnalysis analyzeMorse(const std::shared_ptr<const FlatFaces>& faces, const VectorField& field,
                           const MorseAnalysisOptions& options, Progress& progress) {
  checkEpsilon(options.epsilon);
  MorseAnalysis analysis;
  analysis.method = options.method;
  analysis.keepEmpty = options.keepEmpty;
  analysis.keepTrivial = options.keepTrivial;
  analysis.epsilon = options.relativeEpsilon ? options.epsilon * meanSpeed(field) : options.epsilon;
  analysis.field = std::make_shared<const VectorField>(field);
  if (options.method == MorseMethod::Geometry) {
    if (options.tau || options.tauMax) {
      throw InputError("the method 'geometry' has no tau; leave it out, or choose tau or spatial");
    }
    if (!options.refine) {
      analyzeGeometry(analysis, options, progress);
      return analysis;
    }
  } else {
    checkFlowOptions(options);
  }
  if (!faces) throw InputError("maps of the flow need the faces laid out for tracing; give them");
  if (options.tauMax && !options.refine) throw InputError("tau_max is for refinement; set refine too, or leave it out");
  if (options.method == MorseMethod::Geometry) {
    analyzeByTransits(analysis, faces, options, progress);
  } else if (options.refine) {
    analyzeByRefinement(analysis, faces, options, progress);
  } else {
    analyzeFlow(analysis, *faces, options, progress);
  }
  return analysis;
}

MorseAnalysis within(const MorseAnalysis& analysis, double epsilon, bool keepTrivial, Progress& progress) {
  checkEpsilon(epsilon);
  if (analysis.method != MorseMethod::Geometry || analysis.refinement) {
    throw InputError(message("a decomposition by '", name(analysis.method),
                             "' has no error bound; make one with the method 'geometry'"));
  }
  MorseAnalysis result;
  result.method = analysis.method;
  result.keepEmpty = analysis.keepEmpty;
  result.keepTrivial = keepTrivial;
  result.epsilon = epsilon;
  result.field = analysis.field;
  if (analysis.transits) {
    result.stop = analysis.stop;
    result.transitPersistence = analysis.transitPersistence;
    std::shared_ptr<const TransitRefinement> transits;
    result.seconds.map = timed(
        [&] { transits = std::make_shared<const TransitRefinement>(analysis.transits->within(epsilon, &progress)); });
    takeTransits(result, transits, progress);
    return result;
  }
  result.bounded = analysis.bounded;
  result.levels = analysis.levels;
  result.seconds.map = timed([&] {
    result.map = std::make_shared<const CombinatorialMap>(mapWithinEpsilon(*result.bounded, result.epsilon));
  });
  result.seconds.sets = timed([&] { findSets(result, progress); });
  result.seconds.persistence = timed([&] { findPersistence(result); });
  return result;
}

MorseAnalysis withSetRefined(const std::shared_ptr<const FlatFaces>& faces, const MorseAnalysis& analysis, Index set,
                             Progress& progress) {
  const Index count = analysis.decomposition.faces.count();
  if (set < 0 || set >= count) throw InputError(message("there is no Morse set ", set, "; there are ", count));
  const bool plain = analysis.method == MorseMethod::Geometry && analysis.epsilon == 0.0 && !analysis.transits;
  if (!analysis.refinement && !analysis.transits && !plain) {
    throw InputError("only a refined decomposition, or one by 'geometry' with eps 0, can be refined set by set");
  }
  MorseAnalysis result;
  result.method = plain ? MorseMethod::Tau : analysis.method;
  result.keepEmpty = analysis.keepEmpty;
  result.keepTrivial = analysis.keepTrivial;
  result.field = analysis.field;
  if (analysis.transits) {
    const auto transits = std::make_shared<TransitRefinement>(*analysis.transits);
    result.epsilon = analysis.epsilon;
    result.stop = analysis.stop;
    result.transitPersistence = analysis.transitPersistence;
    result.seconds.map = timed([&] { transits->refineNodes(analysis.nodes.members(set), &progress); });
    takeTransits(result, transits, progress);
    return result;
  }
  MorseAnalysisOptions options;
  options.method = result.method;
  const auto refinement = analysis.refinement
                              ? std::make_shared<MorseRefinement>(*analysis.refinement)
                              : std::make_shared<MorseRefinement>(faces, analysis.field, refinementOptions(options));
  const Index its = refinement->sets().setOf(analysis.decomposition.faces.members(set).front());
  result.seconds.map = timed([&] {
    if (its != kNone) refinement->refineSet(its, &progress);
  });
  takeRefinement(result, refinement);
  return result;
}

std::vector<Index> connectionFaces(const MorseAnalysis& analysis, Index from, Index to) {
  if (!analysis.transits) return connectionRegion(*analysis.map, analysis.decomposition.faces, from, to);
  std::vector<Index> faces, result;
  for (const Index node : connectionRegion(*analysis.map, analysis.nodes, from, to)) {
    analysis.transits->map().appendFaces(node, faces);
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  const auto isOf = [&](Index set, Index f) {
    const std::vector<Index>& cover = analysis.decomposition.covers[set];
    return std::binary_search(cover.begin(), cover.end(), f);
  };
  std::copy_if(faces.begin(), faces.end(), std::back_inserter(result),
               [&](Index f) { return !isOf(from, f) && !isOf(to, f); });
  return result;
}

}  // namespace stormfield
