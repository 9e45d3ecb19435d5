#include "field/interpolation.h"
#include "storm_checks.h"

#include "design/detail/junction.h"
#include "long_tests.h"

namespace stormfield {
namespace {

using namespace storms;

Vec3 onSphere(double longitude, double latitude) {
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

/// A sphere with hills and hollows of a tenth of its radius.
ChartsPointer bumpySphere(Index n) {
  const ChartsPointer round = test::makeCharts(test::dividedIcosahedron(n));
  Points points = round->mesh().points();
  for (Index v = 0; v < points.rows(); ++v) {
    const Vec3 p = points.row(v);
    points.row(v) = p * (1.0 + 0.1 * std::sin(4.0 * p.x()) * std::cos(5.0 * p.y()) + 0.05 * std::sin(6.0 * p.z()));
  }
  return test::makeCharts({points, round->mesh().triangles()});
}

std::vector<DesignElement> onTheSphere(SingularKind kind) {
  return merge(kind, onSphere(-0.9, 0.25), onSphere(0.8, -0.2), onSphere(0.0, 0.0), onSphere(0.1, 0.3), 0.45);
}

class StormsOfKind : public testing::TestWithParam<SingularKind> {};

TEST_P(StormsOfKind, MergeOnTheSphere) {
  const auto elements = onTheSphere(GetParam());
  checkMerge(solved(test::makeCharts(test::dividedIcosahedron(14)), elements, 41), elements, 0.6);
}

INSTANTIATE_TEST_SUITE_P(Kinds, StormsOfKind,
                         testing::Values(SingularKind::VortexCcw, SingularKind::SpiralInCw, SingularKind::SpiralOutCcw,
                                         SingularKind::Source, SingularKind::Sink),
                         [](const auto& test) { return std::string(name(test.param)); });

TEST(Storms, SplitOnTheSphere) {
  const auto elements = reversed(onTheSphere(SingularKind::SpiralInCcw));
  checkMerge(solved(test::makeCharts(test::dividedIcosahedron(14)), elements, 50), elements, 0.4, false);
}

TEST(Storms, MergeAndSplitOnABumpySphere) {
  auto elements = onTheSphere(SingularKind::VortexCw);
  for (DesignElement& e : elements) e.radius = 0.4;
  const auto charts = bumpySphere(test::shortOrLong(14, 18));
  checkMerge(solved(charts, elements, 40), elements, 0.6);
  const auto backwards = reversed(elements);
  checkMerge(solved(charts, backwards, 40), backwards, 0.4, false);
}

TEST(Storms, MergeOnATorus) {
  const auto on = [](double u, double v) {
    return Vec3((1.0 + 0.4 * std::cos(v)) * std::cos(u), (1.0 + 0.4 * std::cos(v)) * std::sin(u), 0.4 * std::sin(v));
  };
  const auto elements = merge(SingularKind::SpiralInCcw, on(-0.6, 0.1), on(0.6, -0.3), on(0.0, 0.0), on(0.1, 0.4), 0.3);
  checkMerge(solved(test::makeCharts(test::torus(60, 32, 1.0, 0.4, 0.15, 2)), elements, 40), elements, 0.6);
}

TEST(Storms, MergeOnASquareWithBoundary) {
  const auto elements = merge(SingularKind::VortexCcw, {-0.6, 0.2, 0}, {0.5, -0.3, 0}, {0, 0, 0}, {0.1, 0.3, 0}, 0.4);
  checkMerge(solved(test::makeCharts(test::grid(test::shortOrLong(28, 40), 0.2)), elements, test::shortOrLong(40, 60)),
             elements, 0.6);
}

TEST(Storms, OneMayWaitForTheOther) {
  auto elements = onTheSphere(SingularKind::VortexCcw);
  elements[0].points = {onSphere(0.0, 0.0)};
  checkMerge(solved(test::makeCharts(test::dividedIcosahedron(14)), elements, 41), elements, 0.6);
}

TEST(Storms, FixedElementsOfEveryKindAreFound) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  for (int k = 0; k < 9; ++k) {
    const auto kind = static_cast<SingularKind>(k);
    const Vec3 place = onSphere(0.4 + 0.3 * k, 0.2);
    const auto result = solved(charts, {singular("x", kind, {place}, {0.0, 1.0}, 0.4)}, 4);
    for (Index j = 0; j < 4; ++j) {
      double nearest = 1e9;
      int index = 0;
      for (const FixedPoint& p : findFixedPoints(sampleField(result.field, j)))
        if ((p.position - place).norm() < nearest) {
          nearest = (p.position - place).norm();
          index = p.index;
        }
      EXPECT_LT(nearest, charts->mesh().meanEdgeLength());
      EXPECT_EQ(index, poincareIndex(kind)) << name(kind);
    }
  }
}

TEST(Storms, SaddleFlowsOutAlongItsAxis) {
  const auto charts = test::makeCharts(test::grid(20));
  DesignElement saddle = singular("s", SingularKind::Saddle, {{0, 0, 0}}, {0.0, 1.0}, 0.5);
  saddle.angle = 0.5;
  const auto result = solved(charts, {saddle}, 2);
  const ClosestPointQuery query(charts->meshPointer());
  const Vec3 axis(std::cos(0.5), std::sin(0.5), 0.0), across(-axis.y(), axis.x(), 0.0);
  const auto at = [&](const Vec3& p) {
    return evaluate(sampleField(result.field, 0), query.closest(p).point).normalized();
  };
  EXPECT_GT(at(0.15 * axis).dot(axis), 0.99);
  EXPECT_GT(at(-0.15 * axis).dot(-axis), 0.99);
  EXPECT_GT(at(0.15 * across).dot(-across), 0.99);
}

TEST(Storms, CloseOnesThatAreNotJoinedGiveWay) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(16));
  const std::vector<DesignElement> elements = {
      singular("x", SingularKind::VortexCcw, {onSphere(-0.15, 0.0)}, {0.0, 1.0}, 0.4),
      singular("y", SingularKind::VortexCw, {onSphere(0.15, 0.0)}, {0.0, 1.0}, 0.4)};
  const auto result = solved(charts, elements, 3);
  for (const DesignElement& e : elements) {
    double nearest = 1e9;
    for (const FixedPoint& p : findFixedPoints(sampleField(result.field, 1)))
      if (p.index == 1) nearest = std::min(nearest, (p.position - e.points[0]).norm());
    EXPECT_LT(nearest, charts->mesh().meanEdgeLength());
  }
}

TEST(Storms, SmallerThanTheMeshBecomesThreeConstraints) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  const Vec3 place = onSphere(0.3, 0.4);
  const auto elements = std::vector{singular("x", SingularKind::VortexCcw, {place}, {0.0, 1.0}, 0.02)};
  ElementOptions options;
  options.samples = 3;
  EXPECT_EQ(elementConstraints(charts, elements, options).size(), 9u);
  const auto result = solved(charts, elements, 3);
  double nearest = 1e9;
  for (const FixedPoint& p : findFixedPoints(sampleField(result.field, 1)))
    nearest = std::min(nearest, (p.position - place).norm());
  EXPECT_LT(nearest, charts->mesh().meanEdgeLength());
}

// At the meeting point itself the zeros of a pair give way to one zero, in a disc of a few edges.
TEST(Storms, NothingJumpsInLambda) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(test::shortOrLong(16, 24)));
  const TriangleMesh& mesh = charts->mesh();
  const auto elements = onTheSphere(SingularKind::VortexCcw);
  const double speed = elements[0].strength.largest() * mesh.size();
  const auto largestChange = [&](Index samples) {
    const auto result = solved(charts, elements, samples);
    double largest = 0.0;
    for (Index j = 0; j + 1 < samples; ++j)
      for (Index v = 0; v < mesh.vertexCount(); ++v)
        if ((mesh.point(v) - onSphere(0.0, 0.0)).norm() > 6.0 * mesh.meanEdgeLength())
          largest = std::max(largest, std::abs(result.field.sample(j + 1)[v] - result.field.sample(j)[v]) / speed);
    return largest;
  };
  const Index coarseSamples = test::shortOrLong(25, 40);
  const double coarse = largestChange(coarseSamples), fine = largestChange(4 * coarseSamples);
  std::printf("largest change between samples, in speeds: %.3f, with four times the samples %.3f\n", coarse, fine);
  EXPECT_LT(fine, 0.5 * coarse);
}

}  // namespace
}  // namespace stormfield
