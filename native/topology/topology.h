// The instantaneous topology of a field: fixed points, boundary points, periodic orbits, separatrices and the entity
// connection graph (ECG) that they make (thesis 2.2, 3.1, 3.2; Chen et al. 2007).
//
// Rounds of streamlines find everything: separatrices from the saddles, one streamline from each source and sink and
// from both sides of each periodic orbit, from the points where the flow touches the boundary, and from the border of
// each recurrent component of the geometry-based map (a periodic orbit cannot leave such a component). A streamline
// that returns to an edge inside its component is a candidate for a periodic orbit (Wischgoll and Scheuermann 2001),
// which a converged return map confirms; streamlines from its two sides search the rest of the component. The search
// ends when every streamline has ended.
//
// Guarantees: the indices add up to the Euler characteristic, whatever the values. That every orbit is found is tested,
// not proved: an orbit that no streamline of the rounds approaches is missed.
//
//   const FlatFaces faces(field.charts);
//   const Topology topology = findTopology(faces, field);
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "topology/boundary_points.h"
#include "topology/entities.h"
#include "topology/fixed_points.h"
#include "tracing/flat_faces.h"

namespace stormfield {

/// Where the field vanishes altogether, which is no fixed point but a whole region (or line) of zeros.
struct ZeroRegions {
  Index faces = 0;     ///< faces with three zero vectors
  Index vertices = 0;  ///< vertices with a zero vector
};

struct TopologyMemory;

struct Topology {
  std::vector<FixedPoint> fixedPoints;        ///< in face order
  std::vector<BoundaryPoint> boundaryPoints;  ///< loop by loop
  std::vector<PeriodicOrbit> periodicOrbits;  ///< by the lowest face they cross
  std::vector<Separatrix> separatrices;       ///< by saddle, outgoing first
  std::vector<EntityLink> links;              ///< ascending by source and target
  ZeroRegions zeros;
  std::map<std::string, double> seconds;         ///< by phase
  std::shared_ptr<const TopologyMemory> memory;  ///< for updatedTopology
};

struct TopologyOptions {
  FixedPointOptions fixedPoints = {};
  /// Largest estimated error of one step of the streamlines, in mean edge lengths.
  double tolerance = 1e-6;
  /// A closed streamline belongs to a band of closed streamlines if its neighbours, half an edge away on either side,
  /// return within this fraction of that distance.
  double bandTolerance = 3e-3;
  /// Integration steps of one streamline, as a rule one for each face; after them it ends in nothing known.
  Index maxSteps = 500000;
};

/// The same for any number of threads. Reversing the field swaps kinds and directions and nothing else.
/// Throws InputError for a field of another mesh, a value that is not finite and options that are not positive;
/// Cancelled.
Topology findTopology(const FlatFaces& faces, const VectorField& field, const TopologyOptions& options = {},
                      Progress* progress = nullptr);

/// The same for a field that differs in some vectors from one whose topology is known by these options: streamlines and
/// isolated periodic orbits that cross no face with a changed vector are not searched again.
Topology updatedTopology(const FlatFaces& faces, const VectorField& field, const VectorField& before,
                         const Topology& topologyBefore, const TopologyOptions& options = {},
                         Progress* progress = nullptr);

}  // namespace stormfield
