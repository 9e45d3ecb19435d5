#include "maps/detail/cone_transit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/message.h"
#include "maps/error_bound.h"
#include "tracing/face_path.h"
#include "tracing/flow.h"

namespace stormfield {
namespace {

/// Largest error of one step, in mean edges and as a part of its length; steps within one face.
constexpr double kTolerance = 1e-7, kRelative = 2e-6;
constexpr int kMostSteps = 400;
/// Where no closed form holds: a step's part of the longest side, at most and at least, and of the distance from the
/// nearest corner, and how many there are before the closed form is tried again.
constexpr double kSmallStep = 1.0 / 32, kSmallestStep = 1e-6, kOfCorner = 0.2;
constexpr int kSmallSteps = 8;
constexpr double kSmallest = 1e-9;
/// Part of a side about a corner that extremes do not start in, but beyond it.
constexpr double kCorner = 1e-5;
/// Where the crossing of an edge changes, to spare, and the same for components in parts of their vector.
constexpr double kTurn = 1e-9, kRoundOff = 1e-12;
/// Cones half as wide as this (80 degrees) bound next to nothing: then epsilon is this part of what a fixed point
/// needs.
constexpr double kWidest = 0.984807753012208;

double around(double from, double to) {
  const double way = to - from;
  return way < 0.0 ? way + 3.0 : way;
}

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

/// Takes some small steps along a trajectory through a face; where it leaves, or kRest while it is inside.
double takeSmallSteps(const FlatFace& face, const std::array<Complex, 3>& values, Eigen::Vector3d& inside) {
  const CarriedVectors vectors = face.carry(values[0], values[1], values[2]);
  const auto ahead = [&](Complex from, double step) {  // Runge and Kutta
    const auto part = [&](Complex at) {
      const Complex v = face.evaluate(vectors, at);
      return step * v / std::abs(v);
    };
    const Complex a = part(from), b = part(from + 0.5 * a), c = part(from + 0.5 * b), d = part(from + c);
    return from + (a + 2.0 * b + 2.0 * c + d) / 6.0;
  };
  Complex p = face.point(inside);
  for (int i = 0; i < kSmallSteps; ++i) {
    double step = kSmallStep * face.longestSide();
    for (int k = 0; k < 3; ++k) step = std::min(step, kOfCorner * std::abs(p - face.corner(k)));
    step = std::max(step, kSmallestStep * face.longestSide());
    const Complex next = ahead(p, step);
    inside = face.barycentric(next);
    if (!inside.allFinite()) return FaceTransit::kRest;
    if (inside.minCoeff() >= 0.0) {
      p = next;
      continue;
    }
    double low = 0.0, high = step;
    while (high - low > kSmallest * step) {
      const double middle = 0.5 * (low + high);
      const Eigen::Vector3d there = face.barycentric(ahead(p, middle));
      (there.minCoeff() >= 0.0 ? low : high) = middle;
    }
    int corner = 0;  // opposite to the side
    inside = face.barycentric(ahead(p, high));
    inside.minCoeff(&corner);
    const int side = (corner + 1) % 3, head = (corner + 2) % 3;
    const double tailPart = std::max(0.0, inside[side]), headPart = std::max(0.0, inside[head]);
    return tailPart + headPart > 0.0 ? side + headPart / (tailPart + headPart) : FaceTransit::kRest;
  }
  return FaceTransit::kRest;
}

}  // namespace

ConeTransit::ConeTransit(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
                         double epsilon, const std::vector<double>& weights)
    : ConeTransit(
          [&] {
            auto given = std::make_shared<Given>();
            given->weights = checkedWeights(*field, weights);
            given->faceEpsilon = fixedPointEpsilons(*field, weights);
            given->ends.resize(field->mesh().edgeCount());
            tbb::parallel_for(Index{0}, field->mesh().edgeCount(),
                              [&](Index e) { given->ends[e] = endVectors(*field, field->mesh().edgeHalfedge(e)); });
            given->faces = std::move(faces);
            given->field = std::move(field);
            return given;
          }(),
          epsilon) {}

ConeTransit::ConeTransit(std::shared_ptr<const Given> given, double epsilon)
    : given_(std::move(given)), epsilon_(epsilon), resting_(given_->faceEpsilon.size()) {
  if (!(epsilon >= 0.0) || !std::isfinite(epsilon)) {
    throw InputError(message("the error bound eps is ", epsilon, "; give a number >= 0"));
  }
  std::transform(given_->faceEpsilon.begin(), given_->faceEpsilon.end(), resting_.begin(),
                 [=](double from) { return epsilon >= kWidest * from ? 1 : 0; });
}

ConeTransit ConeTransit::withinEpsilon(double epsilon) const {
  return {given_, epsilon};
}

EndVectors ConeTransit::endsOf(Index h) const {
  const Index e = mesh().edge(h);
  const EndVectors& ends = given_->ends[e];
  return mesh().edgeHalfedge(e) == h ? ends : EndVectors{-ends.head, -ends.tail};
}

int ConeTransit::crossing(Index e, double from, double to) const {
  const Index h = mesh().edgeHalfedge(e);
  const EndVectors& ends = given_->ends[e];
  const double tail = epsilon_ * given_->weights[mesh().tail(h)], head = epsilon_ * given_->weights[mesh().head(h)];
  const auto certain = [&](double x) {
    const Complex v = blend(ends, x);
    const double error = (1.0 - x) * tail + x * head + kRoundOff * std::abs(v);
    return std::abs(v.imag()) > error ? (v.imag() > 0.0 ? 1 : -1) : 0;
  };
  const int first = certain(from);
  return first == certain(to) ? first : 0;
}

std::vector<double> ConeTransit::turns(Index e) const {
  const Index h = mesh().edgeHalfedge(e);
  const EndVectors& ends = given_->ends[e];
  const double tail = epsilon_ * given_->weights[mesh().tail(h)], head = epsilon_ * given_->weights[mesh().head(h)];
  std::vector<double> result;
  for (const double sign : {1.0, -1.0}) {
    // Positive where flow crosses in the direction of the sign only.
    const double atTail = sign * ends.tail.imag() - tail, atHead = sign * ends.head.imag() - head;
    if ((atTail > 0.0) == (atHead > 0.0)) continue;
    const double at = atTail / (atTail - atHead) + (atTail > 0.0 ? -kTurn : kTurn);
    if (at > kTurn && at < 1.0 - kTurn) result.push_back(at);
  }
  std::sort(result.begin(), result.end());
  return result;
}

ExitArcs ConeTransit::leaving(Index f, int side, double begin, double end) const {
  const double alpha = std::asin(std::min(1.0, epsilon_ / given_->faceEpsilon[f]));
  const EndVectors ends = endsOf(TriangleMesh::halfedge(f, side));
  const Complex atBegin = blend(ends, begin), atEnd = blend(ends, end), turn = std::polar(1.0, alpha);
  // Where the cone's extremes enter, and with them some of the fields within the bound.
  const auto right = notNegative(begin, end, (atBegin * std::conj(turn)).imag(), (atEnd * std::conj(turn)).imag());
  const auto left = notNegative(begin, end, (atBegin * turn).imag(), (atEnd * turn).imag());
  ExitArcs result;
  const auto add = [&](double from, double to) { result.add(leavingPart(f, side, from, to, alpha)); };
  if (right && left && std::max(right->begin, left->begin) <= std::min(right->end, left->end)) {
    add(std::min(right->begin, left->begin), std::max(right->end, left->end));
  } else {
    if (right) add(right->begin, right->end);
    if (left) add(left->begin, left->end);
  }
  takeOutBeyondTouching(f, side, begin, end, alpha, result);
  return result;
}

void ExitArcs::takeOut(const BoundaryArc& part) {
  const ExitArcs all = std::exchange(*this, {});
  for (const auto& [begin, length] : all) {
    // Seen from the arc's begin: up to the part, and beyond it; it may also reach over the begin.
    const double to = around(begin, part.begin), beyond = to + part.length, from = std::max(0.0, beyond - 3.0);
    const auto keep = [&, start = begin](double first, double last) {
      if (first <= last) add({std::fmod(start + first, 3.0), last - first});
    };
    keep(from, std::min(to, length));
    keep(beyond, length);
  }
}

/// What does not enter beyond a place where extremes touch the boundary from within does not leave before them.
void ConeTransit::takeOutBeyondTouching(Index f, int side, double begin, double end, double alpha,
                                        ExitArcs& arcs) const {
  for (int s = 0; s < 3; ++s) {
    const EndVectors ends = endsOf(TriangleMesh::halfedge(f, s));
    for (const double sign : {-1.0, 1.0}) {  // to the right, to the left
      const Complex turned = std::polar(1.0, sign * (alpha + 2.0 * kSpare));
      const Complex tail = ends.tail * turned, head = ends.head * turned;
      const bool entersBeyond = sign * tail.imag() > 0.0 && sign * head.imag() < 0.0;
      if (!entersBeyond) continue;
      const double touch = tail.imag() / (tail.imag() - head.imag());
      const bool goesOn = sign * ((1.0 - touch) * tail.real() + touch * head.real()) < 0.0;
      if (!goesOn || touch < kCorner || touch > 1.0 - kCorner) continue;
      const double at = s + touch;
      const bool reached = std::any_of(arcs.begin(), arcs.end(),
                                       [&](const BoundaryArc& arc) { return around(arc.begin, at) <= arc.length; });
      if (!reached) continue;
      const double to = leaves(f, s, touch, sign * (alpha + kSpare));
      if (to == FaceTransit::kRest) continue;
      const BoundaryArc beyond = sign < 0.0 ? BoundaryArc{at, around(at, std::fmod(to, 3.0))}
                                            : BoundaryArc{std::fmod(to, 3.0), around(std::fmod(to, 3.0), at)};
      const auto isBeyond = [&](double position) {
        const double in = around(beyond.begin, position);
        return in > 0.0 && in < beyond.length;
      };
      if (isBeyond(side + begin) || isBeyond(side + end) || isBeyond(side + 0.5 * (begin + end))) continue;
      arcs.takeOut(beyond);
    }
  }
}

/// What enters over all of a part leaves over this arc, or over the part.
BoundaryArc ConeTransit::leavingPart(Index f, int side, double begin, double end, double alpha) const {
  const double first = extreme(f, side, begin, end, alpha, Side::Right);
  const double last = extreme(f, side, begin, end, alpha, Side::Left);
  const double length = around(first, last), back = around(last, first);
  // As round-off may change the order of the two.
  constexpr double kNear = 1e-3;
  const bool inOrder = length <= around(first, std::fmod(side + begin, 3.0)) + kNear;
  if (inOrder && length < 3.0 - kNear) return {first, length};
  return back < kNear ? BoundaryArc{last, back} : BoundaryArc{0.0, 3.0};
}

/// Where the extreme from the right end of a part of a side leaves, or that from the left end; the end itself where the
/// extreme bounds nothing.
double ConeTransit::extreme(Index f, int side, double begin, double end, double alpha, Side which) const {
  const bool isRight = which == Side::Right;
  const double turn = isRight ? -alpha - kSpare : alpha + kSpare, at = isRight ? end : begin;
  const double none = std::fmod(side + at, 3.0);
  const Complex turned = std::polar(1.0, turn);
  const auto enters = [&](int s, double x) {
    return (blend(endsOf(TriangleMesh::halfedge(f, s)), x) * turned).imag() > 0.0;
  };
  if (!enters(side, begin) || !enters(side, end)) return none;
  // At a corner it starts beyond it, if it enters there.
  int from = side;
  double fraction = std::clamp(at, kCorner, 1.0 - kCorner);
  if (isRight && at > 1.0 - kCorner) {
    from = (side + 1) % 3;
    fraction = kCorner;
  } else if (!isRight && at < kCorner) {
    from = (side + 2) % 3;
    fraction = 1.0 - kCorner;
  }
  if (from != side && !enters(from, fraction)) return none;
  const double to = leaves(f, from, fraction, turn);
  return to == FaceTransit::kRest ? none : std::fmod(to, 3.0);
}

/// Where the trajectory of the field turned by an angle leaves; kRest where it is lost.
double ConeTransit::leaves(Index f, int side, double fraction, double turn) const {
  const FlatFace& face = (*given_->faces)[f];
  const Complex turned = std::polar(1.0, turn);
  std::array<Complex, 3> values = SteadyFlow(given_->field->values.data(), 1.0).vertexValues(face);
  for (Complex& value : values) value *= turned;
  const FaceFlow flow(face, values);
  const StepLimits limits{kTolerance * mesh().meanEdgeLength(), kRelative, 0.0};
  SidePoint entry{side, fraction};
  Eigen::Vector3d inside = Eigen::Vector3d::Zero();
  inside[side] = 1.0 - fraction;
  inside[(side + 1) % 3] = fraction;
  for (int i = 0; i < kMostSteps; ++i) {
    FaceStep step;
    const bool plain = stepThroughFace(flow, entry, inside, limits, step);
    entry = {};
    if (!plain) {
      const double to = takeSmallSteps(face, values, inside);
      if (to != FaceTransit::kRest) return to;
    } else if (step.exit.side >= 0) {
      return step.exit.side + step.exit.fraction;
    } else {
      inside = step.barycentric;
    }
  }
  return FaceTransit::kRest;
}

}  // namespace stormfield
