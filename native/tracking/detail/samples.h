// Samples of a fixed point's path: where the zero is in each of its segments, and what its Jacobian says about its
// kind.
#pragma once

#include <vector>

#include "field/interpolation.h"
#include "tracking/detail/sweep.h"
#include "tracking/tracked_paths.h"

namespace stormfield {

/// A sample with its Jacobian, from which its kind follows. At an edge the Jacobian jumps: the face that is left and
/// the one that is entered each give one.
struct JetSample {
  PathSample sample;
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
  bool listed = true;  ///< false for the near side of an edge, whose place the far side lists
};

struct SamplingOptions {
  double relativeTolerance = 1e-3;  ///< as in TrackingOptions
  double chordTolerance = 0.02;     ///< as in TrackingOptions
};

/// The field and the crossings are kept by reference.
class PathSampler {
 public:
  PathSampler(const ParameterizedField& field, const std::vector<ZeroCrossing>& crossings,
              const SamplingOptions& options);

  /// Lambda never decreases; the samples on both sides of an edge follow each other.
  std::vector<JetSample> sample(const ChargePath& path) const;
  /// The zero of this index inside a face at lambda.
  JetSample inFace(Index face, double lambda, int index) const;
  SurfacePoint crossingPoint(const ZeroCrossing& crossing, Index face) const;

 private:
  void addSegment(std::vector<JetSample>& result, const ChargePath& path, std::size_t k) const;
  JetSample segmentEnd(Index face, int index, Index crossing, double lambdaWithout) const;
  void refine(std::vector<JetSample>& result, const JetSample& last, int index, int depth) const;
  JetSample jetAt(double lambda, const SurfacePoint& point, const FaceInterpolant& local, int index) const;
  FaceInterpolant interpolant(Index face, double lambda) const;

  const ParameterizedField& field_;
  const TriangleMesh& mesh_;
  const std::vector<ZeroCrossing>& crossings_;
  SamplingOptions options_;
};

}  // namespace stormfield
