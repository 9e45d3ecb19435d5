#include "topology/zero_search.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>

namespace stormfield {
namespace {

constexpr int kMaxNewtonSteps = 30;
constexpr int kMaxCuts = 45;  ///< halves the face's sides down to round-off
/// |V| at a zero over the largest corner vector: round-off of a blend of three.
constexpr double kZero = 4e-15;
/// A segment is halved at least and at most so often, and as long as the field rotates by kClearRotation (radians) or
/// more between its ends: a smaller rotation is taken as it is, without a full turn.
constexpr int kMinHalvings = 2, kMaxHalvings = 30;
constexpr double kClearRotation = 0.8;

double cross(Complex a, Complex b) {
  return a.real() * b.imag() - a.imag() * b.real();
}

/// Rotation from a to b in (-pi, pi].
double rotationBetween(Complex a, Complex b) {
  return std::arg(b * std::conj(a));
}

Eigen::Vector3d clamped(Eigen::Vector3d b) {
  b = b.cwiseMax(0.0);
  return b / b.sum();
}

struct ZeroEstimate {
  Complex point = 0.0;
  double magnitude = std::numeric_limits<double>::infinity();
  bool signFits = false;  ///< the Jacobian's determinant has the sign of the index

  bool better(const ZeroEstimate& other) const {
    const bool zero = magnitude <= kZero, otherZero = other.magnitude <= kZero;
    if (zero != otherZero) return zero;
    if (zero && signFits != other.signFits) return signFits;
    return magnitude < other.magnitude;
  }
};

/// A corner of a piece of the face. At a corner of the face itself the field has no single vector: its limit depends on
/// the direction of approach.
struct PieceCorner {
  Complex point;
  std::optional<int> faceCorner = std::nullopt;
};
using Piece = std::array<PieceCorner, 3>;

class FaceSearch {
 public:
  FaceSearch(const FaceInterpolant& local, int index) : local_(local), index_(index) {}

  /// The best estimate on the path of Newton's method, which is kept inside the face.
  ZeroEstimate newton(Complex start) const {
    ZeroEstimate best;
    Complex p = start;
    for (int step = 0; step < kMaxNewtonSteps; ++step) {
      const Complex value = local_.evaluate(p);
      const Eigen::Matrix2d j = local_.jacobian(p);
      const double det = j.determinant();
      const ZeroEstimate here{p, std::abs(value), det * index_ > 0.0};
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

  /// Bisection by degree, with a try of Newton's method from the middle of each piece.
  ZeroEstimate cut(ZeroEstimate best) const {
    Piece piece{PieceCorner{local_.corners[0], 0}, PieceCorner{local_.corners[1], 1},
                PieceCorner{local_.corners[2], 2}};
    for (int round = 0; round < kMaxCuts; ++round) {
      piece = windingQuarter(piece);
      const ZeroEstimate found = newton((piece[0].point + piece[1].point + piece[2].point) / 3.0);
      if (found.better(best)) best = found;
      if (best.magnitude <= kZero && best.signFits) break;
    }
    return best;
  }

 private:
  Complex valueAt(const PieceCorner& at, const PieceCorner& seenFrom) const {
    return at.faceCorner ? limitAt(*at.faceCorner, seenFrom.point) : local_.evaluate(at.point);
  }
  Complex limitAt(int corner, Complex from) const { return local_.towards(corner, from - local_.corners[corner]); }

  /// Rotation of the field along the segment, which is halved until each piece is unmistakable.
  double rotation(const PieceCorner& a, const PieceCorner& b, int depth) const {
    const double whole = rotationBetween(valueAt(a, b), valueAt(b, a));
    if (depth >= kMinHalvings && (std::abs(whole) < kClearRotation || depth > kMaxHalvings)) return whole;
    const PieceCorner middle{0.5 * (a.point + b.point)};
    return rotation(a, middle, depth + 1) + rotation(middle, b, depth + 1);
  }

  /// Poincare index of the piece.
  int winding(const Piece& piece) const {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const PieceCorner &at = piece[k], &onward = piece[(k + 1) % 3], &before = piece[(k + 2) % 3];
      sum += rotation(at, onward, 0);
      if (at.faceCorner) {
        sum += local_.twist[*at.faceCorner] * rotationBetween(before.point - at.point, onward.point - at.point);
      }
    }
    return static_cast<int>(std::lround(sum / (2.0 * std::numbers::pi)));
  }

  /// The quarter whose winding fits the index best.
  Piece windingQuarter(const Piece& piece) const {
    const PieceCorner m0{0.5 * (piece[1].point + piece[2].point)}, m1{0.5 * (piece[2].point + piece[0].point)},
        m2{0.5 * (piece[0].point + piece[1].point)};
    const std::array<Piece, 4> quarters{{{m0, m1, m2}, {piece[0], m2, m1}, {m2, piece[1], m0}, {m1, m0, piece[2]}}};
    int chosen = 0, most = 0;
    for (int c = 0; c < 4; ++c) {
      const int fitting = winding(quarters[c]) * (index_ > 0 ? 1 : -1);
      if (fitting > most || (most == 0 && fitting < 0)) {
        chosen = c;
        most = std::max(fitting, 0);
      }
    }
    return quarters[chosen];
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
  ZeroEstimate best = search.newton(search.linearGuess());
  if (best.magnitude > kZero || !best.signFits) best = search.cut(best);
  return clamped(unit.barycentric(best.point));
}

}  // namespace stormfield
