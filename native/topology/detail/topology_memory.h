// What an analysis of a field learnt that holds for another field with the same vectors on most faces: its periodic
// orbits, and where its streamlines went. What does not cross a face that has changed is as it was.
//
//   const Recollection known(topologyBefore, before, now, fixedPointsNow);
//   if (const std::optional<RememberedStreamline> same = known.find(seed)) use(same->end);
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "topology/detail/streamline_search.h"
#include "topology/topology.h"

namespace stormfield {

struct RememberedOrbit {
  FoundOrbit found;
  std::vector<Index> faces;  ///< of the orbit, and of the streamlines beside it that showed what its sides do
};

/// One that ended in a node of the graph, or at the boundary.
struct RememberedStreamline {
  StreamlineSeed seed;
  StreamlineEnd end;
  std::shared_ptr<const StreamlineCourse> course;
};

/// Orbits are numbered as in Topology::periodicOrbits.
struct TopologyMemory {
  std::vector<RememberedOrbit> orbits;
  std::vector<RememberedStreamline> streamlines;
};

/// All are kept by reference.
class Recollection {
 public:
  Recollection(const Topology& topologyBefore, const VectorField& before, const VectorField& now,
               const std::vector<FixedPoint>& pointsNow);

  /// Numbers before of the orbits that are there still. Bands of closed streamlines are searched again.
  const std::vector<Index>& orbits() const { return orbits_; }
  const RememberedOrbit& orbit(Index before) const { return memory_.orbits[before]; }
  /// Where an orbit stands in the new analysis.
  void numberOrbit(Index before, Index now) { orbitNow_[before] = now; }

  /// The streamline from this seed with its end in the new analysis; none where it may have changed.
  std::optional<RememberedStreamline> find(const StreamlineSeed& seed) const;

 private:
  bool isUnchanged(const std::vector<Index>& faces) const;

  const TopologyMemory& memory_;
  std::vector<char> changed_;                                      ///< per face
  std::vector<Index> pointNow_;                                    ///< per fixed point before, kNone where it is gone
  std::vector<Index> orbits_, orbitNow_;                           ///< per orbit before its number now, kNone
  std::unordered_map<Index, std::vector<Index>> streamlinesFrom_;  ///< by the seed's face
};

}  // namespace stormfield
