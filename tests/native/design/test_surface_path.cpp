// Drawn curves projected to surfaces, against circles and straight lines.
#include "design/detail/surface_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "checks.h"
#include "fixtures.h"

namespace stormfield {
namespace {

DesignElement pathline(std::vector<Vec3> points, std::vector<double> lambdas) {
  DesignElement element;
  element.name = "path";
  element.type = ElementType::Pathline;
  element.points = std::move(points);
  element.lambdas = std::move(lambdas);
  element.radius = 0.3;
  return element;
}

struct Square {
  std::shared_ptr<const TriangleMesh> mesh = test::makeMesh(test::grid(20, 0.2));
  ClosestPointQuery query{mesh};
  SurfacePath path(const DesignElement& element) const { return {*mesh, query, element}; }
};

TEST(SurfacePath, MovesWithArcLengthBetweenGivenLambdas) {
  const Square square;
  const SurfacePath spread = square.path(pathline({{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}}, {0.1, 0.7}));
  EXPECT_TRUE(spread.moves());
  EXPECT_NEAR(spread.length(), 1.5, 1e-12);
  EXPECT_EQ(spread.start(), 0.1);
  EXPECT_EQ(spread.end(), 0.7);
  test::expectNear(spread.positionAt(0.5), Vec3(0.5, 0.0, 0.0), 1e-12);  // two thirds of the way, at the corner
  test::expectNear(spread.positionAt(0.3), Vec3(0.0, 0.0, 0.0), 1e-12);
  test::expectNear(spread.positionAt(0.0), Vec3(-0.5, 0.0, 0.0), 1e-12);
  test::expectNear(spread.positionAt(1.0), Vec3(0.5, 0.5, 0.0), 1e-12);
  test::expectNear(position(*square.mesh, spread.at(0.3)), Vec3(0.0, 0.0, 0.0), 1e-12);

  const SurfacePath given = square.path(pathline({{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}}, {0.0, 0.2, 1.0}));
  test::expectNear(given.positionAt(0.2), Vec3(0.5, 0.0, 0.0), 1e-12);
  test::expectNear(given.positionAt(0.6), Vec3(0.5, 0.25, 0.0), 1e-12);
}

TEST(SurfacePath, IsTheSameForSparseAndDenseDrawings) {
  const auto mesh = test::makeMesh(test::dividedIcosahedron(20));
  const ClosestPointQuery query(mesh);
  const auto arc = [](int pieces) {
    std::vector<Vec3> points;
    for (int k = 0; k <= pieces; ++k) {
      const double angle = 0.5 * std::numbers::pi * k / pieces;
      points.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    }
    return points;
  };
  for (const int pieces : {2, 50}) {
    const SurfacePath path(*mesh, query, pathline(arc(pieces), {0.0, 1.0}));
    EXPECT_NEAR(path.length(), 0.5 * std::numbers::pi, 2e-3) << pieces;
    const Vec3 middle = path.positionAt(0.5).normalized();
    test::expectNear(middle, Vec3(std::sqrt(0.5), std::sqrt(0.5), 0.0), 2e-3);
    for (const Vec3& p : path.positions()) EXPECT_NEAR(query.closest(p).distance, 0.0, 1e-12);
  }
}

TEST(SurfacePath, OfOnePointStaysWhereItIs) {
  const Square square;
  DesignElement element = pathline({{0.3, -0.2, 0.1}}, {0.2, 0.9});
  element.type = ElementType::Singular;
  const SurfacePath path = square.path(element);
  EXPECT_FALSE(path.moves());
  EXPECT_EQ(path.length(), 0.0);
  for (const double lambda : {0.0, 0.2, 0.5, 1.0}) {
    test::expectNear(path.positionAt(lambda), Vec3(0.3, -0.2, 0.0), 1e-12);
  }
}

TEST(SurfacePath, RefusesBadInputByName) {
  const Square square;
  test::expectFault<InputError>(
      [&] {
        square.path(pathline({{0, 0, 0}, {0.5, 0, 0.31}}, {0.0, 1.0}));
      },
      {"\"path\"", "point 1", "off the surface"});
  EXPECT_NO_THROW(square.path(pathline({{0, 0, 0}, {0.5, 0, 0.29}}, {0.0, 1.0})));
  test::expectFault<InputError>(
      [&] {
        square.path(pathline({{0.2, 0, 0.1}, {0.2, 0, -0.1}}, {0.0, 1.0}));
      },
      {"\"path\"", "one point"});
}

}  // namespace
}  // namespace stormfield
