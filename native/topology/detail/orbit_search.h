// From a streamline that came back to an edge to a periodic orbit: the fixed point of the return map (thesis 3.1), what
// the flow does on its two sides, and the orbit as a curve.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "topology/detail/return_map.h"
#include "topology/periodic_orbit.h"

namespace stormfield {

/// What streamlines beside an orbit do, in the direction of the flow.
enum class SideFlow { Unknown, Attracted, Repelled, Closed };

/// Where an orbit crosses a section, and how far what is known of its sides holds there. Lower positions are on the
/// left of the orbit, higher ones on its right (the flow crosses sections from right to left).
struct OrbitSection {
  Section section;
  double position = 0.0;
  double low = 0.0, high = 0.0;
};

struct FoundOrbit {
  PeriodicOrbit orbit;
  std::array<SideFlow, 2> sides{SideFlow::Unknown, SideFlow::Unknown};  ///< left, right
  OrbitSection best;          ///< the section that it crosses farthest from any end, with both sides
  OrbitSection found;         ///< the section where it was found, with the side that was searched
  int side = 0;               ///< that side: 0 left, 1 right
  bool closedAround = false;  ///< half an edge away on both sides streamlines close as well
  int loops = 1;
  Index crossings = 0;  ///< of edges, once around
  std::vector<EdgePassage> passages;
  bool known = false;  ///< then its sides and best section were not looked at again
};

/// A streamline that came back.
struct Candidate {
  Index halfedge = kNone;
  double fraction = 0.0;
  int loops = 1;
  Index crossings = 0;  ///< of edges, on the way around
  Direction direction = Direction::Forward;
  Index part = kNone;
};

struct OrbitSearchOptions {
  double tolerance = 1e-9;      ///< of the streamlines, in mean edge lengths
  double bandTolerance = 3e-3;  ///< as in TopologyOptions
};

class OrbitSearch {
 public:
  /// partOf: the strongly connected part of each face, or kNone. All are kept by reference.
  OrbitSearch(const FlatFaces& faces, const VectorField& field, const std::vector<Index>& partOf,
              const OrbitSearchOptions& options);

  struct Outcome {
    std::optional<FoundOrbit> orbit;
    /// Without one: where the streamline comes to on its way past the section, if it winds so slowly (less than 1/50 of
    /// an edge per turn) that the windings in between say nothing.
    std::optional<SurfacePoint> onward;
  };
  /// The orbit that the streamline comes to, if it crosses the candidate's edge or the edges in a row with it.
  /// isKnown(FoundOrbit with its passages) says whether more about it is needed.
  Outcome follow(const Candidate& candidate, const std::function<bool(const FoundOrbit&)>& isKnown) const;
  /// Whether the streamline through a point of an edge closes but for this part of the mean edge length.
  bool closes(Index halfedge, double fraction, Index part, Index crossings, double tolerance,
              std::vector<Index>* crossedFaces) const;

 private:
  struct Side {
    SideFlow flow = SideFlow::Unknown;
    double reach = 0.0;            ///< how far from the orbit it was seen
    bool closed = false;           ///< as good as closed half an edge away
    std::optional<double> growth;  ///< of the distance from the orbit, per loop, close to it
  };

  ReturnMap map(Direction direction, const Section& section, int loops, Index part, Index crossings) const;
  struct March {
    std::optional<double> fixed;  ///< position of the orbit
    double reached = 0.0;         ///< else, how far streamlines wind slowly
    double largest = 0.0;         ///< the largest displacement on the way there
    bool closedAround = false;
  };
  March march(ReturnMap& map, double start) const;
  March checked(ReturnMap& map, double start, March way) const;
  std::optional<double> solve(ReturnMap& map, double a, double atA, double b, double atB) const;
  Side look(ReturnMap& forward, ReturnMap& backward, double position, double sign) const;
  void lookAround(const Candidate& candidate, FoundOrbit& found) const;
  int fewestLoops(ReturnMap& map, double position) const;
  bool record(ReturnMap& map, double position, FoundOrbit& found) const;
  OrbitSection bestSection(const std::vector<EdgePassage>& passages) const;
  double multiplier(const PeriodicOrbit& orbit) const;

  const FlatFaces& faces_;
  const VectorField& field_;
  const std::vector<Index>& partOf_;
  OrbitSearchOptions options_;
  double edge_;  ///< mean edge length
  FlowWalk forward_, backward_;
};

}  // namespace stormfield
