// The instantaneous topology of a field: fixed points, boundary points, periodic orbits, separatrices and the entity
// connection graph that they make (thesis 2.2, 3.1, 3.2).
//
//   const FlatFaces faces(field.charts);
//   const Topology topology = findTopology(faces, field);
//
// Rounds of tracing find everything: separatrices from the saddles, one streamline from each node and from both sides
// of each periodic orbit, from the points where the flow touches the boundary, and from the border of each strongly
// connected part of the geometry-based map (a periodic orbit cannot leave such a part). A streamline that returns to an
// edge inside its part points at a periodic orbit, which a converged return map confirms; streamlines from its two
// sides search what is left of the part beyond it. It ends when every streamline has come to an end.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "topology/boundary_points.h"
#include "topology/fixed_points.h"
#include "topology/periodic_orbit.h"
#include "tracing/flat_faces.h"

namespace stormfield {

/// What a curve or a link of the graph leads to.
enum class EntityKind {
  None,  ///< nowhere known: into a region of rest, or the work allowed was used up
  FixedPoint,
  PeriodicOrbit,
  /// The flow leaves the surface there. No node of the graph: the thesis defines it for closed surfaces, and what
  /// leaves has no limit. Separatrices say that they end there.
  Boundary,
};
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

/// Where the field vanishes altogether, which is no fixed point but a region (or line) of rest.
struct ZeroRegions {
  Index faces = 0;     ///< faces with three zero vectors
  Index vertices = 0;  ///< vertices with a zero vector
};

struct Topology {
  std::vector<FixedPoint> fixedPoints;        ///< in face order
  std::vector<BoundaryPoint> boundaryPoints;  ///< loop by loop
  std::vector<PeriodicOrbit> periodicOrbits;  ///< by the lowest face they cross
  std::vector<Separatrix> separatrices;       ///< by saddle, outgoing first
  std::vector<EntityLink> links;              ///< ascending by source and target
  ZeroRegions zeros;
  std::map<std::string, double> seconds;  ///< by phase
};

struct TopologyOptions {
  FixedPointOptions fixedPoints;
  /// Largest estimated error of one step of the streamlines, in mean edge lengths.
  double tolerance = 1e-6;
  /// A closed streamline whose neighbours, half an edge away on either side, return to within this part of that
  /// distance belongs to a band of closed streamlines.
  double bandTolerance = 3e-3;
  /// Integration steps, as a rule one for each face, after which a streamline is given up.
  Index maxSteps = 500000;
};

/// The same for any number of threads. Reversing the field swaps kinds and directions and nothing else.
/// Throws InputError for a field of another mesh or a value that is not finite, and Cancelled.
Topology findTopology(const FlatFaces& faces, const VectorField& field, const TopologyOptions& options = {},
                      Progress* progress = nullptr);

}  // namespace stormfield
