#include <gtest/gtest.h>

#include <algorithm>

#include "base/message.h"
#include "checks.h"
#include "flows.h"
#include "long_tests.h"

namespace stormfield::test {
namespace {

int count(const Topology& topology, OrbitKind kind) {
  return static_cast<int>(std::count_if(topology.periodicOrbits.begin(), topology.periodicOrbits.end(),
                                        [&](const PeriodicOrbit& orbit) { return orbit.kind == kind; }));
}

double meanRadius(const VectorField& field, const PeriodicOrbit& orbit) {
  double sum = 0.0;
  for (const SurfacePoint& p : orbit.points) sum += position(field.mesh(), p).norm();
  return sum / static_cast<double>(orbit.points.size());
}

void expectClosed(const VectorField& field, const PeriodicOrbit& orbit, const std::string& what) {
  ASSERT_GE(orbit.points.size(), 3u) << what;
  ASSERT_EQ(orbit.points.size(), orbit.times.size()) << what;
  EXPECT_EQ(orbit.points.front().face, orbit.points.back().face) << what;
  EXPECT_EQ(orbit.points.front().barycentric, orbit.points.back().barycentric) << what;
  EXPECT_EQ(orbit.times.front(), 0.0) << what;
  EXPECT_NEAR(orbit.times.back(), orbit.period, 1e-12 * orbit.period) << what;
  EXPECT_TRUE(std::is_sorted(orbit.times.begin(), orbit.times.end())) << what;
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < orbit.points.size(); ++i) {
    length += (position(field.mesh(), orbit.points[i + 1]) - position(field.mesh(), orbit.points[i])).norm();
  }
  EXPECT_NEAR(length, orbit.length, 0.02 * orbit.length) << what;
}

// Where equation 3.1 itself comes back to the positive y axis, by Newton's method on a fine Runge-Kutta trace.
double returnOfEquation31(double y) {
  constexpr double kStep = 1e-3;
  Vec3 p(0.0, y, 0.0);
  while (true) {
    const Vec3 k1 = equation31(p), k2 = equation31(p + 0.5 * kStep * k1), k3 = equation31(p + 0.5 * kStep * k2),
               k4 = equation31(p + kStep * k3);
    const Vec3 next = p + kStep / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    if (p.x() < 0.0 && next.x() >= 0.0) return p.y() + (next.y() - p.y()) * -p.x() / (next.x() - p.x());
    p = next;
  }
}

double exactHeight(double near) {
  double a = near - 0.3, b = near + 0.3, atA = returnOfEquation31(a) - a;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (a + b), d = returnOfEquation31(middle) - middle;
    ((d > 0.0) == (atA > 0.0) ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

double heightOnAxis(const VectorField& field, const PeriodicOrbit& orbit) {
  for (std::size_t i = 0; i + 1 < orbit.points.size(); ++i) {
    const Vec3 a = position(field.mesh(), orbit.points[i]), b = position(field.mesh(), orbit.points[i + 1]);
    if (a.x() <= 0.0 && b.x() > 0.0) return a.y() + (b.y() - a.y()) * -a.x() / (b.x() - a.x());
  }
  return 0.0;
}

TEST(PeriodicOrbits, OfEquation31AreExactlyN) {
  const int cells = shortOrLong(10, 40);  // in 2 pi
  for (const int n : shortOrLong<std::vector<int>>({1, 2, 3, 6, 10}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10})) {
    const VectorField field = sampledOn(scaled(grid(cells * (n + 1)), (n + 0.999) * kPi), equation31);
    const Topology topology = topologyOf(field);
    ASSERT_EQ(topology.periodicOrbits.size(), static_cast<std::size_t>(n));
    // From the middle outwards they attract and repel in turn, all linked in a chain that begins at the source.
    std::vector<std::pair<double, OrbitKind>> rings;
    for (const PeriodicOrbit& orbit : topology.periodicOrbits) {
      expectClosed(field, orbit, message("n = ", n));
      rings.emplace_back(meanRadius(field, orbit), orbit.kind);
    }
    std::sort(rings.begin(), rings.end());
    for (int i = 0; i < n; ++i) {
      EXPECT_EQ(rings[i].second, i % 2 == 0 ? OrbitKind::Attracting : OrbitKind::Repelling);
    }
    ASSERT_EQ(topology.fixedPoints.size(), 1u);
    EXPECT_EQ(topology.links.size(), static_cast<std::size_t>(n));
  }
}

TEST(PeriodicOrbits, OfEquation31HaveTheRightRadii) {
  // Linear interpolation moves an orbit by the square of the edge length. Cells of 2 pi / 40 keep those of n = 1, 2 and
  // 5 within 1e-3, cells of 2 pi / 80 those of every n up to 10 (1.5 million faces).
  const int cells = shortOrLong(40, 80);
  for (const int n : shortOrLong<std::vector<int>>({1, 2, 5}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10})) {
    const VectorField field = sampledOn(scaled(grid(cells * (n + 1), 0.2), (n + 0.999) * kPi), equation31);
    const Topology topology = topologyOf(field);
    ASSERT_EQ(topology.periodicOrbits.size(), static_cast<std::size_t>(n));
    for (const PeriodicOrbit& orbit : topology.periodicOrbits) {
      const double height = heightOnAxis(field, orbit);
      EXPECT_NEAR(height, exactHeight(height), 1e-3) << "n = " << n;
    }
  }
}

/// r' = growth r - r^3, angle' = turning.
SpaceFunction hopf(double growth, double turning) {
  return [=](const Vec3& p) {
    const double radial = growth - p.squaredNorm();
    return Vec3(radial * p.x() - turning * p.y(), radial * p.y() + turning * p.x(), 0.0);
  };
}

TEST(PeriodicOrbits, OfHopfNormalForms) {
  for (const double turning : {1.0, -0.7}) {
    for (const double growth : {0.2, 0.5}) {
      const VectorField field = sampledOn(grid(shortOrLong(100, 200), 0.2), hopf(growth, turning));
      const Topology topology = topologyOf(field);
      const std::string what = message("growth ", growth, ", turning ", turning);
      ASSERT_EQ(topology.periodicOrbits.size(), 1u) << what;
      const PeriodicOrbit& orbit = topology.periodicOrbits[0];
      expectClosed(field, orbit, what);
      EXPECT_EQ(orbit.kind, OrbitKind::Attracting) << what;
      EXPECT_NEAR(meanRadius(field, orbit), std::sqrt(growth), 1e-3) << what;
      EXPECT_NEAR(orbit.period, 2.0 * kPi / std::abs(turning), 1e-3) << what;
      EXPECT_NEAR(std::log(orbit.multiplier), -2.0 * growth * orbit.period, 2e-2) << what;
      EXPECT_NEAR(turnsAround(field.mesh(), orbit.points, Vec3::Zero()), turning > 0.0 ? 1.0 : -1.0, 1e-9) << what;
      ASSERT_EQ(topology.links.size(), 1u);
      EXPECT_EQ(topology.links[0].source, (EntityRef{EntityKind::FixedPoint, 0}));
      EXPECT_EQ(topology.links[0].target, (EntityRef{EntityKind::PeriodicOrbit, 0}));
    }
  }
}

TEST(PeriodicOrbits, BeforeAHopfBifurcationAreNone) {
  const Topology topology = topologyOf(sampledOn(grid(60, 0.2), hopf(-0.1, 1.0)));
  EXPECT_TRUE(topology.periodicOrbits.empty());
  EXPECT_EQ(topology.fixedPoints[0].kind, FixedPointKind::Sink);
}

TEST(PeriodicOrbits, NestOnSpheres) {
  // Latitudes turn around the axis and drift along it: orbits where the drift vanishes.
  const int level = shortOrLong(3, 5), rings = shortOrLong(20, 64);
  const std::vector<int> all{1, 3, 7};
  const std::vector<std::pair<Surface, std::vector<int>>> cases = {
      {icosphere(level), shortOrLong({7}, all)},
      {uvSphere(rings, 3 * rings / 2), shortOrLong({3}, all)},
      {bumpySphere(level, 0.01), shortOrLong({1}, all)}};
  for (const auto& [s, numbers] : cases) {
    for (const int orbits : numbers) {
      const VectorField field = sampledOn(s, [orbits](const Vec3& p) {
        const Vec3 east(-p.y(), p.x(), 0.0), north = Vec3::UnitZ() - p.z() * p;
        return Vec3(east + 0.5 * std::sin(0.5 * orbits * kPi * p.z()) * north);
      });
      const Topology topology = topologyOf(field);
      ASSERT_EQ(topology.periodicOrbits.size(), static_cast<std::size_t>(orbits));
      for (const PeriodicOrbit& orbit : topology.periodicOrbits) {
        // At z = 2 i / orbits, repelling where i is even.
        const double i = 0.5 * orbits * position(field.mesh(), orbit.points[0]).normalized().z();
        EXPECT_NEAR(i, std::round(i), shortOrLong(0.05, 0.02)) << orbits;
        const bool repelling = static_cast<int>(std::abs(std::round(i))) % 2 == 0;
        EXPECT_EQ(orbit.kind, repelling ? OrbitKind::Repelling : OrbitKind::Attracting) << orbits;
        EXPECT_NEAR(turnsAround(field.mesh(), orbit.points, Vec3::Zero()), 1.0, 1e-9);
      }
      // From pole to pole.
      EXPECT_EQ(topology.links.size(), static_cast<std::size_t>(orbits + 1));
    }
  }
}

/// A field on the torus from its two angular speeds.
VectorField onTorus(const Surface& s, const std::function<Complex(double, double)>& speeds) {
  return sampledOn(s, [&](const Vec3& p) {
    const double u = std::atan2(p.y(), p.x()), ring = std::hypot(p.x(), p.y()) - 1.0;
    const double v = std::atan2(p.z(), ring), small = std::hypot(ring, p.z());
    const Vec3 along(-p.y(), p.x(), 0.0);
    const Vec3 across = small * Vec3(-std::sin(v) * std::cos(u), -std::sin(v) * std::sin(u), std::cos(v));
    const Complex speed = speeds(u, v);
    return Vec3(speed.real() * along + speed.imag() * across);
  });
}

TEST(PeriodicOrbits, AroundTheHoleOfATorus) {
  for (const int k : {1, 2, 3}) {
    for (const double sign : shortOrLong<std::vector<double>>({k == 2 ? -1.0 : 1.0}, {1.0, -1.0})) {
      const VectorField field = onTorus(torus(shortOrLong(36, 90), shortOrLong(24, 60)),
                                        [&](double, double v) { return Complex(sign, 0.5 * std::sin(k * v + 0.3)); });
      const Topology topology = topologyOf(field);
      EXPECT_TRUE(topology.fixedPoints.empty());
      ASSERT_EQ(topology.periodicOrbits.size(), static_cast<std::size_t>(2 * k)) << k;
      EXPECT_EQ(count(topology, OrbitKind::Attracting), k);
      for (const PeriodicOrbit& orbit : topology.periodicOrbits) {
        EXPECT_NEAR(turnsAround(field.mesh(), orbit.points, Vec3::Zero()), sign, 1e-9);
        EXPECT_NEAR(orbit.period, 2.0 * kPi, shortOrLong(4e-2, 1e-2));  // as the square of the edge length
      }
      // Each repelling one leads to the attracting ones beside it.
      EXPECT_EQ(topology.links.size(), static_cast<std::size_t>(k == 1 ? 1 : 2 * k));
    }
  }
}

TEST(PeriodicOrbits, AlongVertices) {
  // The orbits are rows of vertices and edges.
  const VectorField field = onTorus(torus(30, 20), [](double, double v) { return Complex(1.0, 0.5 * std::sin(v)); });
  const Topology topology = topologyOf(field);
  EXPECT_EQ(topology.periodicOrbits.size(), 2u);
  EXPECT_EQ(count(topology, OrbitKind::Attracting), 1);
  EXPECT_EQ(count(topology, OrbitKind::Repelling), 1);
}

TEST(PeriodicOrbits, ThatWindAroundATorusSeveralTimes) {
  const std::vector<std::pair<int, int>> few{{1, 2}, {3, 2}}, all{{1, 2}, {2, 1}, {2, 3}, {3, 2}};
  for (const auto& [p, q] : shortOrLong(few, all)) {
    const VectorField field =
        onTorus(torus(shortOrLong(30, 120), shortOrLong(20, 80)), [p = p, q = q](double u, double v) {
          const double drift = 0.4 * std::sin(p * v - q * u);
          return Complex(p, q + drift);
        });
    const Topology topology = topologyOf(field);
    ASSERT_EQ(topology.periodicOrbits.size(), 2u) << p << ", " << q;
    EXPECT_EQ(count(topology, OrbitKind::Attracting), 1);
    EXPECT_EQ(count(topology, OrbitKind::Repelling), 1);
    for (const PeriodicOrbit& orbit : topology.periodicOrbits) {
      EXPECT_NEAR(turnsAround(field.mesh(), orbit.points, Vec3::Zero()), p, 1e-9);
    }
  }
}

TEST(PeriodicOrbits, AroundAHandleOfGenusTwo) {
  // Around the first hole of the plate, drawn to its inner wall's middle height.
  const Surface s = plateWithHoles(2, 6);
  const Vec3 hole(9.0, 9.0, 3.0);
  const VectorField field = sampledOn(s, [&](const Vec3& p) {
    const Vec3 d = p - hole;
    const double weight = std::exp(-d.head<2>().squaredNorm() / 30.0);
    return Vec3(weight * Vec3(-d.y(), d.x(), -1.5 * d.z()) + 0.15 * Vec3(1.0, 0.4, 0.2));
  });
  const Topology topology = topologyOf(field);
  int around = 0;
  for (const PeriodicOrbit& orbit : topology.periodicOrbits) {
    expectClosed(field, orbit, "genus 2");
    around += std::lround(turnsAround(field.mesh(), orbit.points, hole)) == 1 ? 1 : 0;
  }
  EXPECT_GE(around, 1);
}

TEST(PeriodicOrbits, AroundAFocusAcrossTwoFacesTakeManySteps) {
  // A rough field on a coarse surface: one of its orbits winds closely around a source, hundreds of steps in one face.
  TopologyOptions options;
  options.maxSteps = 20000;
  const auto charts = makeCharts(joined(icosphere(1), torus(8, 6), {4, 0, 0}));
  const Topology topology = topologyOf(randomField(charts, 2), options);
  for (const Separatrix& s : topology.separatrices) EXPECT_LT(s.points.size(), 2000u);
}

TEST(PeriodicOrbits, InABandAreOneEntry) {
  const auto turning = [](const Vec3& p) { return Vec3(-p.y(), p.x(), 0.0); };
  for (const Surface& s : {grid(24, 0.3), grid(24), annulus(60, 8)}) {
    const Topology topology = topologyOf(sampledOn(s, turning));
    ASSERT_EQ(topology.periodicOrbits.size(), 1u);
    EXPECT_EQ(topology.periodicOrbits[0].kind, OrbitKind::Center);
    EXPECT_NEAR(topology.periodicOrbits[0].period, 2.0 * kPi, 0.2);
    EXPECT_NEAR(topology.periodicOrbits[0].multiplier, 1.0, 1e-2);
    EXPECT_TRUE(topology.links.empty());
  }
}

TEST(PeriodicOrbits, OfTheReversedFieldAreTheSameTheOtherWayRound) {
  const VectorField field = sampledOn(scaled(grid(80, 0.2), 3.999 * kPi), equation31);
  const Topology a = topologyOf(field), b = topologyOf(reversedField(field));
  ASSERT_EQ(a.periodicOrbits.size(), 3u);
  ASSERT_EQ(b.periodicOrbits.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const PeriodicOrbit &p = a.periodicOrbits[i], &q = b.periodicOrbits[i];
    EXPECT_EQ(p.kind == OrbitKind::Attracting, q.kind == OrbitKind::Repelling);
    EXPECT_NEAR(p.length, q.length, 1e-6 * p.length);
    EXPECT_NEAR(p.period, q.period, 1e-6 * p.period);
    EXPECT_NEAR(p.multiplier * q.multiplier, 1.0, 1e-2);
  }
}

}  // namespace
}  // namespace stormfield::test
