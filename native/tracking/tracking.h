// The history of a field's fixed points over lambda: their paths and bifurcations (thesis 10.1.4, 11.2.2).
//
// Paths are followed cell by cell through mesh x [lambda_j, lambda_j+1] by the exact rule for edges (see
// tracking_crossings.h, tracking_sweep.h), so that they never break: a path begins at the first sample, at the mesh
// boundary or by a creation, and ends at the last sample, at the boundary or by an annihilation; a saddle and a node
// appear and vanish together. At every lambda the indices of the living paths are the Poincare indices of the faces
// that hold them: on a closed mesh they add up to the Euler characteristic. Where a source turns into a sink or back,
// through a center, the path goes on and a Hopf bifurcation is listed. Two points of opposite index inside one face,
// which only a strongly curved one can hold, are no points as long as they stay there: a pair that is born in one
// appears when its first point leaves.
//
//   const Tracking tracking = trackFixedPoints(field, {}, progress);
//   for (const TrackedPath& path : tracking.paths) begins.push_back(path.samples.front().position);
//
// Memory beside the result: about 60 bytes for each crossing of an edge and 8 for each face.
#pragma once

#include <array>
#include <vector>

#include "base/progress.h"
#include "field/parameterized_field.h"
#include "topology/fixed_points.h"

namespace stormfield {

struct TrackingOptions {
  /// As for findFixedPoints: below this part |trace| counts as none, |det| below its square.
  double relativeTolerance = 1e-3;
  /// A Hopf bifurcation is listed once |trace| / (2 sqrt(det)) has exceeded this on both sides of zero: a damping
  /// ratio, 1 for a node. Jacobians differ a little from face to face, so that a center's sign means nothing.
  double hopfDamping = 0.02;
  /// Samples are added until the curve differs from its chords by less than this part of the mean edge length.
  double chordTolerance = 0.02;
};

struct PathSample {
  double lambda = 0.0;
  SurfacePoint point;
  Vec3 position = Vec3::Zero();
  FixedPointKind kind = FixedPointKind::Degenerate;
};

enum class PathEnd { Range, Boundary, Bifurcation };

struct TrackedPath {
  int index = 0;                                     ///< Poincare index, +1 or -1
  FixedPointKind kind = FixedPointKind::Degenerate;  ///< what it is for the longest part of its life
  std::vector<PathSample> samples;                   ///< at every sample of the field and every edge, and in between
  PathEnd begin = PathEnd::Range, end = PathEnd::Range;
  double strength = 0.0;  ///< mean of sqrt|det J| over its life, 1/s
  double rotation = 0.0;  ///< mean of the curl over its life, 1/s: > 0 turns counter-clockwise seen from outside

  /// Part of lambda it lives through: its persistence.
  double life() const { return samples.back().lambda - samples.front().lambda; }
};

enum class BifurcationKind { Creation, Annihilation, Hopf };
/// Lower-case word used in files and messages.
const char* name(BifurcationKind kind);

struct Bifurcation {
  double lambda = 0.0;
  SurfacePoint point;
  Vec3 position = Vec3::Zero();
  BifurcationKind kind = BifurcationKind::Hopf;
  FixedPointKind node = FixedPointKind::Degenerate;  ///< source or sink that meets the saddle; Hopf: what it becomes
  std::array<Index, 2> paths{kNone, kNone};          ///< node's and saddle's path; Hopf: the path and kNone
};

struct Tracking {
  std::vector<TrackedPath> paths;         ///< in the order they begin, those of the first sample by face
  std::vector<Bifurcation> bifurcations;  ///< by lambda
};

/// Works on any field, degenerate ones included: zero vectors count as infinitesimal ones, a zero of higher order as
/// several of order one, and a field that has one sample has paths of one sample. Parallel; the result does not depend
/// on the thread count. Throws InputError for options out of range, Cancelled.
Tracking trackFixedPoints(const ParameterizedField& field, const TrackingOptions& options, Progress& progress);

}  // namespace stormfield
