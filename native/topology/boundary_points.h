// Points of the boundary where the flow changes between entering and leaving, and the sum of indices on surfaces with
// boundary (Morse 1929; Pugh 1968).
//
// Go around a boundary loop with the surface on the left and let a be the angle from the direction of the loop to the
// field. The field is tangent where a is a multiple of pi. Of a generic tangency there are two kinds: the trajectory
// touches the boundary from outside (a falls), as in a uniform flow past a disk, or from inside (a grows). By the
// argument of Poincare and Hopf the indices inside add up to the Euler characteristic plus the rotations of a:
//     sum of the indices inside = chi + (touching from inside - touching from outside) / 2
// (each loop rotates its tangent once, and a passes two multiples of pi per rotation). A point that is touched from
// outside so carries the index +1/2, one touched from inside -1/2 (half a center and half a saddle: what becomes of
// them when the surface is glued to its mirror image), and
//     sum of the indices inside + sum of the boundary's half-indices = chi
// exactly, on every mesh, because the rotations of a are counted by the same edges as the indices of the faces. At a
// vertex of the boundary the loop itself rotates, and what a passes in that rotation is the vertex's share, of any size
// at a spike. Where the surface's boundary is a polygon, a smooth tangency from inside can so become three points
// -1/2 +1/2 -1/2 in a row.
//
//   const std::vector<BoundaryPoint> points = findBoundaryPoints(field);
#pragma once

#include <vector>

#include "field/vector_field.h"

namespace stormfield {

struct BoundaryPoint {
  SurfacePoint point;
  Vec3 position = Vec3::Zero();
  int halfIndex = 0;  ///< twice the index: +1 touched from outside, -1 from inside; more only at vertices
};

/// Loop by loop, in the order along it; loops by their lowest halfedge. None on a closed mesh. A vector of zero counts
/// as an infinitesimal one along its chart's x axis, as for the faces' indices.
std::vector<BoundaryPoint> findBoundaryPoints(const VectorField& field);

}  // namespace stormfield
