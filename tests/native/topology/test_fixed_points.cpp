#include "topology/fixed_points.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/message.h"
#include "checks.h"
#include "field/poincare_index.h"
#include "fixtures.h"
#include "long_tests.h"
#include "topology/zero_search.h"

namespace stormfield::test {
namespace {

VectorField planarField(const std::shared_ptr<const VertexCharts>& charts, const Eigen::Matrix2d& a,
                        const Vec3& centre) {
  Points vectors = Points::Zero(charts->mesh().vertexCount(), 3);
  for (Index v = 0; v < vectors.rows(); ++v) {
    vectors.row(v).head<2>() = (a * (charts->mesh().point(v) - centre).head<2>()).transpose();
  }
  return fromSpace(charts, vectors);
}

struct Linear {
  const char* name;
  Eigen::Matrix2d matrix;
  FixedPointKind kind;
};

std::vector<Linear> linearFields() {
  const auto matrix = [](double a, double b, double c, double d) {
    return (Eigen::Matrix2d() << a, b, c, d).finished();
  };
  return {{"source", matrix(1, 0, 0, 1), FixedPointKind::Source},
          {"node", matrix(-3, 1, 0, -1), FixedPointKind::Sink},
          {"saddle", matrix(1, 2, 0, -2), FixedPointKind::Saddle},
          {"center", matrix(0, -1, 1, 0), FixedPointKind::Center},
          {"clockwise center", matrix(0, 2, -1, 0), FixedPointKind::Center},
          {"spiral out", matrix(0.2, -1, 1, 0.2), FixedPointKind::Source},
          {"spiral in", matrix(-0.2, 1, -1, -0.2), FixedPointKind::Sink}};
}

TEST(FixedPoints, OfLinearFieldsAreExact) {
  const auto charts = makeCharts(grid(8));
  // Inside a face, on edges (along the axes and the diagonal), at a vertex.
  for (const Vec3& centre : {Vec3(0.11, 0.03, 0), Vec3(0.25, 0.1, 0), Vec3(0.1, -0.5, 0), Vec3(0.1, 0.1, 0),
                             Vec3(0.25, -0.5, 0), Vec3(0, 0, 0)}) {
    for (const Linear& linear : linearFields()) {
      const std::string what = message(linear.name, " at ", centre.transpose());
      const auto found = findFixedPoints(planarField(charts, linear.matrix, centre));
      ASSERT_EQ(found.size(), 1u) << what;
      expectNear(found[0].position, centre, 1e-14, what);
      EXPECT_EQ(found[0].kind, linear.kind) << what << ": " << name(found[0].kind);
      EXPECT_EQ(found[0].index, linear.matrix.determinant() > 0.0 ? 1 : -1) << what;
      EXPECT_NEAR(found[0].rotation, linear.matrix(1, 0) - linear.matrix(0, 1), 1e-12) << what;
      EXPECT_NEAR(found[0].jacobian.determinant(), linear.matrix.determinant(), 1e-12) << what;
      EXPECT_NEAR(found[0].jacobian.trace(), linear.matrix.trace(), 1e-12) << what;
    }
  }
}

TEST(FixedPoints, NearlyCentersObeyTheTolerance) {
  const auto charts = makeCharts(grid(8));
  const Eigen::Matrix2d a = (Eigen::Matrix2d() << 0.01, -1, 1, 0.01).finished();
  const VectorField field = planarField(charts, a, {0.11, 0.03, 0});
  EXPECT_EQ(findFixedPoints(field, {0.001})[0].kind, FixedPointKind::Source);
  EXPECT_EQ(findFixedPoints(field, {0.1})[0].kind, FixedPointKind::Center);
}

TEST(FixedPoints, AtAVertexAreReportedOnce) {
  // A monkey saddle, index -2, on a fan of 12 faces around a zero vertex.
  std::vector<Vec3> points{{0, 0, 0}};
  std::vector<std::array<Index, 3>> faces;
  for (Index i = 0; i < 12; ++i) {
    points.emplace_back(std::cos(kPi * i / 6.0), std::sin(kPi * i / 6.0), 0.0);
    faces.push_back({0, 1 + i, 1 + (i + 1) % 12});
  }
  const auto charts = makeCharts(surface(points, faces));
  for (const int power : {-3, -2, -1, 1, 2, 3}) {
    Points vectors = Points::Zero(13, 3);
    for (Index i = 0; i < 12; ++i) {
      vectors.row(1 + i) << std::cos(power * kPi * i / 6.0 + 0.1), std::sin(power * kPi * i / 6.0 + 0.1), 0.0;
    }
    VectorField field = fromSpace(charts, vectors);
    field.values[0] = 0.0;
    const auto found = findFixedPoints(field);
    ASSERT_EQ(found.size(), 1u) << power;
    EXPECT_EQ(found[0].index, power);
    EXPECT_EQ(found[0].position, Vec3(0, 0, 0));
    EXPECT_EQ(found[0].kind == FixedPointKind::Degenerate, std::abs(power) > 1) << name(found[0].kind);
  }
}

void expectSound(const VectorField& field, const std::string& what) {
  const TriangleMesh& mesh = field.mesh();
  const auto found = findFixedPoints(field);
  int indexSum = 0;
  for (const FixedPoint& p : found) {
    indexSum += p.index;
    EXPECT_GE(p.point.barycentric.minCoeff(), 0.0) << what;
    EXPECT_NEAR(p.point.barycentric.sum(), 1.0, 1e-15) << what;
    expectNear(p.position, position(mesh, p.point), 0.0, what);
    double largest = 0.0;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(field.values[mesh.vertex(p.point.face, k)]));
    if (p.point.barycentric.maxCoeff() < 1.0) {
      EXPECT_LE(evaluate(field, p.point).norm(), 2e-14 * largest) << what << ", face " << p.point.face;
    } else {
      EXPECT_EQ(field.values[nearestVertex(mesh, p.point)], 0.0) << what;
    }
    if (p.kind != FixedPointKind::Degenerate) {
      EXPECT_EQ(p.index, p.kind == FixedPointKind::Saddle ? -1 : 1) << what;
    }
  }
  EXPECT_EQ(indexSum, mesh.eulerCharacteristic()) << what;
}

TEST(FixedPoints, AreZerosInTheirFaces) {
  for (const NamedSurface& s : closedSurfaces()) {
    const auto charts = makeCharts(s.surface);
    for (std::uint64_t seed = 0; seed < shortOrLong(6u, 30u); ++seed) {
      expectSound(randomField(charts, seed), message(s.name, ", random field ", seed));
      expectSound(randomIntegerField(charts, seed), message(s.name, ", integer field ", seed));
    }
    expectSound(zeroField(charts), s.name + ", zero field");
  }
}

TEST(FixedPoints, OfTheReversedFieldSwapSourcesAndSinks) {
  const VectorField field = randomField(makeCharts(bumpySphere(3, 0.2)), 3);
  VectorField reversed = field;
  for (Complex& value : reversed.values) value = -value;
  const auto a = findFixedPoints(field), b = findFixedPoints(reversed);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    FixedPointKind wanted = a[i].kind;
    if (wanted == FixedPointKind::Source)
      wanted = FixedPointKind::Sink;
    else if (wanted == FixedPointKind::Sink)
      wanted = FixedPointKind::Source;
    EXPECT_EQ(b[i].kind, wanted);
    EXPECT_EQ(b[i].point.face, a[i].point.face);
    expectNear(b[i].position, a[i].position, 1e-12);
  }
}

void expectSame(const std::vector<FixedPoint>& a, const std::vector<FixedPoint>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].point.face, b[i].point.face);
    EXPECT_EQ(a[i].position, b[i].position);
    EXPECT_EQ(a[i].kind, b[i].kind);
    EXPECT_EQ(a[i].jacobian, b[i].jacobian);
  }
}

TEST(FixedPoints, DoNotDependOnLabelsOrThreads) {
  const Surface s = bumpySphere(3, 0.2);
  const VectorField field = randomIntegerField(makeCharts(s), 4);
  const auto found = findFixedPoints(field);
  Surface reversedLabels = s;
  const Index last = static_cast<Index>(s.points.rows()) - 1;
  reversedLabels.points = s.points.colwise().reverse();
  reversedLabels.triangles = (last - s.triangles.array()).matrix();
  expectSame(found, findFixedPoints(
                        makeVectorField(makeCharts(reversedLabels), {field.values.rbegin(), field.values.rend()})));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  expectSame(found, findFixedPoints(field));
}

TEST(FixedPoints, TurnWithTheScene) {
  const Surface s = bumpySphere(3, 0.2);
  const VectorField field = randomField(makeCharts(s), 5);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Vec3(-1, 2, 0.5).normalized()).toRotationMatrix();
  const VectorField turned =
      fromSpace(makeCharts({s.points * turn.transpose(), s.triangles}), toSpace(field) * turn.transpose());
  const auto a = findFixedPoints(field), b = findFixedPoints(turned);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].kind, b[i].kind);
    expectNear(turn * a[i].position, b[i].position, 1e-10);
  }
}

TEST(ZeroSearch, FindsZerosWhereNewtonsMethodFails) {
  // Strong twist: three needles around each vertex turn the field by most of a circle inside one face.
  for (const double height : {0.5, 2.0, 8.0, 30.0}) {
    const Surface spike = surface({{1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}, {0, 0, height}},
                                  {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
    const auto charts = makeCharts(spike);
    for (std::uint64_t seed = 0; seed < shortOrLong(50u, 200u); ++seed) {
      const VectorField field = randomField(charts, seed);
      const std::vector<int> indices = poincareIndices(field);
      for (Index f = 0; f < 4; ++f) {
        if (indices[f] == 0) continue;
        const FaceInterpolant local = faceInterpolant(field, f);
        const Eigen::Vector3d b = findZero(local, indices[f]);
        EXPECT_GE(b.minCoeff(), 0.0);
        EXPECT_LE(std::abs(local.evaluate(local.point(b))), 1e-13) << "height " << height << ", seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace stormfield::test
