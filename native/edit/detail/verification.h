// Whether an edit did what it was to do, seen by the topology of the field before and after it: what is left inside its
// block, and that the graph outside is the same.
//
// The vectors outside the block are bit-identical, so that fixed points outside are found again with equal bits.
// Separatrices and links of the entities outside keep their ends, unless they ended in the interval: these go on to where
// the flow through the interval leads, as if the interval were one node of the graph.
//
//   const Verification found = verify(mesh, before, after, interval, wanted);
//   const bool verified = found.fault.empty();
#pragma once

#include <string>
#include <vector>

#include "edit/contents.h"
#include "edit/interval.h"
#include "topology/topology.h"

namespace stormfield {

/// The same entity before and after.
struct EntityMatch {
  std::vector<Index> fixedPoints, periodicOrbits;  ///< per entity before its number after, or kNone
  std::vector<EntityRef> unmatched;                ///< after, ascending
};

/// Fixed points by place and kind, orbits by kind and the faces that they cross; none for those that may change.
EntityMatch matchEntities(const TriangleMesh& mesh, const Topology& before, const Topology& after,
                          const Interval& changed);

struct Verification {
  std::string fault;            ///< empty: verified; else what is wrong, with the entity
  std::vector<EntityRef> left;  ///< entities of the field after the edit that were not there before
};

/// changed: the entities that the edit may change, and the flow through which may go elsewhere.
Verification verify(const TriangleMesh& mesh, const Topology& before, const Topology& after, const Interval& changed,
                    const Contents& wanted);

/// Whether one fixed point is elsewhere and all else as before: the same graph.
Verification verifyMoved(const TriangleMesh& mesh, const Topology& before, const Topology& after, Index moved);

}  // namespace stormfield
