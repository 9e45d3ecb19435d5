#include "morse/morse_analysis.h"

#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/message.h"
#include "morse/tau_map.h"

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

/// The time, or the length, to cross four edges at the mean speed.
double fewEdges(const VectorField& field, MorseMethod method) {
  const double length = 4.0 * field.mesh().meanEdgeLength(), speed = meanSpeed(field);
  if (method == MorseMethod::Spatial) return length;
  if (!(speed > 0.0)) throw InputError("the field is zero everywhere; give tau, or choose the method 'geometry'");
  return length / speed;
}

/// Everything after the map.
void findSets(MorseAnalysis& analysis, Progress& progress) {
  MorseOptions options;
  options.keepEmpty = analysis.keepEmpty;
  options.keepTrivial = analysis.keepTrivial;
  if (analysis.bounded) {
    options.resting = restingWithin(*analysis.bounded, analysis.epsilon);
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
    analysis.map = std::make_shared<const CombinatorialMap>(mapWithin(*analysis.bounded, analysis.epsilon));
  });
  progress.range(0.3, options.persistence ? 0.4 : 1.0);
  analysis.seconds.sets = timed([&] { findSets(analysis, progress); });
  if (!options.persistence) return;
  progress.range(0.4, 1.0);
  analysis.seconds.persistence = timed([&] {
    analysis.levels = std::make_shared<const MergeLevels>(mergeLevels(*analysis.bounded, progress));
    findPersistence(analysis);
  });
}

void analyzeFlow(MorseAnalysis& analysis, const FlatFaces& faces, const MorseAnalysisOptions& options,
                 Progress& progress) {
  if (options.epsilon > 0.0) {
    throw InputError(message("an error bound needs the geometry-based map, not '", name(options.method),
                             "'; choose the method 'geometry' or set eps to 0"));
  }
  if (options.tau && !(*options.tau > 0.0 && std::isfinite(*options.tau))) {
    throw InputError(message("tau is ", *options.tau, "; give a positive number, or none to have one found"));
  }
  analysis.tau = options.tau ? *options.tau : fewEdges(*analysis.field, options.method);
  progress.range(0.0, 0.9);
  analysis.seconds.map = timed([&] {
    TauMapOptions tauOptions;
    tauOptions.unit = unitOf(options.method);
    analysis.map =
        std::make_shared<const CombinatorialMap>(tauMap(faces, *analysis.field, analysis.tau, tauOptions, &progress));
  });
  progress.range(0.9, 1.0);
  analysis.seconds.sets = timed([&] { findSets(analysis, progress); });
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

MorseAnalysis analyzeMorse(const FlatFaces* faces, const VectorField& field, const MorseAnalysisOptions& options,
                           Progress& progress) {
  checkEpsilon(options.epsilon);
  MorseAnalysis analysis;
  analysis.method = options.method;
  analysis.keepEmpty = options.keepEmpty;
  analysis.keepTrivial = options.keepTrivial;
  analysis.epsilon = options.relativeEpsilon ? options.epsilon * meanSpeed(field) : options.epsilon;
  analysis.field = std::make_shared<const VectorField>(field);
  if (options.method == MorseMethod::Geometry) {
    if (options.tau) throw InputError("the method 'geometry' has no tau; leave it out, or choose tau or spatial");
    analyzeGeometry(analysis, options, progress);
  } else {
    if (faces == nullptr) throw InputError("maps of the flow need the faces laid out for tracing; give them");
    analyzeFlow(analysis, *faces, options, progress);
  }
  return analysis;
}

MorseAnalysis within(const MorseAnalysis& analysis, double epsilon, bool keepTrivial, Progress& progress) {
  checkEpsilon(epsilon);
  if (!analysis.bounded) {
    throw InputError(message("a decomposition by '", name(analysis.method),
                             "' has no error bound; make one with the method 'geometry'"));
  }
  MorseAnalysis result;
  result.method = analysis.method;
  result.keepEmpty = analysis.keepEmpty;
  result.keepTrivial = keepTrivial;
  result.epsilon = epsilon;
  result.field = analysis.field;
  result.bounded = analysis.bounded;
  result.levels = analysis.levels;
  result.seconds.map =
      timed([&] { result.map = std::make_shared<const CombinatorialMap>(mapWithin(*result.bounded, result.epsilon)); });
  result.seconds.sets = timed([&] { findSets(result, progress); });
  result.seconds.persistence = timed([&] { findPersistence(result); });
  return result;
}

}  // namespace stormfield
