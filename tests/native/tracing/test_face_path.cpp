#include "tracing/face_path.h"

#include <gtest/gtest.h>

#include "fixtures.h"
#include "tracing/streamline.h"

namespace stormfield {
namespace {

struct Comparison {
  int steps = 0, partial = 0;
  int worse = 0;       ///< steps whose error exceeds the tolerance
  double worst = 0.0;  ///< largest error as a multiple of the tolerance
};

/// Steps from random points of sides and of faces, against the other integrator with a tolerance out of reach.
Comparison compare(const test::ChartsPointer& charts, const VectorField& field, double tolerance) {
  const TriangleMesh& mesh = charts->mesh();
  const FlatFaces faces(charts);
  const double edge = mesh.meanEdgeLength();
  const StepLimits limits{tolerance * edge, 1e-4, 0.0};
  test::Random random(1);
  const auto unit = [&] { return random.uniform(0.0, 1.0); };
  // Out of reach of steps in closed form, so that the other integrator takes it.
  const double reference = std::min(1e-10, 1e-4 * tolerance);
  Comparison result;
  for (SurfacePoint seed : test::randomSeeds(mesh, 3000, 2)) {
    SidePoint entry;
    if (unit() < 0.8) {
      entry = {random.below(3), unit()};
      seed.barycentric.setZero();
      seed.barycentric[entry.side] = 1.0 - entry.fraction;
      seed.barycentric[(entry.side + 1) % 3] = entry.fraction;
    }
    const auto value = [&](int corner) { return field.values[mesh.vertex(seed.face, corner)]; };
    FaceStep step;
    const FaceFlow flow(faces[seed.face], {value(0), value(1), value(2)});
    if (!stepThroughFace(flow, entry, seed.barycentric, limits, step)) continue;
    SurfacePoint end{seed.face, step.barycentric};
    if (step.exit.side >= 0) {
      end.barycentric.setZero();
      end.barycentric[step.exit.side] = 1.0 - step.exit.fraction;
      end.barycentric[(step.exit.side + 1) % 3] = step.exit.fraction;
    }
    const TraceEnd exact = traceStreamline(faces, field, seed, {.maxTime = step.duration, .tolerance = reference});
    const double error =
        std::max((position(mesh, end) - position(mesh, exact.point)).norm(), std::abs(step.length - exact.length)) /
        (tolerance * edge);
    ++result.steps;
    result.partial += step.exit.side < 0;
    result.worse += error > 1.0;
    result.worst = std::max(result.worst, error);
  }
  return result;
}

TEST(FacePath, ErrorsAreWithinTheTolerance) {
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    const auto sphere = test::makeCharts(test::dividedIcosahedron(20));
    const Comparison smooth = compare(sphere, sampled(sphere, analytic::swirl()), tolerance);
    EXPECT_GT(smooth.steps, 1500);  // half of the points on sides do not flow into the face
    EXPECT_LE(smooth.worse, 0.002 * smooth.steps);
    EXPECT_LT(smooth.worst, 5.0);
    // Twists of a tenth of a radian, faces of all shapes.
    const auto torus = test::makeCharts(test::torus(40, 20, 1.0, 0.4, 0.3));
    const Comparison rough = compare(torus, sampled(torus, analytic::swirl()), tolerance);
    EXPECT_GT(rough.steps, 1500);
    EXPECT_LE(rough.worse, 0.05 * rough.steps);
    EXPECT_LT(rough.worst, 50.0);
  }
}

TEST(FacePath, MostFacesOfASmoothFieldTakeOneStep) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(40));
  const Comparison c = compare(charts, sampled(charts, analytic::swirl()), 1e-6);
  EXPECT_LT(c.partial, 0.1 * c.steps);
}

TEST(FacePath, PlanarFieldsAreExact) {
  const auto charts = test::makeCharts(test::grid(12, 0.3));
  const VectorField field =
      sampled(charts, [](const Vec3& p) { return Vec3(0.3 + 0.2 * p.y(), 0.2 - 0.1 * p.x(), 0.0); });
  const Comparison c = compare(charts, field, 1e-9);
  EXPECT_GT(c.steps, 1500);
  EXPECT_LT(c.worst, 0.1);
}

TEST(FacePath, RefusesRestAndCorners) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(4));
  const FlatFaces faces(charts);
  FaceStep step;
  const StepLimits limits{1e-6, 1e-4, 1e-12};
  const Eigen::Vector3d middle(0.3, 0.3, 0.4);
  EXPECT_FALSE(stepThroughFace(FaceFlow(faces[0], {0.0, 0.0, 0.0}), {}, middle, limits, step));
  EXPECT_FALSE(stepThroughFace(FaceFlow(faces[0], {1.0, 1.0, 1.0}), {}, {1.0, 0.0, 0.0}, limits, step));
}

TEST(FacePath, PathsThatTurnRoundEndInside) {
  const auto charts = test::makeCharts(test::grid(2));
  const TriangleMesh& mesh = charts->mesh();
  const FlatFaces faces(charts);
  // Half circles, in over a side and out over the same.
  const Vec3 center = position(mesh, {0, {0.5, 0.5, 0.0}});
  const VectorField field =
      sampled(charts, [&](const Vec3& p) { return Vec3(center.y() - p.y(), p.x() - center.x(), 0.0); });
  const auto value = [&](int corner) { return field.values[mesh.vertex(0, corner)]; };
  const FaceFlow flow(faces[0], {value(0), value(1), value(2)});
  for (const double away : {0.05, 0.1, 0.2}) {
    const Eigen::Vector3d seed(0.5 - away, 0.5 + away, 0.0);
    FaceStep step;
    ASSERT_TRUE(stepThroughFace(flow, {0, 0.5 + away}, seed, {1e-7, 1e-2, 0.0}, step));
    ASSERT_EQ(step.exit.side, -1);
    EXPECT_GT(step.duration, 0.2);
    const Vec3 from = position(mesh, {0, seed}) - center;
    const double c = std::cos(step.duration), s = std::sin(step.duration);
    const Vec3 turned(c * from.x() - s * from.y(), s * from.x() + c * from.y(), 0.0);
    EXPECT_LT((position(mesh, {0, step.barycentric}) - center - turned).norm(), 1e-7);
    EXPECT_NEAR(step.length, from.norm() * step.duration, 1e-7);
  }
}

TEST(FacePath, EndsAfterTheLongestDuration) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(4));
  const FlatFaces faces(charts);
  FaceStep step;
  const Eigen::Vector3d middle(0.3, 0.3, 0.4);
  ASSERT_TRUE(stepThroughFace(FaceFlow(faces[0], {1.0, 1.0, 1.0}), {}, middle, {1e-6, 1e-2, 0.0, 1e-3}, step));
  EXPECT_EQ(step.exit.side, -1);
  EXPECT_EQ(step.duration, 1e-3);
}

}  // namespace
}  // namespace stormfield
