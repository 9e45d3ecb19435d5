#include "maps/detail/chord_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracing/dense_step.h"

namespace stormfield {
namespace {

// No theorem gives these factors. They are the ones of which the tests of tau maps (test_tau_map.cpp) find no point
// that leaves its image.

/// Bend of a chord by one step, in chord lengths per radian by which the field turns along it (at most one radian).
constexpr double kBendPerTurn = 0.025;
/// Fraction of that within one face, where the field is linear but for the correction for curvature.
constexpr double kBendWithinFace = 0.1;
/// Largest logarithm of the growth in one step: keeps the estimate finite where a step is long for the gradient.
constexpr double kMaxLogGrowth = 3.0;
/// Length below which a chord resolves the curve between its ends, in face sizes: the field is nearly linear along it.
constexpr double kResolvedChord = 0.25;
/// Deviation that a resolved chord may still hide, in chord lengths: that of an arc of 106 degrees from its chord is
/// 1/4.
constexpr double kResolvedDeviation = 0.25;

}  // namespace

ChordShape chordShape(const FlatFaces& faces, const SurfacePoint& a, const SurfacePoint& middle,
                      const SurfacePoint& b) {
  ChordShape shape{{faces, middle.face, a.face}, {faces, middle.face, b.face}};
  if (!shape.isComparable()) return shape;
  shape.middle = faces[middle.face].point(middle.barycentric);
  shape.inA = faces[a.face].point(a.barycentric);
  shape.inB = faces[b.face].point(b.barycentric);
  shape.deviation = std::numeric_limits<double>::infinity();
  for (int i = 0; i < shape.toA.count(); ++i) {
    for (int j = 0; j < shape.toB.count(); ++j) {
      const Complex midpoint = 0.5 * (shape.toA[i](shape.inA) + shape.toB[j](shape.inB));
      shape.deviation = std::min(shape.deviation, magnitude(shape.middle - midpoint));
    }
  }
  shape.chords = {magnitude(shape.middle - shape.toA[0](shape.inA)), magnitude(shape.middle - shape.toB[0](shape.inB))};
  shape.longestChord = std::max(shape.chords[0], shape.chords[1]);
  shape.spread = std::max(shape.toA.spread(shape.middle, shape.inA), shape.toB.spread(shape.middle, shape.inB));
  shape.faceSize = faceSize(faces[middle.face]);
  return shape;
}

double deviationAfterStep(const PreparedFlow& flow, double stepTau, DeviationModel model, const DeviationBefore& before,
                          const std::array<Index, 3>& faces, const ChordShape& shape) {
  const auto [left, middle, right] = faces;
  const double growth = std::max({flow.growthRate(middle), flow.growthRate(left), flow.growthRate(right)});
  const double divergence =
      std::max({flow.divergenceRate(middle), flow.divergenceRate(left), flow.divergenceRate(right)});
  const double gradient = std::max({flow.gradientNorm(middle), flow.gradientNorm(left), flow.gradientNorm(right)});
  const bool inOneFace = middle == left && middle == right;
  const double bend =
      kBendPerTurn * (inOneFace ? kBendWithinFace : 1.0) * std::min(gradient * stepTau, 1.0) * shape.longestChord;
  const double byGrowth = std::exp(std::min(growth * stepTau, kMaxLogGrowth)) * before.deviation + bend;
  if (model == DeviationModel::InWindow) return std::min(byGrowth, kResolvedDeviation * shape.longestChord);
  if (std::max(before.chords[0], before.chords[1]) > kResolvedChord * shape.faceSize) return byGrowth;
  const double shortening = std::max(before.chords[0] / shape.chords[0], before.chords[1] / shape.chords[1]);
  const double byArea = std::exp(std::min(divergence * stepTau, kMaxLogGrowth)) * shortening * before.deviation + bend;
  return std::min(byGrowth, std::max(byArea, kResolvedDeviation * shape.longestChord));
}

}  // namespace stormfield
