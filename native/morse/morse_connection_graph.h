// The Morse connection graph (thesis 2.4.1, 6.2): the least edges between Morse sets that say which of them flow leads
// to, from a combinatorial map F. What lies between the sets is removed from the condensation of F, and edges that
// follow from others are left out.
//
//   const auto graph = morseConnectionGraph(map, components, sets);
//   graph.edges;                                     // {a, b}: flow leads from set a to set b
#pragma once

#include <array>
#include <vector>

#include "maps/combinatorial_map.h"
#include "morse/index_sets.h"

namespace stormfield {

struct MorseConnectionGraph {
  std::vector<std::array<Index, 2>> edges;  ///< ascending
  std::vector<char> outflow;                ///< per set whether flow leads from it over the surface's boundary
};

/// components: of map.graph. Each set is one of them.
MorseConnectionGraph morseConnectionGraph(const CombinatorialMap& map, const Components& components,
                                          const IndexSets& sets);

/// Faces, ascending, on a way from one set to another (thesis 6.4, dotted regions), without those of the two sets.
/// Empty when none leads there.
std::vector<Index> connectionRegion(const CombinatorialMap& map, const IndexSets& sets, Index from, Index to);

}  // namespace stormfield
