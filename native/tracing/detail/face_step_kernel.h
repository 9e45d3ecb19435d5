// The steps of tracing/face_path.h for as many particles as a register has lanes, each in a face of its own. A lane's
// result does not depend on the others, nor on their number.
//
// The class; its members are defined in face_step_affine.h (the path of the field's affine part), face_step_bend.h (the
// correction for curvature) and face_step.h (the whole step), which users include. A template on the width of a
// register alone, as detail/lanes.h is, and under the same rule.
#pragma once

#include "tracing/detail/lanes.h"
#include "tracing/face_flow.h"

namespace stormfield::lanes {

/// What a step results in.
enum : int { kInside = -1, kNotPlain = -2, kTooLong = -3 };

/// Particles side by side; unused ones need a face as well. Coordinates are the barycentric ones of corners 1 and 2.
template <int Count>
struct alignas(Count < 2 ? 8 : 64) ParticlesOf {
  const FaceFlow* face[Count];
  double start[2][Count];
  double entry[Count];        ///< the corner opposite to the side of entry, -1 inside
  double maxDuration[Count];  ///< of the step, seconds

  double exit[Count];  ///< the corner opposite to the side of exit; kInside, kNotPlain; kTooLong: shorten to duration
  double end[2][Count];
  double duration[Count], length[Count];
};

/// As StepLimits, in mesh units.
struct KernelLimits {
  double tolerance, relativeTolerance, minSpeed;
};

/// Steps as many particles as there are lanes, from a first one. Unless Curved, what curvature adds to the affine part
/// counts as an error.
template <int Bytes, int Count, bool Curved>
class FaceStepKernel {
  using L = Lanes<Bytes>;
  using F = typename L::Floats;
  using D = typename L::Doubles;
  using Particles = ParticlesOf<Count>;
  struct FloatPair {
    F x, y;
  };
  struct Pair {
    D x, y;
  };

  static constexpr int kOrder = 12, kNodes = 4, kMoments = 7, kMaxPasses = 4;
  static constexpr double kPlain = 1e-6;  ///< barycentric distance from a vertex below which a path is not plain
  static constexpr float kNever = 1e30F;  ///< longer than any time

  // Gauss' rule with four points on [0, 1]; integrals from 0 to each of them of the cubic through four values; that
  // cubic at 0 (and, reversed, at 1); its quadratic and cubic Legendre parts; integrals from 0 to the inner points of
  // the parabola through the outer values that vanishes in the middle, for the first value and then for the last.
  static constexpr float kPoint[kNodes] = {0.0694318442F, 0.330009478F, 0.669990522F, 0.930568156F};
  static constexpr float kWeight[kNodes] = {0.173927423F, 0.326072577F, 0.326072577F, 0.173927423F};
  static constexpr float kIntegral[kNodes][kNodes] = {{0.0869637113F, -0.0266041801F, 0.0126274627F, -0.00355514969F},
                                                      {0.188118117F, 0.163036289F, -0.0278804286F, 0.00673550059F},
                                                      {0.167191922F, 0.353953006F, 0.163036289F, -0.0141906949F},
                                                      {0.177482572F, 0.313445115F, 0.352676758F, 0.0869637113F}};
  static constexpr float kAtStart[kNodes] = {1.52678813F, -0.813632449F, 0.400761520F, -0.113917196F};
  static constexpr float kGuess[4] = {0.236339015F, 0.245171218F, -0.0204185039F, -0.0115863007F};
  static constexpr float kQuadratic[kNodes] = {0.532404142F, -0.532404142F, -0.532404142F, 0.532404142F};
  static constexpr float kCubic[kNodes] = {-0.371027003F, 0.939772470F, -0.939772470F, 0.371027003F};

  // Estimates of errors that have no closed form. The factors are fitted to measured errors (smooth spheres, tori with
  // twists of 0.1 radians, tolerances 1e-4 to 1e-8), which test_face_path.cpp compares to the tolerance.
  /// Error of Gauss' rule per cubic Legendre part of the correction, for nearness n to a corner: min(kRule n, kRuleNear
  /// n^2), without unit.
  static constexpr float kRule = 0.012F, kRuleNear = 0.0012F, kMaxRule = 2.0F;
  /// Growth of the correction's gradient per nearness to a corner, without unit.
  static constexpr float kGradientNear = 0.2F;
  /// Change of the correction at displaced points over duration * gradient * displacement, without unit.
  static constexpr float kSecondLook = 2.6F;
  /// Error of the quadratic end of the path: fraction of lateness * (stretch * lateness)^2 * |v|, without unit.
  static constexpr float kLateCubic = 0.2F;
  /// Error of the length per visible Legendre part of its excess, without unit.
  static constexpr float kLengthRule = 0.02F;
  /// Relative round-off of the length's and the correction's single precision sums.
  static constexpr float kLengthRounding = 4e-7F, kBendRounding = 1e-6F;
  // The next try of a step whose error is too large: duration times the fourth root of allowed over estimated error,
  // times kCaution, within these bounds.
  static constexpr float kCaution = 0.8F, kMinFactor = 0.2F, kMaxFactor = 0.7F;

 public:
  static constexpr int kLanes = L::kCount;

  static void step(Particles& particles, int first, const KernelLimits& limits) {
    FaceStepKernel(particles, first, limits).run(particles, first);
  }

 private:
  FaceStepKernel(const Particles& particles, int first, const KernelLimits& limits) {
    const auto face = [&](int lane) -> const FaceFlow& { return *particles.face[first + lane]; };
    const auto given = [&](const double* values) { return L::load(values + first); };
    const auto doubles = [&](const auto& get) { return L::doubles([&](int lane) { return get(face(lane)); }); };
    const auto floats = [&](const auto& get) { return L::floats([&](int lane) { return get(face(lane)); }); };
    for (int i = 0; i < 3; ++i) {
      rate_[i] = {doubles([i](const FaceFlow& f) { return f.rate[i][0]; }),
                  doubles([i](const FaceFlow& f) { return f.rate[i][1]; })};
      if constexpr (Curved) {
        tanHalf_[i] = floats([i](const FaceFlow& f) { return f.tanHalf[i]; });
        doubleTwist_[i] = floats([i](const FaceFlow& f) { return f.doubleTwist[i]; });
      }
    }
    foot_ = doubles([](const FaceFlow& f) { return f.foot; });
    height_ = doubles([](const FaceFlow& f) { return f.height; });
    base_ = doubles([](const FaceFlow& f) { return f.base; });
    unit_ = doubles([](const FaceFlow& f) { return f.unit; });
    size_ = floats([](const FaceFlow& f) { return f.longestSide; });
    if constexpr (!Curved) neglected_ = floats([](const FaceFlow& f) { return f.bend; });
    start_ = {given(particles.start[0]), given(particles.start[1])};
    const D entry = given(particles.entry);
    for (int i = 0; i < 3; ++i) entered_[i] = entry == L::all(static_cast<double>(i));
    maxSeconds_ = given(particles.maxDuration);
    maxTime_ = maxSeconds_ / unit_;
    tolerance_ = toFloats(limits.tolerance / base_);
    relativeTolerance_ = L::all(static_cast<float>(limits.relativeTolerance));
    minSpeed_ = toFloats(limits.minSpeed * unit_ / base_);
  }

  void run(Particles& particles, int first);
  void gatherShape();
  void followAffinePart();
  void meetSides();
  void settle();
  FloatPair correctionNearMiddle(const FloatPair& rate) const;
  void placeNodes();
  F bend();
  /// At one point of each particle's face, or (Point wider than F) at several points of the one particle's face.
  template <typename Point>
  Point correction(const Point& p) const;
  template <int Points>
  void correctionsAt(const FloatPair* p, FloatPair* c) const;
  Pair at(const D& t) const;

  // Barycentric coordinates of all three corners.
  static D third(const Pair& p) { return 1.0 - p.x - p.y; }
  static F third(const FloatPair& p) { return 1.0F - p.x - p.y; }
  static F rateOfThird(const FloatPair& p) { return -p.x - p.y; }
  static FloatPair toFloatPair(const Pair& p) { return {toFloats(p.x), toFloats(p.y)}; }
  Pair jacobian(const Pair& v) const {
    return {v.x * along_[0].x + v.y * along_[1].x, v.x * along_[0].y + v.y * along_[1].y};
  }
  FloatPair jacobian(const FloatPair& v) const {
    return {v.x * floatAlong_[0].x + v.y * floatAlong_[1].x, v.x * floatAlong_[0].y + v.y * floatAlong_[1].y};
  }
  /// Length, in bases, of a change of the coordinates.
  F lengthOf(const FloatPair& v) const {
    const F x = v.x + v.y * floatFoot_, y = v.y * floatHeight_;
    return squareRoot(x * x + y * y);
  }

  // The face and its field.
  Pair rate_[3], along_[2];  ///< rates of the carried vectors; columns of the Jacobian
  D foot_, height_, base_, unit_;
  F size_, neglected_, floatFoot_, floatHeight_;
  FloatPair floatAlong_[2], floatRate_[3], rotated_[3];  ///< rotated: rates of the vectors rotated by a right angle
  F sides_[3], tanHalf_[3], doubleTwist_[3];
  // The task.
  Pair start_;
  decltype(D() == D()) entered_[3];
  D maxTime_, maxSeconds_;
  F tolerance_, relativeTolerance_, minSpeed_;
  // The path of the affine part and a constant.
  FloatPair constant_ = {F(), F()};
  Pair series_[kOrder + 1];
  FloatPair floatSeries_[kOrder + 1];
  F stretch_;
  D duration_;
  D leaving_;  ///< the corner whose coordinate vanishes at the end; -1 where the step ends inside
  Pair end_;
  decltype(D() == D()) settled_;
  // What bends it.
  FloatPair node_[kNodes], bent_[kNodes] = {};
  FloatPair displacement_ = {F(), F()}, firstBent_ = displacement_, lastBent_ = displacement_;
};

}  // namespace stormfield::lanes
