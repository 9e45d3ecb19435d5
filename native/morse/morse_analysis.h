// From a field to its Morse decomposition in one call: the map F of the chosen method, the Morse sets with their
// indices and order, and for the geometry-based maps what an error bound makes of them (thesis 6.2, 6.4, Figure 6.3).
//
//   const MorseAnalysis analysis = analyzeMorse(faces, field, {.method = MorseMethod::Tau, .tau = 0.3}, progress);
//   analysis.decomposition.sets[0].kind;
//   const MorseAnalysis sure = analyzeMorse(faces, field, {.epsilon = 0.02}, progress);
//   const MorseAnalysis simpler = withinEpsilon(sure, 0.05, sure.kept, progress);   // fields that differ by up to 0.05
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "morse/morse_decomposition.h"
#include "morse/morse_model.h"
#include "tracing/flat_faces.h"

namespace stormfield {

struct MorseAnalysisOptions {
  MorseMethod method = MorseMethod::Geometry;
  /// Seconds, or mesh units for Spatial; none: startingTau. Geometry has none.
  std::optional<double> tau{};
  /// Refine coarse sets step by step (thesis 8): Tau and Spatial by ever larger tau, of which tau is then the first
  /// (tau_refinement.h), Geometry by ever smaller pieces of edges (transit_refinement.h).
  bool refine = false;
  std::optional<double> tauMax{};  ///< Tau and Spatial with refine; none: tau_refinement.h
  /// With refine: seconds after which the sets so far are taken.
  double maxSeconds = std::numeric_limits<double>::infinity();
  /// Bound on the error of the vectors, mesh units per second, or with relativeEpsilon in mean speeds of the field.
  double epsilon = 0.0;
  bool relativeEpsilon = false;
  std::vector<double> weights{};  ///< factors of epsilon, one per vertex; empty: 1
  /// Geometry: whether to find when sets merge; none: where it costs little, without refine.
  std::optional<bool> persistence{};
  KeptSets kept{};
};

struct MorseAnalysis {
  std::shared_ptr<const MorseModel> model;  ///< what was used: method, map, taus, error bound
  KeptSets kept;
  MorseDecomposition decomposition;
  struct {
    double map = 0.0, sets = 0.0, persistence = 0.0;
  } seconds;  ///< of wall time, by phase
};

/// faces: of the field's mesh; may be null for Geometry without refine. Throws InputError for options that cannot be
/// used or do not go together, and Cancelled; a refinement that is cancelled returns the sets it has come to.
MorseAnalysis analyzeMorse(const std::shared_ptr<const FlatFaces>& faces, const VectorField& field,
                           const MorseAnalysisOptions& options, Progress& progress);

/// The decomposition that holds for every field within epsilon: that of the same analysis with this epsilon and choice
/// of sets, in the time of a search for components. A refined one keeps its pieces of edges, in the time of a map of
/// all of them. Persistence is found again where it was asked for. Throws InputError unless the method is Geometry and
/// epsilon a number >= 0, and Cancelled.
MorseAnalysis withinEpsilon(const MorseAnalysis& analysis, double epsilon, const KeptSets& kept, Progress& progress);

/// The decomposition with one set refined further, by the method of its refinement, or by maps of the flow for a time
/// where it is a plain geometry-based one. Throws InputError for a set that does not exist and for other
/// decompositions, and Cancelled.
MorseAnalysis withSetRefined(const std::shared_ptr<const FlatFaces>& faces, const MorseAnalysis& analysis, Index set,
                             Progress& progress);

/// Faces, ascending, that connections from one set to another pass through, without those of the two sets. Throws
/// InputError for a set that does not exist.
std::vector<Index> facesBetween(const MorseAnalysis& analysis, Index from, Index to);

}  // namespace stormfield
