#include "tracing/particle_lines.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/error.h"
#include "fixtures.h"
#include "mesh/closest_point.h"
#include "tracing/streamline.h"

namespace stormfield {
namespace {

Vec3 at(const FlatFaces& faces, const SurfacePoint& p) {
  return position(faces.mesh(), p);
}

/// A field with its faces, followed along lambda = t for 0 <= t <= 1.
struct Scene {
  explicit Scene(const test::ChartsPointer& charts, const std::vector<VectorField>& samples)
      : faces(charts), field{charts, {}, {}} {
    std::vector<Complex> values;
    for (std::size_t j = 0; j < samples.size(); ++j) {
      field.lambdas.push_back(samples.size() > 1 ? static_cast<double>(j) / static_cast<double>(samples.size() - 1)
                                                 : 0.0);
      values.insert(values.end(), samples[j].values.begin(), samples[j].values.end());
    }
    field.values = values;
  }
  UnsteadyField flow() const { return {faces, field, {{0.0, 1.0}, {0.0, 1.0}}}; }

  FlatFaces faces;
  ParameterizedField field;
};

Scene swirl(int samples) {
  const auto charts = test::makeCharts(test::torus(40, 20, 1.0, 0.4, 0.2));
  std::vector<VectorField> fields;
  for (int j = 0; j < samples; ++j) fields.push_back(sampled(charts, analytic::swirl(0.4 * j)));
  return Scene(charts, fields);
}

TEST(ParticleLines, AFieldConstantInLambdaMakesTheFourCurvesAgree) {
  const auto charts = test::makeCharts(test::torus(40, 20, 1.0, 0.4, 0.2));
  const VectorField steady = sampled(charts, analytic::swirl());
  const Scene scene(charts, {steady, steady, steady});
  const auto flow = scene.flow();
  const auto seeds = test::randomSeeds(charts->mesh(), 20, 3);
  LineOptions options;
  options.tolerance = 1e-9;
  options.interval = 0.05;
  const auto streaks = traceStreaklines(flow, seeds, 0.0, {0.25, 0.5}, options);
  ASSERT_EQ(streaks.size(), 2U);
  const double edge = charts->mesh().meanEdgeLength();
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    EXPECT_EQ(streaks[1].offsets[i + 1] - streaks[1].offsets[i], 11U);
    for (std::size_t k = streaks[1].offsets[i]; k < streaks[1].offsets[i + 1]; ++k) {
      const double age = streaks[1].ages[k];
      const TraceEnd streamline = traceStreamline(scene.faces, steady, seeds[i], {.maxTime = age, .tolerance = 1e-9});
      EXPECT_LT((at(scene.faces, streaks[1].points[k]) - at(scene.faces, streamline.point)).norm(), 1e-5 * edge);
    }
  }
  // The timeline is the front of the streamlines from all points of the curve.
  const auto fronts = traceTimelines(flow, {seeds}, 0.0, {0.25, 0.5}, {.tolerance = 1e-9});
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const TraceEnd streamline = traceStreamline(scene.faces, steady, seeds[i], {.maxTime = 0.5, .tolerance = 1e-9});
    EXPECT_LT((at(scene.faces, fronts[1].points[i]) - at(scene.faces, streamline.point)).norm(), 1e-5 * edge);
  }
}

TEST(ParticleLines, EveryPointIsTheEndOfAPathline) {
  const Scene scene = swirl(4);
  const auto flow = scene.flow();
  const double edge = scene.faces.mesh().meanEdgeLength();
  const auto seeds = test::randomSeeds(scene.faces.mesh(), 8, 5);
  const auto lines = traceStreaklines(flow, seeds, 0.1, {0.3, 0.6, 0.9}, {.spacing = 0.5 * edge, .tolerance = 1e-9});
  for (const ParticleLines& line : lines) {
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      for (std::size_t k = line.offsets[i]; k < line.offsets[i + 1]; ++k) {
        EXPECT_DOUBLE_EQ(line.parameters[k] + line.ages[k], line.time);
        const auto end = tracePathlineEnds(flow, {{seeds[i], line.parameters[k], line.ages[k]}}, {.tolerance = 1e-9});
        EXPECT_LT((at(scene.faces, end[0].point) - at(scene.faces, line.points[k])).norm(), 1e-4 * edge);
      }
    }
  }
}

TEST(ParticleLines, ParticlesJoinWhereALineStretches) {
  const Scene scene = swirl(3);
  const double edge = scene.faces.mesh().meanEdgeLength(), spacing = 0.25 * edge;
  std::vector<SurfacePoint> curve;
  for (const int corner : {0, 1, 2}) {
    SurfacePoint p{100, Eigen::Vector3d::Constant(0.1)};
    p.barycentric[corner] = 0.8;
    curve.push_back(p);
  }
  const auto fronts = traceTimelines(scene.flow(), {curve, curve}, 0.0, {0.2, 1.0}, {.spacing = spacing});
  ASSERT_EQ(fronts[1].offsets.size(), 3U);
  EXPECT_GT(fronts[1].offsets[1], fronts[0].offsets[1]);
  for (const ParticleLines& front : fronts) {
    EXPECT_EQ(front.parameters.front(), 0.0);
    EXPECT_EQ(front.parameters[front.offsets[1] - 1], 2.0);
    for (std::size_t k = 0; k + 1 < front.offsets[1]; ++k) {
      EXPECT_LT(front.parameters[k], front.parameters[k + 1]);
      EXPECT_LE((at(scene.faces, front.points[k]) - at(scene.faces, front.points[k + 1])).norm(),
                spacing * (1.0 + 1e-9));
      EXPECT_FALSE(front.torn[k]);
    }
  }
}

TEST(ParticleLines, EarlierTimesDoNotChangeALine) {
  const Scene scene = swirl(3);
  const auto seeds = test::randomSeeds(scene.faces.mesh(), 1, 11);
  const auto curve = std::vector<SurfacePoint>{{7, {0.8, 0.1, 0.1}}, {7, {0.1, 0.1, 0.8}}};
  const LineOptions options{.spacing = 0.02, .tolerance = 1e-9};
  const auto direct = traceTimelines(scene.flow(), {curve}, 0.0, {0.7}, options);
  const auto stepwise = traceTimelines(scene.flow(), {curve}, 0.0, {0.1, 0.2, 0.4, 0.7}, options);
  const auto& a = direct.back();
  const auto& b = stepwise.back();
  // Particles that both have are at the same places.
  std::size_t common = 0;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    for (std::size_t j = 0; j < b.points.size(); ++j) {
      if (a.parameters[i] != b.parameters[j]) continue;
      ++common;
      EXPECT_LT((at(scene.faces, a.points[i]) - at(scene.faces, b.points[j])).norm(), 1e-6);
    }
  }
  EXPECT_GE(common, 2U);
}

TEST(ParticleLines, ParticlesStayWhereTheBoundaryStopsThem) {
  const auto charts = test::makeCharts(test::grid(16));
  const VectorField field = sampled(charts, [](const Vec3& p) { return Vec3(p.x() > 0.0 ? 1.0 : -1.0, 0.2, 0.0); });
  const Scene scene(charts, {field});
  const ClosestPointQuery query(charts->meshPointer());
  std::vector<SurfacePoint> curve;
  for (const double x : {-0.4, -0.2, 0.2, 0.4}) curve.push_back(query.closest(Vec3(x, -0.5, 0.0)).point);
  const auto fronts = traceTimelines(scene.flow(), {curve}, 0.0, {5.0}, {.spacing = 0.05});
  const auto& front = fronts.back();
  for (std::size_t k = 0; k < front.points.size(); ++k) {
    EXPECT_NEAR(at(scene.faces, front.points[k]).cwiseAbs().maxCoeff(), 1.0, 1e-9);
  }
}

TEST(ParticleLines, SameForAnyNumberOfThreads) {
  const Scene scene = swirl(3);
  const auto seeds = test::randomSeeds(scene.faces.mesh(), 30, 4);
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return traceStreaklines(scene.flow(), seeds, 0.0, {0.5, 1.0}, {.spacing = 0.02});
  };
  const auto one = run(1), many = run(4);
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].offsets, many[k].offsets);
    EXPECT_EQ(one[k].parameters, many[k].parameters);
    for (std::size_t i = 0; i < one[k].points.size(); ++i) {
      EXPECT_EQ(one[k].points[i].barycentric, many[k].points[i].barycentric);
    }
  }
}

TEST(ParticleLines, RefuseBadInput) {
  const Scene scene = swirl(2);
  const auto flow = scene.flow();
  const auto seeds = test::randomSeeds(scene.faces.mesh(), 2, 1);
  EXPECT_THROW(traceStreaklines(flow, seeds, 0.5, {0.2}, {}), InputError);
  EXPECT_THROW(traceStreaklines(flow, seeds, 0.0, {0.4, 0.2}, {}), InputError);
  EXPECT_THROW(traceStreaklines(flow, seeds, 0.0, {1.0}, {.spacing = 0.0}), InputError);
  EXPECT_THROW(traceStreaklines(flow, seeds, 0.0, {1.0}, {.spacing = 1e-4, .maxParticles = 100}), InputError);
  EXPECT_THROW(traceTimelines(flow, {{{-1, {1, 0, 0}}}}, 0.0, {1.0}, {}), InputError);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(traceStreaklines(flow, seeds, 0.0, {1.0}, {}, &progress), Cancelled);
  EXPECT_TRUE(traceTimelines(flow, {}, 0.0, {1.0}, {}).front().points.empty());
}

}  // namespace
}  // namespace stormfield
