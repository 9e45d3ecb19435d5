// Morse decompositions (thesis 2.4, 6.2): the strongly connected sets of a combinatorial map F that can hold
// recurrence, each with its Conley index, and their order. Whatever recurs (fixed points, periodic orbits) lies in the
// Morse sets; outside them the flow only passes.
//
//   const MorseDecomposition morse = morseDecomposition(field, map, options, progress);
//   const MorseDecomposition coarse = morseDecomposition(field, geometryMap(field), {}, progress);
//   morse.sets[0].kind;  morse.graph.edges;
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "maps/combinatorial_map.h"
#include "morse/conley_index.h"
#include "morse/index_sets.h"
#include "morse/morse_connection_graph.h"

namespace stormfield {

struct MorseOptions {
  /// Per face whether its row of F comes from a map (tau > 0) and not from the directions across its edges. Empty:
  /// none. Sets with mapped faces get an upper bound of their index (conley_index.h).
  std::vector<char> mapped;
  /// Per face whether it can hold a fixed point. Empty: fixedPointFaces(field).
  std::vector<char> resting;
  /// Whether to keep sets that provably hold nothing (recurrence.h).
  bool keepEmpty = false;
  /// Whether to keep sets of trivial index. What recurs in them (pairs that cancel, say) needs not be there in nearby
  /// fields, so that a simpler graph does without them (thesis 6.2); then Morse sets no longer hold all recurrence.
  bool keepTrivial = true;
};

struct MorseSet {
  ConleyIndex index;  ///< exact, or an upper bound
  MorseKind kind = MorseKind::Trivial;
  bool upperBound = false;  ///< whether the index is an upper bound, as with tau maps (thesis 8.2.3)
  /// Sum of the Poincare indices of its faces: b0 - b1 + b2, except at the boundary of the surface, where it is that
  /// less grazings for an exact index, and nothing is known for an upper bound.
  int poincare = 0;
  int grazings = 0;  ///< exit_set.h; 0 except at the boundary of the surface
  /// Least epsilon at which it merges with another set (persistence.h), mesh units per second; infinite where it never
  /// does or none was asked for.
  double persistence = std::numeric_limits<double>::infinity();
};

struct MorseDecomposition {
  FaceSets faces;              ///< numbered by their first faces
  std::vector<MorseSet> sets;  ///< one for each of faces
  /// All faces that each set meets, where sets may be parted inside faces (transit_refinement.h); else empty.
  std::vector<std::vector<Index>> covers;
  MorseConnectionGraph graph;
  std::size_t mapEdges = 0;  ///< edges of F
};

/// The same for any number of threads. Throws Cancelled, and InputError when map or options do not fit the mesh.
MorseDecomposition morseDecomposition(const VectorField& field, const CombinatorialMap& map,
                                      const MorseOptions& options, Progress& progress);

/// The strongly connected sets alone, of which the Morse sets are those that can recur.
FaceSets recurrentSets(const CombinatorialMap& map, const Components& components);

/// Index and kind of one set; poincare: index of each face. Sets may be any strongly connected ones of the map.
MorseSet morseSet(const VectorField& field, const CombinatorialMap& map, const std::vector<int>& poincare,
                  const std::vector<char>& mapped, const FaceSets& faces, Index set);

}  // namespace stormfield
