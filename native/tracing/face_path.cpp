#include "tracing/face_path.h"

#include <algorithm>
#include <cmath>

namespace stormfield {
namespace {

/// Two barycentric coordinates, of corners a and b; that of c, the third, grows at the start of the step.
using Pair = Eigen::Array2d;
/// One lane per point of Gauss' rule.
using Nodes = Eigen::Array4d;
using Lanes = Eigen::Array4f;

constexpr int kOrder = 8, kMoments = 6, kFewMoments = 4;
/// Barycentric distance from a vertex below which a path is not plain.
constexpr double kPlain = 1e-6;
constexpr int kMostAttempts = 4, kMostPasses = 4, kMostIterations = 4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Gauss' rule with four points on [0, 1].
const Nodes kPoints{0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629};
const Nodes kWeights{0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};

struct LanePair {
  Lanes x, y;
};

/// Integrals from 0 to each of the four points of the cubic through four values.
Lanes integrals(const Lanes& v) {
  const Lanes first{0.0869637113F, 0.188118117F, 0.167191922F, 0.177482572F};
  const Lanes second{-0.0266041801F, 0.163036289F, 0.353953006F, 0.313445115F};
  const Lanes third{0.0126274627F, -0.0278804286F, 0.163036289F, 0.352676758F};
  const Lanes fourth{-0.00355514969F, 0.00673550059F, -0.0141906949F, 0.0869637113F};
  return (v[0] * first + v[1] * second) + (v[2] * third + v[3] * fourth);
}

/// Size of the cubic part (of its Legendre polynomial) of what four values show.
double cubicPart(const LanePair& v) {
  const Lanes null{-0.371027003F, 0.939772470F, -0.939772470F, 0.371027003F};
  return std::abs((v.x * null).sum()) + std::abs((v.y * null).sum());
}

/// Error of Gauss' rule for the mean of speeds: the terms it misses are smaller by powers of those that can be seen.
double meanError(const Nodes& speeds, double mean) {
  const Nodes quadratic{0.532404142, -0.532404142, -0.532404142, 0.532404142};
  const Nodes cubic{-0.371027003, 0.939772470, -0.939772470, 0.371027003};
  const double second = std::abs((speeds * quadratic).sum()) / mean, third = std::abs((speeds * cubic).sum()) / mean;
  const double measure = third + second * std::sqrt(second);
  return 2.0 * mean * measure * measure * std::sqrt(measure);
}

double largest(const Lanes& x, const Lanes& y) {
  return std::sqrt((x * x + y * y).maxCoeff());
}

/// What a face's field is made of, seen from corners a, b, c.
struct Corners {
  const FlatFace& face;
  int a, b, c;
  Complex atA, atB, atC, towardsA, towardsB;  ///< carried vectors, and the first two less the third
  Pair gradientX, gradientY;

  Corners(const FlatFace& flat, const std::array<Complex, 3>& values, int first)
      : face(flat), a(first), b(a == 2 ? 0 : a + 1), c(a == 0 ? 2 : a - 1) {
    atA = face.carry(a, values[a]);
    atB = face.carry(b, values[b]);
    atC = face.carry(c, values[c]);
    towardsA = atA - atC;
    towardsB = atB - atC;
    const Complex ga = face.gradient(a), gb = face.gradient(b);
    gradientX = {ga.real(), gb.real()};
    gradientY = {ga.imag(), gb.imag()};
  }
  /// Change of the coordinates along a vector.
  Pair rate(Complex v) const { return gradientX * v.real() + gradientY * v.imag(); }
  LanePair rate(const LanePair& v) const {
    const Eigen::Array2f gx = gradientX.cast<float>(), gy = gradientY.cast<float>();
    return {v.x * gx[0] + v.y * gy[0], v.x * gx[1] + v.y * gy[1]};
  }
  Complex affine(const Pair& p) const { return atC + p[0] * towardsA + p[1] * towardsB; }
  LanePair correction(const Lanes& atPointsA, const Lanes& atPointsB) const {
    const auto v = face.corrections(a, {atA, atB, atC}, atPointsA, atPointsB);
    return {v[0], v[1]};
  }
};

/// The path of the affine part.
struct AffinePath {
  Pair start, rate;     ///< where it begins, and its velocity there
  Pair alongA, alongB;  ///< columns of the Jacobian
  std::array<Pair, kOrder + 1> series;

  AffinePath(const Corners& corners, const Pair& from)
      : start(from),
        rate(corners.rate(corners.affine(from))),
        alongA(corners.rate(corners.towardsA)),
        alongB(corners.rate(corners.towardsB)) {
    series[0] = start;
    series[1] = rate;
    for (int k = 2; k <= kOrder; ++k) series[k] = jacobian(series[k - 1]) * (1.0 / k);
  }
  Pair jacobian(const Pair& v) const { return alongA * v[0] + alongB * v[1]; }
  Pair velocity(const Pair& p) const { return rate + jacobian(p - start); }
  Pair at(double t) const {
    Pair p = series[kOrder];
    for (int k = kOrder; k-- > 0;) p = p * t + series[k];
    return p;
  }
  Nodes at(int coordinate, const Nodes& t) const {
    Nodes p = Nodes::Constant(series[kOrder][coordinate]);
    for (int k = kOrder; k-- > 0;) p = p * t + series[k][coordinate];
    return p;
  }
  /// Barycentric size of the terms that the series leaves out, where the last one kept is already small.
  double truncation(double t) const {
    const double squared = t * t, fourth = squared * squared;
    return lastTerm() * (fourth * fourth);
  }
  /// The time at which truncation reaches a size.
  double reach(double size) const { return std::sqrt(std::sqrt(std::sqrt(size / lastTerm()))); }
  double lastTerm() const { return 0.5 * (std::abs(series[kOrder][0]) + std::abs(series[kOrder][1])); }

  /// When the path of second order meets the sides where the coordinates vanish; infinity where it runs away from one.
  Pair sidesMet() const {
    const Pair q = (rate * rate - 4.0 * series[2] * start).max(0.0).sqrt() - rate;
    const Pair t = 2.0 * start / q;
    return {q[0] > 0.0 ? t[0] : kInfinity, q[1] > 0.0 ? t[1] : kInfinity};
  }
  /// One of Newton's steps to the side where a coordinate vanishes; its length is left in change.
  double towards(int coordinate, double t, Pair& point, double& change) const {
    point = at(t);
    change = point[coordinate] / velocity(point)[coordinate];
    return t - change;
  }
};

/// What the correction for curvature adds to a path over a time.
struct Bend {
  Nodes x, y;            ///< at the points of Gauss' rule, flat frame
  Nodes movedA, movedB;  ///< by how much the points are displaced
  Pair displacement;     ///< of the end
  Complex first, last;   ///< correction near the ends
  double error;          ///< mesh units
};

/// How many times nearer to a corner a path begins or ends than it is long.
double nearnessToCorner(const Pair& start, const Pair& end) {
  const auto distance = [](const Pair& p) { return 1.0 - std::max(p.maxCoeff(), 1.0 - p.sum()); };
  const double extent = std::max((end - start).abs().maxCoeff(), std::abs((end - start).sum()));
  return extent / std::max(std::min(distance(start), distance(end)), kPlain);
}

/// Error of Gauss' rule as a multiple of what cubicPart shows, measured on vectors that turn around a corner: next to
/// it the rule sees too little of the turn.
double ruleError(double nearness) {
  return std::min({2.0, 0.01 * nearness, 0.001 * nearness * nearness});
}

bool findBend(const Corners& corners, const AffinePath& path, const Nodes& nodeA, const Nodes& nodeB, double t,
              double speed, double nearness, double tolerance, Bend& bend) {
  const Lanes a = nodeA.cast<float>(), b = nodeB.cast<float>();
  const Eigen::Array2f ja = path.alongA.cast<float>(), jb = path.alongB.cast<float>();
  const auto duration = static_cast<float>(t);
  LanePair correction = corners.correction(a, b), rate = corners.rate(correction);
  LanePair moved{Lanes::Zero(), Lanes::Zero()};
  const double size = largest(correction.x, correction.y);
  const double stretch = t * (path.alongA.abs() + path.alongB.abs()).maxCoeff();
  const auto displace = [&] {
    double left = size * t * stretch * stretch * 0.1;
    for (int i = 0; i < kMostIterations; ++i) {
      const Lanes bentA = rate.x + (moved.x * ja[0] + moved.y * jb[0]);
      const Lanes bentB = rate.y + (moved.x * ja[1] + moved.y * jb[1]);
      moved = {duration * integrals(bentA), duration * integrals(bentB)};
      if (left < 0.25 * tolerance) break;
      left *= 0.5 * stretch;
    }
  };
  // Displaced points see another correction: by its gradient, some 2 c per length of the way, and more next to a
  // corner.
  double missing = 2.0 * size * size / speed * (1.0 + 0.2 * nearness);
  for (int pass = 0;; ++pass) {
    displace();
    if (missing * t <= 0.25 * tolerance) break;
    if (pass == kMostPasses) return false;
    const LanePair again = corners.correction(a + moved.x, b + moved.y);
    missing = 0.25 * largest(again.x - correction.x, again.y - correction.y);
    correction = again;
    rate = corners.rate(correction);
  }
  Nodes rateA = kWeights * rate.x.cast<double>(), rateB = kWeights * rate.y.cast<double>();
  const Nodes left = t * (1.0 - kPoints);
  // The exponential of the Jacobian, by its first terms.
  const int kept = stretch < 0.25 ? kFewMoments : kMoments;
  std::array<Pair, kMoments> moments;
  for (int k = 0;; ++k) {
    moments[k] = {rateA.sum(), rateB.sum()};
    if (k + 1 == kept) break;
    rateA *= left * (1.0 / (k + 1));
    rateB *= left * (1.0 / (k + 1));
  }
  Pair sum = moments[kept - 1];
  for (int k = kept - 1; k-- > 0;) sum = moments[k] + path.jacobian(sum);
  bend.displacement = t * sum;
  bend.x = correction.x.cast<double>();
  bend.y = correction.y.cast<double>();
  bend.movedA = moved.x.cast<double>();
  bend.movedB = moved.y.cast<double>();
  bend.first = Complex(correction.x[0], correction.y[0]);
  bend.last = Complex(correction.x[3], correction.y[3]);
  const double cubed = stretch * stretch * stretch;
  const double leftOut = kept == kMoments ? cubed * cubed / 5040.0 : cubed * stretch / 120.0;
  bend.error = t * (missing + ruleError(nearness) * cubicPart(correction) + size * leftOut);
  return true;
}

/// Whether a coordinate that is positive at both ends of the way might be negative between them.
bool mayDip(double value0, double rate0, double value1, double rate1, double duration) {
  if (!(rate0 < 0.0 && rate1 > 0.0)) return false;
  return value0 + 0.5 * duration * rate0 < 0.0 || value1 - 0.5 * duration * rate1 < 0.0;
}

/// The corner whose barycentric coordinate grows fastest.
int growing(const FlatFace& face, const std::array<Complex, 3>& values, const Eigen::Vector3d& p) {
  const Complex v = p[0] * face.carry(0, values[0]) + p[1] * face.carry(1, values[1]) + p[2] * face.carry(2, values[2]);
  int corner = 0;
  face.barycentricRate(v).maxCoeff(&corner);
  return corner;
}

}  // namespace

bool stepThroughFace(const FlatFaces& faces, Index f, const std::array<Complex, 3>& values, const SidePoint& entry,
                     const Eigen::Vector3d& inside, const StepLimits& limits, FaceStep& step) {
  const FlatFace& face = faces[f];
  if (face.isExtreme()) return false;
  const bool entering = entry.side >= 0;
  if (!entering && !(inside.minCoeff() > kPlain)) return false;
  const Corners corners(face, values, entering ? entry.side : (growing(face, values, inside) + 1) % 3);
  const Pair start = entering ? Pair(1.0 - entry.fraction, entry.fraction) : Pair(inside[corners.a], inside[corners.b]);
  const AffinePath path(corners, start);
  if (!(path.rate.sum() < 0.0)) return false;

  // Which side, and when: the affine part alone.
  const double size = face.longestSide();
  const Pair met = path.sidesMet();
  int leaving = met[1] < met[0] ? 1 : 0;
  const Index next = face.twin(leaving == 0 ? corners.b : corners.c);
  if (next != kNone) faces.prefetch(TriangleMesh::face(next));
  double t = met[leaving];
  bool across = true;
  if (!(size * path.truncation(t) <= 0.25 * limits.tolerance)) {
    const double reach = path.reach(0.25 * limits.tolerance / size);
    across = t <= reach;
    t = std::min(t, reach);
  }
  if (t > limits.maximalDuration) {
    across = false;
    t = limits.maximalDuration;
  }
  if (!(t < kInfinity)) return false;
  Pair end;
  if (across) {
    double change = 0.0;
    t = path.towards(leaving, t, end, change);
    end = path.at(t);
    if (!(end[1 - leaving] > 0.0)) {
      leaving = 1 - leaving;  // the other side came first
      t = path.towards(leaving, t, end, change);
      end = path.at(t);
    }
    for (int i = 0; i < kMostIterations && std::abs(change) > 0.1 * t; ++i) {
      t = path.towards(leaving, t, end, change);
      end = path.at(t);
    }
    if (!(t > 0.0)) return false;
  }

  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    if (!across) end = path.at(t);
    const Nodes times = t * kPoints;
    Nodes a = path.at(0, times), b = path.at(1, times);
    const auto velocityX = [&]() -> Nodes {
      return a * corners.towardsA.real() + b * corners.towardsB.real() + corners.atC.real();
    };
    const auto velocityY = [&]() -> Nodes {
      return a * corners.towardsA.imag() + b * corners.towardsB.imag() + corners.atC.imag();
    };
    Nodes vx = velocityX(), vy = velocityY();
    double error = size * path.truncation(t);
    Complex endVelocity;
    Pair startRate = path.rate;
    double turning = 0.0;
    if (face.isFlat()) {
      endVelocity = corners.affine(end);
    } else {
      const double speed = std::sqrt((vx * vx + vy * vy).maxCoeff());
      Bend bend;
      const double nearness = nearnessToCorner(start, end);
      if (!findBend(corners, path, a, b, t, speed, nearness, limits.tolerance, bend)) return false;
      error += bend.error;
      a += bend.movedA;
      b += bend.movedB;
      vx = velocityX() + bend.x;
      vy = velocityY() + bend.y;
      end += bend.displacement;
      endVelocity = corners.affine(end) + bend.last;
      startRate += corners.rate(bend.first);
      turning = (1.0 + nearness) * std::abs(bend.last);
    }
    const Pair endRate = corners.rate(endVelocity);
    // Inside all along: neither back over the side of entry nor over another side before.
    if (!(startRate.sum() < 0.0 && (a.min(b).min(1.0 - a - b) > 0.0).all())) return false;
    const Nodes squaredSpeeds = vx * vx + vy * vy;
    if (!(squaredSpeeds.minCoeff() > limits.squaredMinimalSpeed)) return false;
    const Nodes speeds = squaredSpeeds.sqrt();
    const double meanSpeed = (kWeights * speeds).sum();
    double length = t * meanSpeed;
    error += t * meanError(speeds, meanSpeed);
    double late = 0.0;
    if (across) {
      late = -end[leaving] / endRate[leaving];
      length += late * std::sqrt(std::norm(endVelocity));
      // Where the affine part bends and, next to a corner, the correction turns on that way.
      error += late * late * (size * path.jacobian(endRate).abs().sum() + turning / t);
    }
    const double allowed = std::min(limits.tolerance, limits.relativeTolerance * length);
    if (!(error <= allowed)) {
      if (across && std::abs(late) > 1e-3 * t) {
        t += late;
        end = path.at(t);
      } else {
        across = false;
        t *= std::clamp(0.8 * std::sqrt(std::sqrt(allowed / error)), 0.2, 0.7);
      }
      continue;
    }
    const double duration = t + late;
    if (!across) {
      const double third = 1.0 - end[0] - end[1];
      if (!(end.minCoeff() > kPlain && third > kPlain)) return false;
      if (mayDip(start[0], startRate[0], end[0], endRate[0], t) ||
          mayDip(start[1], startRate[1], end[1], endRate[1], t)) {
        return false;
      }
      step.exit = SidePoint{};
      step.barycentric[corners.a] = end[0];
      step.barycentric[corners.b] = end[1];
      step.barycentric[corners.c] = third;
    } else {
      const int other = 1 - leaving;
      const double weight = end[other] + late * endRate[other];
      if (!(weight > kPlain && weight < 1.0 - kPlain && endRate[leaving] < 0.0 && duration > 0.0)) return false;
      if (mayDip(start[other], startRate[other], weight, endRate[other], duration)) return false;
      if (duration > limits.maximalDuration) return false;
      step.exit = leaving == 0 ? SidePoint{corners.b, 1.0 - weight} : SidePoint{corners.c, weight};
    }
    step.duration = duration;
    step.length = length;
    return true;
  }
  return false;
}

}  // namespace stormfield
