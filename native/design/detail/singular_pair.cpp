#include "design/detail/singular_pair.h"

#include <algorithm>
#include <cmath>

namespace stormfield {

namespace {

Complex unit(Complex a) {
  return std::abs(a) > 0.0 ? a / std::abs(a) : Complex(1.0);
}

double mixed(double a, double b, double weightOfB) {
  return a + weightOfB * (b - a);
}

/// Unit factor by which the arrival directions of the other element and of the saddle rotate the field at a.
Complex rotationAt(const TriangleMesh& mesh, const SurfacePoint& a, const LogMap& other, const LogMap& saddle) {
  Complex sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Index v = mesh.vertex(a.face, k);
    const LogMapEntry *eo = other.find(v), *es = saddle.find(v);
    if (eo && es) sum += a.barycentric[k] * eo->arrival * std::conj(es->arrival);
  }
  return unit(sum);
}

}  // namespace

double SingularPair::joint() const {
  const double touching = a.radius + b.radius, inside = std::max(a.radius, b.radius);
  return smoothStep((touching - distance) / (touching - inside));
}

double SingularPair::closeness() const {
  return smoothStep(1.0 - 2.0 * distance / (a.radius + b.radius));
}

std::vector<PairTarget> pairTargets(const TriangleMesh& mesh, const SingularPair& pair, const LogMap& mapA,
                                    const LogMap& mapB, const LogMap& mapSaddle) {
  const double closeness = pair.closeness();
  const double radiusA = mixed(pair.a.radius, pair.single.radius, closeness);
  const double radiusB = mixed(pair.b.radius, pair.single.radius, closeness);
  const Complex rotA = rotation(pair.a.kind) * std::conj(rotationAt(mesh, pair.a.point, mapB, mapSaddle));
  const Complex rotB = rotation(pair.b.kind) * std::conj(rotationAt(mesh, pair.b.point, mapA, mapSaddle));
  const Complex rotSingle = rotation(pair.single.kind);

  std::vector<PairTarget> targets;
  for (const LogMapEntry& ea : mapA.entries) {
    const LogMapEntry *eb = mapB.find(ea.vertex), *es = mapSaddle.find(ea.vertex);
    if (!eb || !es) continue;
    const double fromA = ea.distance, fromB = eb->distance, nearest = std::min(fromA, fromB);
    const double cover = 1.0 - (1.0 - falloff(fromA / radiusA)) * (1.0 - falloff(fromB / radiusB));
    if (!(cover > 0.0)) continue;
    const double weightOfB = fromA * fromA / (fromA * fromA + fromB * fromB);
    const Complex ownRot = unit((1.0 - weightOfB) * rotA + weightOfB * rotB);
    const Complex rot = unit((1.0 - closeness) * ownRot + closeness * rotSingle);
    const double speed = mixed(mixed(pair.a.speed, pair.b.speed, weightOfB), pair.single.speed, closeness);
    const double core = kCore * mixed(radiusA, radiusB, weightOfB);
    // Cores as small as the pair needs to keep three zeros apart, inside the core of the element they become.
    const double small = std::min(core, pair.distance / 3.0);
    const double profile = speedProfile(fromA, small) * speedProfile(fromB, small) * speedProfile(es->distance, small) *
                           std::hypot(nearest, small) / std::hypot(nearest, core);
    targets.push_back({ea.vertex, speed * profile * rot * ea.arrival * eb->arrival * std::conj(es->arrival), cover,
                       std::min(mixed(radiusA, radiusB, weightOfB), std::max(pair.distance, nearest)),
                       fromA < kCore * radiusA || fromB < kCore * radiusB});
  }
  return targets;
}

}  // namespace stormfield
