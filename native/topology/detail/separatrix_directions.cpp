#include "topology/detail/separatrix_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;
/// Nearer than this (barycentric) to an edge or a vertex is on it.
constexpr double kOnBorder = 1e-6;
/// Radius of the circle that is searched, in lengths of the face: far above the round-off of the point itself.
constexpr double kRadius = 1e-5;
/// Directions tried around a full turn.
constexpr int kSamples = 180;

/// The field seen from the apex of a sector in one direction.
struct Ray {
  const FaceInterpolant& local;
  Complex apex;
  double radius;

  Complex value(double angle) const {
    const Complex direction = std::polar(1.0, angle);
    return local.evaluate(apex + radius * direction) * std::conj(direction);
  }
  /// Component around the apex; zero where the field is radial.
  double around(double angle) const { return value(angle).imag(); }
};

/// Whether the field turns to the left of the direction in which the sector begins.
bool beginsLeft(const VectorField& field, const Sector& sector) {
  const FaceInterpolant local = faceInterpolant(field, sector.face);
  return Ray{local, sector.apex, kRadius * std::sqrt(local.doubleArea)}.around(sector.from) >= 0.0;
}

/// after: the sector that begins where this one ends, if any. What it says about their common direction holds for both:
/// along an edge, where symmetric fields have their separatrices, two faces differ by round-off.
void searchSector(const VectorField& field, const Sector& sector, const Sector* after,
                  std::vector<SeparatrixDirection>& found) {
  const FaceInterpolant local = faceInterpolant(field, sector.face);
  const Ray ray{local, sector.apex, kRadius * std::sqrt(local.doubleArea)};
  const int samples = std::max(8, static_cast<int>(std::ceil(kSamples * sector.opening / (2.0 * kPi))));
  double low = sector.from;
  bool leftAtLow = ray.around(low) >= 0.0;
  for (int i = 1; i <= samples; ++i) {
    const double high = sector.from + sector.opening * i / samples;
    const bool leftAtHigh = i == samples && after != nullptr ? beginsLeft(field, *after) : ray.around(high) >= 0.0;
    if (leftAtLow != leftAtHigh) {
      double a = low, b = high;
      for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (a + b);
        ((ray.around(middle) >= 0.0) == leftAtLow ? a : b) = middle;
      }
      const Complex direction = std::polar(1.0, 0.5 * (a + b));
      found.push_back({sector.face, direction, field.charts->faceToSpace(sector.face, direction),
                       ray.value(0.5 * (a + b)).real() > 0.0});
    }
    low = high;
    leftAtLow = leftAtHigh;
  }
}

bool isWholeTurn(const VertexCharts& charts, const SurfacePoint& p, const std::vector<Sector>& sectors) {
  const TriangleMesh& mesh = charts.mesh();
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] >= 1.0 - kOnBorder) return !mesh.isBoundaryVertex(mesh.vertex(p.face, k));
  }
  return sectors.size() > 1 || sectors.front().opening > 1.5 * kPi;
}

}  // namespace

std::vector<Sector> sectorsAround(const VertexCharts& charts, const SurfacePoint& p) {
  const TriangleMesh& mesh = charts.mesh();
  const auto corner = [&](Index h) {
    const Index f = TriangleMesh::face(h), h0 = 3 * f;
    if (h == h0) return Complex(0.0);
    if (h == h0 + 1) return Complex(mesh.edgeLength(mesh.edge(h0)));
    return std::polar(mesh.edgeLength(mesh.edge(h0 + 2)), mesh.cornerAngle(h0));
  };
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] < 1.0 - kOnBorder) continue;
    std::vector<Sector> fan;
    for (Index h = mesh.outgoing(mesh.vertex(p.face, k)); h != kNone; h = mesh.nextOutgoing(h)) {
      fan.push_back({TriangleMesh::face(h), corner(h), charts.faceAngle(h), mesh.cornerAngle(h)});
    }
    return fan;
  }
  for (int k = 0; k < 3; ++k) {
    if (p.barycentric[k] > kOnBorder) continue;
    const Index h = TriangleMesh::halfedge(p.face, (k + 1) % 3), twin = mesh.twin(h);
    const double fraction = p.barycentric[(k + 2) % 3] / (p.barycentric[(k + 1) % 3] + p.barycentric[(k + 2) % 3]);
    const auto half = [&](Index side, double along) {
      const Complex apex = (1.0 - along) * corner(side) + along * corner(TriangleMesh::next(side));
      return Sector{TriangleMesh::face(side), apex, charts.faceAngle(side), kPi};
    };
    if (twin == kNone) return {half(h, fraction)};
    return {half(h, fraction), half(twin, 1.0 - fraction)};
  }
  const Index h = 3 * p.face;
  const Complex apex = p.barycentric[1] * corner(h + 1) + p.barycentric[2] * corner(h + 2);
  return {{p.face, apex, 0.0, 2.0 * kPi}};
}

std::vector<SeparatrixDirection> separatrixDirections(const VectorField& field, const SurfacePoint& p) {
  std::vector<SeparatrixDirection> radial;
  const std::vector<Sector> sectors = sectorsAround(*field.charts, p);
  // At a boundary the last sector is followed by none.
  const bool around = isWholeTurn(*field.charts, p, sectors);
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    const bool last = i + 1 == sectors.size();
    searchSector(field, sectors[i], last && !around ? nullptr : &sectors[(i + 1) % sectors.size()], radial);
  }
  std::vector<SeparatrixDirection> result;
  for (std::size_t i = 0; i < radial.size(); ++i) {
    const SeparatrixDirection& next = radial[(i + 1) % radial.size()];
    const SeparatrixDirection& before = radial[(i + radial.size() - 1) % radial.size()];
    if (next.outgoing != radial[i].outgoing || before.outgoing != radial[i].outgoing) result.push_back(radial[i]);
  }
  return result;
}

}  // namespace stormfield
