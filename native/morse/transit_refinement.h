// Hierarchical refinement (thesis 8) of the geometry-based decomposition without tau: the pieces of edges inside chosen
// sets are halved (transit_map.h), and the strongly connected components take the place of the sets.
//
// In the end the pieces on ways between sets that flow passes through (saddles, say) are halved too, so that the graph
// of the sets has few connections that the flow has not.
//
// What a set splits into stays within it, the other sets do not change (thesis 8.2.1), and the result is that of the
// transit map of all pieces at once, in whatever order they were halved. Sets without pieces (a fixed point that
// nothing comes back to) are done; so are those that halving leaves as they are, and those that have come to the last
// level. Sets may be parted inside a face: a face may be met by several.
//
// Maps of whole faces, of whatever tau, cannot part that much: where a trajectory that comes from a saddle and one that
// goes there pass through the same face, F leads from the saddle to the face and back, and so for a chain of saddles.
// On the gas engine of the thesis (26,298 faces) this joins 17 of the 64 fixed points and orbits in 7 sets: 54 sets are
// the most that refinement by tau can find there.
//
// Outside the sets pieces stay as coarse as they were when they were left, so that the order of the sets may hold more
// than the flow.
//
// The index is exact. Let N be a set's strips: in each face, what flows from its pieces of entry to its pieces of exit,
// with the fixed points. N is connected, flow enters it over its pieces and leaves it over pieces beyond it. So b0 = 1
// just when no edge of the map leads out of the set (what is in N stays), b2 = 1 just when none leads into it (the same
// for the reversed flow), and b1 = b0 + b2 - the sum of the Poincare indices inside.
//
// With an error bound the sets hold for every field W within it. The nodes that a set leads to, with and without its
// own, make an index pair for all W at once: what a trajectory of any W enters of their strips it does not leave again.
// So the index, found as above from the map of all W and the fixed points of V, is that of what every W has in the set,
// and exact; but a fixed point may leave over the boundary of the surface, so that nothing is certain of the index of
// a set with a face there that some W rests in (upperBound).
//
//   TransitRefinement refinement(faces, field);
//   refinement.refine(&progress);
//   const TransitDecomposition result = refinement.decomposition(false, true, progress);
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "maps/transit_map.h"
#include "morse/morse_decomposition.h"
#include "morse/tau_refinement.h"

namespace stormfield {

struct TransitOptions {
  int levels = 8;  ///< halvings of an edge, at most; a few more in small sets
  /// Rounds in a row that halve a set's pieces and lose hardly any of them, until it is done. A spiral that comes
  /// nearer by a part c of its radius with each radian needs -log2(c), and some.
  int patience = 5;
  double maximalSeconds = std::numeric_limits<double>::infinity();  ///< of wall time
  /// Bytes that pieces and graph may take, about; none: half of the memory of the machine.
  std::optional<std::size_t> memoryLimit{};
  /// With epsilon > 0 for all fields within it, mesh units per second, times the weights: one per vertex, empty for 1.
  double epsilon = 0.0;
  std::vector<double> weights{};
};

struct TransitDecomposition {
  /// Its faces are parted among the sets: a face that several sets meet belongs to that with the fixed point in it,
  /// else to the smallest. covers has all faces that each set meets.
  MorseDecomposition morse;
  CombinatorialMap map;  ///< of all nodes
  NodeSets nodes;        ///< nodes of each set
};

/// A decomposition that can be refined; copies are independent.
class TransitRefinement {
 public:
  /// faces: of the field's mesh. Throws InputError for a field of another mesh, or an epsilon or weights that are not
  /// numbers >= 0, and Cancelled.
  TransitRefinement(const std::shared_ptr<const FlatFaces>& faces, const std::shared_ptr<const VectorField>& field,
                    const TransitOptions& options = {}, Progress* progress = nullptr);

  /// Refines until a limit is met or nothing is left. Being cancelled is no error: what is there is valid.
  RefinementStop refine(Progress* progress = nullptr);
  /// One round: every set that is not done. False when nothing is left. Throws Cancelled.
  bool round(Progress* progress = nullptr);
  /// Halves the pieces of some nodes (those of one set, say) until the sets they belong to change, by 4 levels at most
  /// beyond the last; whether they did. Throws Cancelled.
  bool refineNodes(const std::vector<Index>& nodes, Progress* progress = nullptr);

  /// The same pieces for all fields within another epsilon; they can be refined further. With 0 the sets are nearly
  /// those of the field itself, or just those where this has no error bound. Throws InputError and Cancelled.
  TransitRefinement within(double epsilon, Progress* progress = nullptr) const;
  const VectorField& field() const { return *field_; }
  const TransitOptions& options() const { return options_; }

  /// Nodes of each recurrent set, ascending.
  const std::vector<std::vector<Index>>& sets() const { return nodes_; }
  const TransitMap& map() const { return map_; }
  TransitDecomposition decomposition(bool keepEmpty, bool keepTrivial, Progress& progress) const;

 private:
  struct Trial {
    int kept = 0;         ///< rounds in a row that lost hardly any piece
    bool halved = false;  ///< pieces were halved, and the components not looked at since
    bool done = false;
  };

  void findSets(Progress* progress);
  int levelsOf(Index set) const;
  bool isOpen(Index set, int levels) const;
  bool isOpenPiece(Index node, int levels) const;
  bool refineSets(const std::vector<Index>& chosen, int more, Progress* progress);
  bool refineWays(Progress* progress);
  bool fits() const;

  std::shared_ptr<const FlatFaces> faces_;
  std::shared_ptr<const VectorField> field_;
  TransitOptions options_;
  std::shared_ptr<const ConeTransit> cones_;  ///< null without an error bound
  TransitMap map_;
  std::vector<std::vector<Index>> nodes_;
  std::vector<Trial> trials_;
  std::vector<Index> ways_;  ///< nodes on ways between sets that flow passes through, and of these; empty: not known
  int level_ = 0;
};

}  // namespace stormfield
