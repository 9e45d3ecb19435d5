#include "streamlines/topology_features.h"

namespace stormfield {

StreamlineFeatures featuresOf(const Topology& topology) {
  StreamlineFeatures features;
  for (const PeriodicOrbit& orbit : topology.periodicOrbits) {
    features.curves.push_back({.points = orbit.points, .closed = true});
  }
  for (const Separatrix& separatrix : topology.separatrices) {
    const bool toPoint = separatrix.end.kind == EntityKind::FixedPoint &&
                         topology.fixedPoints[separatrix.end.index].kind != FixedPointKind::Saddle;
    const bool toBoundary = separatrix.end.kind == EntityKind::Boundary;
    features.curves.push_back({.points = separatrix.points,
                               .againstFlow = !separatrix.outgoing,
                               .endsOnBoundary = toBoundary,
                               .leadsToPoint = toPoint});
  }
  features.fixedPoints = topology.fixedPoints;
  return features;
}

}  // namespace stormfield
