// Fields whose topology is known, shared by the tests of it and the benchmark.
#pragma once

#include <cmath>

#include "field/analytic_fields.h"
#include "fixtures.h"
#include "topology/topology.h"

namespace stormfield::test {

using analytic::equation31;

inline VectorField sampledOn(const Surface& s, const SpaceField& field) {
  return sampled(makeCharts(s), field);
}

inline Surface scaled(Surface s, double factor) {
  s.points *= factor;
  return s;
}

/// Waves of a few lengths in random directions.
inline VectorField smoothField(const Surface& s, std::uint64_t seed) {
  Random random(seed);
  struct Wave {
    Vec3 along, amplitude;
    double phase;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 12; ++i) waves.push_back({3.0 * random.vector(), random.vector(), 3.0 * random.uniform()});
  return sampledOn(s, [&](const Vec3& p) {
    Vec3 sum = Vec3::Zero();
    for (const Wave& w : waves) sum += w.amplitude * std::sin(w.along.dot(p) + w.phase);
    return sum;
  });
}

inline VectorField reversedField(VectorField field) {
  for (Complex& v : field.values) v = -v;
  return field;
}

inline Topology topologyOf(const VectorField& field, const TopologyOptions& options = {}) {
  const FlatFaces faces(field.charts);
  return findTopology(faces, field, options);
}

/// Counter-clockwise angles around the z axis that a curve goes through, in full turns.
inline double turnsAround(const TriangleMesh& mesh, const std::vector<SurfacePoint>& curve, const Vec3& centre) {
  double turns = 0.0;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const Vec3 a = position(mesh, curve[i]) - centre, b = position(mesh, curve[i + 1]) - centre;
    turns += std::arg(Complex(b.x(), b.y()) * Complex(a.x(), -a.y()));
  }
  return turns / (2.0 * kPi);
}

}  // namespace stormfield::test
