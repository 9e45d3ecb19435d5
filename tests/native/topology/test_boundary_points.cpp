#include "topology/boundary_points.h"

#include <gtest/gtest.h>

#include <functional>

#include "checks.h"
#include "field/poincare_index.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

/// A disk: a fan of rings around the origin.
Surface disk(int around, int rings) {
  std::vector<Vec3> points{{0, 0, 0}};
  std::vector<std::array<Index, 3>> faces;
  for (int i = 1; i <= rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double u = 2.0 * kPi * j / around, r = static_cast<double>(i) / rings;
      points.emplace_back(r * std::cos(u), r * std::sin(u), 0.0);
    }
  }
  const auto at = [&](int i, int j) { return static_cast<Index>(1 + (i - 1) * around + j % around); };
  for (int j = 0; j < around; ++j) {
    faces.push_back({0, at(1, j), at(1, j + 1)});
    for (int i = 1; i < rings; ++i) {
      faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return surface(points, faces);
}

template <typename Function>
VectorField planar(const Surface& s, const Function& function) {
  Points vectors = Points::Zero(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) {
    const Complex value = function(Complex(s.points(v, 0), s.points(v, 1)));
    vectors.row(v) << value.real(), value.imag(), 0.0;
  }
  return fromSpace(makeCharts(s), vectors);
}

int halfSum(const std::vector<BoundaryPoint>& points) {
  int result = 0;
  for (const BoundaryPoint& p : points) result += p.halfIndex;
  return result;
}

TEST(BoundaryPoints, OfKnownFlowsInADisk) {
  const Surface s = disk(40, 6);
  const Complex turn = std::polar(1.0, 0.03);
  // A uniform flow touches the disk twice from outside, a saddle four times, a source never, a dipole twice from
  // inside.
  struct Case {
    std::function<Complex(Complex)> flow;
    std::size_t points;
    int halfIndex;
  };
  for (const Case& c : {Case{[&](Complex) { return turn; }, 2, 1}, Case{[](Complex z) { return z; }, 0, 0},
                        Case{[&](Complex z) { return turn * std::conj(z); }, 4, 1},
                        Case{[&](Complex z) { return turn * std::conj(z * z); }, 6, 1}}) {
    const auto found = findBoundaryPoints(planar(s, c.flow));
    ASSERT_EQ(found.size(), c.points);
    for (const BoundaryPoint& p : found) EXPECT_EQ(p.halfIndex, c.halfIndex);
  }
  EXPECT_EQ(halfSum(findBoundaryPoints(planar(s, [](Complex z) { return z * z; }))), -2);
}

TEST(BoundaryPoints, LieWhereTheFlowIsTangent) {
  const auto found = findBoundaryPoints(planar(disk(200, 6), [](Complex) { return Complex(1.0, 0.0); }));
  ASSERT_EQ(found.size(), 2u);
  for (const BoundaryPoint& p : found) EXPECT_NEAR(std::abs(p.position.y()), 1.0, 1e-3);
}

TEST(BoundaryPoints, CompleteTheSumOfIndices) {
  auto surfaces = boundedSurfaces();
  surfaces.push_back({"several components", severalComponents(), 3});
  surfaces.push_back({"one triangle", surface({{0, 0, 0}, {1, 0, 0}, {0.2, 0.7, 0}}, {{0, 1, 2}}), 1});
  for (const NamedSurface& s : surfaces) {
    const auto charts = makeCharts(s.surface);
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      for (const VectorField& field : {randomField(charts, seed), randomIntegerField(charts, seed)}) {
        const int inside = sum(poincareIndices(field)), boundary = halfSum(findBoundaryPoints(field));
        EXPECT_EQ(2 * inside + boundary, 2 * charts->mesh().eulerCharacteristic()) << s.name << ", seed " << seed;
      }
    }
    EXPECT_EQ(2 * sum(poincareIndices(zeroField(charts))) + halfSum(findBoundaryPoints(zeroField(charts))),
              2 * charts->mesh().eulerCharacteristic())
        << s.name;
  }
}

TEST(BoundaryPoints, AreTheSameForTheReversedField) {
  const VectorField field = randomField(makeCharts(grid(6, 0.3)), 4);
  VectorField back = field;
  for (Complex& v : back.values) v = -v;
  const auto a = findBoundaryPoints(field), b = findBoundaryPoints(back);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].halfIndex, b[i].halfIndex);
    expectNear(a[i].position, b[i].position, 1e-12);
  }
}

TEST(BoundaryPoints, OfClosedSurfacesAreNone) {
  EXPECT_TRUE(findBoundaryPoints(randomField(makeCharts(icosphere(1)), 1)).empty());
}

}  // namespace
}  // namespace stormfield::test
