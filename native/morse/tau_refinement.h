// Hierarchical refinement of Morse decompositions (thesis 8): from the coarse sets of the geometry-based map, those
// that may hold more than one feature get rows of tau maps inside, with tau doubled from step to step.
//
// In each round the sets of highest priority (thesis 8.3) are refined: all faces of a set get rows of one tau for what
// stays in the set, keep those that lead out of it, and the strongly connected components inside the set take its
// place. What a set splits into stays within it, the other sets and the order between sets do not change
// (thesis 8.2.1), so that every round leaves a valid decomposition. A set is done when its priority is low, when its
// tau would exceed the limit, or when doubling no longer changes it. What shares faces stays together whatever tau is:
// transit_refinement.h goes on from there.
//
// The result is that of a recomputation from taus(). Let G be the geometry-based map and S(0), S(1), ... the sets that
// a face f was in when it got its taus t(1), t(2), ..., t(k). R(i) has the rows of S(i-1) at t(i), of images that are
// followed only while they come back to the sets before (tauRowsWithinSet; a larger tau, with fewer points that stay,
// then costs little), and S(i) is a strongly connected component of R(i) restricted to S(i-1). The refinement's map has
// from f the edges
//     of R(1) to S(0) without S(1), and to what comes after S(0) in a total order of the components of G (padding that
//          leads back is left out, which no trajectory does),
//     of R(i) to S(i-1) without S(i), for 1 < i < k,
//     of R(k) to S(k-1),
// and its strongly connected sets that can recur are sets(). Both depend on the field, the options and taus() alone:
// not on the order of refinement, the other sets, limits or threads. Images that are followed everywhere give further
// edges where what has left for ever comes as near as the padding again: of 180 refinements of random fields on meshes
// of 54 to 108 faces, 170 had the same sets then too, and 10 had not.
//
//   MorseRefinement refinement(faces, field, {.tauMax = 0.5});
//   const RefinementStop stop = refinement.refine(&progress);
//   refinement.sets();  refinement.taus();
//   const CombinatorialMap map = refinement.map();
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "maps/prepared_flow.h"
#include "maps/set_windows.h"
#include "maps/tau_map.h"
#include "morse/morse_decomposition.h"

namespace stormfield {

struct RefinementOptions {
  TauMapOptions map = {};  ///< unit and accuracy of the tau maps
  /// Tau of a set's first step and the largest one; none: to cross so many edges at the mean speed within the set.
  std::optional<double> tauMin{}, tauMax{};
  double edgesMin = 4.0, edgesMax = 256.0;
  double leastPriority = 2.0;  ///< sets of this priority or less are left as they are (r of thesis 8.3)
  int patience = 3;            ///< doublings in a row that leave a set as it is, until it is done
  Index maxSteps = std::numeric_limits<Index>::max();               ///< refinements of one set at one tau, in all
  double maximalSeconds = std::numeric_limits<double>::infinity();  ///< of wall time; the last complete round stays
};

enum class RefinementStop {
  Done,       ///< no set is left to refine
  Steps,      ///< maxSteps were used
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
  /// they are at the first smaller tau that finds them outside. Its strongly connected sets that can recur are sets().
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
  std::vector<Index> rowAfter(Index face, const std::vector<Index>& seen) const;

  std::shared_ptr<const FlatFaces> faces_;
  std::shared_ptr<const VectorField> field_;
  RefinementOptions options_;
  std::shared_ptr<const PreparedFlow> flow_;
  std::vector<int> poincare_;
  std::vector<char> resting_;
  std::vector<Index> order_;  ///< components of the geometry-based map: edges lead to the same or a lower one

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
