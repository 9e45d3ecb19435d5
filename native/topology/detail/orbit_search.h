// From a streamline that returns to an edge to a periodic orbit: the fixed point of the return map, what the flow does
// on the orbit's two sides, and the orbit as a curve (thesis 3.1; Wischgoll and Scheuermann 2001 for the returning
// streamline; Chen et al. 2007 for orbits on surfaces).
//
//   const OrbitSearch orbits(faces, field, componentOf, {});
//   const OrbitSearch::Outcome outcome = orbits.findFrom(candidate, [](const FoundOrbit&) { return false; });
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "topology/detail/return_map.h"
#include "topology/entities.h"

namespace stormfield {

/// Seen in the direction of the flow.
enum class OrbitSide { Left, Right };
inline constexpr std::array<OrbitSide, 2> kOrbitSides{OrbitSide::Left, OrbitSide::Right};

/// One value for each side of an orbit.
template <typename T>
struct BothSides {
  T left{}, right{};

  T& operator[](OrbitSide side) { return side == OrbitSide::Left ? left : right; }
  const T& operator[](OrbitSide side) const { return side == OrbitSide::Left ? left : right; }
};

/// What streamlines next to an orbit do, in the direction of the flow.
enum class SideFlow { Unknown, Attracted, Repelled, Closed };

/// Where an orbit crosses a section. Between low and high its sides are known to do what FoundOrbit::sides says. Lower
/// positions are on the left of the orbit, higher ones on its right (the flow crosses sections from right to left).
struct OrbitSection {
  Section section;
  double position = 0.0;
  double low = 0.0, high = 0.0;
};

struct FoundOrbit {
  PeriodicOrbit orbit;
  BothSides<SideFlow> sides{SideFlow::Unknown, SideFlow::Unknown};
  OrbitSection bestSection;   ///< the section that it crosses farthest from any end, with both sides
  OrbitSection foundSection;  ///< the section where it was found, with the side that was searched
  OrbitSide foundSide = OrbitSide::Left;
  bool inBand = false;  ///< half an edge away on both sides streamlines close as well
  int loops = 1;
  Index crossings = 0;  ///< of edges, once around
  std::vector<EdgePassage> passages;
  bool known = false;  ///< then its sides and best section were not examined again
};

/// A streamline that returned to an edge.
struct OrbitCandidate {
  Index halfedge = kNone;
  double fraction = 0.0;
  int loops = 1;
  Index crossings = 0;  ///< of edges, once around
  Direction direction = Direction::Forward;
  Index component = kNone;  ///< recurrent component
};

struct OrbitSearchOptions {
  double tolerance = 1e-9;      ///< of one step of the streamlines, in mean edge lengths
  double bandTolerance = 3e-3;  ///< as in TopologyOptions
};

class OrbitSearch {
 public:
  /// componentOf: the recurrent component of each face, or kNone. All are kept by reference.
  OrbitSearch(const FlatFaces& faces, const VectorField& field, const std::vector<Index>& componentOf,
              const OrbitSearchOptions& options);

  struct Outcome {
    std::optional<FoundOrbit> orbit;
    /// Without an orbit: a later point of the streamline, if it moves so slowly across the section (less than 1/50 of
    /// an edge per loop) that the loops in between cannot hide anything.
    std::optional<SurfacePoint> restart;
  };
  /// The orbit that the streamline approaches, if that orbit crosses the candidate's edge or the edges in a row with
  /// it. isKnown(FoundOrbit with its passages): then its sides are not examined.
  Outcome findFrom(const OrbitCandidate& candidate, const std::function<bool(const FoundOrbit&)>& isKnown) const;

  /// The faces of the streamlines, once around, from both ends of a section that an orbit crosses, and those beside the
  /// section: what is known of the flow between there and the orbit rests on these and the orbit's own.
  std::vector<Index> facesBeside(const FoundOrbit& found, const OrbitSection& section, Index component) const;

  /// The faces of the streamline through a point of an edge, if it closes within tolerance (mean edge lengths).
  std::optional<std::vector<Index>> facesIfClosed(Index halfedge, double fraction, Index component, Index crossings,
                                                  double tolerance) const;

 private:
  /// A position on a section and how far its streamline returns from there.
  struct Sample {
    double position, displacement;
  };
  struct Approach {
    std::optional<double> orbit;   ///< its position
    double reached = 0.0;          ///< else, how far streamlines move slowly
    double maxDisplacement = 0.0;  ///< on the way there
    bool inBand = false;
  };
  struct SideProbe {
    SideFlow flow = SideFlow::Unknown;
    double reach = 0.0;            ///< how far from the orbit the flow was seen
    bool closed = false;           ///< as good as closed half an edge away
    std::optional<double> growth;  ///< of the distance from the orbit, per return, close to it
  };

  ReturnMap returnMap(Direction direction, const Section& section, int loops, Index component, Index crossings) const;
  static std::optional<double> displacement(ReturnMap& returns, double position);
  // The search along the section.
  Approach approach(ReturnMap& returns, double start) const;
  bool neighboursClose(ReturnMap& returns, double position) const;
  /// Displacement up to which a streamline closes as one of a band does.
  double bandDrift() const;
  double secantStep(const Sample& before, const Sample& last) const;
  Approach firstSignChange(ReturnMap& returns, double start, Approach approach) const;
  std::optional<double> falsePosition(ReturnMap& returns, Sample a, Sample b) const;
  // The orbit as a curve.
  int fewestLoops(ReturnMap& returns, double position) const;
  bool record(ReturnMap& returns, double position, FoundOrbit& found) const;
  double multiplier(const PeriodicOrbit& orbit) const;
  // Its sides.
  OrbitSection widestSection(const std::vector<EdgePassage>& passages) const;
  void examineSides(const OrbitCandidate& candidate, FoundOrbit& found) const;
  SideProbe probe(ReturnMap& forward, ReturnMap& backward, double position, double sign) const;
  static void classify(const BothSides<SideProbe>& probes, Direction direction, FoundOrbit& found);

  const FlatFaces& faces_;
  const VectorField& field_;
  const std::vector<Index>& componentOf_;
  OrbitSearchOptions options_;
  double edge_;  ///< mean edge length
  CrossingTrace forward_, backward_;
};

}  // namespace stormfield
