// Hierarchical refinement (thesis 8) of the geometry-based decomposition without tau: the pieces of edges inside chosen
// sets are halved (transit_map.h), and the strongly connected components of the finer pieces replace the sets. Szymczak
// & Zhang 2012, Robust Morse Decompositions of Piecewise Constant Vector Fields, refine a graph on pieces of edges for
// fields that are constant in each face; here the field is the thesis's, and a piece leads to what its image meets.
//
// At the end the pieces on connections through intermediate sets, which have both predecessors and successors (saddles,
// say), are halved too, so that the graph of the sets has few connections that the flow has not.
//
// The components of a set lie within it, the other sets do not change (thesis 8.2.1), and the result is that of the
// transit map of all pieces at once, in whatever order they were halved. A set without pieces (a fixed point that no
// piece leads back to) is done, and so is one that halving leaves unchanged, or whose pieces have reached the last
// level. A face may be met by several sets.
//
// Maps of whole faces cannot separate as much at any tau: where a trajectory from a saddle and one to it pass through
// the same face, F leads from the saddle to the face and back, and so on along a chain of saddles
// (docs/algorithms/refinement.md has numbers).
//
// Outside the sets pieces stay as coarse as they were when the sets shrank, so that the order of the sets may hold more
// than the flow.
//
// The index is exact. Let N be a set's strips: in each face, what flows from its pieces of entry to its pieces of exit,
// with the fixed points. N is connected, flow enters it over its pieces and leaves it over pieces beyond it. So b0 = 1
// exactly when no edge of the map leads out of the set (trajectories stay in N), b2 = 1 exactly when none leads into it
// (the same for the reversed flow), and b1 = b0 + b2 - the sum of the Poincare indices inside.
//
// With an error bound the sets hold for every field W within epsilon. The nodes that a set leads to, with and without
// its own, make an index pair for all W at once: a trajectory of any W that enters their strips does not leave them
// again. So the index, found as above from the map of all W and the fixed points of V, is that of what every W has in
// the set, and exact. But a fixed point may leave over the boundary of the surface, so that the index of a set with a
// face there in which some W has a fixed point is not certain (upperBound).
//
//   TransitRefinement refinement(faces, field);
//   const RefinementStop stop = refinement.refine(&progress);
//   const CombinatorialMap map = refinement.map().map(&progress);
//   const MorseDecomposition morse = refinement.decomposition(map, {}, progress);
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "maps/transit_map.h"
#include "morse/morse_decomposition.h"
#include "morse/refinement_stop.h"

namespace stormfield {

struct TransitRefinementOptions {
  int maxLevel = 8;  ///< halvings of an edge; small sets get a few more
  /// Rounds in a row that halve a set's pieces and lose hardly any of them, after which it is done. A spiral that comes
  /// nearer by a fraction c of its radius per radian needs about -log2(c) of them.
  int patience = 5;
  double maxSeconds = std::numeric_limits<double>::infinity();  ///< of wall time
  /// Estimated bytes of pieces and graph; none: half of the memory of the machine.
  std::optional<std::size_t> memoryLimit{};
  /// The sets hold for all fields within epsilon, mesh units per second, times the weights: one per vertex, empty
  /// for 1.
  double epsilon = 0.0;
  std::vector<double> weights{};
};

/// A decomposition that can be refined; copies are independent.
class TransitRefinement {
 public:
  /// faces: of the field's mesh. Throws InputError for a field of another mesh, or an epsilon or weights that are not
  /// numbers >= 0, and Cancelled.
  TransitRefinement(const std::shared_ptr<const FlatFaces>& faces, const std::shared_ptr<const VectorField>& field,
                    const TransitRefinementOptions& options = {}, Progress* progress = nullptr);

  /// Refines until a limit is met or nothing is left to refine. Cancellation is no error: the sets so far are valid.
  RefinementStop refine(Progress* progress = nullptr);
  /// One round: every set that is not done. False when nothing is left to refine. Throws Cancelled.
  bool round(Progress* progress = nullptr);
  /// Halves the pieces of the sets that some nodes belong to until the sets change, at most 4 levels beyond the last;
  /// whether they did. Throws Cancelled.
  bool refineNodes(const std::vector<Index>& nodes, Progress* progress = nullptr);

  /// The same pieces for all fields within another epsilon; they can be refined further. At 0 the sets are those of the
  /// field itself where this has no error bound, else nearly those. Throws InputError and Cancelled.
  TransitRefinement withinEpsilon(double epsilon, Progress* progress = nullptr) const;
  const VectorField& field() const { return *field_; }
  const TransitRefinementOptions& options() const { return options_; }

  /// Nodes of each recurrent component, ascending.
  const std::vector<std::vector<Index>>& sets() const { return nodes_; }
  const TransitMap& map() const { return map_; }
  /// The Morse sets. map: map().map(), whose nodes are interior nodes of faces and pieces of edges. Of a face that
  /// several sets meet, the set with the fixed point in it has it in `faces`, else the smallest. Throws InputError for
  /// a map of other pieces, and Cancelled.
  MorseDecomposition decomposition(const CombinatorialMap& map, const KeptSets& kept, Progress& progress) const;

 private:
  struct SetState {
    int unchanged = 0;    ///< rounds in a row that lost hardly any piece
    bool halved = false;  ///< pieces were halved, and the components not searched since
    bool done = false;
  };

  void findSets(Progress* progress);
  int maxLevelOf(Index set) const;
  bool canBeRefined(Index set, int maxLevel) const;
  bool canBeHalved(Index node, int maxLevel) const;
  bool refineSets(const std::vector<Index>& chosen, int furtherLevels, Progress* progress);
  void halvePiecesOf(const std::vector<Index>& chosen, int furtherLevels, Progress* progress);
  bool replaceByComponents(const std::vector<Index>& chosen, Progress* progress);
  bool refineConnections(Progress* progress);
  std::vector<Index> nodesOfConnections() const;
  std::vector<Index> nodesThroughIntermediateSets(const std::vector<Index>& nodes, Progress* progress) const;
  bool fitsIntoMemory() const;
  MorseSet morseSetOf(const std::vector<Index>& nodes, bool hasPredecessor, bool hasSuccessor) const;

  std::shared_ptr<const FlatFaces> faces_;
  std::shared_ptr<const VectorField> field_;
  TransitRefinementOptions options_;
  std::shared_ptr<const ConeTransit> cones_;  ///< null without an error bound
  TransitMap map_;
  std::vector<std::vector<Index>> nodes_;
  std::vector<SetState> states_;
  /// Nodes on connections through intermediate sets, with those of these sets; none before they are found, and after
  /// the sets have changed.
  std::optional<std::vector<Index>> connecting_;
  int level_ = 0;
};

}  // namespace stormfield
