// Hierarchical refinement of Morse decompositions by tau maps (thesis 8; Chen, Deng, Szymczak, Laramee, Zhang 2012,
// Morse Set Classification and Hierarchical Refinement Using Conley Index): the coarse sets of the geometry-based map
// that may hold more than one fixed point or orbit get rows of tau maps inside, with tau doubled from step to step.
//
// In each round the sets of highest priority (thesis 8.3) are refined. All faces of such a set get rows of one tau for
// what stays in the set, and keep the edges that lead out of it; the strongly connected components inside the set then
// replace it. They lie within the set, the other sets and the order between sets do not change (thesis 8.2.1), so that
// every round leaves a valid decomposition. A set is done when its priority is low, when its tau would exceed the
// limit, or when doubling no longer changes it. Sets are unions of faces: fixed points and orbits that share faces stay
// in one set at every tau (transit_refinement.h separates them).
//
// The result is that of a recomputation from taus(). Let G be the geometry-based map and S(0), S(1), ... the sets that
// a face f was in when it got its taus t(1), t(2), ..., t(k). R(i) has the rows of S(i-1) at t(i), of images that are
// followed only as far as they come back to the sets before (tauRowsWithinSet; then a larger tau, with fewer points
// that stay, costs little), and S(i) is a strongly connected component of R(i) restricted to S(i-1). The refinement's
// map has from f the edges
//     of R(1) to S(0) without S(1), and to what comes after S(0) in a total order of the components of G (edges against
//          that order come from padding, and no trajectory follows them),
//     of R(i) to S(i-1) without S(i), for 1 < i < k,
//     of R(k) to S(k-1),
// and its recurrent components that can recur are sets(). Both depend on the field, the options and taus() alone: not
// on the order of refinement, the other sets, limits or threads. Images that are followed everywhere give further
// edges, where what has left a set comes within the padding of it again: docs/algorithms/refinement.md says how often.
//
//   TauRefinement refinement(faces, field, {.tauMax = 0.5});
//   const RefinementStop stop = refinement.refine(&progress);
//   refinement.sets().members(0);  refinement.taus();
//   const CombinatorialMap map = refinement.map();
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "maps/prepared_flow.h"
#include "maps/set_windows.h"
#include "maps/tau_map.h"
#include "morse/morse_decomposition.h"
#include "morse/refinement_stop.h"

namespace stormfield {

struct TauRefinementOptions {
  TauMapOptions map = {};  ///< unit and accuracy of the tau maps
  /// Tau of a set's first step and largest tau; none: the time (or length) to cross so many edges at the mean speed
  /// within the set.
  std::optional<double> tauMin{}, tauMax{};
  double edgesMin = 4.0, edgesMax = 256.0;
  double minPriority = 2.0;  ///< only sets of higher priority are refined (r of thesis 8.3)
  int patience = 3;          ///< doublings in a row that leave a set unchanged, after which it is done
  Index maxSteps = std::numeric_limits<Index>::max();           ///< steps, each of one set at one tau
  double maxSeconds = std::numeric_limits<double>::infinity();  ///< of wall time; the last complete round stays
};

/// A decomposition that can be refined; copies are independent.
class TauRefinement {
 public:
  /// The coarse start. faces: of the field's mesh. Throws InputError for tauMin or tauMax that are not positive
  /// numbers.
  TauRefinement(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
                const TauRefinementOptions& options = {});

  /// Refines until a limit is met (options.map.memoryLimit holds for the rows of each set) or nothing is left to
  /// refine. Cancellation is no error: the complete rounds stay.
  RefinementStop refine(Progress* progress = nullptr);
  /// One round of refine; false when nothing is left to refine. Throws Cancelled, and then nothing has changed.
  bool round(Progress* progress = nullptr);
  /// Refines one set, of any priority, until it changes or tauMax is met; whether it changed. Throws InputError for a
  /// set that does not exist, and Cancelled, and then nothing has changed.
  bool refineSet(Index set, Progress* progress = nullptr);

  /// The sets that can recur, numbered by their first faces.
  const FaceSets& sets() const { return sets_; }
  /// Index and kind of each set.
  const std::vector<MorseSet>& indices() const { return indices_; }
  /// The tau of every face's row; 0 where it is the geometry-based one.
  const std::vector<double>& taus() const { return taus_; }
  /// F: from every face to the faces that its points are in at its tau, or, where they have left a set that the face
  /// was in, at the first smaller tau at which they are outside. Its recurrent components that can recur are sets().
  CombinatorialMap map() const;
  const std::shared_ptr<const VectorField>& field() const { return field_; }
  const TauRefinementOptions& options() const { return options_; }
  /// Steps so far, each of one set at one tau, and the traces they took.
  Index steps() const { return steps_; }
  std::size_t traces() const { return work_.traces; }

 private:
  /// A set that a step has found, with the tau of that step.
  struct Ancestor {
    double tau;
    SharedFaces faces;
  };
  struct SetState {
    double tau = 0.0;    ///< of the last step, 0 before the first
    double scale = 0.0;  ///< tau to cross one edge
    int unchanged = 0;   ///< steps in a row without change
    bool done = false;
    std::vector<Ancestor> ancestors;  ///< by growing tau; the last one is the set itself
  };

  double edgeTau(const std::vector<Index>& faces) const;
  double nextTau(const SetState& state) const;
  double lastTau(const SetState& state) const;
  bool canBeRefined(Index set) const;
  double priority(Index set) const;
  std::vector<Index> chooseSets() const;
  std::vector<char> refineAll(const std::vector<Index>& chosen, Progress* progress);
  std::vector<char> replaceByComponents(const std::vector<Index>& chosen,
                                        const std::vector<std::vector<Index>>& newRows);
  double fractionDone() const;
  SetWindows windowsOf(Index set) const;
  std::vector<Index> mergedRow(Index face, const std::vector<Index>& newRow) const;

  std::shared_ptr<const FlatFaces> faces_;
  std::shared_ptr<const VectorField> field_;
  TauRefinementOptions options_;
  std::shared_ptr<const PreparedFlow> flow_;
  std::vector<int> poincare_;
  std::vector<char> fixedPointFaces_;
  std::vector<Index> order_;  ///< components of the geometry-based map: edges lead to the same or a lower one

  std::vector<std::vector<Index>> rows_;  ///< of F, per face
  std::vector<double> taus_;
  FaceSets sets_;
  std::vector<MorseSet> indices_;
  std::vector<SetState> states_;  ///< per set
  Index steps_ = 0;
  TauWork work_;
};

/// Priority of thesis equation 8.1: (1 + the distance of the index from those of fixed points and periodic orbits)
/// times the number of faces.
double refinementPriority(const ConleyIndex& index, std::size_t faceCount);

}  // namespace stormfield
