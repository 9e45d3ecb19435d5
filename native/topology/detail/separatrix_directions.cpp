#include "topology/detail/separatrix_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "field/interpolation.h"
#include "topology/detail/sectors.h"

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;
/// Radius of the circle that is searched over the square root of the face's double area: far above the round-off of the
/// point itself.
constexpr double kRadius = 1e-5;
/// Directions tried in 2 pi, and at least in each sector.
constexpr int kSamples = 180, kMinSamples = 8;
constexpr int kBisections = 60;
/// Length of a separatrix' first step over the square root of the face's double area.
constexpr double kFirstStep = 1e-3;

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

/// Whether the field points to the left of the sector's first direction.
bool isLeftAtBegin(const VectorField& field, const Sector& sector) {
  const FaceInterpolant local = faceInterpolant(field, sector.face);
  return Ray{local, sector.apex, kRadius * std::sqrt(local.doubleArea)}.around(sector.from) >= 0.0;
}

/// Adds the directions of one sector in which the field is radial: where the component around the apex changes its
/// sign. after: the sector that begins where this one ends, if any. Its sign at their common direction counts for both:
/// along an edge, where symmetric fields have their separatrices, two faces differ by round-off.
void searchSector(const VectorField& field, const Sector& sector, const Sector* after,
                  std::vector<SeparatrixDirection>& found) {
  const FaceInterpolant local = faceInterpolant(field, sector.face);
  const Ray ray{local, sector.apex, kRadius * std::sqrt(local.doubleArea)};
  const int samples = std::max(kMinSamples, static_cast<int>(std::ceil(kSamples * sector.opening / (2.0 * kPi))));
  double low = sector.from;
  bool leftAtLow = ray.around(low) >= 0.0;
  for (int i = 1; i <= samples; ++i) {
    const double high = sector.from + sector.opening * i / samples;
    const bool leftAtHigh = i == samples && after != nullptr ? isLeftAtBegin(field, *after) : ray.around(high) >= 0.0;
    if (leftAtLow != leftAtHigh) {
      double a = low, b = high;
      for (int step = 0; step < kBisections; ++step) {
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

}  // namespace

std::vector<SeparatrixDirection> separatrixDirections(const VectorField& field, const SurfacePoint& p) {
  std::vector<SeparatrixDirection> radial;
  const std::vector<Sector> sectors = sectorsAround(*field.charts, p);
  const bool around = surroundsPoint(*field.charts, p, sectors);
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    const bool last = i + 1 == sectors.size();
    searchSector(field, sectors[i], last && !around ? nullptr : &sectors[(i + 1) % sectors.size()], radial);
  }
  // Between two radial directions of one kind lies a parabolic sector: its border is none.
  std::vector<SeparatrixDirection> result;
  for (std::size_t i = 0; i < radial.size(); ++i) {
    const SeparatrixDirection& next = radial[(i + 1) % radial.size()];
    const SeparatrixDirection& before = radial[(i + radial.size() - 1) % radial.size()];
    if (next.outgoing != radial[i].outgoing || before.outgoing != radial[i].outgoing) result.push_back(radial[i]);
  }
  return result;
}

SurfacePoint separatrixStart(const FlatFaces& faces, const SurfacePoint& p, const SeparatrixDirection& d) {
  const FlatFace& flat = faces[d.face];
  Complex apex = flat.point(p.barycentric);
  for (const Sector& sector : sectorsAround(faces.charts(), p)) {
    if (sector.face == d.face) apex = sector.apex;
  }
  // At most halfway to the border of the face.
  const Eigen::Vector3d b = flat.barycentric(apex), rate = flat.barycentricRate(d.direction);
  double step = kFirstStep * std::sqrt(2.0 * faces.mesh().faceArea(d.face));
  for (int k = 0; k < 3; ++k) {
    if (rate[k] < 0.0 && b[k] > 0.0) step = std::min(step, -0.5 * b[k] / rate[k]);
  }
  Eigen::Vector3d start = (b + step * rate).cwiseMax(0.0);
  start /= start.sum();
  return {d.face, start};
}

}  // namespace stormfield
