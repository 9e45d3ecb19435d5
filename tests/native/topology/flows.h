// Fields whose topology is known, shared by the tests of it and the benchmark.
#pragma once

#include <cmath>
#include <functional>

#include "fixtures.h"
#include "topology/topology.h"

namespace stormfield::test {

using SpaceFunction = std::function<Vec3(const Vec3&)>;

inline VectorField sampledOn(const Surface& s, const SpaceFunction& function) {
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = function(s.points.row(v));
  return fromSpace(makeCharts(s), vectors);
}

inline Surface scaled(Surface s, double factor) {
  s.points *= factor;
  return s;
}

/// Thesis equation 3.1: exactly n periodic orbits inside the radius (n + 1) pi.
inline Vec3 equation31(const Vec3& p) {
  return {p.y(), -p.x() + p.y() * std::cos(p.x()), 0.0};
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
