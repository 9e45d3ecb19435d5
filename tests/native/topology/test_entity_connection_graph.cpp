#include "topology/detail/entity_connection_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "checks.h"
#include "cylinder_flow.h"
#include "maps/fixed_point_faces.h"
#include "maps/geometry_map.h"
#include "topology/detail/recurrent_components.h"

namespace stormfield::test {
namespace {

EntityRef point(Index i) {
  return {EntityKind::FixedPoint, i};
}
EntityRef orbit(Index i) {
  return {EntityKind::PeriodicOrbit, i};
}
StreamlineEnd at(const EntityRef& entity, OrbitSide side = OrbitSide::Left) {
  return {entity, side};
}
const EntityRef kBoundary{EntityKind::Boundary, kNone};

using Link = std::tuple<EntityRef, EntityRef, std::vector<Index>>;

std::vector<Link> links(std::size_t points, const std::vector<PeriodicOrbit>& orbits,
                        const ConnectionEvidence& evidence) {
  std::vector<Link> result;
  for (const EntityLink& link : entityLinks(std::vector<FixedPoint>(points), orbits, evidence)) {
    result.emplace_back(link.source, link.target, link.separatrices);
  }
  return result;
}

TEST(EntityLinks, OfSeparatricesGoWithTheFlow) {
  // Saddle 0 between sinks 1 and 2 and source 3; its second incoming separatrix comes from the boundary.
  ConnectionEvidence evidence;
  evidence.ends = {at(point(1)), at(point(2)), at(point(3)), at(kBoundary), at(point(2)), at(point(3)), at(point(1))};
  evidence.separatrices = {{0, true, 0}, {0, true, 1}, {0, false, 2}, {0, false, 3}};
  // Nodes that separatrices reach have no link of their own.
  evidence.fixedPoints = {{1, Direction::Backward, 5}, {2, Direction::Backward, 5}, {3, Direction::Forward, 6}};
  const std::vector<Link> expected = {{point(0), point(1), {0}}, {point(0), point(2), {1}}, {point(3), point(0), {2}}};
  EXPECT_EQ(links(4, {}, evidence), expected);
}

TEST(EntityLinks, OfTwoSeparatricesToOneNodeAreOne) {
  ConnectionEvidence evidence;
  evidence.ends = {at(point(1)), at(point(1))};
  evidence.separatrices = {{0, true, 0}, {0, true, 1}};
  const std::vector<Link> expected = {{point(0), point(1), {0, 1}}};
  EXPECT_EQ(links(2, {}, evidence), expected);
}

TEST(EntityLinks, OfNodesWithoutSeparatricesFollowTheirStreamline) {
  // A magnet: a source and a sink, each with a streamline to the other.
  ConnectionEvidence evidence;
  evidence.ends = {at(point(1)), at(point(0))};
  evidence.fixedPoints = {{0, Direction::Forward, 0}, {1, Direction::Backward, 1}};
  const std::vector<Link> expected = {{point(0), point(1), {}}};
  EXPECT_EQ(links(2, {}, evidence), expected);
}

TEST(EntityLinks, OfOrbitSidesAreTakenOncePerSide) {
  // Source 0 inside orbit 0 (attracting), which lies inside orbit 1 (repelling).
  std::vector<PeriodicOrbit> orbits(2);
  orbits[0].kind = OrbitKind::Attracting;
  orbits[1].kind = OrbitKind::Repelling;
  ConnectionEvidence evidence;
  evidence.ends = {at(point(0)), at(orbit(1), OrbitSide::Left), at(orbit(0), OrbitSide::Right), at(kBoundary),
                   at(orbit(0), OrbitSide::Left)};
  evidence.orbitSides = {{0, OrbitSide::Left, Direction::Backward, 0},
                         {0, OrbitSide::Right, Direction::Backward, 1},
                         {1, OrbitSide::Left, Direction::Forward, 2},
                         {1, OrbitSide::Right, Direction::Forward, 3}};
  evidence.fixedPoints = {{0, Direction::Forward, 4}};
  const std::vector<Link> expected = {{point(0), orbit(0), {}}, {orbit(1), orbit(0), {}}};
  EXPECT_EQ(links(1, orbits, evidence), expected);

  // A separatrix that reaches one side takes that side's link away.
  evidence.ends.push_back(at(orbit(0), OrbitSide::Right));
  evidence.separatrices = {{1, true, 5}};
  const auto withSaddle = links(2, orbits, evidence);
  EXPECT_EQ(std::count(withSaddle.begin(), withSaddle.end(), Link{point(1), orbit(0), {0}}), 1);
}

TEST(EntityLinks, OfBandsAndCenters) {
  std::vector<PeriodicOrbit> orbits(1);
  orbits[0].kind = OrbitKind::Center;
  ConnectionEvidence evidence;
  // Beyond the band the flow comes from it and goes to sink 1; center 0 lies inside it.
  evidence.ends = {at(point(1)), at(orbit(0)), at(orbit(0))};
  evidence.bandEnds = {{0, 0, 1}};
  evidence.fixedPoints = {{0, Direction::Forward, 2}};
  const std::vector<Link> expected = {{orbit(0), point(1), {}}};
  EXPECT_EQ(links(2, orbits, evidence), expected);
}

TEST(EntityLinks, OfTangenciesJoinWhatTheyComeFromAndGoTo) {
  ConnectionEvidence evidence;
  evidence.ends = {at(point(1)), at(point(0)), at(kBoundary)};
  evidence.tangencies = {{0, 1}, {0, 2}};
  const std::vector<Link> expected = {{point(0), point(1), {}}};
  EXPECT_EQ(links(2, {}, evidence), expected);
}

TEST(EntityLinks, RenumberOrbits) {
  ConnectionEvidence evidence;
  evidence.ends = {at(orbit(0)), at(point(0)), at(orbit(1))};
  evidence.orbitSides = {{0, OrbitSide::Left, Direction::Forward, 2}};
  evidence.bandEnds = {{1, 0, 0}};
  evidence.renumberOrbits({1, 0});
  EXPECT_EQ(evidence.ends[0].entity, orbit(1));
  EXPECT_EQ(evidence.ends[1].entity, point(0));
  EXPECT_EQ(evidence.ends[2].entity, orbit(0));
  EXPECT_EQ(evidence.orbitSides[0].orbit, 1);
  EXPECT_EQ(evidence.bandEnds[0].orbit, 0);
}

TEST(RecurrentComponents, OfACylinderFlowAreItsRings) {
  // The flow crosses each ring of edges in one direction, so that each row of faces is a component of its own.
  for (const double rate : {0.3, -0.3}) {
    const CylinderFlow flow{.rate = rate};
    const VectorField field = flow.field();
    const auto components = recurrentComponents(field, geometryMap(field), fixedPointFaces(field));
    ASSERT_EQ(components.count, flow.rows);
    const Index perRow = 2 * flow.around;
    for (Index f = 0; f < field.mesh().faceCount(); ++f) EXPECT_EQ(components.of[f], f / perRow);
    // Streamlines enter over both borders of the row with an attracting orbit, elsewhere over one.
    ASSERT_EQ(components.seeds.size(), 2u * flow.rows);
    std::vector<int> forward(flow.rows, 0);
    for (const ComponentSeed& seed : components.seeds) {
      EXPECT_EQ(components.of[seed.point.face], seed.component);
      forward[seed.component] += seed.direction == Direction::Forward ? 1 : 0;
    }
    const int orbitRow = static_cast<int>((flow.height + 1.0) / 2.0 * flow.rows);
    for (int row = 0; row < flow.rows; ++row) {
      EXPECT_EQ(forward[row], row != orbitRow ? 1 : rate > 0.0 ? 2 : 0) << "row " << row;
    }
  }
}

TEST(RecurrentComponents, LeaveOutWhatHoldsNoOrbit) {
  // No face leads back to another in a constant field. Around a center all faces do, which then needs no seeds.
  const VectorField constant = fromSpace(makeCharts(grid(10, 0.2)), [] {
    Points vectors = Points::Zero(121, 3);
    vectors.col(0).setOnes();
    vectors.col(1).setConstant(0.3);
    return vectors;
  }());
  EXPECT_EQ(recurrentComponents(constant, geometryMap(constant), fixedPointFaces(constant)).count, 0);
  const auto charts = makeCharts(icosphere(3));
  Points rotation = Points::Zero(charts->mesh().vertexCount(), 3);
  for (Index v = 0; v < rotation.rows(); ++v) {
    const Vec3 p = charts->mesh().point(v);
    rotation.row(v) << 0.3 * p.z() - p.y(), p.x(), -0.3 * p.x();
  }
  const VectorField centers = fromSpace(charts, rotation);
  const auto components = recurrentComponents(centers, geometryMap(centers), fixedPointFaces(centers));
  EXPECT_GE(components.count, 1);
  EXPECT_TRUE(components.seeds.empty());
}

TEST(KnownLimitSets, TellWhatAStreamlineEndsIn) {
  const CylinderFlow flow;
  const VectorField field = flow.field();
  const TriangleMesh& mesh = field.mesh();
  const std::vector<FixedPoint> points(1, {.point = {7, Eigen::Vector3d::Constant(1.0 / 3.0)},
                                           .position = position(mesh, {7, Eigen::Vector3d::Constant(1.0 / 3.0)})});
  const std::vector<TrappingRegion> regions(
      1, {.forward = true, .ellipses = {{7, Complex(0.05, 0.05), 1e4 * Eigen::Matrix2d::Identity()}}});
  KnownLimitSets limitSets(mesh, points, regions);
  const FlatFaces faces(field.charts);
  EXPECT_FALSE(limitSets.hasHandles());
  const SurfacePoint inside{7, faces[7].barycentric(Complex(0.055, 0.05))};
  const SurfacePoint outside{7, faces[7].barycentric(Complex(0.065, 0.05))};
  EXPECT_EQ(limitSets.fixedPointTrapping(faces, inside, Direction::Forward), point(0));
  EXPECT_EQ(limitSets.fixedPointTrapping(faces, inside, Direction::Backward), EntityRef{});
  EXPECT_EQ(limitSets.fixedPointTrapping(faces, outside, Direction::Forward), EntityRef{});
  EXPECT_EQ(limitSets.centerIn(7), point(0));
  EXPECT_EQ(limitSets.centerIn(8), EntityRef{});
  EXPECT_EQ(limitSets.fixedPointNear(points[0].point), point(0));
  EXPECT_EQ(limitSets.fixedPointNear({7, {0.8, 0.1, 0.1}}), EntityRef{});

  // An orbit that attracts on its left and repels on its right.
  const auto [h, fraction] = flow.crossedAt(mesh, flow.height);
  FoundOrbit found;
  found.sides = {SideFlow::Attracted, SideFlow::Repelled};
  found.bestSection.section = Section(field, h, 0);
  const double length = found.bestSection.section.high();
  found.bestSection.position = 0.5 * length;
  found.bestSection.low = 0.2 * length;
  found.bestSection.high = 0.7 * length;
  EXPECT_FALSE(limitSets.orbitReachedFrom({h, 0.4, kNone}, Direction::Forward));
  limitSets.addOrbit(found);
  const auto reached = [&](double at, Direction direction) {
    return limitSets.orbitReachedFrom({h, at, kNone}, direction);
  };
  ASSERT_TRUE(reached(0.4, Direction::Forward));
  EXPECT_EQ(reached(0.4, Direction::Forward)->entity, orbit(0));
  EXPECT_EQ(reached(0.4, Direction::Forward)->side, OrbitSide::Left);
  EXPECT_FALSE(reached(0.4, Direction::Backward));
  ASSERT_TRUE(reached(0.6, Direction::Backward));
  EXPECT_EQ(reached(0.6, Direction::Backward)->side, OrbitSide::Right);
  EXPECT_FALSE(reached(0.6, Direction::Forward));
  EXPECT_FALSE(reached(0.1, Direction::Forward)) << "beyond what is known of its side";
  EXPECT_FALSE(reached(0.8, Direction::Backward));
  EXPECT_EQ(limitSets.orbitAt({h, 0.5 + 1e-6, kNone}, 1e-3 * length), 0);
  EXPECT_EQ(limitSets.orbitAt({h, 0.6, kNone}, 1e-3 * length), kNone);
  limitSets.addBandFace(3, 0);
  EXPECT_EQ(limitSets.bandAt(3), 0);
  EXPECT_EQ(limitSets.bandAt(4), kNone);
}

TEST(KnownLimitSets, CountHandles) {
  EXPECT_FALSE(KnownLimitSets(*makeMesh(icosphere(1)), {}, {}).hasHandles());
  EXPECT_TRUE(KnownLimitSets(*makeMesh(torus(12, 8)), {}, {}).hasHandles());
  EXPECT_TRUE(KnownLimitSets(*makeMesh(plateWithHoles(2)), {}, {}).hasHandles());
}

}  // namespace
}  // namespace stormfield::test
