#include "texture/flow_attributes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/error.h"
#include "fixtures.h"
#include "texture/rotation.h"

namespace stormfield {
namespace {

/// Rotation about z, eleven samples of growing speed.
ParameterizedField growing(const std::shared_ptr<const VertexCharts>& charts) {
  const VectorField one = sampled(charts, [](const Vec3& p) { return Vec3(Vec3::UnitZ().cross(p)); });
  std::vector<Complex> values;
  for (int j = 0; j < 11; ++j) {
    for (const Complex& value : one.values) values.push_back((1.0 + j) * value);
  }
  return {charts, evenLambdas(11), values};
}

TEST(FlowAttributes, AreThoseOfEachSample) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(8));
  const ParameterizedField field = growing(charts);
  const StreamFunctionSolver streams(charts);
  const Index n = field.vertexCount();
  const FlowAttributes found = flowAttributes(field, 2, 9, streams);
  ASSERT_EQ(static_cast<Index>(found.speed.size()), 9 * n);
  for (const Index j : {0, 5, 8}) {
    const Points vectors = toSpace(sampleField(field, 2 + j));
    const std::vector<double> psi = streams.solve(field.sample(2 + j));
    std::vector<double> curl(n);
    rotation(charts->mesh(), vectors, curl.data());
    for (Index v = 0; v < n; ++v) {
      const std::size_t at = static_cast<std::size_t>(j) * n + v;
      EXPECT_EQ(found.vectors[3 * at], static_cast<float>(vectors(v, 0)));
      EXPECT_EQ(found.vectors[3 * at + 2], static_cast<float>(vectors(v, 2)));
      EXPECT_FLOAT_EQ(found.speed[at], static_cast<float>(vectors.row(v).norm()));
      EXPECT_EQ(found.stream[at], static_cast<float>(psi[v]));
      EXPECT_EQ(found.rotation[at], static_cast<float>(curl[v]));
    }
  }
  EXPECT_EQ(vectorsInSpace(field, 2, 9), found.vectors);
}

TEST(FlowAttributes, DoNotDependOnBlocksOrThreads) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(8));
  const ParameterizedField field = growing(charts);
  const StreamFunctionSolver streams(charts);
  const FlowAttributes all = flowAttributes(field, 0, 11, streams);
  const auto n = static_cast<std::ptrdiff_t>(field.vertexCount());
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (Index first = 0; first < 11; first += 3) {
      const Index count = std::min<Index>(3, 11 - first);
      const FlowAttributes some = flowAttributes(field, first, count, streams);
      EXPECT_TRUE(std::equal(some.stream.begin(), some.stream.end(), all.stream.begin() + first * n));
      EXPECT_TRUE(std::equal(some.rotation.begin(), some.rotation.end(), all.rotation.begin() + first * n));
      EXPECT_TRUE(std::equal(some.speed.begin(), some.speed.end(), all.speed.begin() + first * n));
    }
  }
}

TEST(FlowAttributes, CanBeStopped) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(4));
  const StreamFunctionSolver streams(charts);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(flowAttributes(growing(charts), 0, 11, streams, &progress), Cancelled);
  EXPECT_THROW(vectorsInSpace(growing(charts), 0, 11, &progress), Cancelled);
}

}  // namespace
}  // namespace stormfield
