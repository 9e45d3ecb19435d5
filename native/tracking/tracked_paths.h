// The paths and bifurcations of a field's fixed points over lambda: what tracking finds and persistence simplifies
// (thesis 10.1.4, 11.2.2).
//
// In mesh x lambda the zeros of the field form curves. A path is a piece of one on which lambda grows; a bifurcation is
// where a curve turns back, or where a path changes its stability.
#pragma once

#include <array>
#include <vector>

#include "base/words.h"
#include "topology/entities.h"

namespace stormfield {

struct PathSample {
  double lambda = 0.0;
  SurfacePoint point;
  Vec3 position = Vec3::Zero();
  FixedPointKind kind = FixedPointKind::Degenerate;
};

/// Where a path begins or ends: at the first or last sample of the field, at the mesh boundary, or with a second path.
enum class PathEnd { Range, Boundary, Bifurcation };

/// Where the trace of the Jacobian changes its sign.
struct StabilityChange {
  double lambda = 0.0;
  SurfacePoint point;
  Vec3 position = Vec3::Zero();
};

/// What is needed of a path to judge Hopf bifurcations when it is joined to the path that it is the continuation of:
/// signs of the trace are +1, a source, -1, a sink, or 0 where there is none.
struct StabilityMargins {
  int first = 0, last = 0;                ///< signs of the first and last trace that is not zero
  int firstCertain = 0, lastCertain = 0;  ///< the same where the damping ratio exceeds the tolerance
  std::vector<StabilityChange> before;    ///< changes before the first certain sign; all where none is certain
  std::vector<StabilityChange> after;     ///< changes after the last certain sign
};

struct TrackedPath {
  int index = 0;                                     ///< Poincare index, +1 or -1
  FixedPointKind kind = FixedPointKind::Degenerate;  ///< what it is for the longest share of its life
  std::vector<PathSample> samples;                   ///< at every sample of the field and every edge, and in between
  PathEnd begin = PathEnd::Range, end = PathEnd::Range;
  double strength = 0.0;     ///< mean of sqrt|det J| over its life, 1/s
  double rotation = 0.0;     ///< mean of the curl over its life, 1/s: > 0 is counter-clockwise seen from outside
  StabilityMargins margins;  ///< of a path of index +1, as it was tracked

  /// The interval of lambda it lives through: its persistence.
  double life() const { return samples.back().lambda - samples.front().lambda; }
};

enum class BifurcationKind { Creation, Annihilation, Hopf };
template <>
inline constexpr Words kWords<BifurcationKind>{"kind of bifurcation", {"creation", "annihilation", "hopf"}};

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

/// The kind with the longest share of lambda; of equal ones the first in the order of the kinds.
FixedPointKind prevailingKind(const std::vector<PathSample>& samples);

/// A tracking put together from paths and bifurcations of others, such as those of windows of lambda. The kinds of the
/// paths are found anew. Throws InputError that names the path or bifurcation: a path needs samples at finite lambda
/// from 0 to 1 that do not go back, on faces, and the index +1 or -1; a creation or annihilation names two paths, a
/// Hopf bifurcation one.
Tracking makeTracking(std::vector<TrackedPath> paths, std::vector<Bifurcation> bifurcations);

}  // namespace stormfield
