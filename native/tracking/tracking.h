// Tracking: the fixed points of a field that changes over lambda, followed from their creation to their annihilation
// (thesis 10.1.4, 11.2.2).
//
// Paths are followed cell by cell through mesh x [lambda_j, lambda_j+1], as Tricoche et al. 2002 and Garth et al. 2004
// do for linear space-time cells, here with an exact rule for edges (detail/crossings.h, detail/sweep.h) in place of
// integrating a feature flow field (Theisel and Seidel 2003; Weinkauf et al. 2011). So a path never breaks: it begins
// at the first sample, at the mesh boundary or by a creation, and ends at the last sample, at the boundary or by an
// annihilation; a saddle and a node appear and vanish together. At every lambda the indices of the living paths are the
// Poincare indices of the faces that hold them: on a closed mesh they add up to the Euler characteristic. Where a
// source turns into a sink or back, through a center, the path continues and a Hopf bifurcation is listed. Two points
// of opposite index inside one face, which only a strongly curved one can hold, are not seen as long as they stay
// there: a pair that is created in one appears when its first point leaves.
//
//   Progress progress;
//   const Tracking tracking = trackFixedPoints(field, {}, progress);
//   const double life = tracking.paths.front().life();
//
// Memory besides the result: about 60 bytes for each crossing of an edge and 8 for each face.
#pragma once

#include "base/progress.h"
#include "field/parameterized_field.h"
#include "tracking/tracked_paths.h"

namespace stormfield {

struct TrackingOptions {
  /// As for findFixedPoints: below this fraction |trace| counts as none, |det| below its square.
  double relativeTolerance = 1e-3;
  /// A Hopf bifurcation is listed once |trace| / (2 sqrt(det)) has exceeded this on both sides of zero: a damping
  /// ratio, 1 for a node. Jacobians differ a little from face to face, so that a center's sign means nothing.
  double hopfDamping = 0.02;
  /// Samples are added until the curve differs from its chords by less than this fraction of the mean edge length.
  double chordTolerance = 0.02;
};

/// Works on any field, degenerate ones included: zero vectors count as infinitesimal ones, a zero of higher order as
/// several of order one, and a field that has one sample has paths of one sample. Parallel; the result does not depend
/// on the thread count. Throws InputError for options out of range; Cancelled.
Tracking trackFixedPoints(const ParameterizedField& field, const TrackingOptions& options, Progress& progress);

}  // namespace stormfield
