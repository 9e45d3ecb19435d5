// Boundary tangencies against a flow whose tangent trajectory is a parabola.
#include "maps/detail/boundary_tangencies.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "checks.h"
#include "flat_fields.h"

namespace stormfield::test {
namespace {

constexpr double kTangency = 0.03;  ///< x of the tangency, inside an edge of grid(8)

/// V = (1, x - kTangency): the trajectory through (kTangency, -1) touches the lower boundary from inside there.
Vec3 onParabola(double t) {
  return {kTangency + t, -1.0 + 0.5 * t * t, 0.0};
}

std::vector<TangencyEdge> tangencyEdges(const VectorField& field, double tau, TauUnit unit = TauUnit::Time) {
  const FlatFaces faces(field.charts);
  const PreparedFlow flow(faces, field, unit, 1e-8);
  return boundaryTangencyEdges(flow, tau, nullptr);
}

TEST(BoundaryTangencies, AreTheFacesOfTheTangentTrajectoryTauLater) {
  const auto charts = makeCharts(grid(8));
  const TriangleMesh& mesh = charts->mesh();
  const VectorField field = flatField(charts, [](const Vec3& p) { return Vec3(1.0, p.x() - kTangency, 0.0); });
  for (const double tau : {0.1, 0.5, 0.9}) {
    const std::vector<TangencyEdge> found = tangencyEdges(field, tau);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    // Every place of the parabola that passes the tangency within tau leads to the one tau later.
    constexpr int kSamples = 400;
    int compared = 0;
    for (int i = 0; i <= kSamples; ++i) {
      const double before = tau * i / kSamples;
      const Index face = faceAt(mesh, onParabola(-before), 1e-4), image = faceAt(mesh, onParabola(tau - before), 1e-4);
      if (face == kNone || image == kNone) continue;
      ++compared;
      EXPECT_TRUE(std::binary_search(found.begin(), found.end(), TangencyEdge{face, image}))
          << face << " -> " << image << " at tau " << tau;
    }
    EXPECT_GT(compared, kSamples / 2);
    // And nothing else: of every edge found, some place of the parabola is in the face and its image in the other.
    for (const auto& [face, image] : found) {
      bool isSeen = false;
      for (int i = 0; i <= 20 * kSamples && !isSeen; ++i) {
        const double before = tau * i / (20 * kSamples);
        isSeen = barycentricIn(mesh, face, onParabola(-before)).minCoeff() > -2e-3 &&
                 barycentricIn(mesh, image, onParabola(tau - before)).minCoeff() > -2e-3;
      }
      EXPECT_TRUE(isSeen) << face << " -> " << image << " at tau " << tau;
    }
  }
}

TEST(BoundaryTangencies, FollowTheTrajectoryByLengthToo) {
  // Where the speed is 1 nearly everywhere, both units see the same.
  const auto charts = makeCharts(grid(8));
  const VectorField field = flatField(charts, [](const Vec3& p) { return Vec3(1.0, 0.1 * (p.x() - kTangency), 0.0); });
  EXPECT_EQ(tangencyEdges(field, 0.3), tangencyEdges(field, 0.3, TauUnit::Length));
}

TEST(BoundaryTangencies, FromOutsideHaveNoEdges) {
  // Trajectories touch the upper boundary from inside and the lower one from outside, where they are on the surface for
  // a moment only.
  const auto charts = makeCharts(grid(8));
  const TriangleMesh& mesh = charts->mesh();
  const VectorField field = flatField(charts, [](const Vec3& p) { return Vec3(1.0, kTangency - p.x(), 0.0); });
  const std::vector<TangencyEdge> found = tangencyEdges(field, 0.5);
  EXPECT_FALSE(found.empty());
  for (const TangencyEdge& edge : found) {
    EXPECT_GT(position(mesh, {edge.face, Eigen::Vector3d::Constant(1.0 / 3.0)}).y(), 0.5);
    EXPECT_GT(position(mesh, {edge.image, Eigen::Vector3d::Constant(1.0 / 3.0)}).y(), 0.5);
  }
}

TEST(BoundaryTangencies, NeedABoundaryAndASignChange) {
  EXPECT_TRUE(tangencyEdges(randomField(makeCharts(icosphere(1)), 3), 0.2).empty());
  const auto outwards = [](const Vec3& p) { return p; };
  EXPECT_TRUE(tangencyEdges(flatField(makeCharts(grid(4, 0.2)), outwards), 0.5).empty());
}

TEST(BoundaryTangencies, StopWhenCancelled) {
  // Enough traces: an advector checks its progress every 1024 steps.
  const auto charts = makeCharts(grid(60));
  const FlatFaces faces(charts);
  const VectorField field = randomField(charts, 2);
  const PreparedFlow flow(faces, field, TauUnit::Time, 1e-5);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(boundaryTangencyEdges(flow, 20.0, &progress), Cancelled);
}

}  // namespace
}  // namespace stormfield::test
