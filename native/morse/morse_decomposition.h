// Morse decompositions (thesis 2.4, 6.2; Conley 1978, Isolated Invariant Sets and the Morse Index): the strongly
// connected components of a combinatorial map F that can hold recurrence, each with its Conley index, and their partial
// order. Fixed points and periodic orbits lie in the Morse sets; outside them the flow is gradient-like.
//
// Combinatorial maps for this purpose: Chen, Mischaikow, Laramee, Zhang 2008, Efficient Morse Decompositions of Vector
// Fields. Components are found in linear time (Tarjan 1972).
//
//   Progress progress;
//   const MorseDecomposition morse = morseDecomposition(field, geometryMap(field), {}, progress);
//   morse.faces.members(0);  morse.sets[0].kind;  morse.graph.edges;
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "maps/combinatorial_map.h"
#include "morse/conley_index.h"
#include "morse/index_sets.h"
#include "morse/morse_connection_graph.h"

namespace stormfield {

/// Which recurrent components of F count as Morse sets.
struct KeptSets {
  /// Those that provably hold no recurrence (recurrence.h).
  bool empty = false;
  /// Those of trivial index. What recurs in them (pairs that cancel, say) need not be there in nearby fields, so that a
  /// simpler graph does without them (thesis 6.2); then Morse sets no longer hold all recurrence.
  bool trivial = true;
};

struct MorseOptions {
  /// Per face whether its row of F comes from a map of the flow (tau > 0) and not from the directions across its edges.
  /// Empty: no face. Sets with mapped faces get an upper bound of their index (conley_index.h).
  std::vector<char> mapped{};
  /// Per face whether it can hold a fixed point; none: fixedPointFaces(field).
  std::optional<std::vector<char>> fixedPointFaces{};
  KeptSets kept{};
};

struct MorseSet {
  ConleyIndex index;  ///< exact, or an upper bound
  MorseKind kind = MorseKind::Trivial;
  bool upperBound = false;  ///< whether the index is an upper bound, as with tau maps (thesis 8.2.3)
  /// Sum of the Poincare indices of its faces. An exact index has b0 - b1 + b2 = poincare - internalTangencies; at the
  /// boundary of the surface nothing is known of an upper bound.
  int poincare = 0;
  /// Boundary tangencies of the surface at which the flow touches from inside the set (exit_set.h).
  int internalTangencies = 0;
  /// Least error bound epsilon at which it merges with another set (persistence.h), mesh units per second; infinite
  /// where it never does, or none was asked for.
  double persistence = std::numeric_limits<double>::infinity();
};

/// Sets that may share faces: what each has of F, whose nodes are not the faces (transit_map.h).
struct SetsWithinFaces {
  NodeSets nodes;
  std::vector<std::vector<Index>> facesMet;  ///< per set all faces that it meets, ascending
};

struct MorseDecomposition {
  /// Numbered by their first faces. Of a face that several sets meet, one set has it (transit_refinement.h).
  FaceSets faces;
  std::vector<MorseSet> sets;                    ///< one for each of faces
  std::optional<SetsWithinFaces> withinFaces{};  ///< where the nodes of F are not the faces
  MorseConnectionGraph graph;
  std::size_t mapEdges = 0;  ///< edges of F

  /// All faces that a set meets, ascending.
  const std::vector<Index>& facesMet(Index set) const {
    return withinFaces ? withinFaces->facesMet[set] : faces.members(set);
  }
};

/// For a map whose nodes are the faces. The same for any number of threads. Throws Cancelled, and InputError when map
/// or options do not fit the mesh.
MorseDecomposition morseDecomposition(const VectorField& field, const CombinatorialMap& map,
                                      const MorseOptions& options, Progress& progress);

/// The recurrent components of F, numbered by their first faces; the Morse sets are those of them that can recur.
FaceSets recurrentSets(const CombinatorialMap& map, const Components& components);

/// Index and kind of one recurrent component of F. poincare: Poincare index of each face. mapped: as MorseOptions has
/// it.
MorseSet morseSet(const VectorField& field, const CombinatorialMap& map, const std::vector<int>& poincare,
                  const std::vector<char>& mapped, const FaceSets& faces, Index set);

}  // namespace stormfield
