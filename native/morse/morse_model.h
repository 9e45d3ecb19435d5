// A combinatorial map F of a field, made by one method and at one accuracy, with what can be asked of it: its Morse
// sets, the map of all fields within an error bound, the map with one set refined (thesis 6.2, 6.4, 8).
//
// There is one kind of model per method (detail/): directions across edges, the flow for a time or an arc length, and
// the refinement of either. morse_analysis.h makes them.
//
//   const MorseAnalysis analysis = analyzeMorse(faces, field, {}, progress);
//   const MorseModel& model = *analysis.model;
//   model.map().graph.edgeCount();
//   model.facesBetween(analysis.decomposition, 0, 1);
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/words.h"
#include "maps/combinatorial_map.h"
#include "morse/morse_decomposition.h"
#include "morse/refinement_stop.h"
#include "tracing/flat_faces.h"

namespace stormfield {

enum class MorseMethod {
  Geometry,  ///< directions across the edges: fast, coarse, with exact indices and error bounds
  Tau,       ///< the flow for a time tau
  Spatial    ///< the flow for an arc length tau
};
template <>
inline constexpr Words kWords<MorseMethod>{"Morse method", {"geometry", "tau", "spatial"}};

class MorseModel {
 public:
  virtual ~MorseModel() = default;

  virtual MorseMethod method() const = 0;
  /// F.
  virtual const CombinatorialMap& map() const = 0;
  /// The Morse sets of F. Throws Cancelled; refinements do not, as what they have come to is valid.
  virtual MorseDecomposition decomposition(const KeptSets& kept, Progress& progress) const = 0;
  /// Per set of that decomposition the least error bound beyond epsilon() at which it merges with another, infinite
  /// where it never does (persistence.h). None where it was not asked for, or the method has no error bounds. What is
  /// found for one error bound is kept for others. Throws Cancelled; refinements have none then, and say so in stop().
  virtual std::optional<std::vector<double>> findPersistence(const MorseDecomposition& morse, Progress& progress);

  /// Per face the tau of its row of F, 0 where that comes from directions across edges.
  virtual std::vector<double> taus() const = 0;
  /// The largest of taus().
  double tau() const;
  /// The error bound that F holds for, mesh units per second.
  virtual double epsilon() const { return 0.0; }
  /// Why a refinement went no further; none for others, and where sets were chosen by hand.
  virtual std::optional<RefinementStop> stop() const { return std::nullopt; }

  /// The model of all fields within another epsilon >= 0. Throws InputError for methods without error bounds, and
  /// Cancelled.
  virtual std::unique_ptr<MorseModel> withinEpsilon(double epsilon, Progress& progress) const;
  /// The model with one set of its decomposition refined further, by the method of its refinement, or by maps of the
  /// flow for a time where it is a plain geometry-based one with epsilon 0. Throws InputError for others, and
  /// Cancelled.
  virtual std::unique_ptr<MorseModel> withSetRefined(const std::shared_ptr<const FlatFaces>& faces,
                                                     const MorseDecomposition& morse, Index set,
                                                     Progress& progress) const;
  /// Faces, ascending, that connections from one set of its decomposition to another pass through, without those of
  /// the two sets.
  virtual std::vector<Index> facesBetween(const MorseDecomposition& morse, Index from, Index to) const;
};

}  // namespace stormfield
