// From a field to its Morse decomposition in one call: the map F of the chosen method, the Morse sets with their
// indices and order, and for the geometry-based map what an error bound makes of them (thesis 6.2; Figure 6.3).
//
//   MorseAnalysis analysis = analyzeMorse(faces, field, {.method = MorseMethod::Tau, .tau = 0.3}, progress);
//   analysis.decomposition.sets[0].kind;
//   MorseAnalysis simpler = within(analysis, 0.05, true, progress);    // geometry: fields that differ by up to 0.05
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "maps/error_bound.h"
#include "morse/morse_decomposition.h"
#include "morse/persistence.h"
#include "morse/tau_refinement.h"
#include "morse/transit_persistence.h"
#include "morse/transit_refinement.h"
#include "tracing/flat_faces.h"

namespace stormfield {

enum class MorseMethod {
  Geometry,  ///< directions across the edges: fast, coarse, with exact indices and error bounds
  Tau,       ///< the flow for a time tau
  Spatial    ///< the flow for an arc length tau
};

/// Lower-case word used in files and messages; and back (throws InputError).
const char* name(MorseMethod method);
MorseMethod morseMethod(const std::string& name);

struct MorseAnalysisOptions {
  MorseMethod method = MorseMethod::Geometry;
  /// Seconds, or mesh units for Spatial; none: startingTau. Geometry has none.
  std::optional<double> tau{};
  /// Refine coarse sets step by step (thesis 8): Tau and Spatial by ever larger tau, of which tau is then the first
  /// (tau_refinement.h), Geometry by ever smaller pieces of edges (transit_refinement.h).
  bool refine = false;
  std::optional<double> tauMax{};  ///< Tau and Spatial with refine; none: tau_refinement.h
  /// With refine: seconds after which the sets so far are taken.
  double maximalSeconds = std::numeric_limits<double>::infinity();
  /// Bound on the error of the vectors, mesh units per second, or with relativeEpsilon in mean speeds of the field.
  double epsilon = 0.0;
  bool relativeEpsilon = false;
  std::vector<double> weights{};  ///< factors of epsilon, one per vertex; empty: 1
  /// Geometry: whether to find when sets merge; none: where it costs little, without refine.
  std::optional<bool> persistence{};
  bool keepEmpty = false;   ///< recurrence.h
  bool keepTrivial = true;  ///< morse_decomposition.h
};

struct MorseAnalysis {
  MorseMethod method = MorseMethod::Geometry;
  double tau = 0.0;      ///< what was used, the largest where it was refined; 0 for Geometry
  double epsilon = 0.0;  ///< mesh units per second
  bool keepEmpty = false, keepTrivial = true;
  std::shared_ptr<const VectorField> field;
  std::shared_ptr<const CombinatorialMap> map;
  std::shared_ptr<const ErrorBoundedMap> bounded;     ///< Geometry without refine only
  std::shared_ptr<const MergeLevels> levels;          ///< Geometry with persistence only
  std::shared_ptr<const MorseRefinement> refinement;  ///< Tau and Spatial with refine only
  std::shared_ptr<const TransitRefinement> transits;  ///< Geometry with refine only
  bool transitPersistence = false;                    ///< whether it was asked for
  NodeSets nodes;                                     ///< of the map; Geometry with refine only: nodes of each set
  std::optional<RefinementStop> stop;                 ///< why it went no further
  MorseDecomposition decomposition;
  struct {
    double map = 0.0, sets = 0.0, persistence = 0.0;
  } seconds;
};

/// faces: of the field's mesh; may be null for Geometry without refine. Throws InputError for options that cannot be
/// used or do not go together, and Cancelled; a refinement that is cancelled returns the sets it has come to.
MorseAnalysis analyzeMorse(const std::shared_ptr<const FlatFaces>& faces, const VectorField& field,
                           const MorseAnalysisOptions& options, Progress& progress);

/// The decomposition that holds for every field within epsilon: that of the same analysis with this epsilon and choice
/// of trivial sets, in the time of a search for components. A refined one keeps its pieces, in the time of a map of all
/// of them; sets that it was asked to find persistence for get it again. Throws InputError unless the method is
/// Geometry and epsilon a number >= 0, and Cancelled.
MorseAnalysis within(const MorseAnalysis& analysis, double epsilon, bool keepTrivial, Progress& progress);

/// The decomposition with one set refined further by hand, by the method of its refinement, or by maps of the flow for
/// a time where it is a plain geometry-based one. Throws InputError for a set that does not exist and for other
/// decompositions, and Cancelled.
MorseAnalysis withSetRefined(const std::shared_ptr<const FlatFaces>& faces, const MorseAnalysis& analysis, Index set,
                             Progress& progress);

/// Faces, ascending, on a way of the map from one set to another, without those of the two sets.
std::vector<Index> connectionFaces(const MorseAnalysis& analysis, Index from, Index to);

/// Lower-case word: done, steps, time, memory or cancelled.
const char* name(RefinementStop stop);

}  // namespace stormfield
