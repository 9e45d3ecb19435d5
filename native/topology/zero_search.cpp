#include "topology/zero_search.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace stormfield {
namespace {

constexpr int kNewtonSteps = 30;
constexpr int kCuts = 45;
/// |V| at a zero, as part of the largest corner vector: round-off of a blend of three.
constexpr double kZero = 4e-15;

double cross(Complex a, Complex b) {
  return a.real() * b.imag() - a.imag() * b.real();
}

/// Turn from a to b in (-pi, pi].
double turnBetween(Complex a, Complex b) {
  return std::arg(b * std::conj(a));
}

Eigen::Vector3d clamped(Eigen::Vector3d b) {
  b = b.cwiseMax(0.0);
  return b / b.sum();
}

struct Candidate {
  Complex point = 0.0;
  double magnitude = std::numeric_limits<double>::infinity();
  bool signFits = false;

  bool better(const Candidate& other) const {
    const bool zero = magnitude <= kZero, otherZero = other.magnitude <= kZero;
    if (zero != otherZero) return zero;
    if (zero && signFits != other.signFits) return signFits;
    return magnitude < other.magnitude;
  }
};

/// A corner of a part of the face. Corners of the face itself have no single vector: it depends on the approach.
struct Node {
  Complex point;
  int corner = -1;
};

class FaceSearch {
 public:
  FaceSearch(const FaceInterpolant& local, int index) : local_(local), index_(index) {}

  Candidate newton(Complex start) const {
    Candidate best;
    Complex p = start;
    for (int step = 0; step < kNewtonSteps; ++step) {
      const Complex value = local_.evaluate(p);
      const Eigen::Matrix2d j = local_.jacobian(p);
      const double det = j.determinant();
      const Candidate here{p, std::abs(value), det * index_ > 0.0};
      if (here.better(best)) best = here;
      // Beyond round-off further steps would only wander.
      if (det == 0.0 || (here.magnitude <= kZero && here.signFits)) break;
      const Complex move((j(1, 1) * value.real() - j(0, 1) * value.imag()) / det,
                         (j(0, 0) * value.imag() - j(1, 0) * value.real()) / det);
      const Complex next = local_.point(clamped(local_.barycentric(p - move)));
      if (next == p) break;
      p = next;
    }
    return best;
  }

  /// The zero of the blend of the corner vectors as the centroid sees them.
  Complex linearGuess() const {
    const Complex centroid = (local_.corners[0] + local_.corners[1] + local_.corners[2]) / 3.0;
    std::array<Complex, 3> seen;
    for (int i = 0; i < 3; ++i) seen[i] = local_.towards(i, centroid - local_.corners[i]);
    Eigen::Vector3d b(cross(seen[1], seen[2]), cross(seen[2], seen[0]), cross(seen[0], seen[1]));
    if (b.sum() < 0.0) b = -b;
    return b.minCoeff() >= 0.0 && b.sum() > 0.0 ? local_.point(b / b.sum()) : centroid;
  }

  Candidate cut(Candidate best) const {
    std::array<Node, 3> part{Node{local_.corners[0], 0}, Node{local_.corners[1], 1}, Node{local_.corners[2], 2}};
    for (int round = 0; round < kCuts; ++round) {
      part = windingChild(part);
      const Candidate found = newton((part[0].point + part[1].point + part[2].point) / 3.0);
      if (found.better(best)) best = found;
      if (best.magnitude <= kZero && best.signFits) break;
    }
    return best;
  }

 private:
  Complex valueAt(const Node& at, const Node& seenFrom) const {
    return at.corner < 0 ? local_.evaluate(at.point) : limitAt(at.corner, seenFrom.point);
  }
  Complex limitAt(int corner, Complex from) const { return local_.towards(corner, from - local_.corners[corner]); }

  /// Turn along the segment, halved until each piece is unmistakable.
  double turn(const Node& a, const Node& b, int depth) const {
    const double whole = turnBetween(valueAt(a, b), valueAt(b, a));
    if (depth >= 2 && (std::abs(whole) < 0.8 || depth > 30)) return whole;
    const Node middle{0.5 * (a.point + b.point)};
    return turn(a, middle, depth + 1) + turn(middle, b, depth + 1);
  }

  int winding(const std::array<Node, 3>& part) const {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const Node &at = part[k], &onward = part[(k + 1) % 3], &before = part[(k + 2) % 3];
      sum += turn(at, onward, 0);
      if (at.corner >= 0) {
        sum += local_.twist[at.corner] * turnBetween(before.point - at.point, onward.point - at.point);
      }
    }
    return static_cast<int>(std::lround(sum / (2.0 * std::numbers::pi)));
  }

  std::array<Node, 3> windingChild(const std::array<Node, 3>& part) const {
    const Node m0{0.5 * (part[1].point + part[2].point)}, m1{0.5 * (part[2].point + part[0].point)},
        m2{0.5 * (part[0].point + part[1].point)};
    const std::array<std::array<Node, 3>, 4> children{
        {{m0, m1, m2}, {part[0], m2, m1}, {m2, part[1], m0}, {m1, m0, part[2]}}};
    int chosen = 0, most = 0;
    for (int c = 0; c < 4; ++c) {
      const int fitting = winding(children[c]) * (index_ > 0 ? 1 : -1);
      if (fitting > most || (most == 0 && fitting < 0)) {
        chosen = c;
        most = std::max(fitting, 0);
      }
    }
    return children[chosen];
  }

  const FaceInterpolant& local_;
  int index_;
};

}  // namespace

Eigen::Vector3d findZero(const FaceInterpolant& local, int index) {
  FaceInterpolant unit = local;
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (local.carried[i] == 0.0) return Eigen::Vector3d::Unit(i);
    largest = std::max(largest, std::abs(local.carried[i]));
  }
  for (Complex& vector : unit.carried) vector /= largest;

  const FaceSearch search(unit, index);
  Candidate best = search.newton(search.linearGuess());
  if (best.magnitude > kZero || !best.signFits) best = search.cut(best);
  return clamped(unit.barycentric(best.point));
}

}  // namespace stormfield
