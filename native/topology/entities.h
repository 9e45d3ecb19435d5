// The entities of a field's topology and the edges between them: the nodes and edges of the entity connection graph
// (thesis 2.2, 3.2; Chen et al. 2007, "Vector field editing and periodic orbit extraction using Morse decomposition").
//
// Plain data without any search, so that every step of the search can share it. Directions of the flow are those of the
// given field; a face's flat frame is that of mesh/vertex_charts.h.
#pragma once

#include <array>
#include <vector>

#include "base/words.h"
#include "mesh/surface_point.h"

namespace stormfield {

enum class FixedPointKind { Source, Sink, Saddle, Center, Degenerate };
template <>
inline constexpr Words kWords<FixedPointKind>{"kind of fixed point",
                                              {"source", "sink", "saddle", "center", "degenerate"}};

/// Where a trajectory leaves or enters a fixed point between two hyperbolic sectors. At an ordinary saddle these are
/// the two directions of each eigenvector.
struct SeparatrixDirection {
  Index face = kNone;  ///< into which it leads
  Complex direction;   ///< unit vector in the flat frame of that face
  Vec3 inSpace = Vec3::Zero();
  bool outgoing = true;
};

struct FixedPoint {
  SurfacePoint point;
  Vec3 position = Vec3::Zero();
  int index = 0;  ///< Poincare index
  FixedPointKind kind = FixedPointKind::Degenerate;
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();  ///< in the face's flat frame, 1/s
  double rotation = 0.0;  ///< curl at the point, 1/s: > 0 is counter-clockwise seen from outside
  /// Of the Jacobian, 1/s: by falling real part, or a conjugate pair with the positive imaginary part first.
  std::array<Complex, 2> eigenvalues{};
  /// Unit vectors in space, zero where the eigenvalues are not real.
  std::array<Vec3, 2> eigenvectors{Vec3::Zero(), Vec3::Zero()};
  /// Of points with a negative index, counter-clockwise; alternately outgoing and incoming.
  std::vector<SeparatrixDirection> separatrices = {};
};

enum class OrbitKind {
  Attracting,
  Repelling,
  Center,      ///< one of a whole band of closed streamlines
  Degenerate,  ///< attracting on one side and repelling on the other
};
template <>
inline constexpr Words kWords<OrbitKind>{"kind of periodic orbit", {"attracting", "repelling", "center", "degenerate"}};

/// A closed streamline (thesis 2.2.1, 3.1).
struct PeriodicOrbit {
  OrbitKind kind = OrbitKind::Degenerate;
  /// Along the flow, one per edge crossing and integration step, the first repeated at the end.
  std::vector<SurfacePoint> points;
  std::vector<double> times;  ///< per point, seconds from the first
  double length = 0.0;        ///< mesh units
  double period = 0.0;        ///< seconds
  double multiplier = 1.0;    ///< derivative of the return map: < 1 attracting, > 1 repelling
};

/// What a curve or an edge of the graph leads to.
enum class EntityKind {
  None,  ///< nothing known: the streamline stops in a region of zeros, or its step limit is reached
  FixedPoint,
  PeriodicOrbit,
  /// The flow leaves the surface there. No node of the graph: the thesis defines it for closed surfaces, and a
  /// trajectory that leaves has no limit set. Separatrices say that they end there.
  Boundary,
};
template <>
inline constexpr Words kWords<EntityKind>{"kind of entity", {"none", "fixed_point", "periodic_orbit", "boundary"}};

struct EntityRef {
  EntityKind kind = EntityKind::None;
  Index index = kNone;  ///< in Topology::fixedPoints or ::periodicOrbits

  friend bool operator==(const EntityRef&, const EntityRef&) = default;
  friend auto operator<=>(const EntityRef&, const EntityRef&) = default;
};

/// From the saddle to its end: with the flow where it is outgoing, against it otherwise.
struct Separatrix {
  Index saddle = kNone;  ///< in Topology::fixedPoints
  bool outgoing = true;
  EntityRef end;
  std::vector<SurfacePoint> points;  ///< one per edge crossing and integration step, the first on the saddle
  std::vector<double> times;         ///< per point, seconds from the second point, positive
  double length = 0.0;               ///< mesh units
};

/// One edge of the graph: flow leads from source to target, along these separatrices or, without any, through a whole
/// basin between the two.
struct EntityLink {
  EntityRef source, target;
  std::vector<Index> separatrices;
};

}  // namespace stormfield
