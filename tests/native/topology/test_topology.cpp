#include "topology/topology.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <set>

#include "base/message.h"
#include "checks.h"
#include "data_sets.h"
#include "flows.h"
#include "long_tests.h"
#include "tracing/streamline.h"

namespace stormfield::test {
namespace {

enum class Role { Repels, Saddle, Attracts, Neither };

Role roleOf(const Topology& topology, const EntityRef& entity) {
  if (entity.kind == EntityKind::PeriodicOrbit) {
    const OrbitKind kind = topology.periodicOrbits[entity.index].kind;
    if (kind == OrbitKind::Attracting) return Role::Attracts;
    return kind == OrbitKind::Repelling ? Role::Repels : Role::Neither;
  }
  switch (topology.fixedPoints[entity.index].kind) {
    case FixedPointKind::Source:
      return Role::Repels;
    case FixedPointKind::Sink:
      return Role::Attracts;
    case FixedPointKind::Saddle:
      return Role::Saddle;
    default:
      return Role::Neither;
  }
}

void expectSound(const VectorField& field, const Topology& topology, const std::string& what) {
  int twice = 0;
  for (const FixedPoint& p : topology.fixedPoints) twice += 2 * p.index;
  for (const BoundaryPoint& p : topology.boundaryPoints) twice += p.halfIndex;
  EXPECT_EQ(twice, 2 * field.mesh().eulerCharacteristic()) << what;

  std::size_t separatrices = 0;
  for (const FixedPoint& p : topology.fixedPoints) {
    separatrices += p.separatrices.size();
    if (p.kind == FixedPointKind::Saddle) {
      EXPECT_EQ(p.separatrices.size(), 4u) << what;
    }
  }
  EXPECT_EQ(topology.separatrices.size(), separatrices) << what;
  for (const Separatrix& s : topology.separatrices) {
    EXPECT_NE(s.end.kind, EntityKind::None) << what << ", saddle " << s.saddle;
    EXPECT_EQ(s.points.size(), s.times.size()) << what;
    EXPECT_TRUE(std::is_sorted(s.times.begin(), s.times.end())) << what;
  }
  std::set<std::pair<EntityRef, EntityRef>> pairs;
  std::size_t drawn = 0;
  for (const EntityLink& link : topology.links) {
    const Role from = roleOf(topology, link.source), to = roleOf(topology, link.target);
    EXPECT_NE(from, Role::Attracts) << what;
    EXPECT_NE(to, Role::Repels) << what;
    EXPECT_TRUE(pairs.emplace(link.source, link.target).second) << what;
    EXPECT_EQ(link.separatrices.empty(), from != Role::Saddle && to != Role::Saddle) << what;
    drawn += link.separatrices.size();
  }
  std::size_t ended = 0;
  for (const Separatrix& s : topology.separatrices) {
    ended += s.end.kind == EntityKind::FixedPoint || s.end.kind == EntityKind::PeriodicOrbit ? 1 : 0;
  }
  EXPECT_EQ(drawn, ended) << what;
}

TEST(Topology, OfSmoothFieldsIsSound) {
  const std::vector<NamedSurface> surfaces = {
      {"sphere", icosphere(4), 2},      {"bumpy sphere", bumpySphere(4, 0.03), 2},
      {"torus", torus(60, 30), 0},      {"genus 2", scaled(plateWithHoles(2, 6), 0.15), -2},
      {"square", grid(40, 0.3), 1},     {"annulus", annulus(60, 16), 0},
      {"cylinder", cylinder(60, 24), 0}};
  for (const NamedSurface& s : surfaces) {
    for (std::uint64_t seed = 0; seed < shortOrLong(3u, 12u); ++seed) {
      const VectorField field = smoothField(s.surface, seed);
      expectSound(field, topologyOf(field), message(s.name, ", seed ", seed));
    }
  }
}

/// Squared distance from a point to the nearest attracting entity.
double distanceToAttractors(const VectorField& field, const Topology& topology, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const FixedPoint& sink : topology.fixedPoints) {
    if (sink.index > 0) nearest = std::min(nearest, (sink.position - p).norm());
  }
  for (const PeriodicOrbit& orbit : topology.periodicOrbits) {
    for (const SurfacePoint& q : orbit.points) nearest = std::min(nearest, (position(field.mesh(), q) - p).norm());
  }
  return nearest;
}

TEST(Topology, HoldsWhereEveryStreamlineGoes) {
  for (const Surface& s : {icosphere(3), torus(45, 20), scaled(plateWithHoles(2, 6), 0.15)}) {
    for (std::uint64_t seed = 0; seed < shortOrLong(2u, 8u); ++seed) {
      for (const VectorField& forward : {smoothField(s, seed), reversedField(smoothField(s, seed))}) {
        const Topology topology = topologyOf(forward);
        const FlatFaces faces(forward.charts);
        Random random(seed);
        std::vector<SurfacePoint> seeds(shortOrLong(50, 150));
        for (SurfacePoint& p : seeds) p = {random.below(forward.mesh().faceCount()), random.barycentric(0.05)};
        const auto ends = traceStreamlineEnds(faces, forward, seeds, {.maxLength = 300.0, .minSpeed = 1e-5});
        for (const TraceEnd& end : ends) {
          const double distance = distanceToAttractors(forward, topology, position(forward.mesh(), end.point));
          EXPECT_LE(distance, forward.mesh().meanEdgeLength()) << "seed " << seed;
        }
      }
    }
  }
}

TEST(Topology, OfRandomVectorsEnds) {
  for (const NamedSurface& s : closedSurfaces()) {
    const auto charts = makeCharts(s.surface);
    for (std::uint64_t seed = 4; seed < shortOrLong(5u, 12u); ++seed) {
      // Integers are the harder ones: zeros at vertices and on edges, flow along edges.
      std::vector<VectorField> fields{randomIntegerField(charts, seed)};
      if (longTests()) fields.push_back(randomField(charts, seed));
      for (const VectorField& field : fields) {
        const Topology topology = topologyOf(field);
        int sum = 0;
        for (const FixedPoint& p : topology.fixedPoints) sum += p.index;
        EXPECT_EQ(sum, s.euler) << s.name << ", seed " << seed;
      }
    }
  }
}

TEST(Topology, OfAMagnetHasALinkWithoutASaddle) {
  const Topology topology =
      topologyOf(sampledOn(icosphere(3), [](const Vec3& p) { return Vec3(Vec3(0.2, -0.1, 1.0) + 0.0 * p); }));
  ASSERT_EQ(topology.fixedPoints.size(), 2u);
  ASSERT_EQ(topology.links.size(), 1u);
  EXPECT_EQ(roleOf(topology, topology.links[0].source), Role::Repels);
  EXPECT_EQ(roleOf(topology, topology.links[0].target), Role::Attracts);
  EXPECT_TRUE(topology.links[0].separatrices.empty());
}

TEST(Topology, OfAPlanarSaddle) {
  const VectorField field = sampledOn(grid(20, 0.3), [](const Vec3& p) { return Vec3(p.x() - 0.03, -p.y(), 0.0); });
  const Topology topology = topologyOf(field);
  ASSERT_EQ(topology.fixedPoints.size(), 1u);
  const FixedPoint& saddle = topology.fixedPoints[0];
  EXPECT_NEAR(saddle.eigenvalues[0].real(), 1.0, 1e-9);
  EXPECT_NEAR(saddle.eigenvalues[1].real(), -1.0, 1e-9);
  EXPECT_NEAR(std::abs(saddle.eigenvectors[0].x()), 1.0, 1e-9);
  EXPECT_NEAR(std::abs(saddle.eigenvectors[1].y()), 1.0, 1e-9);
  ASSERT_EQ(topology.separatrices.size(), 4u);
  for (const Separatrix& s : topology.separatrices) {
    EXPECT_EQ(s.end.kind, EntityKind::Boundary);
    const Vec3 end = position(field.mesh(), s.points.back());
    EXPECT_NEAR(s.outgoing ? end.y() : end.x() - 0.03, 0.0, 1e-9);
    EXPECT_NEAR(s.length, s.outgoing ? 1.0 - std::copysign(0.03, end.x()) : 1.0, 1e-9);
  }
  EXPECT_TRUE(topology.links.empty());
}

TEST(Topology, OfASaddleOnAVertexHasSeparatricesAlongEdgesOnce) {
  for (const int cells : {2, 6, 20}) {
    for (int turn = 0; turn < 16; ++turn) {
      const VectorField field = sampledOn(grid(cells), [turn](const Vec3& p) {
        const Complex v = std::polar(1.0, turn * kPi / 8.0) * Complex(p.x(), -p.y());
        return Vec3(v.real(), v.imag(), 0.0);
      });
      const auto points = findFixedPoints(field);
      ASSERT_EQ(points.size(), 1u);
      const auto& directions = points[0].separatrices;
      ASSERT_EQ(directions.size(), 4u) << cells << " cells, turned by pi / 8 times " << turn;
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NE(directions[i].outgoing, directions[(i + 1) % 4].outgoing);
    }
  }
}

TEST(Topology, OfAMonkeySaddleHasSixSeparatrices) {
  std::vector<Vec3> points{{0, 0, 0}};
  std::vector<std::array<Index, 3>> faces;
  for (Index i = 0; i < 12; ++i) {
    points.emplace_back(std::cos(kPi * i / 6.0), std::sin(kPi * i / 6.0), 0.0);
    faces.push_back({0, 1 + i, 1 + (i + 1) % 12});
  }
  const VectorField field = sampledOn(surface(points, faces), [](const Vec3& p) {
    const Complex z(p.x(), p.y()), v = std::conj(z * z) * std::polar(1.0, 0.2);
    return Vec3(v.real(), v.imag(), 0.0);
  });
  const Topology topology = topologyOf(field);
  ASSERT_EQ(topology.fixedPoints.size(), 1u);
  EXPECT_EQ(topology.fixedPoints[0].index, -2);
  EXPECT_EQ(topology.separatrices.size(), 6u);
}

void expectReversed(const Topology& a, const Topology& b, const std::string& what) {
  ASSERT_EQ(a.fixedPoints.size(), b.fixedPoints.size()) << what;
  ASSERT_EQ(a.periodicOrbits.size(), b.periodicOrbits.size()) << what;
  EXPECT_EQ(a.separatrices.size(), b.separatrices.size()) << what;
  std::set<std::pair<EntityRef, EntityRef>> links, reversedLinks;
  for (const EntityLink& link : a.links) links.emplace(link.source, link.target);
  for (const EntityLink& link : b.links) reversedLinks.emplace(link.target, link.source);
  EXPECT_EQ(links, reversedLinks) << what;
}

TEST(Topology, OfTheReversedFieldSwapsKindsAndArrows) {
  for (const Surface& s : {bumpySphere(4, 0.03), torus(60, 30), grid(40, 0.3)}) {
    for (std::uint64_t seed = 0; seed < shortOrLong(2u, 8u); ++seed) {
      const VectorField field = smoothField(s, seed);
      expectReversed(topologyOf(field), topologyOf(reversedField(field)), message("seed ", seed));
    }
  }
}

TEST(Topology, DoesNotDependOnLabels) {
  for (std::uint64_t seed = 0; seed < shortOrLong(3u, 8u); ++seed) {
    const Surface s = bumpySphere(4, 0.03);
    const VectorField field = smoothField(s, seed);
    Surface turned = s;
    const Index last = static_cast<Index>(s.points.rows()) - 1;
    turned.points = s.points.colwise().reverse();
    turned.triangles = (last - s.triangles.array()).matrix();
    const Topology a = topologyOf(field);
    const Topology b = topologyOf(makeVectorField(makeCharts(turned), {field.values.rbegin(), field.values.rend()}));
    ASSERT_EQ(a.fixedPoints.size(), b.fixedPoints.size());
    ASSERT_EQ(a.periodicOrbits.size(), b.periodicOrbits.size());
    for (std::size_t i = 0; i < a.periodicOrbits.size(); ++i) {
      EXPECT_EQ(a.periodicOrbits[i].kind, b.periodicOrbits[i].kind);
      EXPECT_NEAR(a.periodicOrbits[i].length, b.periodicOrbits[i].length, 1e-6);
    }
    ASSERT_EQ(a.links.size(), b.links.size());
    for (std::size_t i = 0; i < a.links.size(); ++i) {
      EXPECT_EQ(a.links[i].source, b.links[i].source);
      EXPECT_EQ(a.links[i].target, b.links[i].target);
      EXPECT_EQ(a.links[i].separatrices, b.links[i].separatrices);
    }
  }
}

TEST(Topology, DoesNotDependOnThreads) {
  const VectorField field = sampledOn(scaled(grid(80, 0.2), 3.999 * kPi), equation31);
  for (const VectorField& f : {field, smoothField(bumpySphere(4, 0.03), 3)}) {
    const Topology a = topologyOf(f);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Topology b = topologyOf(f);
    ASSERT_EQ(a.periodicOrbits.size(), b.periodicOrbits.size());
    for (std::size_t i = 0; i < a.periodicOrbits.size(); ++i) {
      EXPECT_EQ(a.periodicOrbits[i].times, b.periodicOrbits[i].times);
      EXPECT_EQ(a.periodicOrbits[i].multiplier, b.periodicOrbits[i].multiplier);
    }
    ASSERT_EQ(a.separatrices.size(), b.separatrices.size());
    for (std::size_t i = 0; i < a.separatrices.size(); ++i) {
      EXPECT_EQ(a.separatrices[i].times, b.separatrices[i].times);
    }
    ASSERT_EQ(a.links.size(), b.links.size());
  }
}

TEST(Topology, OfFieldsWithoutDirection) {
  const Surface s = grid(12, 0.3);
  const auto axis = [](const Vec3& p) { return Vec3(p.x(), 0.0, 0.0); };
  const auto half = [](const Vec3& p) { return p.x() > 0.0 ? Vec3(0.0, 0.0, 0.0) : Vec3(p.x(), 0.2, 0.0); };
  const auto constant = [](const Vec3&) { return Vec3(1.0, 0.0, 0.0); };
  EXPECT_EQ(topologyOf(zeroField(makeCharts(s))).zeros.faces, makeMesh(s)->faceCount());
  EXPECT_EQ(topologyOf(zeroField(makeCharts(s))).zeros.vertices, makeMesh(s)->vertexCount());
  for (const SpaceField& f : std::vector<SpaceField>{axis, half, constant}) {
    const VectorField field = sampledOn(grid(12), f);
    const Topology topology = topologyOf(field);
    int twice = 0;
    for (const FixedPoint& p : topology.fixedPoints) twice += 2 * p.index;
    for (const BoundaryPoint& p : topology.boundaryPoints) twice += p.halfIndex;
    EXPECT_EQ(twice, 2);
  }
  EXPECT_EQ(topologyOf(sampledOn(grid(12), axis)).zeros.vertices, 13);
  EXPECT_GT(topologyOf(sampledOn(grid(12), half)).zeros.faces, 100);
  const Topology uniform = topologyOf(sampledOn(grid(12), constant));
  EXPECT_TRUE(uniform.fixedPoints.empty());
  EXPECT_TRUE(uniform.periodicOrbits.empty());
  EXPECT_TRUE(uniform.links.empty());
  // Zero spheres, and zero regions on them.
  EXPECT_NO_THROW(topologyOf(zeroField(makeCharts(icosphere(3)))));
  EXPECT_NO_THROW(topologyOf(sampledOn(icosphere(3), half)));
}

TEST(Topology, OfOneTriangle) {
  const Surface s = surface({{0, 0, 0}, {1, 0, 0}, {0.2, 0.7, 0}}, {{0, 1, 2}});
  for (const double turn : {0.0, 0.5 * kPi, 1.0, kPi}) {
    const VectorField field = sampledOn(
        s, [&](const Vec3& p) { return Vec3(Eigen::AngleAxisd(turn, Vec3::UnitZ()) * (p - Vec3(0.4, 0.2, 0.0))); });
    const Topology topology = topologyOf(field);
    ASSERT_EQ(topology.fixedPoints.size(), 1u) << turn;
  }
}

TEST(Topology, OfSeveralComponents) {
  const Surface s = joined(icosphere(3), scaled(torus(40, 20), 1.0), {4, 0, 0});
  const VectorField field = smoothField(s, 2);
  expectSound(field, topologyOf(field), "two components");
}

TEST(Topology, RefusesWhatIsNoField) {
  const auto charts = makeCharts(icosphere(1));
  const FlatFaces faces(charts);
  VectorField field = randomField(charts, 1);
  field.values[5] = Complex(std::numeric_limits<double>::quiet_NaN(), 0.0);
  expectFault<InputError>([&] { findTopology(faces, field); }, {"vertex 5", "finite"});
  field.values.pop_back();
  expectFault<InputError>([&] { findTopology(faces, field); }, {"another mesh"});
}

TEST(Topology, RefusesOptionsThatAreNotPositive) {
  const VectorField field = randomField(makeCharts(icosphere(1)), 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const TopologyOptions& options :
       {TopologyOptions{.tolerance = 0.0}, TopologyOptions{.tolerance = nan}, TopologyOptions{.bandTolerance = -1.0},
        TopologyOptions{.bandTolerance = nan}, TopologyOptions{.maxSteps = 0}}) {
    expectFault<InputError>([&] { topologyOf(field, options); }, {"must be positive"});
  }
}

TEST(Topology, StopsWhenCancelled) {
  const VectorField field = smoothField(icosphere(4), 1);
  const FlatFaces faces(field.charts);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(findTopology(faces, field, {}, &progress), Cancelled);
}

TEST(Topology, OfTheGasEngine) {
  const auto data = dataSet("gasEngineV.t");
  if (!data) GTEST_SKIP() << "the gas engine's data set is not at hand";
  for (const SampledSurface& s : {*data, subdivided(*data)}) {
    const VectorField field = fieldOn(s);
    const Topology topology = topologyOf(field);
    expectSound(field, topology, message(field.mesh().faceCount(), " faces"));
    if (field.mesh().faceCount() != 105192) continue;
    EXPECT_EQ(topology.fixedPoints.size(), 56u);
    EXPECT_EQ(topology.periodicOrbits.size(), 5u);
  }
}

TEST(Topology, OfTheDesignedDataSets) {
  for (const char* name : {"bunny1V.t", "torus1V.t"}) {
    const auto data = dataSet(name);
    if (!data) GTEST_SKIP() << "the thesis's data sets are not at hand";
    const VectorField field = fieldOn(*data);
    expectSound(field, topologyOf(field), name);
  }
}

}  // namespace
}  // namespace stormfield::test
