// The edges of the entity connection graph (thesis 3.2; Chen et al. 2007), from the ends of the streamlines that were
// traced.
#pragma once

#include <cstddef>
#include <vector>

#include "topology/detail/known_limit_sets.h"

namespace stormfield {

/// Which streamline was traced for what. A streamline's number is its place in ends.
struct ConnectionEvidence {
  struct OfSeparatrix {
    Index saddle;
    bool outgoing;
    std::size_t streamline;
  };
  /// From a source or with a sink's flow reversed; around a center.
  struct OfFixedPoint {
    Index fixedPoint;
    Direction direction;
    std::size_t streamline;
  };
  struct OfOrbitSide {
    Index orbit;
    OrbitSide side;
    Direction direction;
    std::size_t streamline;
  };
  /// From just beyond the end of a band of closed streamlines.
  struct OfBandEnd {
    Index orbit;
    std::size_t forward, backward;
  };
  /// From where the flow touches the boundary from inside.
  struct OfTangency {
    std::size_t forward, backward;
  };

  std::vector<StreamlineEnd> ends;
  std::vector<OfSeparatrix> separatrices;
  std::vector<OfFixedPoint> fixedPoints;
  std::vector<OfOrbitSide> orbitSides;
  std::vector<OfBandEnd> bandEnds;
  std::vector<OfTangency> tangencies;

  /// numbers: the new number of each orbit.
  void renumberOrbits(const std::vector<Index>& numbers);
};

/// Separatrices link saddles with nodes and orbits. A source or sink, or a side of an orbit, that no separatrix reaches
/// has one basin: the streamline from there gives its one link. A streamline that touches the boundary from inside
/// links what it comes from with what it goes to. One link for each pair, ascending.
std::vector<EntityLink> entityLinks(const std::vector<FixedPoint>& fixedPoints,
                                    const std::vector<PeriodicOrbit>& orbits, const ConnectionEvidence& evidence);

}  // namespace stormfield
