// The Gronwall bound against pairs of linear flows whose distance has a closed form, and the rates that it rests on.
#include "maps/detail/divergence_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "checks.h"
#include "flat_fields.h"
#include "maps/detail/error_checks.h"
#include "maps/prepared_flow.h"

namespace stormfield::test {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

/// The bound for the field within an error, with the rates of its prepared flow.
DivergenceBound boundOf(const FlatFaces& faces, const VectorField& field, TauUnit unit, const FieldError& error,
                        double slowSpeed = 0.0) {
  const PreparedFlow flow(faces, field, unit, 1e-6);
  std::vector<double> growth;
  for (Index f = 0; f < faces.mesh().faceCount(); ++f) growth.push_back(flow.growthRate(f));
  return {faces, field, unit, growth, std::vector<double>(faces.mesh().vertexCount(), slowSpeed), error};
}

TEST(PreparedFlow, HasTheRatesOfALinearField) {
  const auto charts = makeCharts(grid(4, 0.2));
  const FlatFaces faces(charts);
  const double a = 0.3, b = -1.1, c = 0.7, d = -0.4;
  const VectorField field = linearField(charts, a, b, c, d);
  const PreparedFlow flow(faces, field, TauUnit::Time, 1e-6);
  // The largest eigenvalue of the symmetric part.
  const double growth = 0.5 * (a + d) + std::hypot(0.5 * (a - d), 0.5 * (b + c));
  for (Index f = 0; f < faces.mesh().faceCount(); ++f) {
    EXPECT_NEAR(flow.growthRate(f), growth, 1e-10);
    EXPECT_NEAR(flow.divergenceRate(f), a + d, 1e-10);
    EXPECT_NEAR(flow.gradientNorm(f), std::sqrt(a * a + b * b + c * c + d * d), 1e-10);
  }
}

TEST(PreparedFlow, FollowsALinearFlow) {
  const auto charts = makeCharts(grid(6, 0.2));
  const TriangleMesh& mesh = charts->mesh();
  const FlatFaces faces(charts);
  const VectorField field = linearField(charts, 0.5, 0.0, 0.0, -0.8);  // (x exp(t / 2), y exp(-0.8 t))
  const PreparedFlow flow(faces, field, TauUnit::Time, 1e-7);
  const SurfacePoint from{faceAt(mesh, {0.3, 0.4, 0.0}, 0.0), {0.2, 0.3, 0.5}};
  const Vec3 start = position(mesh, from);
  const auto forward = flow.advector(Direction::Forward, nullptr);
  const auto backward = flow.advector(Direction::Backward, nullptr);
  const AdvectedPoint image = forward->advect(from, 1.0);
  EXPECT_FALSE(image.leftSurface);
  EXPECT_EQ(image.radius, 0.0);
  expectNear(position(mesh, image.point), {start.x() * std::exp(0.5), start.y() * std::exp(-0.8), 0.0}, 1e-5);
  expectNear(position(mesh, backward->advect(image.point, 1.0).point), start, 1e-5);
  for (const auto& [p, tau] : forward->trajectory(from, 1.0)) {
    expectNear(position(mesh, p), {start.x() * std::exp(0.5 * tau), start.y() * std::exp(-0.8 * tau), 0.0}, 1e-5);
  }
  EXPECT_TRUE(forward->advect(from, 10.0).leftSurface);
}

TEST(PreparedFlow, RefusesFieldsItCannotFollow) {
  const auto charts = makeCharts(grid(3));
  const FlatFaces faces(charts);
  const VectorField field = randomField(charts, 1);
  VectorField other = field;
  other.values.resize(5);
  expectFault<InputError>([&] { PreparedFlow(faces, other, TauUnit::Time, 1e-5); }, {"another mesh"});
  other = field;
  other.values[4] = {0.0, kNan};
  expectFault<InputError>([&] { PreparedFlow(faces, other, TauUnit::Time, 1e-5); }, {"vertex 4", "not finite"});
  for (const double tolerance : {0.0, -1.0, kNan}) {
    EXPECT_THROW(PreparedFlow(faces, field, TauUnit::Time, tolerance), InputError) << tolerance;
  }
}

TEST(DivergenceBound, IsTheDistanceWhereAllVectorsGrowAlike) {
  // V = a p and W = V + e: their trajectories from one point are e (exp(a t) - 1) / a apart, |e| = epsilon.
  const auto charts = makeCharts(grid(4, 0.2));
  const FlatFaces faces(charts);
  for (const double a : {-2.0, -0.1, 0.1, 0.7}) {
    const double epsilon = 0.01;
    const DivergenceBound bound = boundOf(faces, linearField(charts, a, 0.0, 0.0, a), TauUnit::Time, {epsilon, {}});
    for (const double t : {0.01, 0.2, 1.0}) {
      const double wanted = epsilon * std::expm1(a * t) / a;
      EXPECT_NEAR(bound.after(0.0, 5, t), wanted, 1e-10) << a << ", " << t;
      // In steps, as traces take them.
      double distance = 0.0;
      for (int i = 0; i < 10; ++i) distance = bound.after(distance, 5, 0.1 * t);
      EXPECT_NEAR(distance, wanted, 1e-10) << a << ", " << t;
    }
  }
}

TEST(DivergenceBound, HoldsWhereVectorsGrowDifferently) {
  // W = V + e has the distance of the integral of exp(A s) e. For a saddle the error along its unstable direction
  // attains the bound; for rotation the bound leaves out that the error turns.
  const auto charts = makeCharts(grid(4, 0.2));
  const FlatFaces faces(charts);
  const double epsilon = 0.01, w = 1.5, t = 0.8;
  const DivergenceBound saddle = boundOf(faces, linearField(charts, w, 0.0, 0.0, -w), TauUnit::Time, {epsilon, {}});
  EXPECT_NEAR(saddle.after(0.0, 3, t), epsilon * std::expm1(w * t) / w, 1e-10);
  EXPECT_GT(saddle.after(0.0, 3, t), epsilon * -std::expm1(-w * t) / w);  // the error along the stable one
  const DivergenceBound rotation = boundOf(faces, linearField(charts, 0.0, -w, w, 0.0), TauUnit::Time, {epsilon, {}});
  const double distance = epsilon * 2.0 * std::sin(0.5 * w * t) / w;
  EXPECT_GE(rotation.after(0.0, 3, t), distance);
  EXPECT_LE(rotation.after(0.0, 3, t), 1.1 * distance);
  // Shear draws its error out by t^2 / 2 at most; the bound allows growth at half the shear in all directions.
  const DivergenceBound shear = boundOf(faces, linearField(charts, 0.0, w, 0.0, 0.0), TauUnit::Time, {epsilon, {}});
  const double sheared = epsilon * std::hypot(t, 0.5 * w * t * t);
  EXPECT_GE(shear.after(0.0, 3, t), sheared);
  EXPECT_LE(shear.after(0.0, 3, t), 1.3 * sheared);
}

TEST(DivergenceBound, IsNoMoreThanTwoPointsCanMoveApart) {
  const auto charts = makeCharts(grid(4));
  const FlatFaces faces(charts);
  const double epsilon = 0.01;
  const VectorField field = linearField(charts, 0.0, 50.0, 0.0, 0.0);
  const DivergenceBound bound = boundOf(faces, field, TauUnit::Time, {epsilon, {}});
  EXPECT_LE(bound.after(0.02, 3, 1.0), 0.02 + 2.0 * 50.0 + epsilon);
}

TEST(DivergenceBound, TakesTheLargestWeightNearby) {
  const auto charts = makeCharts(grid(8));
  const TriangleMesh& mesh = charts->mesh();
  const FlatFaces faces(charts);
  std::vector<double> weights(mesh.vertexCount(), 0.0);
  const Index heavy = mesh.vertex(0, 0);
  weights[heavy] = 3.0;
  const VectorField field = linearField(charts, 0.0, 0.0, 0.0, 0.0);
  const DivergenceBound bound = boundOf(faces, field, TauUnit::Time, {0.1, weights});
  EXPECT_NEAR(bound.after(0.0, 0, 1.0), 0.3, 1e-12);
  EXPECT_EQ(bound.after(0.0, mesh.faceCount() - 1, 1.0), 0.0);
  // From a distance of some rings of neighbours it reaches there.
  EXPECT_GT(bound.after(4.0, mesh.faceCount() - 1, 1.0), 4.0);
}

TEST(DivergenceBound, BoundsDirectionsAtUnitSpeed) {
  // V = (1, 0) and W = (1, epsilon): straight lines with an angle of atan(epsilon) between them.
  const auto charts = makeCharts(grid(4, 0.2));
  const FlatFaces faces(charts);
  const double epsilon = 0.1, length = 0.7;
  const VectorField field = flatField(charts, [](const Vec3&) { return Vec3(1.0, 0.0, 0.0); });
  const DivergenceBound bound = boundOf(faces, field, TauUnit::Length, {epsilon, {}}, 0.02);
  const double distance = 2.0 * std::sin(0.5 * std::atan(epsilon)) * length;
  EXPECT_GE(bound.after(0.0, 2, length), distance);
  EXPECT_LE(bound.after(0.0, 2, length), 1.2 * distance);
}

TEST(DivergenceBound, RefusesWhatIsTooFar) {
  const auto charts = makeCharts(grid(4));
  const FlatFaces faces(charts);
  const DivergenceBound bound = boundOf(faces, linearField(charts, 1.0, 0.0, 0.0, 1.0), TauUnit::Time, {0.25, {}});
  EXPECT_NO_THROW(bound.after(1.0, 7, 0.1));
  expectFault<InputError>([&] { bound.after(1000.0, 7, 0.1); }, {"eps = 0.25", "64 faces", "face 7"});
  EXPECT_THROW(bound.after(kNan, 7, 0.1), InputError);
}

TEST(ErrorChecks, RefuseBadErrors) {
  const auto closed = makeMesh(icosphere(0));
  for (const double epsilon : {-1.0, kNan, HUGE_VAL}) {
    expectFault<InputError>([&] { checkEpsilon(epsilon); }, {"eps"});
    expectFault<InputError>([&] { checkFieldError(*closed, {epsilon, {}}); }, {"eps"});
  }
  EXPECT_NO_THROW(checkEpsilon(0.0));
  EXPECT_NO_THROW(checkWeights(*closed, {}));
  EXPECT_NO_THROW(checkFieldError(*closed, {0.1, std::vector<double>(12, 0.0)}));
  expectFault<InputError>([&] { checkWeights(*closed, {1.0, 2.0}); }, {"2 weights", "12 vertices"});
  for (const double weight : {-0.5, kNan, HUGE_VAL}) {
    std::vector<double> weights(12, 1.0);
    weights[9] = weight;
    expectFault<InputError>([&] { checkWeights(*closed, weights); }, {"vertex 9"});
    expectFault<InputError>([&] { checkFieldError(*closed, {0.1, weights}); }, {"vertex 9"});
  }
  expectFault<InputError>([&] { checkFieldError(*makeMesh(grid(2)), {0.1, {}}); }, {"closed surface", "boundary"});
  EXPECT_NO_THROW(checkFieldError(*makeMesh(grid(2)), {}));
}

}  // namespace
}  // namespace stormfield::test
