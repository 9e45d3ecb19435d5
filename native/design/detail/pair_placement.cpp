#include "design/detail/pair_placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace stormfield {

namespace {

constexpr double kMaxMove = 0.85;       // of an edge, for each element
constexpr double kEnoughSafety = 0.45;  // radians below pi: more is not better
constexpr double kMinArm = 0.6;         // of an edge, from the saddle to each element
constexpr double kPriceOfMoves = 0.3;   // radians of safety per edge length of all moves together

/// The surface around the middle of the pair, flat.
struct Patch {
  std::vector<Index> faces;
  std::vector<std::array<Complex, 3>> corners;
  std::vector<std::pair<Complex, Complex>> edges;
};

Complex flat(const LogMapEntry& entry) {
  return std::polar(entry.distance, entry.angle);
}

Patch patchAround(const TriangleMesh& mesh, const LogMap& map) {
  std::set<Index> faces, edges;
  for (const LogMapEntry& entry : map.entries)
    for (Index h = mesh.outgoing(entry.vertex); h != kNone; h = mesh.nextOutgoing(h))
      faces.insert(TriangleMesh::face(h));
  Patch patch;
  for (const Index f : faces) {
    std::array<Complex, 3> corners;
    bool whole = true;
    for (int k = 0; k < 3; ++k) {
      const LogMapEntry* entry = map.find(mesh.vertex(f, k));
      whole = whole && entry;
      if (entry) corners[k] = flat(*entry);
    }
    if (!whole) continue;
    patch.faces.push_back(f);
    patch.corners.push_back(corners);
    for (int k = 0; k < 3; ++k)
      if (edges.insert(mesh.edge(TriangleMesh::halfedge(f, k))).second)
        patch.edges.emplace_back(corners[k], corners[(k + 1) % 3]);
  }
  return patch;
}

double cross(Complex a, Complex b) {
  return a.real() * b.imag() - a.imag() * b.real();
}

/// The face of the patch that holds z, strictly inside.
std::optional<SurfacePoint> locate(const Patch& patch, Complex z) {
  for (std::size_t i = 0; i < patch.faces.size(); ++i) {
    const auto& [p, q, r] = patch.corners[i];
    const double area = cross(q - p, r - p);
    if (!(area > 0.0)) continue;
    const Eigen::Vector3d b(cross(q - z, r - z) / area, cross(r - z, p - z) / area, cross(p - z, q - z) / area);
    if (b.minCoeff() > 0.0) return SurfacePoint{patch.faces[i], b};
  }
  return std::nullopt;
}

/// Radians by which the largest rotation along an edge stays below pi.
double safety(const Patch& patch, Complex a, Complex b, Complex s, double enough) {
  double largest = 0.0;
  for (const auto& [p, q] : patch.edges) {
    const double angle = std::arg((q - a) / (p - a)) + std::arg((q - b) / (p - b)) - std::arg((q - s) / (p - s));
    largest = std::max(largest, std::abs(angle));
    if (std::numbers::pi - largest < enough) break;
  }
  return std::numbers::pi - largest;
}

/// Moves of an element from its path: none, or onto rings around it, first of all away from the other element.
std::vector<Complex> moves(double edge, Complex away) {
  std::vector<Complex> result = {0.0};
  const std::array<std::pair<double, int>, 4> rings = {{{0.2, 6}, {0.45, 8}, {0.65, 12}, {kMaxMove, 16}}};
  for (const auto& [radius, count] : rings)
    for (int i = 0; i < count; ++i)
      result.push_back(std::polar(radius * edge, std::arg(away) + 2.0 * std::numbers::pi * i / count));
  return result;
}

/// Flat coordinates of a surface point, or of the middle itself when its face was not reached.
Complex flatPoint(const TriangleMesh& mesh, const LogMap& map, const SurfacePoint& p) {
  Complex z = 0.0;
  for (int k = 0; k < 3; ++k) {
    const LogMapEntry* entry = map.find(mesh.vertex(p.face, k));
    if (entry) z += p.barycentric[k] * flat(*entry);
  }
  return z;
}

/// Elements and saddle in flat coordinates, and their score in radians.
struct Candidate {
  Complex a, b, saddle;
  double score = -std::numeric_limits<double>::infinity();
};

/// The pair's paths and its neighbourhood.
class Search {
 public:
  Search(Patch patch, Complex pathA, Complex pathB, Complex along, double edge)
      : patch_(std::move(patch)), pathA_(pathA), pathB_(pathB), along_(along), edge_(edge) {}

  /// A grid of moves, then small steps to the best places.
  Candidate best() const {
    Candidate best;
    for (const Complex moveA : moves(edge_, along_))
      for (const Complex moveB : moves(edge_, -along_))
        for (const Complex off : {Complex(0.0), Complex(-0.2), Complex(0.2), Complex(0.0, 0.2), Complex(0.0, -0.2)}) {
          const Complex a = pathA_ + moveA, b = pathB_ + moveB;
          improve(best, a, b, 0.5 * (a + b) + 0.5 * off * (a - b));
        }
    constexpr int kDirections = 8;
    for (const double step : {0.2, 0.1, 0.05})
      for (int i = 0; i < kDirections; ++i) {
        const Complex by = std::polar(step * edge_, 2.0 * std::numbers::pi * i / kDirections);
        const Candidate from = best;
        improve(best, from.a + by, from.b, from.saddle);
        improve(best, from.a, from.b + by, from.saddle);
        improve(best, from.a, from.b, from.saddle + by);
      }
    return best;
  }

  std::optional<PairPlacement> place(const Candidate& candidate) const {
    const auto a = locate(patch_, candidate.a), b = locate(patch_, candidate.b), s = locate(patch_, candidate.saddle);
    if (!a || !b || !s || a->face == b->face || a->face == s->face || b->face == s->face) return std::nullopt;
    return PairPlacement{*a, *b, *s};
  }

 private:
  /// Replaces best where the three places are allowed, safe and better.
  void improve(Candidate& best, Complex a, Complex b, Complex saddle) const {
    const double moveA = std::abs(a - pathA_), moveB = std::abs(b - pathB_);
    const double moveS = std::abs(saddle - 0.5 * (a + b));
    if (std::max(moveA, moveB) > kMaxMove * edge_ * (1.0 + 1e-9)) return;
    const Complex arm = 0.5 * (a - b);
    if (std::abs(arm) < kMinArm * edge_ || std::real(arm / along_) < 0.5 * std::abs(arm)) return;
    const double price = kPriceOfMoves * (moveA + moveB + moveS) / edge_;
    if (kEnoughSafety - price <= best.score) return;
    const double safe = safety(patch_, a, b, saddle, std::max(0.0, best.score + price));
    const double score = std::min(kEnoughSafety, safe) - price;
    const Candidate candidate{a, b, saddle, score};
    if (safe > 0.0 && score > best.score && place(candidate)) best = candidate;
  }

  Patch patch_;
  Complex pathA_, pathB_, along_;
  double edge_;
};

}  // namespace

std::optional<PairPlacement> placePair(const VertexCharts& charts, const ClosestPointQuery& query,
                                       const SurfacePoint& a, const SurfacePoint& b, const Vec3& axis, double edge,
                                       LogMapScratch& scratch) {
  const TriangleMesh& mesh = charts.mesh();
  const Vec3 pa = position(mesh, a), pb = position(mesh, b);
  const SurfacePoint middle = query.closest(Vec3(0.5 * (pa + pb))).point;
  const LogMap map = logMap(charts, middle, (pa - pb).norm() + 3.5 * edge, scratch);
  const Complex za = flatPoint(mesh, map, a), zb = flatPoint(mesh, map, b);
  const Complex along = std::abs(za - zb) > edge ? za - zb : charts.spaceToFace(middle.face, axis);
  if (std::abs(along) == 0.0) return std::nullopt;
  const Search search(patchAround(mesh, map), za, zb, along / std::abs(along), edge);
  const Candidate best = search.best();
  return std::isfinite(best.score) ? search.place(best) : std::nullopt;
}

}  // namespace stormfield
