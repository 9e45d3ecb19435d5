#include "topology/detail/orbit_band.h"

#include <cmath>

namespace stormfield {
namespace {

/// |component across| over the sum of those at both ends: below, the flow runs along the edge and says nothing there.
constexpr double kMinAcross = 0.1;
/// Where on the edge that stands in for a vertex the flow is tested, as a fraction from the vertex.
constexpr double kBesideVertex = 0.05;
/// Edges that a closed streamline of the band may cross, over those of the orbit.
constexpr Index kMaxLengthening = 4;

/// A point of an edge, with the halfedge whose face the flow enters.
struct EdgePlace {
  Index halfedge;
  double fraction;
};

/// The edge of the passage as the field itself crosses it; nothing where the field runs along it.
std::optional<EdgePlace> crossedByField(const VectorField& field, const EdgePassage& passage) {
  EdgePlace place{passage.halfedge, passage.fraction};
  if (place.halfedge == kNone) {
    place = {crossedAt(field, passage.vertex, HalfedgeEnd::Tail), kBesideVertex};
    if (place.halfedge == kNone) return std::nullopt;
  }
  const auto ends = acrossEnds(field, place.halfedge);
  const double across = (1.0 - place.fraction) * ends[0] + place.fraction * ends[1];
  if (std::abs(across) < kMinAcross * (std::abs(ends[0]) + std::abs(ends[1]))) return std::nullopt;
  if (across < 0.0) place = {field.mesh().twin(place.halfedge), 1.0 - place.fraction};
  return place;
}

}  // namespace

OrbitBand findBand(const FlatFaces& faces, const VectorField& field, const OrbitSearch& orbits, const FoundOrbit& found,
                   Index component, double tolerance, double bandTolerance, const Progress* progress) {
  OrbitBand band;
  for (const SurfacePoint& p : found.orbit.points) band.faces.push_back(p.face);
  VectorField rotated = field;
  for (Complex& v : rotated.values) v *= Complex(0.0, 1.0);
  const SurfacePoint start =
      found.bestSection.section.point(field.mesh(), found.bestSection.position, Direction::Forward);
  for (const OrbitSide side : kOrbitSides) {
    CrossingTrace across(faces, rotated, side == OrbitSide::Left ? Direction::Forward : Direction::Backward, tolerance);
    across.run(start, [&](const SurfacePoint& p, double, const EdgePassage& passage) {
      if (progress != nullptr) progress->check();
      const auto place = passage ? crossedByField(field, passage) : std::nullopt;
      if (!place) return true;
      const auto closed = orbits.facesIfClosed(place->halfedge, place->fraction, component,
                                               kMaxLengthening * found.crossings, bandTolerance);
      if (!closed) {
        band.ends[side] = p;
        return false;
      }
      band.faces.insert(band.faces.end(), closed->begin(), closed->end());
      return true;
    });
  }
  return band;
}

}  // namespace stormfield
