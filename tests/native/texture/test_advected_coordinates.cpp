#include "texture/advected_coordinates.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/error.h"
#include "fixtures.h"
#include "long_tests.h"
#include "texture/stagger.h"

namespace stormfield {
namespace {

std::shared_ptr<const ParameterizedField> shared(const std::vector<VectorField>& samples) {
  return std::make_shared<ParameterizedField>(test::blend(samples));
}

struct Scene {
  test::ChartsPointer charts;
  std::shared_ptr<const FlatFaces> faces;
  std::shared_ptr<const ParameterizedField> field;

  explicit Scene(const std::vector<VectorField>& samples)
      : charts(samples.front().charts), faces(std::make_shared<FlatFaces>(charts)), field(shared(samples)) {}

  AdvectedCoordinates coordinates(const AdvectionOptions& options) const {
    return {faces, field, {0.0, 100.0}, {0.0, 1.0}, options, stagger(charts->mesh(), {}, options.deadZone)};
  }
};

Scene stormy(Index n = 10) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(n));
  return Scene({sampled(charts, analytic::swirl()), sampled(charts, analytic::swirl(1.0)),
                sampled(charts, analytic::swirl(2.5))});
}

Vec3 row(const std::vector<float>& a, Index v) {
  return {a[3 * static_cast<std::size_t>(v)], a[3 * static_cast<std::size_t>(v) + 1],
          a[3 * static_cast<std::size_t>(v) + 2]};
}

TEST(BlendWeight, IsExactlyZeroAndOneInTheDeadZones) {
  for (const double age : {0.0, 0.05, 0.1, 0.9, 0.95, 1.0}) EXPECT_EQ(blendWeight(age, 0.1), 1.0);
  for (const double age : {0.4, 0.45, 0.5, 0.6}) EXPECT_EQ(blendWeight(age, 0.1), 0.0);
  for (double age = 0.0; age <= 0.5; age += 0.01) {
    EXPECT_NEAR(blendWeight(age, 0.1), blendWeight(1.0 - age, 0.1), 1e-12);
    EXPECT_NEAR(blendWeight(age, 0.1) + blendWeight(age + 0.5, 0.1), 1.0, 1e-12);
  }
}

TEST(Stagger, IsSmoothWellMixedAndRespectsTheDeadZone) {
  const auto fine = test::makeCharts(test::dividedIcosahedron(24));
  const auto offsets = stagger(fine->mesh(), {.cycles = 1.0, .frequency = 1.5}, 0.1);
  const auto [low, high] = std::minmax_element(offsets.begin(), offsets.end());
  EXPECT_GT(*high - *low, 0.5);
  EXPECT_LT(largestStaggerStep(fine->mesh(), offsets).difference, 0.1);
  const auto coarse = test::makeCharts(test::dividedIcosahedron(1));
  EXPECT_LE(largestStaggerStep(coarse->mesh(), stagger(coarse->mesh(), {}, 0.05)).difference, 0.05 * (1 + 1e-12));
  EXPECT_NE(stagger(fine->mesh(), {.seed = 1}, 0.1), offsets);
}

TEST(AdvectedCoordinates, RotationOfASphereTurnsThemBack) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(24));
  const Scene scene({sampled(charts, [](const Vec3& p) { return Vec3(Vec3::UnitZ().cross(p)); })});
  const AdvectionOptions options{.period = 40.0, .speed = 0.5, .renewal = 0.0};
  const AdvectedCoordinates coordinates = scene.coordinates(options);
  const AdvectedFrame frame = coordinates.frame(33.0);
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const double c = 33.0 / 40.0 + coordinates.offsets()[v];
    const double angle = -0.5 * (c - std::floor(c)) * 40.0 / 24.0;
    const Vec3 expected = Eigen::AngleAxisd(angle, Vec3::UnitZ()) * charts->mesh().point(v);
    EXPECT_LT((row(frame.phaseA, v) - expected).norm(), 0.003);
    EXPECT_EQ(frame.blend[v], static_cast<float>(blendWeight(c - std::floor(c), 0.1)));
  }
}

TEST(AdvectedCoordinates, MoveContinuouslyFromFrameToFrame) {
  // What is visible at a vertex moves by about the speed per frame; a jump only happens where its weight is zero.
  const Scene scene = stormy(test::shortOrLong(6, 10));
  const AdvectedCoordinates coordinates = scene.coordinates({.period = 24.0});
  AdvectedFrame before = coordinates.frame(40.0);
  for (int f = 41; f < 66; ++f) {
    const AdvectedFrame now = coordinates.frame(f);
    for (Index v = 0; v < scene.charts->mesh().vertexCount(); ++v) {
      const double jumpA = (row(now.phaseA, v) - row(before.phaseA, v)).norm();
      const double jumpB = (row(now.phaseB, v) - row(before.phaseB, v)).norm();
      EXPECT_TRUE(jumpA < 0.5 || now.blend[v] == 1.0F) << jumpA;
      EXPECT_TRUE(jumpB < 0.5 || now.blend[v] == 0.0F) << jumpB;
      EXPECT_LT(std::abs(now.blend[v] - before.blend[v]), 0.25);
    }
    before = now;
  }
}

TEST(AdvectedCoordinates, NoTriangleShowsOnePhaseAtTwoCycles) {
  for (const Index n : {2, 5, test::shortOrLong(10, 16)}) {
    const Scene scene = stormy(n);
    const TriangleMesh& mesh = scene.charts->mesh();
    const AdvectedCoordinates coordinates = scene.coordinates({.period = 24.0});
    for (int f = 0; f < 48; f += test::shortOrLong(5, 3)) {
      const AdvectedFrame frame = coordinates.frame(f);
      for (Index t = 0; t < mesh.faceCount(); ++t) {
        for (const double shift : {0.0, 0.5}) {
          double cycles[3], visible = 0.0;
          for (int i = 0; i < 3; ++i) {
            const Index v = mesh.vertex(t, i);
            cycles[i] = std::floor(f / 24.0 + coordinates.offsets()[v] + shift);
            visible = std::max<double>(visible, shift == 0.0 ? 1.0F - frame.blend[v] : frame.blend[v]);
          }
          EXPECT_TRUE(visible == 0.0 || (cycles[0] == cycles[1] && cycles[1] == cycles[2]));
        }
      }
    }
  }
}

TEST(AdvectedCoordinates, CyclesShowOtherPiecesOfTexture) {
  const Scene scene = stormy(4);
  const auto plain = scene.coordinates({.period = 20.0, .renewal = 0.0}), renewed = scene.coordinates({.period = 20.0});
  const Index v = 11;
  const Vec3 first = row(renewed.frame(10.0).phaseA, v) - row(plain.frame(10.0).phaseA, v);
  const Vec3 second = row(renewed.frame(30.0).phaseA, v) - row(plain.frame(30.0).phaseA, v);
  EXPECT_GT((first - second).norm(), 0.1);
  EXPECT_LT(first.norm(), scene.charts->mesh().size());
}

TEST(AdvectedCoordinates, EveryFrameStandsForItself) {
  const Scene scene = stormy();
  const AdvectedCoordinates one = scene.coordinates({}), other = scene.coordinates({});
  other.frame(3.0);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const AdvectedFrame a = one.frame(77.0), b = other.frame(77.0);
  EXPECT_EQ(a.phaseA, b.phaseA);
  EXPECT_EQ(a.phaseB, b.phaseB);
  EXPECT_EQ(a.blend, b.blend);
}

TEST(AdvectedCoordinates, ErrorIsFarBelowAnEdge) {
  const Scene scene = stormy();
  const CarriedError error = scene.coordinates({}).error(60.0, test::shortOrLong(150, 1000));
  EXPECT_LT(error.mean, 1e-3);
  EXPECT_LT(error.largest, 0.05);
  EXPECT_GT(error.meanBetween, error.mean);
  EXPECT_LT(error.meanBetween, 0.5);
}

TEST(AdvectedCoordinates, InflowStaysOnTheBoundary) {
  const auto charts = test::makeCharts(test::grid(10, 0.2));
  const Scene scene({sampled(charts, [](const Vec3&) { return Vec3(1.0, 0.0, 0.0); })});
  const AdvectedFrame frame = scene.coordinates({.period = 48.0, .renewal = 0.0}).frame(20.0);
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    EXPECT_GE(row(frame.phaseA, v).x(), -1.0);
    EXPECT_NEAR(row(frame.phaseA, v).y(), charts->mesh().point(v).y(), 1e-6);
  }
}

TEST(AdvectedCoordinates, RefuseBadInput) {
  const Scene scene = stormy(3);
  EXPECT_THROW(scene.coordinates({.framesPerSecond = 0.0}), InputError);
  EXPECT_THROW(scene.coordinates({.period = 1.0}), InputError);
  EXPECT_THROW(scene.coordinates({.deadZone = 0.3}), InputError);
  EXPECT_THROW(scene.coordinates({.renewal = -1.0}), InputError);
  std::vector<double> rough(scene.charts->mesh().vertexCount(), 0.0);
  EXPECT_THROW(AdvectedCoordinates(scene.faces, scene.field, {0.0}, {0.0}, {}, {}), InputError);
  EXPECT_THROW(AdvectedCoordinates(scene.faces, scene.field, {}, {}, {}, rough), InputError);
  EXPECT_THROW(AdvectedCoordinates(scene.faces, scene.field, {1.0, 0.0}, {0.0, 1.0}, {}, rough), InputError);
  rough[3] = 0.4;
  EXPECT_THROW(AdvectedCoordinates(scene.faces, scene.field, {0.0}, {0.0}, {}, rough), InputError);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(scene.coordinates({}).frame(1.0, &progress), Cancelled);
}

}  // namespace
}  // namespace stormfield
