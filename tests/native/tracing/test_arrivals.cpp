#include "tracing/arrivals.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <limits>

#include "base/error.h"
#include "data_sets.h"
#include "fixtures.h"
#include "tracing/detail/unsteady_step.h"

namespace stormfield {
namespace {

/// Pairs of seeds on one path each, at vertices and between them.
std::vector<PathlineSeed> seedsOn(const TriangleMesh& mesh, double time, double longest) {
  std::vector<SurfacePoint> points = test::randomSeeds(mesh, 300, 5);
  for (Index v = 0; v < mesh.vertexCount(); v += std::max(1, mesh.vertexCount() / 300)) {
    points.push_back(vertexPoint(mesh, v));
  }
  std::vector<PathlineSeed> seeds;
  for (const SurfacePoint& p : points) {
    seeds.push_back({p, time, 0.3 * longest});
    seeds.push_back({p, time, longest});
  }
  return seeds;
}

struct Errors {
  double mean = 0.0, largest = 0.0;  ///< mean edges
};

template <typename Places>
Errors errorsOf(const TriangleMesh& mesh, const std::vector<TraceEnd>& exact, const Places& places) {
  Errors errors;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double distance = (position(mesh, exact[i].point) - position(mesh, places(i))).norm() / mesh.meanEdgeLength();
    errors.mean += distance / static_cast<double>(exact.size());
    errors.largest = std::max(errors.largest, distance);
  }
  return errors;
}

/// That arrivals are no less exact than the paths of the integrator with the same tolerance.
void expectExact(const ParameterizedField& field, double longest, const std::string& name) {
  const TriangleMesh& mesh = field.charts->mesh();
  const FlatFaces faces(field.charts);
  const UnsteadyField flow(faces, field, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}}, longest);
  for (const Direction direction : {Direction::Forward, Direction::Backward}) {
    const auto seeds = seedsOn(mesh, direction == Direction::Forward ? 0.1 : 0.9, 0.8);
    const auto exact = tracePathlineEnds(flow, seeds, {.direction = direction, .tolerance = 1e-11});
    for (const double tolerance : {1e-4, 1e-6}) {
      const TraceOptions options{.direction = direction, .tolerance = tolerance};
      const auto alone = tracePathlineEnds(flow, seeds, options);
      const auto places = traceArrivals(flow, seeds, options);
      const Errors of = errorsOf(mesh, exact, [&](std::size_t i) { return places[i]; });
      const Errors before = errorsOf(mesh, exact, [&](std::size_t i) { return alone[i].point; });
      EXPECT_LE(of.mean, before.mean + 1e-8) << name << ", tolerance " << tolerance;
      EXPECT_LE(of.largest, 3.0 * before.largest + 1e-6) << name << ", tolerance " << tolerance;
    }
  }
}

TEST(Arrivals, AreNoLessExactThanOnePathAtATime) {
  const std::pair<std::string, test::Surface> surfaces[] = {{"sphere", test::dividedIcosahedron(12)},
                                                            {"rough torus", test::torus(30, 16, 1.0, 0.4, 0.2)},
                                                            {"bumpy sphere", test::bumpySphere(3)},
                                                            {"cube", test::cube()}};
  for (const auto& [name, surface] : surfaces) {
    const auto charts = test::makeCharts(surface);
    expectExact(test::blend({sampled(charts, analytic::swirl()), sampled(charts, analytic::swirl(1.0)),
                             sampled(charts, analytic::swirl(2.0))}),
                1.0, name);
  }
}

TEST(Arrivals, AreExactOnFacesOfAllShapes) {
  const auto data = test::dataSet("gasEngineV.t");
  if (!data) GTEST_SKIP() << test::withoutDataSet("gasEngineV.t");
  const VectorField field = test::fieldOn(*data);
  VectorField turned = field;
  for (Complex& v : turned.values) v *= Complex(0.6, 0.3);
  double fastest = 0.0;
  for (const Complex& v : field.values) fastest = std::max(fastest, std::abs(v));
  expectExact(test::blend({field, turned, field}), 20.0 * field.mesh().meanEdgeLength() / fastest, "gas engine");
}

TEST(Arrivals, LinearInTimeIsExactInThePlane) {
  const auto charts = test::makeCharts(test::grid(12, 0.3));
  const FlatFaces faces(charts);
  const Vec3 a(0.3, 0.0, 0.0), b(-0.1, 0.4, 0.0);
  const auto constant = [&](const Vec3& v) { return sampled(charts, [&](const Vec3&) { return v; }); };
  const ParameterizedField field = test::blend({constant(a), constant(b)});
  const UnsteadyField flow(faces, field, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}}, 0.5);
  for (const SurfacePoint& seed : test::randomSeeds(charts->mesh(), 200, 2)) {
    if (position(charts->mesh(), seed).norm() > 0.6) continue;
    // From t = 0.25: the integral of (1 - s) a + s b, at half speed.
    const auto places = traceArrivals(flow, {{seed, 0.25, 0.0}, {seed, 0.25, 0.5}}, {});
    const Vec3 expected = 0.5 * (0.5 * a + (0.75 * 0.75 - 0.25 * 0.25) / 2.0 * (b - a));
    EXPECT_EQ((position(charts->mesh(), places[0]) - position(charts->mesh(), seed)).norm(), 0.0);
    EXPECT_NEAR((position(charts->mesh(), places[1]) - position(charts->mesh(), seed) - expected).norm(), 0.0, 1e-12);
  }
}

TEST(Arrivals, StayOnTheBoundaryAndWhereNothingMoves) {
  const auto charts = test::makeCharts(test::grid(10, 0.2));
  const FlatFaces faces(charts);
  const TriangleMesh& mesh = charts->mesh();
  const ParameterizedField still = test::blend({test::zeroField(charts), test::zeroField(charts)});
  const ParameterizedField wind = test::blend({sampled(charts, [](const Vec3&) { return Vec3(1.0, 0.0, 0.0); })});
  const auto seeds = seedsOn(mesh, 0.5, 5.0);
  const auto rest = traceArrivals({faces, still, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}}}, seeds, {});
  const UnsteadyField flow(faces, wind, {.times = {0.0}, .lambdas = {0.0}});
  const auto blown = traceArrivals(flow, seeds, {});
  const auto alone = tracePathlineEnds(flow, seeds, {});
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const Vec3 start = position(mesh, seeds[i].point);
    EXPECT_LT((position(mesh, rest[i]) - start).norm(), 1e-7);
    if (std::abs(start.y()) > 0.999) continue;  // along the boundary, or stopped there by round-off
    EXPECT_LT((position(mesh, blown[i]) - position(mesh, alone[i].point)).norm(), 1e-6);
    const Vec3 expected(std::min(1.0, start.x() + seeds[i].maxTime), start.y(), start.z());
    EXPECT_LT((position(mesh, blown[i]) - expected).norm(), 1e-6);
  }
}

TEST(Arrivals, ParticleAtRestIsSetInMotion) {
  const auto charts = test::makeCharts(test::grid(6));
  const FlatFaces faces(charts);
  const auto constant = [&](double speed) {
    return sampled(charts, [&](const Vec3&) { return Vec3(speed, 0.3 * speed, 0.0); });
  };
  const ParameterizedField field = test::blend({constant(0.0), constant(0.0), constant(0.4)});
  const UnsteadyField flow(faces, field, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}});
  for (const SurfacePoint& seed : {vertexPoint(charts->mesh(), 24), SurfacePoint{30, {0.2, 0.3, 0.5}}}) {
    const Vec3 way =
        position(charts->mesh(), traceArrivals(flow, {{seed, 0.0, 1.0}}, {}).front()) - position(charts->mesh(), seed);
    EXPECT_NEAR((way - Vec3(0.1, 0.03, 0.0)).norm(), 0.0, 1e-6);
  }
}

TEST(Arrivals, AreTheSameForAnyNumberOfThreads) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(16));
  const FlatFaces faces(charts);
  const ParameterizedField field =
      test::blend({sampled(charts, analytic::swirl()), sampled(charts, analytic::swirl(1.0))});
  const UnsteadyField flow(faces, field, {.times = {0.0, 1.0}, .lambdas = {0.0, 1.0}});
  const auto seeds = seedsOn(charts->mesh(), 0.0, 1.0);
  const auto many = traceArrivals(flow, seeds, {});
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const auto one = traceArrivals(flow, seeds, {});
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    EXPECT_EQ(many[i].face, one[i].face);
    EXPECT_EQ(many[i].barycentric, one[i].barycentric);
    // Nor does it matter with which others a path is followed.
    if (i % 40 != 0) continue;
    const auto alone = traceArrivals(flow, {seeds[i], seeds[i + 1]}, {});
    EXPECT_EQ(alone[1].barycentric, many[i + 1].barycentric);
  }
}

TEST(Arrivals, AreTheSameOnEveryProcessor) {
  const auto charts = test::makeCharts(test::torus(20, 12, 1.0, 0.4, 0.2));
  const FlatFaces faces(charts);
  lanes::UnsteadyParticles fast{};
  const auto seeds = test::randomSeeds(charts->mesh(), 8 * 200, 9);
  int steps = 0;
  for (std::size_t first = 0; first < seeds.size(); first += 8) {
    for (int lane = 0; lane < 8; ++lane) {
      const SurfacePoint& p = seeds[first + lane];
      const FlatFace& face = faces[p.face];
      for (int i = 0; i < 3; ++i) {
        for (int axis = 0; axis < 2; ++axis) {
          fast.rate[i][axis][lane] = std::sin(1.7 * static_cast<double>(first) + lane + 3.0 * i) + 0.7 * axis + 0.5;
          fast.change[i][axis][lane] = 0.1 * std::cos(static_cast<double>(first) + lane + i) + 0.05 * axis;
        }
        fast.tanHalf[i][lane] = face.tanHalf(i);
        fast.doubleTwist[i][lane] = face.doubleTwist(i);
      }
      fast.start[0][lane] = p.barycentric[1];
      fast.start[1][lane] = p.barycentric[2];
      fast.entry[lane] = -1.0;
      fast.maxDuration[lane] = 0.4;
      fast.foot[lane] = 0.4F;
      fast.height[lane] = 0.9F;
      fast.allowed[lane] = 1e-4F;
    }
    lanes::UnsteadyParticles plain = fast;
    lanes::unsteadyStep()(fast);
    lanes::UnsteadyStepKernel<4>::step(plain);
    for (int lane = 0; lane < 8; ++lane) {
      EXPECT_EQ(fast.exit[lane], plain.exit[lane]);
      if (static_cast<int>(plain.exit[lane]) == lanes::UnsteadyParticles::kNoStep) continue;
      ++steps;
      EXPECT_EQ(fast.end[0][lane], plain.end[0][lane]);
      EXPECT_EQ(fast.end[1][lane], plain.end[1][lane]);
      EXPECT_EQ(fast.duration[lane], plain.duration[lane]);
    }
  }
  EXPECT_GT(steps, 800);
}

TEST(Arrivals, RefuseBadInput) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(2));
  const FlatFaces faces(charts);
  const ParameterizedField field = test::blend({sampled(charts, analytic::swirl())});
  const UnsteadyField flow(faces, field, {.times = {0.0}, .lambdas = {0.0}});
  const SurfacePoint p = vertexPoint(charts->mesh(), 3);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(traceArrivals(flow, {}, {}).empty());
  EXPECT_THROW(traceArrivals(flow, {{p, 0.0, infinity}}, {}), InputError);
  EXPECT_THROW(traceArrivals(flow, {{p, infinity, 1.0}}, {}), InputError);
  EXPECT_THROW(traceArrivals(flow, {{p, 0.0, -1.0}}, {}), InputError);
  EXPECT_THROW(traceArrivals(flow, {{p, 0.0, 1.0}, {p, 0.0, 0.5}}, {}), InputError);
  EXPECT_THROW(traceArrivals(flow, {{{99999, p.barycentric}, 0.0, 1.0}}, {}), InputError);
  EXPECT_THROW(traceArrivals(flow, {{p, 0.0, 1.0}}, {.tolerance = 0.0}), InputError);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(traceArrivals(flow, {{p, 0.0, 1.0}}, {}, &progress), Cancelled);
}

}  // namespace
}  // namespace stormfield
