#include "maps/detail/cone_transit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "maps/detail/error_checks.h"
#include "maps/error_bound.h"
#include "tracing/face_flow.h"
#include "tracing/face_path.h"
#include "tracing/flow.h"

namespace stormfield {
namespace {

/// Largest error of one step, in mean edge lengths and as a fraction of the step: below kSpare (radians).
constexpr double kTolerance = 1e-7, kRelative = 2e-6;
/// Steps within one face after which a trajectory counts as lost.
constexpr int kMaxSteps = 400;
/// Where no closed form holds, Runge-Kutta steps of this fraction of the longest side, or of this fraction of the
/// distance from the nearest corner, about which the correction for curvature turns; after kSmallSteps of them the
/// closed form is tried again.
constexpr double kSmallStep = 1.0 / 32, kMinSmallStep = 1e-6, kOfCornerDistance = 0.2;
constexpr int kSmallSteps = 8;
/// Accuracy of an exit, as a fraction of the last small step.
constexpr double kExitAccuracy = 1e-9;
/// Fraction of a side next to a corner in which extremes do not start: they start beyond the corner.
constexpr double kCorner = 1e-5;
/// Fraction of an edge by which its sign changes are moved towards the piece that is crossed both ways, against
/// round-off, and the round-off of a component as a fraction of its vector.
constexpr double kSignChangeMargin = 1e-9, kRoundOff = 1e-12;
/// sin(80 degrees): a cone of half that width or more bounds next to nothing. It is reached where epsilon is this
/// fraction of the least epsilon for a fixed point; the face then counts as one that may hold it.
constexpr double kWidestCone = 0.984807753012208;
/// Positions that are the same but for the errors of tracing.
constexpr double kSamePosition = 1e-3;

Complex blend(const EndVectors& ends, double x) {
  return (1.0 - x) * ends.tail + x * ends.head;
}

struct Interval {
  double begin, end;
};

/// Where a linear function is not negative, between two places with these values.
std::optional<Interval> notNegative(double begin, double end, double atBegin, double atEnd) {
  if (atBegin < 0.0 && atEnd < 0.0) return std::nullopt;
  if (atBegin >= 0.0 && atEnd >= 0.0) return Interval{begin, end};
  const double zero = begin + (end - begin) * atBegin / (atBegin - atEnd);
  return atBegin >= 0.0 ? Interval{begin, zero} : Interval{zero, end};
}

/// Takes some small steps along a trajectory through a face. Its exit, or none while it is inside.
ExitPosition takeSmallSteps(const FlatFace& face, const std::array<Complex, 3>& values, Eigen::Vector3d& inside) {
  const CarriedVectors vectors = face.carry(values[0], values[1], values[2]);
  // Runge-Kutta of order 4, at unit speed.
  const auto ahead = [&](Complex from, double step) {
    const auto stage = [&](Complex at) {
      const Complex v = face.evaluate(vectors, at);
      return step * v / std::abs(v);
    };
    const Complex a = stage(from), b = stage(from + 0.5 * a), c = stage(from + 0.5 * b), d = stage(from + c);
    return from + (a + 2.0 * b + 2.0 * c + d) / 6.0;
  };
  Complex p = face.point(inside);
  for (int i = 0; i < kSmallSteps; ++i) {
    double step = kSmallStep * face.longestSide();
    for (int k = 0; k < 3; ++k) step = std::min(step, kOfCornerDistance * std::abs(p - face.corner(k)));
    step = std::max(step, kMinSmallStep * face.longestSide());
    const Complex next = ahead(p, step);
    inside = face.barycentric(next);
    if (!inside.allFinite()) return kNoExit;
    if (inside.minCoeff() >= 0.0) {
      p = next;
      continue;
    }
    double low = 0.0, high = step;
    while (high - low > kExitAccuracy * step) {
      const double middle = 0.5 * (low + high);
      const Eigen::Vector3d there = face.barycentric(ahead(p, middle));
      (there.minCoeff() >= 0.0 ? low : high) = middle;
    }
    int corner = 0;  // opposite to the side
    inside = face.barycentric(ahead(p, high));
    inside.minCoeff(&corner);
    const int side = (corner + 1) % 3, head = (corner + 2) % 3;
    const double tailWeight = std::max(0.0, inside[side]), headWeight = std::max(0.0, inside[head]);
    if (!(tailWeight + headWeight > 0.0)) return kNoExit;
    return side + headWeight / (tailWeight + headWeight);
  }
  return kNoExit;
}

}  // namespace

std::shared_ptr<const ConeTransit::Shared> ConeTransit::share(std::shared_ptr<const FlatFaces> faces,
                                                              std::shared_ptr<const VectorField> field,
                                                              const std::vector<double>& weights) {
  auto shared = std::make_shared<Shared>();
  shared->weights = checkedWeights(*field, weights);
  shared->faceEpsilon = fixedPointEpsilons(*field, weights);
  shared->ends.resize(field->mesh().edgeCount());
  tbb::parallel_for(Index{0}, field->mesh().edgeCount(),
                    [&](Index e) { shared->ends[e] = endVectors(*field, field->mesh().edgeHalfedge(e)); });
  shared->faces = std::move(faces);
  shared->field = std::move(field);
  return shared;
}

ConeTransit::ConeTransit(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
                         double epsilon, const std::vector<double>& weights)
    : ConeTransit(share(std::move(faces), std::move(field), weights), epsilon) {}

ConeTransit::ConeTransit(std::shared_ptr<const Shared> shared, double epsilon)
    : shared_(std::move(shared)), epsilon_(epsilon), mayHoldFixedPoint_(shared_->faceEpsilon.size()) {
  checkEpsilon(epsilon);
  std::transform(shared_->faceEpsilon.begin(), shared_->faceEpsilon.end(), mayHoldFixedPoint_.begin(),
                 [=](double least) { return epsilon >= kWidestCone * least ? 1 : 0; });
}

ConeTransit ConeTransit::withinEpsilon(double epsilon) const {
  return {shared_, epsilon};
}

EndVectors ConeTransit::endsOf(Index h) const {
  const Index e = mesh().edge(h);
  const EndVectors& ends = shared_->ends[e];
  return mesh().edgeHalfedge(e) == h ? ends : EndVectors{-ends.head, -ends.tail};
}

int ConeTransit::crossingSign(Index e, double from, double to) const {
  const Index h = mesh().edgeHalfedge(e);
  const EndVectors& ends = shared_->ends[e];
  const double tail = epsilon_ * shared_->weights[mesh().tail(h)], head = epsilon_ * shared_->weights[mesh().head(h)];
  const auto commonSign = [&](double x) {
    const Complex v = blend(ends, x);
    const double error = (1.0 - x) * tail + x * head + kRoundOff * std::abs(v);
    return std::abs(v.imag()) > error ? (v.imag() > 0.0 ? 1 : -1) : 0;
  };
  const int sign = commonSign(from);
  return sign == commonSign(to) ? sign : 0;
}

std::vector<double> ConeTransit::signChanges(Index e) const {
  const Index h = mesh().edgeHalfedge(e);
  const EndVectors& ends = shared_->ends[e];
  const double tail = epsilon_ * shared_->weights[mesh().tail(h)], head = epsilon_ * shared_->weights[mesh().head(h)];
  std::vector<double> result;
  for (const double sign : {1.0, -1.0}) {
    // Positive where all fields cross in the direction of the sign.
    const double atTail = sign * ends.tail.imag() - tail, atHead = sign * ends.head.imag() - head;
    if ((atTail > 0.0) == (atHead > 0.0)) continue;
    const double at = atTail / (atTail - atHead) + (atTail > 0.0 ? -kSignChangeMargin : kSignChangeMargin);
    if (at > kSignChangeMargin && at < 1.0 - kSignChangeMargin) result.push_back(at);
  }
  std::sort(result.begin(), result.end());
  return result;
}

ExitArcs ConeTransit::exitArcs(Index f, int side, double begin, double end) const {
  const double alpha = std::asin(std::min(1.0, epsilon_ / shared_->faceEpsilon[f]));
  const EndVectors ends = endsOf(TriangleMesh::halfedge(f, side));
  const Complex atBegin = blend(ends, begin), atEnd = blend(ends, end), rotation = std::polar(1.0, alpha);
  // Where the extremes enter, and with them some of the fields within the bound.
  const auto right =
      notNegative(begin, end, (atBegin * std::conj(rotation)).imag(), (atEnd * std::conj(rotation)).imag());
  const auto left = notNegative(begin, end, (atBegin * rotation).imag(), (atEnd * rotation).imag());
  ExitArcs result;
  const auto add = [&](double from, double to) { result.add(exitArc(f, side, from, to, alpha)); };
  if (right && left && std::max(right->begin, left->begin) <= std::min(right->end, left->end)) {
    add(std::min(right->begin, left->begin), std::max(right->end, left->end));
  } else {
    if (right) add(right->begin, right->end);
    if (left) add(left->begin, left->end);
  }
  removeBeyondTangencies(f, side, begin, end, alpha, result);
  return result;
}

void ExitArcs::remove(const BoundaryArc& arc) {
  const ExitArcs all = std::exchange(*this, {});
  for (const auto& [begin, length] : all) {
    // Lengths from the begin: up to the removed arc, and beyond it. The removed arc may also reach over the begin.
    const double to = arcLength(begin, arc.begin), beyond = to + arc.length, from = std::max(0.0, beyond - 3.0);
    const auto keep = [&, start = begin](double first, double last) {
      if (first <= last) add({std::fmod(start + first, 3.0), last - first});
    };
    keep(from, std::min(to, length));
    keep(beyond, length);
  }
}

/// Removes what only flow reaches that enters beyond a place where an extreme touches the boundary from inside.
void ConeTransit::removeBeyondTangencies(Index f, int side, double begin, double end, double alpha,
                                         ExitArcs& arcs) const {
  for (int s = 0; s < 3; ++s) {
    const EndVectors ends = endsOf(TriangleMesh::halfedge(f, s));
    for (const double sign : {-1.0, 1.0}) {  // to the right, to the left
      const Complex rotation = std::polar(1.0, sign * (alpha + 2.0 * kSpare));
      const Complex tail = ends.tail * rotation, head = ends.head * rotation;
      const bool entersBeyond = sign * tail.imag() > 0.0 && sign * head.imag() < 0.0;
      if (!entersBeyond) continue;
      const double tangency = tail.imag() / (tail.imag() - head.imag());
      const bool continues = sign * ((1.0 - tangency) * tail.real() + tangency * head.real()) < 0.0;
      if (!continues || tangency < kCorner || tangency > 1.0 - kCorner) continue;
      const double at = s + tangency;
      const bool reached = std::any_of(arcs.begin(), arcs.end(),
                                       [&](const BoundaryArc& arc) { return arcLength(arc.begin, at) <= arc.length; });
      if (!reached) continue;
      const ExitPosition exit = exitOfRotated(f, s, tangency, sign * (alpha + kSpare));
      if (!exit.exists()) continue;
      const double to = std::fmod(*exit, 3.0);
      const BoundaryArc beyond = sign < 0.0 ? BoundaryArc{at, arcLength(at, to)} : BoundaryArc{to, arcLength(to, at)};
      const auto isBeyond = [&](double position) {
        const double fromBegin = arcLength(beyond.begin, position);
        return fromBegin > 0.0 && fromBegin < beyond.length;
      };
      if (isBeyond(side + begin) || isBeyond(side + end) || isBeyond(side + 0.5 * (begin + end))) continue;
      arcs.remove(beyond);
    }
  }
}

/// What enters over all of a part leaves over this arc, or over the part.
BoundaryArc ConeTransit::exitArc(Index f, int side, double begin, double end, double alpha) const {
  const double first = exitOfExtreme(f, side, begin, end, alpha, Side::Right);
  const double last = exitOfExtreme(f, side, begin, end, alpha, Side::Left);
  const double length = arcLength(first, last), back = arcLength(last, first);
  // Errors of tracing may change the order of two exits that are nearly the same.
  const bool isInOrder = length <= arcLength(first, std::fmod(side + begin, 3.0)) + kSamePosition;
  if (isInOrder && length < 3.0 - kSamePosition) return {first, length};
  return back < kSamePosition ? BoundaryArc{last, back} : kWholeBoundary;
}

/// Where the right extreme from the end of a part of a side leaves, or the left extreme from its begin; that end itself
/// where the extreme bounds nothing.
double ConeTransit::exitOfExtreme(Index f, int side, double begin, double end, double alpha, Side which) const {
  const bool isRight = which == Side::Right;
  const double angle = isRight ? -alpha - kSpare : alpha + kSpare, at = isRight ? end : begin;
  const double endItself = std::fmod(side + at, 3.0);
  const Complex rotation = std::polar(1.0, angle);
  const auto enters = [&](int s, double x) {
    return (blend(endsOf(TriangleMesh::halfedge(f, s)), x) * rotation).imag() > 0.0;
  };
  if (!enters(side, begin) || !enters(side, end)) return endItself;
  // At a corner the extreme starts beyond it, if it enters there.
  int from = side;
  double fraction = std::clamp(at, kCorner, 1.0 - kCorner);
  if (isRight && at > 1.0 - kCorner) {
    from = (side + 1) % 3;
    fraction = kCorner;
  } else if (!isRight && at < kCorner) {
    from = (side + 2) % 3;
    fraction = 1.0 - kCorner;
  }
  if (from != side && !enters(from, fraction)) return endItself;
  const ExitPosition exit = exitOfRotated(f, from, fraction, angle);
  return exit.exists() ? std::fmod(*exit, 3.0) : endItself;
}

/// The exit of a trajectory of the field rotated by an angle; none where it is lost.
ExitPosition ConeTransit::exitOfRotated(Index f, int side, double fraction, double angle) const {
  const FlatFace& face = (*shared_->faces)[f];
  const Complex rotation = std::polar(1.0, angle);
  std::array<Complex, 3> values = SteadyFlow(shared_->field->values.data(), 1.0).vertexValues(face);
  for (Complex& value : values) value *= rotation;
  const FaceFlow flow(face, values);
  const StepLimits limits{kTolerance * mesh().meanEdgeLength(), kRelative, 0.0};
  SidePoint entry{side, fraction};
  Eigen::Vector3d inside = Eigen::Vector3d::Zero();
  inside[side] = 1.0 - fraction;
  inside[(side + 1) % 3] = fraction;
  for (int i = 0; i < kMaxSteps; ++i) {
    FaceStep step;
    const bool hasClosedForm = stepThroughFace(flow, entry, inside, limits, step);
    entry = {};
    if (!hasClosedForm) {
      const ExitPosition exit = takeSmallSteps(face, values, inside);
      if (exit.exists()) return exit;
    } else if (step.exit.side >= 0) {
      return step.exit.side + step.exit.fraction;
    } else {
      inside = step.barycentric;
    }
  }
  return kNoExit;
}

}  // namespace stormfield
