#include "tracing/streamline.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <limits>

#include "base/error.h"
#include "fixtures.h"
#include "tracing/integrator.h"

namespace stormfield {
namespace {

Vec3 at(const FlatFaces& faces, const SurfacePoint& p) {
  return position(faces.mesh(), p);
}

double distanceInEdges(const FlatFaces& faces, const SurfacePoint& a, const SurfacePoint& b) {
  return (at(faces, a) - at(faces, b)).norm() / faces.mesh().meanEdgeLength();
}

VectorField rotation(const test::ChartsPointer& charts) {
  return sampled(charts, [](const Vec3& p) { return Vec3(Vec3::UnitZ().cross(p)); });
}

TEST(Streamline, ConstantPlanarFieldIsExact) {
  const auto charts = test::makeCharts(test::grid(16, 0.3));
  const FlatFaces faces(charts);
  const Vec3 velocity(0.3, 0.2, 0.0);
  const VectorField field = sampled(charts, [&](const Vec3&) { return velocity; });
  for (const SurfacePoint& seed : test::randomSeeds(charts->mesh(), 200, 1)) {
    const TraceEnd end = traceStreamline(faces, field, seed, {.maxTime = 0.8});
    const bool left = end.reason == StopReason::Boundary;
    EXPECT_TRUE(left || end.time == 0.8);
    EXPECT_NEAR((at(faces, end.point) - at(faces, seed) - end.time * velocity).norm(), 0.0, 1e-12);
    EXPECT_NEAR(end.length, end.time * velocity.norm(), 1e-12);
    EXPECT_NEAR(left ? at(faces, end.point).cwiseAbs().maxCoeff() : 1.0, 1.0, 1e-12);
  }
}

TEST(Streamline, AlongEdgesAndThroughVertices) {
  // Edges of the regular square run along x, y and the diagonal; all seeds are vertices or lie on edges.
  const auto charts = test::makeCharts(test::grid(8));
  const FlatFaces faces(charts);
  for (const Vec3& velocity : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 1, 0), Vec3(-1, -1, 0), Vec3(1, 2, 0)}) {
    const VectorField field = sampled(charts, [&](const Vec3&) { return velocity; });
    for (Index f = 0; f < charts->mesh().faceCount(); ++f) {
      for (const Eigen::Vector3d& b :
           {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0.5, 0.5), Eigen::Vector3d(0, 1, 0)}) {
        const SurfacePoint seed{f, b};
        const TraceEnd end = traceStreamline(faces, field, seed, {});
        const Vec3 from = at(faces, seed), to = at(faces, end.point);
        EXPECT_EQ(end.reason, StopReason::Boundary);
        EXPECT_NEAR(to.cwiseAbs().maxCoeff(), 1.0, 1e-9);
        EXPECT_NEAR((to - from - end.time * velocity).norm(), 0.0, 1e-9);
      }
    }
  }
}

TEST(Streamline, RotationOfASphereClosesWithTheRightPeriod) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(24));
  const FlatFaces faces(charts);
  const VectorField field = rotation(charts);
  for (const SurfacePoint& seed : test::randomSeeds(charts->mesh(), 50, 2)) {
    const double radius = at(faces, seed).head<2>().norm();
    const TraceEnd end = traceStreamline(faces, field, seed, {.maxTime = 2.0 * std::numbers::pi});
    EXPECT_EQ(end.reason, StopReason::Time);
    // The mesh is no exact sphere: what remains falls with the square of the edge length (0.06 here).
    EXPECT_LT((at(faces, end.point) - at(faces, seed)).norm(), 0.004);
    EXPECT_NEAR(end.length, 2.0 * std::numbers::pi * radius, 0.02);
  }
}

TEST(Streamline, ClosedCirclesCloseBetterOnFinerMeshes) {
  double previous = 1.0;
  for (const Index n : {8, 16, 32}) {
    const auto charts = test::makeCharts(test::dividedIcosahedron(n));
    const FlatFaces faces(charts);
    const VectorField field = rotation(charts);
    double worst = 0.0;
    for (const SurfacePoint& seed : test::randomSeeds(charts->mesh(), 30, 4)) {
      const TraceEnd end = traceStreamline(faces, field, seed, {.maxTime = 2.0 * std::numbers::pi});
      worst = std::max(worst, (at(faces, end.point) - at(faces, seed)).norm());
    }
    EXPECT_LT(worst, 0.4 * previous);
    previous = worst;
  }
}

TEST(Streamline, ForwardThenBackwardReturns) {
  for (const auto& charts :
       {test::makeCharts(test::dividedIcosahedron(16)), test::makeCharts(test::torus(40, 20, 1.0, 0.4, 0.3))}) {
    const FlatFaces faces(charts);
    const VectorField field = sampled(charts, analytic::swirl());
    for (const SurfacePoint& seed : test::randomSeeds(charts->mesh(), 100, 3)) {
      const TraceEnd there = traceStreamline(faces, field, seed, {.maxTime = 0.5, .tolerance = 1e-8});
      if (there.reason != StopReason::Time) continue;
      const TraceEnd back = traceStreamline(faces, field, there.point,
                                            {.direction = Direction::Backward, .maxTime = 0.5, .tolerance = 1e-8});
      EXPECT_LT(distanceInEdges(faces, back.point, seed), 1e-4);
      EXPECT_NEAR(back.length, there.length, 1e-5);
    }
  }
}

TEST(Streamline, ErrorFollowsTheTolerance) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(16));
  const FlatFaces faces(charts);
  const VectorField field = sampled(charts, analytic::swirl());
  const auto seeds = test::randomSeeds(charts->mesh(), 200, 6);
  const auto exact = traceStreamlineEnds(faces, field, seeds, {.maxTime = 0.3, .tolerance = 1e-12});
  double previous = 1.0;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    const auto ends = traceStreamlineEnds(faces, field, seeds, {.maxTime = 0.3, .tolerance = tolerance});
    double worst = 0.0;
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      worst = std::max(worst, distanceInEdges(faces, ends[i].point, exact[i].point));
    }
    EXPECT_LT(worst, 100.0 * tolerance);
    EXPECT_LT(worst, 0.2 * previous);
    previous = worst;
  }
}

TEST(Streamline, SamePathFromBothSidesOfAnEdge) {
  const auto charts = test::makeCharts(test::torus(30, 16, 1.0, 0.4, 0.3));
  const TriangleMesh& mesh = charts->mesh();
  const FlatFaces faces(charts);
  const VectorField field = sampled(charts, analytic::swirl());
  for (Index e = 0; e < mesh.edgeCount(); e += 7) {
    const Index h = mesh.edgeHalfedge(e), t = mesh.twin(h);
    SurfacePoint left{TriangleMesh::face(h), Eigen::Vector3d::Zero()},
        right{TriangleMesh::face(t), Eigen::Vector3d::Zero()};
    left.barycentric[TriangleMesh::corner(h)] = right.barycentric[(TriangleMesh::corner(t) + 1) % 3] = 0.3;
    left.barycentric[(TriangleMesh::corner(h) + 1) % 3] = right.barycentric[TriangleMesh::corner(t)] = 0.7;
    const TraceEnd a = traceStreamline(faces, field, left, {.maxTime = 0.3, .tolerance = 1e-9});
    const TraceEnd b = traceStreamline(faces, field, right, {.maxTime = 0.3, .tolerance = 1e-9});
    EXPECT_LT(distanceInEdges(faces, a.point, b.point), 1e-6);
  }
}

TEST(Streamline, EndsAtAFixedPoint) {
  const auto charts = test::makeCharts(test::grid(20, 0.2));
  const FlatFaces faces(charts);
  // A spiral sink between vertices: linear, so that the mesh represents it exactly.
  const Vec3 center(0.03, -0.07, 0.0);
  const VectorField field = sampled(charts, [&](const Vec3& p) {
    const Vec3 d = p - center;
    return Vec3(-d.x() - 2.0 * d.y(), 2.0 * d.x() - d.y(), 0.0);
  });
  for (const double tolerance : {1e-2, 1e-6}) {
    for (const SurfacePoint& seed : test::randomSeeds(charts->mesh(), 100, 8)) {
      if ((at(faces, seed) - center).norm() > 0.9) continue;
      const TraceEnd end = traceStreamline(faces, field, seed, {.tolerance = tolerance});
      EXPECT_EQ(end.reason, StopReason::MinSpeed);
      EXPECT_LT((at(faces, end.point) - center).norm(), 1e-5);
      EXPECT_LT(end.steps, 1000);
    }
  }
}

TEST(Streamline, SlidesAlongTheBoundaryUntilTheFlowTurnsInwards) {
  const auto charts = test::makeCharts(test::grid(10, 0.2));
  const FlatFaces faces(charts);
  // To the right and away from y = 0 on the left half, back down on the right half.
  const VectorField field = sampled(charts, [](const Vec3& p) { return Vec3(0.5, -p.x(), 0.0); });
  for (const SurfacePoint& s : test::randomSeeds(charts->mesh(), 300, 9)) {
    if (at(faces, s).y() < 0.95 || at(faces, s).x() > -0.5) continue;
    const TraceEnd stopped = traceStreamline(faces, field, s, {});
    EXPECT_EQ(stopped.reason, StopReason::Boundary);
    EXPECT_NEAR(at(faces, stopped.point).y(), 1.0, 1e-9);
    // It leaves the boundary at x = 0 and then follows the parabola y = 1 - x^2.
    const TraceEnd slid = traceStreamline(faces, field, s, {.boundary = BoundaryRule::Slide, .maxSteps = 2000});
    const Vec3 end = at(faces, slid.point);
    EXPECT_EQ(slid.reason, StopReason::Boundary) << end.transpose();
    EXPECT_NEAR(end.x(), 1.0, 1e-9);
    const TraceEnd half =
        traceStreamline(faces, field, s, {.maxTime = (0.8 - at(faces, s).x()) / 0.5, .boundary = BoundaryRule::Slide});
    EXPECT_NEAR(at(faces, half.point).x(), 0.8, 1e-6);
    EXPECT_NEAR(at(faces, half.point).y(), 1.0 - 0.64, 1e-6);
  }
}

TEST(Streamline, NeverLeavesAndNeverLoopsForEver) {
  const std::vector<test::ChartsPointer> meshes = {
      test::makeCharts(test::dividedIcosahedron(6)), test::makeCharts(test::torus(14, 9, 1.0, 0.4, 0.45)),
      test::makeCharts(test::cube()), test::makeCharts(test::grid(12, 0.45))};
  for (unsigned run = 0; run < 40; ++run) {
    const auto& charts = meshes[run % meshes.size()];
    const FlatFaces faces(charts);
    const VectorField field = test::randomField(charts, run);
    auto seeds = test::randomSeeds(charts->mesh(), 100, run);
    for (Index v = 0; v < std::min(Index{50}, charts->mesh().vertexCount()); ++v) {
      seeds.push_back(vertexPoint(charts->mesh(), v));
    }
    for (const BoundaryRule rule : {BoundaryRule::Stop, BoundaryRule::Slide}) {
      const TraceOptions options{.maxTime = 20.0, .boundary = rule, .maxSteps = 4000};
      const Traces traces = traceStreamlines(faces, field, seeds, options);
      for (std::size_t i = 0; i < seeds.size(); ++i) {
        EXPECT_LE(traces.ends[i].steps, options.maxSteps + 1);
        EXPECT_TRUE(std::isfinite(traces.ends[i].time) && std::isfinite(traces.ends[i].length));
        EXPECT_GE(traces.offsets[i + 1], traces.offsets[i] + 1);
      }
      for (std::size_t i = 0; i < traces.points.size(); ++i) {
        const SurfacePoint& p = traces.points[i];
        ASSERT_TRUE(p.face >= 0 && p.face < charts->mesh().faceCount());
        ASSERT_GE(p.barycentric.minCoeff(), 0.0);
        ASSERT_NEAR(p.barycentric.sum(), 1.0, 1e-12);
      }
    }
  }
}

TEST(Streamline, PathIsConnectedAndTimesIncrease) {
  const auto charts = test::makeCharts(test::torus(30, 16, 1.0, 0.4, 0.2));
  const FlatFaces faces(charts);
  const VectorField field = sampled(charts, analytic::swirl());
  const Traces traces = traceStreamlines(faces, field, test::randomSeeds(charts->mesh(), 200, 5), {.maxTime = 1.0});
  const double longest = 4.0 * charts->mesh().meanEdgeLength();
  for (std::size_t i = 0; i < traces.ends.size(); ++i) {
    double length = 0.0;
    for (std::size_t k = traces.offsets[i] + 1; k < traces.offsets[i + 1]; ++k) {
      EXPECT_GT(traces.times[k], traces.times[k - 1]);
      const double step = (at(faces, traces.points[k]) - at(faces, traces.points[k - 1])).norm();
      EXPECT_LT(step, longest);
      length += step;
    }
    EXPECT_NEAR(length, traces.ends[i].length, 0.01 * length + 1e-9);
    EXPECT_EQ(traces.times[traces.offsets[i + 1] - 1], traces.ends[i].time);
  }
}

TEST(Streamline, MaxLengthIsMet) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(10));
  const FlatFaces faces(charts);
  const VectorField field = rotation(charts);
  const SurfacePoint seed = vertexPoint(charts->mesh(), 7);
  const TraceEnd end = traceStreamline(faces, field, seed, {.maxLength = 0.7});
  EXPECT_EQ(end.reason, StopReason::Length);
  EXPECT_DOUBLE_EQ(end.length, 0.7);
  EXPECT_NEAR((at(faces, end.point) - at(faces, seed)).norm(), 0.7, 0.1);
}

TEST(Streamline, SameForAnyNumberOfThreads) {
  const auto charts = test::makeCharts(test::torus(30, 16, 1.0, 0.4, 0.2));
  const FlatFaces faces(charts);
  const VectorField field = sampled(charts, analytic::swirl());
  const auto seeds = test::randomSeeds(charts->mesh(), 500, 5);
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return traceStreamlines(faces, field, seeds, {.maxTime = 1.0});
  };
  const Traces one = run(1), many = run(4);
  EXPECT_EQ(one.offsets, many.offsets);
  EXPECT_EQ(one.times, many.times);
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    EXPECT_EQ(one.points[i].face, many.points[i].face);
    EXPECT_EQ(one.points[i].barycentric, many.points[i].barycentric);
  }
}

TEST(Streamline, SideBySideAsAlone) {
  const auto charts = test::makeCharts(test::torus(30, 16, 1.0, 0.4, 0.2));
  const FlatFaces faces(charts);
  const VectorField field = sampled(charts, analytic::swirl());
  const auto seeds = test::randomSeeds(charts->mesh(), 200, 5);
  const TraceOptions options{.maxTime = 1.0, .minSpeed = 0.0};
  const auto together = traceStreamlineEnds(faces, field, seeds, options);
  Integrator<SteadyFlow> integrator(faces, SteadyFlow(field.values.data(), 1.0), options, 0.0);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const TraceEnd alone = integrator.run(seeds[i], 0.0, options.maxTime, [](const SurfacePoint&, double) {});
    EXPECT_EQ(alone.point.face, together[i].point.face);
    EXPECT_EQ(alone.point.barycentric, together[i].point.barycentric);
    EXPECT_EQ(alone.length, together[i].length);
    EXPECT_EQ(alone.crossings, together[i].crossings);
  }
}

TEST(Streamline, FieldOfZerosStaysAtTheSeed) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(3));
  const FlatFaces faces(charts);
  const VectorField field{charts, std::vector<Complex>(charts->mesh().vertexCount(), 0.0)};
  for (const SurfacePoint& seed : {vertexPoint(charts->mesh(), 4), test::randomSeeds(charts->mesh(), 1, 1).front()}) {
    const TraceEnd end = traceStreamline(faces, field, seed, {});
    EXPECT_EQ(end.reason, StopReason::MinSpeed);
    EXPECT_NEAR((at(faces, end.point) - at(faces, seed)).norm(), 0.0, 1e-12);
  }
}

TEST(Streamline, RefusesBadInput) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(2));
  const FlatFaces faces(charts);
  const VectorField field = rotation(charts);
  const SurfacePoint good = vertexPoint(charts->mesh(), 0);
  EXPECT_THROW(traceStreamline(faces, field, {-1, {1, 0, 0}}, {}), InputError);
  EXPECT_THROW(traceStreamline(faces, field, {charts->mesh().faceCount(), {1, 0, 0}}, {}), InputError);
  EXPECT_THROW(traceStreamline(faces, field, {0, {0.6, 0.6, 0.6}}, {}), InputError);
  EXPECT_THROW(traceStreamline(faces, field, {0, {1.5, -0.5, 0.0}}, {}), InputError);
  EXPECT_THROW(traceStreamline(faces, field, {0, {std::numeric_limits<double>::quiet_NaN(), 0.5, 0.5}}, {}),
               InputError);
  EXPECT_THROW(traceStreamline(faces, field, good, {.maxTime = -1.0}), InputError);
  EXPECT_THROW(traceStreamline(faces, field, good, {.tolerance = 0.0}), InputError);
  EXPECT_THROW(traceStreamline(faces, field, good, {.maxSteps = 0}), InputError);
  EXPECT_THROW(traceStreamline(faces, VectorField{charts, {}}, good, {}), InputError);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(traceStreamlineEnds(faces, field, {good}, {}, &progress), Cancelled);
}

}  // namespace
}  // namespace stormfield
