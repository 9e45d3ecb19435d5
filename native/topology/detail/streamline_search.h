// One streamline of the search for a field's topology: followed until it has come to an end, or until it comes back to
// an edge often enough to point at a periodic orbit.
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "base/progress.h"
#include "topology/detail/orbit_search.h"
#include "topology/detail/recurrent_parts.h"
#include "topology/detail/trapping_region.h"
#include "topology/topology.h"

namespace stormfield {

/// What journeys end at. Grows between rounds and is only read while journeys run.
class Destinations {
 public:
  Destinations(const TriangleMesh& mesh, const std::vector<FixedPoint>& points, const std::vector<NodeBasin>& basins);

  struct Arrival {
    EntityRef entity;
    int side = 0;  ///< of an orbit: 0 left, 1 right
  };
  /// The node in whose basin a point lies, for a streamline that goes this way.
  EntityRef nodeAt(const FlatFaces& faces, const SurfacePoint& p, Direction direction) const;
  /// The orbit that a streamline will come to from where it goes over this edge or vertex.
  std::optional<Arrival> orbitBeyond(const EdgePassage& passage, Direction direction) const;
  /// The orbit of which this passage is part, up to a distance (mesh units).
  Index orbitAt(const EdgePassage& passage, double distance) const;
  /// The node that a streamline inside this face circles for good.
  EntityRef circledIn(Index face) const;
  /// The saddle or other fixed point next to where a streamline has come to rest.
  EntityRef restingAt(const TriangleMesh& mesh, const SurfacePoint& p) const;
  /// Whether the surface has genus 1 or more.
  bool hasHandles() const { return hasHandles_; }
  Index bandAt(Index face) const {
    const auto found = bands_.find(face);
    return found == bands_.end() ? kNone : found->second;
  }

  void addOrbit(const FoundOrbit& found);
  void addSection(Index orbit, const OrbitSection& section);
  void addBandFace(Index face, Index orbit) { bands_.try_emplace(face, orbit); }
  Index orbitCount() const { return static_cast<Index>(sides_.size()); }
  SideFlow side(Index orbit, int side) const { return sides_[orbit][side]; }

 private:
  struct KnownSection {
    Index orbit;
    OrbitSection section;
  };

  const TriangleMesh& mesh_;
  const std::vector<FixedPoint>& points_;
  const std::vector<NodeBasin>& basins_;
  std::unordered_map<Index, std::vector<std::pair<Index, int>>> partsIn_;  ///< node and part of its basin, by face
  std::vector<char> hasPart_, hasSection_;                                 ///< by face, by edge
  std::vector<std::array<SideFlow, 2>> sides_;
  std::vector<KnownSection> sections_;
  std::unordered_map<Index, std::vector<Index>> sectionsOn_, sectionsAt_;  ///< by halfedge, by vertex
  std::unordered_map<Index, Index> bands_;
  bool hasHandles_ = false;
};

class Journey {
 public:
  SurfacePoint at;  ///< where it stands
  Direction direction = Direction::Forward;
  bool keepsPoints = false;
  Index within = kNone;  ///< it ends where it leaves this part
  // What came of it:
  enum class State { Going, CameBack, Ended } state = State::Going;
  Destinations::Arrival end;
  Candidate candidate;  ///< where it CameBack
  std::vector<SurfacePoint> points;
  std::vector<double> times;
  double length = 0.0;

  /// On from where it stands. walk must go its direction.
  void travel(FlowWalk walk, const Destinations& destinations, const std::vector<Index>& partOf,
              const TopologyOptions& options, const Progress* progress);
  /// The candidate led nowhere: come back only after twice as many returns.
  void doubt() { returnsWanted_ *= 2; }
  /// On from another point of the same slow spiral.
  void skipTo(const SurfacePoint& p) {
    at = p;
    visits_.clear();
    returnsWanted_ = 2;
  }
  /// Someone else's candidate is looked at first.
  void wait() { ++returnsWanted_; }
  void arrive(const Destinations::Arrival& arrival) {
    end = arrival;
    state = State::Ended;
  }

 private:
  /// The last crossings of one edge.
  struct Visits {
    static constexpr int kKept = 8;
    Index count = 0;
    double time = -1.0;  ///< of the last one, since the start
    std::array<double, kKept> fractions{};
    std::array<Index, kKept> numbers{};  ///< of the crossing, since the start
  };
  bool cameBack(const Destinations& destinations, const EdgePassage& passage, double time, Index part);

  std::unordered_map<Index, Visits> visits_;
  Index part_ = kNone, crossings_ = 0, steps_ = 0, returnsWanted_ = 2;
  double time_ = 0.0;
};

}  // namespace stormfield
