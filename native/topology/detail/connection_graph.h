// The links of the entity connection graph (thesis 3.2), from the ends of the streamlines that were followed.
#pragma once

#include <array>
#include <vector>

#include "topology/detail/streamline_search.h"

namespace stormfield {

/// Which journey was what. All numbers of journeys are places in journeyEnds.
struct ConnectionEvidence {
  struct SeparatrixJourney {
    Index saddle;
    bool outgoing;
    std::size_t journey;
  };
  struct NodeJourney {
    Index node;
    bool onward;  ///< the journey goes with the flow
    std::size_t journey;
  };
  struct SideJourney {
    Index orbit;
    int side;
    bool onward;  ///< the journey goes with the flow
    std::size_t journey;
  };
  /// Beyond the border of a band of closed streamlines: with the flow and against it.
  struct BandJourney {
    Index orbit;
    int side;
    std::size_t onward, back;
  };
  /// From where the flow touches the boundary from inside.
  struct TangencyJourney {
    std::size_t onward, back;
  };

  std::vector<Destinations::Arrival> journeyEnds;
  std::vector<SeparatrixJourney> separatrices;
  std::vector<NodeJourney> nodes;
  std::vector<SideJourney> sides;
  std::vector<BandJourney> bandSides;
  std::vector<TangencyJourney> tangencies;

  void renumberOrbits(const std::vector<Index>& place);
};

/// Separatrices link saddles with nodes and orbits. A node, or a side of an orbit, that no separatrix comes to has one
/// basin: the streamline from there gives its one link. A streamline that touches the boundary from inside links what
/// it comes from with what it goes to. One link for each pair.
std::vector<EntityLink> connectionGraph(const Topology& topology, const ConnectionEvidence& evidence);

}  // namespace stormfield
