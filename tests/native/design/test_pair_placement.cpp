// Places of two singular elements and their saddle that a mesh resolves: the field of the plane must have those zeros.
#include "design/detail/pair_placement.h"

#include <gtest/gtest.h>

#include <complex>

#include "field/poincare_index.h"
#include "fixtures.h"

namespace stormfield {
namespace {

Complex flat(const Vec3& p) {
  return {p.x(), p.y()};
}

TEST(PairPlacement, GivesThreeZerosNearTheDrawnPlaces) {
  const auto charts = test::makeCharts(test::grid(24, 0.25));
  const TriangleMesh& mesh = charts->mesh();
  const ClosestPointQuery query(charts->meshPointer());
  LogMapScratch scratch(mesh);
  const double edge = mesh.meanEdgeLength();
  test::Random random(4);
  int placed = 0;
  for (int round = 0; round < 40; ++round) {
    const Vec3 middle(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0.0);
    const double angle = random.uniform(0.0, 6.28), apart = random.uniform(0.0, 3.0) * edge;
    const Vec3 axis(std::cos(angle), std::sin(angle), 0.0);
    const SurfacePoint a = query.closest(Vec3(middle + 0.5 * apart * axis)).point;
    const SurfacePoint b = query.closest(Vec3(middle - 0.5 * apart * axis)).point;
    const auto placement = placePair(*charts, query, a, b, axis, edge, scratch);
    if (!placement) continue;
    ++placed;
    EXPECT_LT((position(mesh, placement->a) - position(mesh, a)).norm(), edge) << round;
    EXPECT_LT((position(mesh, placement->b) - position(mesh, b)).norm(), edge) << round;

    const Complex za = flat(position(mesh, placement->a)), zb = flat(position(mesh, placement->b)),
                  zs = flat(position(mesh, placement->saddle));
    const VectorField field = sampled(charts, [&](const Vec3& p) {
      const Complex v = (flat(p) - za) * (flat(p) - zb) * std::conj(flat(p) - zs);
      return Vec3(v.real(), v.imag(), 0.0);
    });
    const std::vector<int> indices = poincareIndices(field);
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      const int wanted = f == placement->a.face || f == placement->b.face ? 1 : (f == placement->saddle.face ? -1 : 0);
      EXPECT_EQ(indices[f], wanted) << "round " << round << ", face " << f;
    }
  }
  EXPECT_GT(placed, 35);
}

TEST(PairPlacement, FindsNoneOnAMeshOfTwoFaces) {
  const auto charts = test::makeCharts(test::grid(1));
  const ClosestPointQuery query(charts->meshPointer());
  LogMapScratch scratch(charts->mesh());
  const SurfacePoint p{0, Eigen::Vector3d::Constant(1.0 / 3.0)};
  EXPECT_FALSE(placePair(*charts, query, p, p, Vec3::UnitX(), charts->mesh().meanEdgeLength(), scratch));
}

}  // namespace
}  // namespace stormfield
