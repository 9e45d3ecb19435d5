// Hierarchical refinement of Morse decompositions (thesis 8): from the coarse sets of the geometry-based map, those
// that may hold more than one feature get rows of tau maps inside, with tau doubled from step to step.
//
// In each round the sets of highest priority (thesis 8.3) are refined: all faces of a set get rows of one tau for what
// stays in the set, keep those that lead out of it, and the strongly connected components inside the set take its
// place. What a set splits into stays within it, the other sets and the order between sets do not change
// (thesis 8.2.1), so that every round leaves a valid decomposition. Images are followed only while they come back to
// the set (set_windows.h), so that a larger tau, with fewer points that stay, costs little. A set is done when its
// priority is low, when its tau would exceed the limit, or when doubling no longer changes it. What shares faces stays
// together whatever tau is: transit_refinement.h goes on from there.
//
//   MorseRefinement refinement(faces, field, {.tauMax = 0.5});
//   const RefinementStop stop = refinement.refine(&progress);
//   refinement.sets();  refinement.taus();
//   const CombinatorialMap map = refinement.map();
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "morse/flow_mover.h"
#include "morse/morse_decomposition.h"
#include "morse/set_windows.h"
#include "morse/tau_map.h"

namespace stormfield {

struct RefinementOptions {
  TauMapOptions map = {};  ///< unit and accuracy of the tau maps
  /// Tau of a set's first step and the largest one; none: to cross so many edges at the mean speed within the set.
  std::optional<double> tauMin{}, tauMax{};
  double edgesMin = 4.0, edgesMax = 256.0;
  double leastPriority = 2.0;  ///< sets of this priority or less are left as they are (r of thesis 8.3)
  int patience = 3;            ///< doublings in a row that leave a set as it is, until it is done
  Index maximalSteps = std::numeric_limits<Index>::max();           ///< refinements of one set at one tau, in all
  double maximalSeconds = std::numeric_limits<double>::infinity();  ///< of wall time; the last complete round stays
};

enum class RefinementStop {
  Done,       ///< no set is left to refine
  Steps,      ///< maximalSteps were used
  Time,       ///< maximalSeconds have passed
  Memory,     ///< more would not fit into the memory allowed
  Cancelled,  ///< the sets are those of the last complete round
};

/// A decomposition that can be refined; copies are independent.
class MorseRefinement {
 public:
  /// The coarse start. faces: of the field's mesh. Throws InputError for tauMin or tauMax that are not positive
  /// numbers.
  MorseRefinement(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
                  const RefinementOptions& options = {});

  /// Refines until a limit is met (that of options.map.memoryLimit holds for each set's rows) or nothing is left. Being
  /// cancelled is no error: it leaves what is complete.
  RefinementStop refine(Progress* progress = nullptr);
  /// One round of refine; false when nothing is left. Throws Cancelled, which leaves everything as it was.
  bool round(Progress* progress = nullptr);
  /// Refines one set, whatever its priority, until it changes or tauMax is met; whether it changed. Throws InputError
  /// for a set that does not exist, and Cancelled, which leaves everything as it was.
  bool refineSet(Index set, Progress* progress = nullptr);

  /// The sets that can recur, numbered by their first faces.
  const FaceSets& sets() const { return sets_; }
  /// Index and kind of each set.
  const std::vector<MorseSet>& indices() const { return indices_; }
  /// The tau of every face's row; 0 where it is the geometry-based one.
  const std::vector<double>& taus() const { return taus_; }
  /// F: from every face to where its points are at taus(), or, if they leave a set that the face was part of, to where
  /// they are at the first smaller tau (halved until the first one of the face) that finds them outside.
  CombinatorialMap map() const;
  /// Refinements of one set so far, and the traces they took.
  Index steps() const { return steps_; }
  std::size_t traces() const { return work_.traces; }

 private:
  /// A set that a step has found: a strongly connected component at its tau.
  struct Ancestor {
    double tau;
    SharedFaces faces;
  };
  struct Trial {
    double tau = 0.0;    ///< of the last step, 0 for none
    double scale = 0.0;  ///< tau to cross one edge
    int unchanged = 0;   ///< steps in a row without change
    bool done = false;
    std::vector<Ancestor> ancestors;  ///< by growing tau, the last one is the set itself
  };

  double edgeTau(const std::vector<Index>& faces) const;
  double nextTau(const Trial& trial) const;
  double lastTau(const Trial& trial) const;
  bool isOpen(Index set) const;
  double priority(Index set) const;
  std::vector<Index> chooseSets() const;
  std::vector<char> refineAll(const std::vector<Index>& chosen, Progress* progress);
  std::vector<char> replace(const std::vector<Index>& chosen, std::vector<std::vector<Index>> seen);
  double doneFraction() const;
  SetWindows windowsOf(Index set) const;
  void setRow(Index face, const Index* begin, const Index* end);

  std::shared_ptr<const FlatFaces> faces_;
  std::shared_ptr<const VectorField> field_;
  RefinementOptions options_;
  std::shared_ptr<const TauFlow> flow_;
  std::vector<int> poincare_;
  std::vector<char> resting_;

  std::vector<std::vector<Index>> rows_;  ///< of F, per face
  std::vector<double> taus_;
  FaceSets sets_;
  std::vector<MorseSet> indices_;
  std::vector<Trial> trials_;  ///< per set
  Index steps_ = 0;
  TauWork work_;
};

/// Priority of thesis equation 8.1: (1 + the distance of the index from those of fixed points and periodic orbits)
/// times the number of faces.
double refinementPriority(const ConleyIndex& index, std::size_t faceCount);

}  // namespace stormfield
