#include "texture/stream_function.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "fixtures.h"
#include "tracing/streamline.h"

namespace stormfield {
namespace {

double atPoint(const TriangleMesh& mesh, const std::vector<double>& psi, const SurfacePoint& p) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) sum += p.barycentric[i] * psi[mesh.vertex(p.face, i)];
  return sum;
}

TEST(StreamFunction, RotationOfASphereIsHeight) {
  double previous = 1.0;
  for (const Index n : {6, 12, 24}) {
    const auto charts = test::makeCharts(test::dividedIcosahedron(n));
    const VectorField field = sampled(charts, [](const Vec3& p) { return Vec3(Vec3::UnitZ().cross(p)); });
    const auto psi = StreamFunctionSolver(charts).solve(field.values.data());
    double worst = 0.0;
    for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
      worst = std::max(worst, std::abs(psi[v] - charts->mesh().point(v).z()));
    }
    EXPECT_LT(worst, 0.3 * previous);
    previous = worst;
  }
  EXPECT_LT(previous, 0.005);
}

TEST(StreamFunction, GradientFieldsHaveNone) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(16));
  const VectorField field = sampled(charts, [](const Vec3& p) { return Vec3(1.0 - p.x() * p.x(), 0.0, 0.0); });
  for (const double psi : StreamFunctionSolver(charts).solve(field.values.data())) EXPECT_NEAR(psi, 0.0, 0.02);
}

TEST(StreamFunction, StreamlinesFollowItsLevels) {
  // The divergence-free field of a known stream function with six extrema.
  const auto charts = test::makeCharts(test::dividedIcosahedron(32));
  const auto known = [](const Vec3& p) { return p.x() * p.x() + 0.5 * p.y() * p.y() * p.z(); };
  const VectorField field = sampled(
      charts, [](const Vec3& p) { return Vec3(Vec3(2.0 * p.x(), p.y() * p.z(), 0.5 * p.y() * p.y()).cross(p)); });
  const auto psi = StreamFunctionSolver(charts).solve(field.values.data());
  const FlatFaces faces(charts);
  for (const SurfacePoint& seed : test::randomSeeds(charts->mesh(), 100, 3)) {
    const TraceEnd end = traceStreamline(faces, field, seed, {.maxLength = 1.0});
    EXPECT_NEAR(atPoint(charts->mesh(), psi, end.point), atPoint(charts->mesh(), psi, seed), 0.003);
    const Vec3 a = position(charts->mesh(), seed).normalized(), b = position(charts->mesh(), end.point).normalized();
    EXPECT_NEAR(known(a), known(b), 0.005);
  }
}

TEST(StreamFunction, HoldsOnPlanesAndEveryComponent) {
  // Two squares side by side: shear flow (-y, 0) has psi = -y^2 / 2 with mean zero on each.
  const auto one = test::makeCharts(test::grid(12, 0.2));
  const Index n = one->mesh().vertexCount();
  Points points(2 * n, 3);
  points << one->mesh().points(), one->mesh().points().rowwise() + Eigen::RowVector3d(5.0, 0.0, 0.0);
  Triangles triangles(2 * one->mesh().faceCount(), 3);
  triangles << one->mesh().triangles(), one->mesh().triangles().array() + n;
  const auto charts = test::makeCharts({points, triangles});
  const VectorField field = sampled(charts, [](const Vec3& p) { return Vec3(-p.y(), 0.0, 0.0); });
  const auto psi = StreamFunctionSolver(charts).solve(field.values.data());
  for (Index v = 0; v < 2 * n; ++v) {
    EXPECT_NEAR(psi[v], 1.0 / 6.0 - 0.5 * std::pow(points(v, 1), 2), 0.02);
  }
}

TEST(StreamFunction, IsLinearAndTheSameForSequences) {
  const auto charts = test::makeCharts(test::torus(20, 12, 1.0, 0.4, 0.2));
  const VectorField a = sampled(charts, analytic::swirl()), b = sampled(charts, analytic::swirl(1.0));
  std::vector<Complex> values = a.values;
  values.insert(values.end(), b.values.begin(), b.values.end());
  const ParameterizedField field{charts, {0.0, 1.0}, values};
  const StreamFunctionSolver solver(charts);
  const auto both = streamFunctions(field, solver);
  std::vector<Complex> mixed(a.values.size());
  for (std::size_t v = 0; v < mixed.size(); ++v) mixed[v] = 0.25 * a.values[v] + 0.75 * b.values[v];
  const auto psi = solver.solve(mixed.data());
  for (std::size_t v = 0; v < mixed.size(); ++v) {
    EXPECT_NEAR(psi[v], 0.25 * both[v] + 0.75 * both[mixed.size() + v], 1e-12);
  }
  Progress progress;
  progress.cancel();
  EXPECT_THROW(streamFunctions(field, solver, &progress), Cancelled);
}

TEST(StreamFunction, DoesNotDependOnTheFieldsBesideIt) {
  const auto charts = test::makeCharts(test::torus(20, 12, 1.0, 0.4, 0.2));
  const Index n = charts->mesh().vertexCount();
  const int together = StreamFunctionSolver::kTogether;
  std::vector<Complex> values;
  for (int k = 0; k < together; ++k) {
    const VectorField field = sampled(charts, analytic::swirl(0.5 * k));
    values.insert(values.end(), field.values.begin(), field.values.end());
  }
  const StreamFunctionSolver solver(charts);
  const auto all = solver.solve(values.data(), together);
  ASSERT_EQ(static_cast<Index>(all.size()), together * n);
  for (int k = 0; k < together; ++k) {
    const auto alone = solver.solve(values.data() + static_cast<std::ptrdiff_t>(k) * n);
    EXPECT_TRUE(std::equal(alone.begin(), alone.end(), all.begin() + static_cast<std::ptrdiff_t>(k) * n)) << k;
  }
}

}  // namespace
}  // namespace stormfield
