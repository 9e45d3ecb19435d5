// Where a fixed point is along its way through the faces, and what it is there.
#pragma once

#include <vector>

#include "tracking/detail/sweep.h"
#include "tracking/tracking.h"

namespace stormfield {

/// A sample with what kinds are told from. At an edge the Jacobian jumps: the face that is left and the one that is
/// entered each give one.
struct JetSample {
  PathSample sample;
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
  bool inSample = true;  ///< false for the far side of an edge, which is no point of its own
};

/// The kind with the longest share of lambda; of equal ones the first in the order of the kinds.
FixedPointKind mostly(const std::vector<PathSample>& samples);

class WaySampler {
 public:
  WaySampler(const ParameterizedField& field, const std::vector<ZeroCrossing>& crossings,
             const TrackingOptions& options);

  /// Lambda never decreases; both sides of an edge stand one after the other.
  std::vector<JetSample> sample(const FaceWay& way) const;
  /// The zero of this index inside a face at lambda.
  JetSample inFace(Index face, double lambda, int index) const;
  SurfacePoint crossingPoint(const ZeroCrossing& crossing, Index face) const;

 private:
  void refine(std::vector<JetSample>& result, const JetSample& last, int index, int depth) const;
  JetSample jetAt(double lambda, const SurfacePoint& point, const FaceInterpolant& local, int index) const;
  FaceInterpolant interpolant(Index face, double lambda) const;

  const ParameterizedField& field_;
  const TriangleMesh& mesh_;
  const std::vector<ZeroCrossing>& crossings_;
  TrackingOptions options_;
};

}  // namespace stormfield
