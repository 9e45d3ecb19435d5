#include <numbers>

#include "field/interpolation.h"
#include "long_tests.h"
#include "storm_checks.h"

namespace stormfield {
namespace {

using namespace storms;

// One design, solved on finer and finer meshes and samplings of lambda, is one field: elements act on regions with
// densities, so that nothing of them fades as vertices and samples become smaller.

constexpr double kRadius = 0.4;

Vec3 onSphere(double longitude, double latitude) {
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

std::vector<DesignElement> design() {
  auto elements = merge(SingularKind::SpiralInCcw, onSphere(-0.9, 0.25), onSphere(0.8, -0.2), onSphere(0.0, 0.0),
                        onSphere(0.1, 0.3), kRadius);
  elements.push_back(singular("far", SingularKind::Source, {onSphere(3.0, 0.5)}, {0.0, 1.0}, kRadius));
  DesignElement band = elements.back();
  band.name = "band";
  band.type = ElementType::Streamline;
  band.points.clear();
  for (int i = 0; i <= 30; ++i) band.points.push_back(onSphere(1.2 + 0.05 * i, -0.9));
  band.radius = 0.2;
  band.lambdas = {0.2, 0.8};
  elements.push_back(band);
  return elements;
}

/// The field in space at fixed places and values of lambda.
std::vector<Vec3> probes(const SpaceTimeResult& result) {
  const ClosestPointQuery query(result.field.charts->meshPointer());
  std::vector<Vec3> values;
  for (const double lambda : {0.0, 0.13, 0.31, 0.45, 0.7, 0.86, 1.0}) {
    const VectorField field = at(result.field, lambda);
    for (int i = 0; i < 300; ++i)  // a Fibonacci lattice
      values.push_back(evaluate(field, query
                                           .closest(onSphere(i * 2.0 * std::numbers::pi / std::numbers::phi,
                                                             std::asin(1.0 - (2.0 * i + 1.0) / 300)))
                                           .point));
  }
  return values;
}

double difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double squared = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    squared += (a[i] - b[i]).squaredNorm();
    whole += b[i].squaredNorm();
  }
  return std::sqrt(squared / whole);
}

TEST(Resolution, FinerMeshesAndSamplesConverge) {
  std::vector<std::vector<Vec3>> fields;
  Index n = 6, samples = 26;
  for (int level = 0; level < 3; ++level, n *= 2, samples = 2 * samples - 1) {
    const auto result = solved(test::makeCharts(test::dividedIcosahedron(n)), design(), samples, 1e-6);
    fields.push_back(probes(result));
  }
  const double first = difference(fields[0], fields[2]), second = difference(fields[1], fields[2]);
  std::printf("difference to the finest: %.4f at 1/16 of the faces, %.4f at 1/4\n", first, second);
  EXPECT_LT(second, 0.5 * first);
  EXPECT_LT(second, 0.06);
}

TEST(Resolution, SamplesOfLambdaAloneConverge) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  const auto coarse = probes(solved(charts, design(), 26, 1e-6)), middle = probes(solved(charts, design(), 51, 1e-6)),
             fine = probes(solved(charts, design(), 101, 1e-6));
  const double first = difference(coarse, fine), second = difference(middle, fine);
  std::printf("difference to 101 samples: %.4f at 26, %.4f at 51\n", first, second);
  EXPECT_LT(second, 0.6 * first);
  EXPECT_LT(second, 0.02);
}

TEST(Resolution, StormsStayOnTheirPaths) {
  const auto all = design();
  const std::vector<DesignElement> storms(all.begin(), all.begin() + 3);
  Index n = test::shortOrLong(6, 8), samples = test::shortOrLong(15, 26);
  for (int level = 0; level < 3; ++level, n *= 2, samples = 2 * samples - 1) {
    const auto result = solved(test::makeCharts(test::dividedIcosahedron(n)), all, samples);
    for (Index j = 0; j < samples; j += 1 << level) checkSample(result, storms, j, 0.6, true);
  }
}

}  // namespace
}  // namespace stormfield
