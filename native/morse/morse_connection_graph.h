// The Morse connection graph (thesis 2.4.1, 6.2): the partial order of the Morse sets, by the fewest edges. F leads
// from one set to another where its condensation has a path; nodes between the sets are left out, and so are edges that
// follow from others (transitive reduction: Aho, Garey, Ullman 1972).
//
//   const Components components = stronglyConnectedComponents(map.graph);
//   const MorseConnectionGraph graph = morseConnectionGraph(map, components, recurrentSets(map, components));
//   graph.edges;                                     // {a, b}: flow leads from set a to set b
#pragma once

#include <array>
#include <vector>

#include "maps/combinatorial_map.h"
#include "morse/index_sets.h"

namespace stormfield {

struct MorseConnectionGraph {
  std::vector<std::array<Index, 2>> edges;  ///< ascending
  std::vector<char> outflow;                ///< per set whether flow leads from it over the boundary of the surface
};

/// components: of map.graph. sets: of the map's nodes, each of them one component.
MorseConnectionGraph morseConnectionGraph(const CombinatorialMap& map, const Components& components,
                                          const IndexSets& sets);

/// The nodes, ascending, on connections from one set to another (paths in F; thesis 6.4, dotted regions), without those
/// of the two sets. Empty where F does not lead there.
std::vector<Index> connectionRegion(const CombinatorialMap& map, const IndexSets& sets, Index from, Index to);

}  // namespace stormfield
