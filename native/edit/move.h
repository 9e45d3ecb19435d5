// Moving a fixed point along the surface (Zhang, Mischaikow, Turk 2006, Vector Field Design on Surfaces): the same kind
// of point stands at the target, the graph is the same, and vectors outside of a block around the way keep their bits.
//
// The vectors of the target's face are given by the point's Jacobian, carried along the way, so that the zero is where
// it should be. The rest of the block is filled and verified as for a cancelled pair (edit/cancel.h).
//
//   const EditResult result = movePoint(faces, field, findTopology(faces, field), 2, seed);
#pragma once

#include "base/progress.h"
#include "edit/cancel.h"

namespace stormfield {

/// How near to the target the point must be found, in mean edge lengths.
inline constexpr double kMoveTolerance = 0.1;

/// point: in Topology::fixedPoints, of any kind but degenerate. A move that cannot be made is a result with its reason:
/// what is in the way, or which test failed. The same for any number of threads. Throws Cancelled.
EditResult movePoint(const FlatFaces& faces, const VectorField& field, const Topology& topology, Index point,
                     const SurfacePoint& target, const CancelOptions& options = {}, Progress* progress = nullptr);

}  // namespace stormfield
