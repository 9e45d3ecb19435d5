#include "field/vector_field.h"

#include <gtest/gtest.h>

#include <limits>

#include "checks.h"
#include "field/parameterized_field.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(VectorField, ConvertsToSpaceAndBack) {
  const VectorField field = randomField(makeCharts(bumpySphere(2)), 1);
  const VectorField back = fromSpace(field.charts, toSpace(field));
  for (std::size_t v = 0; v < field.values.size(); ++v) expectNear(back.values[v], field.values[v], 1e-14);
}

TEST(VectorField, DropsNormalParts) {
  const auto charts = makeCharts(icosphere(2));
  const VectorField field = fromSpace(charts, charts->normals());
  for (const Complex value : field.values) expectNear(value, 0.0, 1e-14);
}

TEST(VectorField, RefusesWhatDoesNotFit) {
  const auto charts = makeCharts(tetrahedron());
  expectFault<InputError>([&] { makeVectorField(charts, std::vector<Complex>(3)); }, {"3 vectors", "4 vertices"});
  expectFault<InputError>([&] { fromSpace(charts, Points::Zero(5, 3)); }, {"5 vectors", "4 vertices"});
  expectFault<InputError>(
      [&] {
        makeVectorField(charts, {0.0, 0.0, Complex(0.0, kNaN), 0.0});
      },
      {"vertex 2", "not finite"});
}

ParameterizedField twoSamples(const std::shared_ptr<const VertexCharts>& charts) {
  std::vector<Complex> values = randomField(charts, 1).values;
  const std::vector<Complex> second = randomField(charts, 2).values;
  values.insert(values.end(), second.begin(), second.end());
  return makeParameterizedField(charts, {0.25, 0.75}, values);
}

TEST(ParameterizedField, IsLinearBetweenItsSamples) {
  const ParameterizedField field = twoSamples(makeCharts(tetrahedron()));
  for (Index v = 0; v < 4; ++v) {
    const Complex a = field.sample(0)[v], b = field.sample(1)[v];
    EXPECT_EQ(at(field, 0.25).values[v], a);
    EXPECT_EQ(at(field, 0.75).values[v], b);
    EXPECT_EQ(at(field, 0.0).values[v], a) << "clamped";
    EXPECT_EQ(at(field, 1.0).values[v], b) << "clamped";
    EXPECT_EQ(sampleField(field, 1).values[v], b);
    expectNear(at(field, 0.35).values[v], 0.8 * a + 0.2 * b, 1e-15);
  }
}

TEST(ParameterizedField, RefusesWhatDoesNotFit) {
  const auto charts = makeCharts(tetrahedron());
  const auto make = [&](std::vector<double> lambdas, std::size_t count) {
    return [=] { makeParameterizedField(charts, lambdas, std::vector<Complex>(count)); };
  };
  expectFault<InputError>(make({}, 0), {"no samples"});
  expectFault<InputError>(make({0.0, 1.5}, 8), {"sample 1", "1.5", "between 0 and 1"});
  expectFault<InputError>(make({kNaN}, 4), {"sample 0", "between 0 and 1"});
  expectFault<InputError>(make({0.5, 0.5}, 8), {"sample 1", "sort"});
  expectFault<InputError>(make({0.0, 1.0}, 7), {"7 vectors", "8"});
  std::vector<Complex> values(8);
  values[6] = kNaN;
  expectFault<InputError>([&] { makeParameterizedField(charts, {0.0, 1.0}, values); }, {"vertex 2", "sample 1"});
  const ParameterizedField field = twoSamples(charts);
  expectFault<InputError>([&] { sampleField(field, 2); }, {"sample 2", "0 to 1"});
  expectFault<InputError>([&] { at(field, kNaN); }, {"lambda", "not finite"});
}

}  // namespace
}  // namespace stormfield::test
