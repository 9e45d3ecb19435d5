#include "tracing/face_flow.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "tracing/flat_faces.h"
#include "tracing/flow.h"

namespace stormfield {

namespace {

/// Fields whose rates, or their inverses, exceed this have no steps in closed form.
constexpr double kMaxRate = 1e300;
/// Twists that move nothing, but whose powers would be too small for single precision.
constexpr float kNoTwist = 1e-9F;

}  // namespace

static_assert(std::is_trivially_copyable_v<FaceFlow>);

FaceFlow::FaceFlow(const FlatFace& face, const std::array<Complex, 3>& values) {
  const Complex third = face.corner(2);
  base = face.corner(1).real();
  const double inverseBase = face.gradient(1).real();
  foot = third.real() * inverseBase;
  height = third.imag() * inverseBase;
  longestSide = static_cast<float>(face.longestSide() * inverseBase);
  double fastest = 0.0, bound = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Complex v = face.carry(i, values[i]), g1 = face.gradient(1);
    rate[i][0] = v.real() * g1.real() + v.imag() * g1.imag();
    rate[i][1] = v.imag() * face.gradient(2).imag();
    fastest = std::max(fastest, std::max(std::abs(rate[i][0]), std::abs(rate[i][1])));
    doubleTwist[i] = std::abs(face.doubleTwist(i)) < kNoTwist ? 0.0F : face.doubleTwist(i);
    tanHalf[i] = face.tanHalf(i);
    twin[i] = face.twin(i);
    // The rotation is the double twist times half the angle to the bisector.
    const auto angle = static_cast<double>(0.5F * std::abs(doubleTwist[i]) * tanHalf[i]);
    bound = std::max(bound, angle * std::abs(v) * inverseBase);
  }
  unit = 1.0 / fastest;
  if (face.isExtreme() || !(unit < kMaxRate && fastest < kMaxRate)) {
    unit = 0.0;
    bend = 0.0F;
    return;
  }
  bend = static_cast<float>(bound * unit);
  for (auto& r : rate) {
    r[0] *= unit;
    r[1] *= unit;
  }
}

std::unique_ptr<FaceFlow[]> prepareFaces(const FlatFaces& faces, const SteadyFlow& flow) {
  const Index count = faces.mesh().faceCount();
  auto prepared = std::make_unique_for_overwrite<FaceFlow[]>(count);
  tbb::parallel_for(Index{0}, count, [&](Index f) { prepared[f] = FaceFlow(faces[f], flow.vertexValues(faces[f])); });
  return prepared;
}

}  // namespace stormfield
