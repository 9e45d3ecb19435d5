#include "topology/detail/section.h"

#include <gtest/gtest.h>

#include "checks.h"
#include "cylinder_flow.h"
#include "flows.h"
#include "topology/detail/return_map.h"

namespace stormfield::test {
namespace {

/// growth and frequency of a linear focus at the origin: streamlines are r = r0 exp(growth t), angle = frequency t.
VectorField focus(int cells, double growth, double frequency) {
  return sampledOn(grid(cells), [=](const Vec3& p) {
    return Vec3(growth * p.x() - frequency * p.y(), frequency * p.x() + growth * p.y(), 0.0);
  });
}

/// The halfedge between two places.
Index halfedgeFrom(const TriangleMesh& mesh, const Vec3& from, const Vec3& to) {
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    if ((mesh.point(mesh.tail(h)) - from).norm() + (mesh.point(mesh.head(h)) - to).norm() < 1e-9) return h;
  }
  return kNone;
}

TEST(Section, ContinuesOverVerticesAcrossTheFlow) {
  // Counter-clockwise around the origin: the positive x axis is crossed to its left.
  const VectorField field = focus(10, 0.0, 1.0);
  const TriangleMesh& mesh = field.mesh();
  const Index h = halfedgeFrom(mesh, {0.4, 0, 0}, {0.6, 0, 0});
  ASSERT_NE(h, kNone);
  const Section section(field, h, 1);
  ASSERT_EQ(section.halfedges().size(), 3u);
  for (const Index i : section.halfedges()) EXPECT_NEAR(mesh.point(mesh.tail(i)).y(), 0.0, 1e-15);
  EXPECT_NEAR(section.low(), 0.0, 1e-15);
  EXPECT_NEAR(section.high(), 0.6, 1e-15);
  EXPECT_EQ(Section(field, h, 0).halfedges(), std::vector<Index>{h});
}

TEST(Section, EndsWhereTheFlowIsTangent) {
  // Upwards right of x = 0.13 only: the edge from 0 to 0.2 is crossed from there on.
  const VectorField field = sampledOn(grid(10), [](const Vec3& p) { return Vec3(0.0, p.x() - 0.13, 0.0); });
  const Index h = halfedgeFrom(field.mesh(), {0.0, 0, 0}, {0.2, 0, 0});
  const Section section(field, h, 1);
  ASSERT_EQ(section.halfedges().size(), 2u);
  EXPECT_EQ(section.halfedges().front(), h);
  EXPECT_NEAR(section.low(), 0.13, 1e-14);
  EXPECT_NEAR(section.high(), 0.4, 1e-14);
  const auto across = acrossEnds(field, h);
  EXPECT_NEAR(across[0], -0.13, 1e-15);
  EXPECT_NEAR(across[1], 0.07, 1e-15);
}

TEST(Section, PositionsArePointsAndBack) {
  const VectorField field = focus(10, 0.0, 1.0);
  const TriangleMesh& mesh = field.mesh();
  const Section section(field, halfedgeFrom(mesh, {0.4, 0, 0}, {0.6, 0, 0}), 1);
  for (const double s : {0.0, 0.05, 0.19, 0.2, 0.33, 0.6}) {
    for (const Direction direction : {Direction::Forward, Direction::Backward}) {
      const SurfacePoint p = section.point(mesh, s, direction);
      expectNear(position(mesh, p), Vec3(0.2 + s, 0.0, 0.0), 1e-15);
      // In the face that the trace enters: above the axis with the flow, below it against the flow.
      const Vec3 centre = position(mesh, {p.face, Eigen::Vector3d::Constant(1.0 / 3.0)});
      EXPECT_EQ(centre.y() > 0.0, direction == Direction::Forward);
    }
  }
  const std::vector<Index>& halfedges = section.halfedges();
  EXPECT_NEAR(*section.at(mesh, {halfedges[1], 0.25, kNone}), 0.25, 1e-15);
  EXPECT_NEAR(*section.at(mesh, {kNone, 0.0, mesh.tail(halfedges[2])}), 0.4, 1e-15);
  EXPECT_FALSE(section.at(mesh, {mesh.twin(halfedges[1]), 0.25, kNone}));
  EXPECT_FALSE(section.at(mesh, {kNone, 0.0, mesh.tail(halfedges[0])})) << "the section does not continue there";
}

TEST(ReturnMap, OfALinearFocusIsAFactor) {
  const std::vector<Index> componentOf(2 * 40 * 40, 0);
  for (const double frequency : {1.0, 2.5}) {
    for (const double growth : {-0.05, 0.0, 0.04}) {
      const VectorField field = focus(40, growth, frequency);
      const FlatFaces faces(field.charts);
      const Section section(field, halfedgeFrom(field.mesh(), {0.4, 0, 0}, {0.45, 0, 0}), 3);
      const double period = 2.0 * kPi / frequency;
      for (const Direction direction : {Direction::Forward, Direction::Backward}) {
        const double factor = std::exp((direction == Direction::Forward ? 1.0 : -1.0) * growth * period);
        ReturnMap returns(CrossingTrace(faces, field, direction, 1e-10), section, 1, componentOf, 0, 1000);
        const double x0 = position(field.mesh(), section.point(field.mesh(), 0.0, direction)).x();
        const double x = 0.42, step = 1e-3;
        const auto back = returns(x - x0), further = returns(x + step - x0);
        ASSERT_TRUE(back && further) << frequency << " " << growth;
        EXPECT_NEAR(back->position + x0, x * factor, 1e-7);
        EXPECT_NEAR(back->time, period, 1e-6);
        // The multiplier: the derivative of the return map.
        EXPECT_NEAR((further->position - back->position) / step, factor, 1e-5);
        // Length of a logarithmic spiral.
        const double slope = std::hypot(growth, frequency) / growth;
        const double length = growth == 0.0 ? 2.0 * kPi * x : std::abs(slope * x * (factor - 1.0));
        EXPECT_NEAR(back->length, length, 1e-2 * length);
      }
    }
  }
}

TEST(ReturnMap, CountsLoops) {
  const std::vector<Index> componentOf(2 * 40 * 40, 0);
  const VectorField field = focus(40, -0.01, 1.0);
  const FlatFaces faces(field.charts);
  const Section section(field, halfedgeFrom(field.mesh(), {0.4, 0, 0}, {0.45, 0, 0}), 3);
  const double x0 = position(field.mesh(), section.point(field.mesh(), 0.0, Direction::Forward)).x();
  for (const int loops : {1, 2, 3}) {
    ReturnMap returns(CrossingTrace(faces, field, Direction::Forward, 1e-10), section, loops, componentOf, 0, 1000);
    const auto back = returns(0.42 - x0);
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->position + x0, 0.42 * std::exp(-0.02 * kPi * loops), 1e-7);
    EXPECT_NEAR(back->time, 2.0 * kPi * loops, 1e-6);
  }
}

TEST(ReturnMap, ReportsNoReturnFromOutsideTheComponentOrBeyondTheCrossings) {
  const VectorField field = focus(40, 0.0, 1.0);
  const FlatFaces faces(field.charts);
  const Section section(field, halfedgeFrom(field.mesh(), {0.4, 0, 0}, {0.45, 0, 0}), 1);
  const CrossingTrace trace(faces, field, Direction::Forward, 1e-8);
  const std::vector<Index> all(2 * 40 * 40, 0);
  const double middle = 0.5 * (section.low() + section.high());
  const auto back = ReturnMap(trace, section, 1, all, 0, 1000)(middle);
  ASSERT_TRUE(back);
  EXPECT_FALSE(ReturnMap(trace, section, 1, all, 0, back->crossings - 1)(middle));
  EXPECT_TRUE(ReturnMap(trace, section, 1, all, 0, back->crossings)(middle));
  EXPECT_FALSE(ReturnMap(trace, section, 1, all, 1, 1000)(middle)) << "another component";
  // A component without the left half of the square.
  std::vector<Index> right(all.size(), 0);
  for (Index f = 0; f < field.mesh().faceCount(); ++f) {
    if (position(field.mesh(), {f, Eigen::Vector3d::Constant(1.0 / 3.0)}).x() < 0.0) right[f] = kNone;
  }
  EXPECT_FALSE(ReturnMap(trace, section, 1, right, 0, 1000)(middle));
}

TEST(ReturnMap, OfACylinderFlowIsExact) {
  const CylinderFlow flow;
  const VectorField field = flow.field();
  const FlatFaces faces(field.charts);
  const std::vector<Index> componentOf(field.mesh().faceCount(), 0);
  for (const double z : {0.0, 0.05, 0.1}) {
    const auto [h, fraction] = flow.crossedAt(field.mesh(), z);
    const Section section(field, h, 1);
    const auto start = section.at(field.mesh(), {h, fraction, kNone});
    ASSERT_TRUE(start);
    ReturnMap returns(CrossingTrace(faces, field, Direction::Forward, 1e-10), section, 1, componentOf, 0, 1000);
    const auto back = returns(*start);
    ASSERT_TRUE(back);
    const Vec3 there = position(field.mesh(), section.point(field.mesh(), back->position, Direction::Forward));
    EXPECT_NEAR(there.z() - flow.height, (z - flow.height) * std::exp(-flow.rate * back->time), 1e-9);
    // The section is oblique: the streamline comes back a little before or after a whole period.
    const Vec3 from = position(field.mesh(), section.point(field.mesh(), *start, Direction::Forward));
    const double further = std::remainder(flow.along(there) - flow.along(from), flow.perimeter());
    EXPECT_NEAR(back->time, flow.period() + further / flow.speed, 1e-9);
    EXPECT_NEAR(further, 0.0, 0.5 * flow.width());
  }
}

}  // namespace
}  // namespace stormfield::test
