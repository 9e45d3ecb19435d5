#include "edit/transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "checks.h"
#include "edited_fields.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Another random field at every sample.
ParameterizedField randomOverLambda(const ChartsPointer& charts, Index samples) {
  std::vector<Complex> values;
  for (Index j = 0; j < samples; ++j) {
    const VectorField field = randomField(charts, 3 + j);
    values.insert(values.end(), field.values.begin(), field.values.end());
  }
  return makeParameterizedField(charts, evenLambdas(samples), values);
}

/// One field at all samples.
ParameterizedField still(const VectorField& field, Index samples) {
  std::vector<Complex> values;
  for (Index j = 0; j < samples; ++j) values.insert(values.end(), field.values.begin(), field.values.end());
  return makeParameterizedField(field.charts, evenLambdas(samples), values);
}

double largestDifference(const ParameterizedField& a, Index j, const ParameterizedField& b, Index k) {
  double largest = 0.0;
  for (Index v = 0; v < a.vertexCount(); ++v) largest = std::max(largest, std::abs(a.sample(j)[v] - b.sample(k)[v]));
  return largest;
}

/// The axis of an x direction in the plane, in every chart.
FieldValues alongX(const ParameterizedField& field) {
  std::vector<Complex> axes;
  for (Index j = 0; j < field.sampleCount(); ++j) {
    for (Index v = 0; v < field.vertexCount(); ++v) axes.push_back(field.charts->toTangent(v, Vec3(1.0, 0.0, 0.0)));
  }
  return axes;
}

TEST(Transform, TurnsEveryVectorByExactAngles) {
  const ParameterizedField field = randomOverLambda(makeCharts(icosphere(3)), 11);
  const double from = 0.2, to = 0.7, angle = 1.234;
  const ParameterizedField turned = transformField(field, {.keys = {{from}, {to, angle}}});
  for (Index j = 0; j < field.sampleCount(); ++j) {
    const double part = std::clamp((field.lambdas[j] - from) / (to - from), 0.0, 1.0);
    for (Index v = 0; v < field.vertexCount(); ++v) {
      const Complex before = field.sample(j)[v], after = turned.sample(j)[v];
      expectNear(after, before * std::polar(1.0, part * angle), 1e-14);
      if (field.lambdas[j] < from) {
        EXPECT_EQ(before, after);
      }
    }
  }
}

TEST(Transform, QuarterTurnMakesCentersOfSourcesAndMovesNoZero) {
  const VectorField source = sampledOn(scaled(grid(20, 0.2), 1.0), [](const Vec3& p) { return p; });
  const ParameterizedField turned = transformField(still(source, 3), {.keys = {{0.0}, {1.0, 0.5 * kPi}}});
  for (const Index j : {0, 1, 2}) {
    const VectorField now = sampleField(turned, j);
    EXPECT_EQ(poincareIndices(now), poincareIndices(source)) << j;
    const Points vectors = toSpace(now);
    const double a = 0.25 * kPi * j;
    for (Index v = 0; v < now.mesh().vertexCount(); ++v) {
      const Vec3 p = now.mesh().point(v);
      expectNear(Vec3(vectors.row(v)),
                 {std::cos(a) * p.x() - std::sin(a) * p.y(), std::sin(a) * p.x() + std::cos(a) * p.y(), 0.0}, 1e-12);
    }
  }
}

TEST(Transform, OneStepAndThousandAgree) {
  const VectorField field = sampledOn(grid(6, 0.2), [](const Vec3& p) { return Vec3(1.0 + p.y(), p.x() - 0.3, 0.0); });
  const ParameterizedField one = still(field, 2), many = still(field, 1001);
  const std::vector<TransformKey> keys = {{0.0}, {1.0, 2.5, 3.0, 0.2}};
  const ParameterizedField last = transformField(one, {.keys = keys, .axes = alongX(one)});
  const ParameterizedField all = transformField(many, {.keys = keys, .axes = alongX(many)});
  EXPECT_LE(largestDifference(last, 1, all, 1000), 1e-12);
  // V_j = M V_(j-1) with one matrix of turning and scaling for all steps.
  const ParameterizedField spun = transformField(many, {.keys = {{0.0}, {1.0, 2.5, 3.0}}});
  const Complex step = std::polar(std::pow(3.0, 1e-3), 2.5e-3);
  std::vector<Complex> product = field.values;
  for (Index j = 1; j <= 1000; ++j) {
    for (Complex& value : product) value *= step;
    for (Index v = 0; v < spun.vertexCount(); ++v) expectNear(spun.sample(j)[v], product[v], 1e-9);
  }
  // Two transforms after each other are one.
  const ParameterizedField half = transformField(many, {.keys = {{0.0}, {0.5, 1.25, std::sqrt(3.0)}}});
  const ParameterizedField both = transformField(half, {.keys = {{0.5}, {1.0, 1.25, std::sqrt(3.0)}}});
  EXPECT_LE(largestDifference(spun, 1000, both, 1000), 1e-12);
  EXPECT_LE(largestDifference(spun, 700, both, 700), 1e-12);
}

TEST(Transform, StretchesAlongItsAxisAlone) {
  const VectorField field = sampledOn(grid(8, 0.2), [](const Vec3& p) { return Vec3(1.0 + p.y(), p.x(), 0.0); });
  const ParameterizedField over = still(field, 5);
  const ParameterizedField result = transformField(over, {.keys = {{0.0}, {1.0, 0.0, 2.0, 9.0}}, .axes = alongX(over)});
  const Points before = toSpace(field);
  for (Index j = 0; j < 5; ++j) {
    const Points after = toSpace(sampleField(result, j));
    const double scale = std::pow(2.0, 0.25 * j), stretch = std::pow(9.0, 0.25 * j);
    for (Index v = 0; v < field.mesh().vertexCount(); ++v) {
      expectNear(Vec3(after.row(v)), {scale * stretch * before(v, 0), scale * before(v, 1), 0.0}, 1e-12);
    }
  }
}

TEST(Transform, FrozenFieldIsThatOfTheFirstKey) {
  const ParameterizedField field = randomOverLambda(makeCharts(icosphere(2)), 9);
  const ParameterizedField result =
      transformField(field, {.keys = {{0.25}, {0.75, kPi, 4.0}}, .source = TransformOf::FieldAtFirstKey});
  EXPECT_EQ(largestDifference(result, 1, field, 1), 0.0);
  for (Index v = 0; v < field.vertexCount(); ++v) {
    const Complex start = field.sample(2)[v];
    expectNear(result.sample(2)[v], start, 0.0);
    expectNear(result.sample(4)[v], start * Complex(0.0, 2.0), 1e-12);
    expectNear(result.sample(6)[v], -4.0 * start, 1e-12);
    expectNear(result.sample(8)[v], -4.0 * start, 1e-12);
  }
}

TEST(Transform, RegionFadesAndKeepsWhatIsOutside) {
  const ParameterizedField field = randomOverLambda(makeCharts(grid(20)), 2);
  const TriangleMesh& mesh = field.charts->mesh();
  std::vector<Index> faces;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && mesh.point(mesh.vertex(f, k)).norm() < 0.4;
    if (inside) faces.push_back(f);
  }
  const double falloff = 0.3;
  const std::vector<double> weights = falloffWeights(mesh, faces, falloff);
  for (const Index f : faces) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(weights[mesh.vertex(f, k)], 1.0);
  }
  const ParameterizedField result = transformField(field, {.keys = {{0.0}, {1.0, 1.0, 3.0}}, .weights = weights});
  int fading = 0;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const Complex before = field.sample(1)[v], after = result.sample(1)[v];
    if (mesh.point(v).norm() > 0.4 + falloff) {
      EXPECT_EQ(weights[v], 0.0);
    }
    if (weights[v] == 0.0) {
      EXPECT_EQ(before, after);
    }
    expectNear(after, std::polar(std::pow(3.0, weights[v]), weights[v]) * before, 1e-12);
    fading += weights[v] > 0.0 && weights[v] < 1.0 ? 1 : 0;
  }
  EXPECT_GT(fading, 20);
  const std::vector<double> sharp = falloffWeights(mesh, faces, 0.0);
  EXPECT_TRUE(std::all_of(sharp.begin(), sharp.end(), [](double w) { return w == 0.0 || w == 1.0; }));
}

TEST(Transform, KeysMayTurnBackAndStayAfterTheLast) {
  const ParameterizedField field = randomOverLambda(makeCharts(grid(4)), 11);
  const ParameterizedField result = transformField(field, {.keys = {{0.1}, {0.4, kPi, 2.0}, {0.8}}});
  EXPECT_EQ(largestDifference(result, 0, field, 0), 0.0);
  EXPECT_LE(largestDifference(result, 8, field, 8), 1e-15);
  EXPECT_EQ(largestDifference(result, 10, field, 10), 0.0);
  for (Index v = 0; v < field.vertexCount(); ++v) expectNear(result.sample(4)[v], -2.0 * field.sample(4)[v], 1e-12);
}

TEST(Transform, RefusesWhatItCannotDo) {
  const ParameterizedField field = randomOverLambda(makeCharts(grid(4)), 2);
  const auto refuses = [&](const TransformOptions& options, const std::vector<std::string>& parts) {
    expectFault<InputError>([&] { transformField(field, options); }, parts);
  };
  refuses({}, {"needs a key"});
  refuses({.keys = {{0.0, kNan}}}, {"key 0", "not finite"});
  refuses({.keys = {{0.0, 0.0, 0.0}}}, {"scales by 0", "factors above 0"});
  refuses({.keys = {{0.0, 0.0, 1.0, -2.0}}}, {"stretches by -2"});
  refuses({.keys = {{0.0}, {0.0, 1.0}}}, {"key 1", "not after"});
  refuses({.keys = {{0.0, 0.0, 1.0, 2.0}}}, {"needs an axis"});
  refuses({.keys = {{0.0}}, .weights = {1.0}}, {"1 weights for 25 vertices"});
  refuses({.keys = {{0.0}}, .weights = std::vector<double>(25, 2.0)}, {"a weight is 2"});
  refuses({.keys = {{0.0}}, .axes = FieldValues(7)}, {"7 axes for 50 vectors"});
  refuses({.keys = {{0.0}}, .axes = std::vector<Complex>(50, 3.0)}, {"axis has the length 3"});
  const TriangleMesh& mesh = field.charts->mesh();
  expectFault<InputError>([&] { falloffWeights(mesh, {999}, 0.1); }, {"there is no face 999"});
  expectFault<InputError>([&] { falloffWeights(mesh, {0}, -1.0); }, {"falloff is -1"});
}

}  // namespace
}  // namespace stormfield::test
