#include "design/pair_placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

namespace stormfield {

namespace {

constexpr double kMostMove = 0.85;     // of an edge, for each storm
constexpr double kSafeTurn = 0.45;     // radians short of half a turn: more is not better
constexpr double kLeastArm = 0.6;      // of an edge, from the saddle to each storm
constexpr double kPriceOfMoves = 0.3;  // radians of safety per edge length of all moves together

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

/// Radians by which the fullest turn along an edge stays below half a turn.
double safety(const Patch& patch, Complex a, Complex b, Complex s, double enough) {
  double fullest = 0.0;
  for (const auto& [p, q] : patch.edges) {
    const double turn = std::arg((q - a) / (p - a)) + std::arg((q - b) / (p - b)) - std::arg((q - s) / (p - s));
    fullest = std::max(fullest, std::abs(turn));
    if (std::numbers::pi - fullest < enough) break;
  }
  return std::numbers::pi - fullest;
}

/// Where a storm may go from its path: nowhere, or onto rings around it, first of all away from the other storm.
std::vector<Complex> moves(double edge, Complex away) {
  std::vector<Complex> result = {0.0};
  const std::array<std::pair<double, int>, 4> rings = {{{0.2, 6}, {0.45, 8}, {0.65, 12}, {kMostMove, 16}}};
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

}  // namespace

std::optional<PairPlacement> placePair(const VertexCharts& charts, const ClosestPointQuery& query,
                                       const SurfacePoint& a, const SurfacePoint& b, const Vec3& axis, double edge,
                                       LogMapScratch& scratch) {
  const TriangleMesh& mesh = charts.mesh();
  const Vec3 pa = position(mesh, a), pb = position(mesh, b);
  const SurfacePoint middle = query.closest(Vec3(0.5 * (pa + pb))).point;
  const LogMap map = logMap(charts, middle, (pa - pb).norm() + 3.5 * edge, scratch);
  const Patch patch = patchAround(mesh, map);
  const Complex za = flatPoint(mesh, map, a), zb = flatPoint(mesh, map, b);
  const double apart = std::abs(za - zb);
  Complex along = apart > edge ? za - zb : charts.spaceToFace(middle.face, axis);
  if (std::abs(along) == 0.0) return std::nullopt;
  along /= std::abs(along);

  const std::vector<Complex> movesA = moves(edge, along), movesB = moves(edge, -along);
  double best = -3.0 * kPriceOfMoves;
  std::optional<PairPlacement> placement;
  for (const Complex moveA : movesA) {
    for (const Complex moveB : movesB) {
      const Complex ca = za + moveA, cb = zb + moveB, arm = 0.5 * (ca - cb);
      if (std::abs(arm) < kLeastArm * edge || std::real(arm / along) < 0.5 * std::abs(arm)) continue;
      for (const Complex off : {Complex(0.0), Complex(-0.2), Complex(0.2), Complex(0.0, 0.2), Complex(0.0, -0.2)}) {
        const Complex moveS = off * arm, cs = 0.5 * (ca + cb) + moveS;
        const double price = kPriceOfMoves * (std::abs(moveA) + std::abs(moveB) + std::abs(moveS)) / edge;
        if (kSafeTurn - price <= best) continue;
        const double safe = safety(patch, ca, cb, cs, std::max(0.0, best + price));
        const double score = std::min(kSafeTurn, safe) - price;
        if (safe <= 0.0 || score <= best) continue;
        const auto inA = locate(patch, ca), inB = locate(patch, cb), inS = locate(patch, cs);
        if (!inA || !inB || !inS || inA->face == inB->face || inA->face == inS->face || inB->face == inS->face)
          continue;
        best = score;
        placement = PairPlacement{*inA, *inB, *inS};
      }
    }
  }
  return placement;
}

}  // namespace stormfield
