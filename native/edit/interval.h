// The interval of the entity connection graph between a repeller and an attractor: both, and the saddles that lie on
// the way from one to the other (thesis 4.3; Kalies and Ban 2006 for intervals of Morse decompositions).
//
// A pair is direct where flow leads from the one to the other without a saddle in between, and indirect through one or
// two saddles. The invariant set of an interval, its entities and the trajectories between them, is isolated, which is
// what makes it possible to change it alone.
//
//   const Interval between = findInterval(topology, mesh, {EntityKind::FixedPoint, 0}, {EntityKind::FixedPoint, 4});
#pragma once

#include <string>
#include <vector>

#include "topology/topology.h"

namespace stormfield {

/// Of nothing, unless filled.
struct Interval {
  EntityRef repeller, attractor;    ///< one of the two may be a saddle
  std::vector<Index> saddles;       ///< between the two, in Topology::fixedPoints, ascending
  std::vector<Index> separatrices;  ///< that connect entities of the interval, in Topology::separatrices
  bool holds(const EntityRef& entity) const;
};

/// Which of the two is the repeller follows from their kinds. Throws InputError, in a sentence for users, where the two
/// are no pair: the same entity, an index that is not there, a center or a degenerate entity, two entities of one role,
/// no way from one to the other, or more than two saddles in between (the nearest pair to cancel first is named).
Interval findInterval(const Topology& topology, const TriangleMesh& mesh, const EntityRef& a, const EntityRef& b);

}  // namespace stormfield
