// Orbits and separatrices of known fields become the first lines, whole and turned with the flow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "spacing_checks.h"
#include "streamlines/topology_features.h"

namespace stormfield {
namespace {

using test::kPi;

VectorField onSquare(int cells, double half, const std::function<Vec3(const Vec3&)>& v) {
  test::Surface s = test::grid(cells, 0.2);
  s.points *= half;
  auto charts = test::makeCharts(s);
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index i = 0; i < s.points.rows(); ++i) vectors.row(i) = v(s.points.row(i));
  return fromSpace(charts, vectors);
}

EvenStreamlines place(const VectorField& field, double d) {
  const FlatFaces faces(field.charts);
  return placeStreamlines(faces, field, {.distance = d}, featuresOf(findTopology(faces, field)));
}

TEST(TopologyFeatures, EveryOrbitOfTheThesisFieldIsAWholeLoop) {
  // Thesis eq. 3.1: orbits at the radii pi, 2 pi, 3 pi.
  const VectorField field = onSquare(70, 3.5 * kPi, [](const Vec3& p) {
    const double r = std::hypot(p.x(), p.y()), s = r > 0.0 ? std::sin(r) / r : 1.0;
    return r > 0.0 ? Vec3(-p.y() / r + s * p.x(), p.x() / r + s * p.y(), 0.0) : Vec3::Zero();
  });
  const EvenStreamlines lines = place(field, 0.8);
  std::vector<double> radii;
  for (std::size_t i = 0; i < lines.closed.size(); ++i) {
    if (lines.given[i] == kNone) continue;
    ASSERT_TRUE(lines.closed[i]);
    double least = 1e9, most = 0.0;
    for (std::size_t k = lines.offsets[i]; k < lines.offsets[i + 1]; ++k) {
      const double r = position(field.mesh(), lines.points[k]).norm();
      least = std::min(least, r);
      most = std::max(most, r);
    }
    EXPECT_LT(most - least, 0.1);
    radii.push_back(0.5 * (least + most));
  }
  std::sort(radii.begin(), radii.end());
  ASSERT_EQ(radii.size(), 3U);
  for (int n = 1; n <= 3; ++n) EXPECT_NEAR(radii[n - 1], n * kPi, 0.05);
  EXPECT_LT(test::crowdedPart(field.mesh(), lines, 0.49 * 0.8), 0.05);
  EXPECT_LE(test::largestGap(field, lines), 1.2 * 0.8);
}

TEST(TopologyFeatures, SeparatricesRunWithTheFlowAndEndBeforeSinks) {
  // A saddle in the middle, a sink on either side at x = -1 and 1.
  const VectorField field =
      onSquare(80, 2.0, [](const Vec3& p) { return Vec3(p.x() - p.x() * p.x() * p.x(), -p.y(), 0.0); });
  const double d = 0.2;
  const EvenStreamlines lines = place(field, d);
  int incoming = 0, outgoing = 0;
  for (std::size_t i = 0; i < lines.closed.size(); ++i) {
    if (lines.given[i] == kNone) continue;
    const Vec3 from = position(field.mesh(), lines.points[lines.offsets[i]]);
    const Vec3 to = position(field.mesh(), lines.points[lines.offsets[i + 1] - 1]);
    if (from.norm() < 0.05) {
      ++outgoing;
      const double left = 1.0 - std::abs(to.x());
      EXPECT_GT(left, 0.5 * d);
      EXPECT_LT(left, d);
    } else {
      ++incoming;
      EXPECT_LT(to.norm(), 0.05);
      EXPECT_NEAR(std::abs(from.y()), 2.0, 1e-3);
      EXPECT_EQ(lines.taper[lines.offsets[i]], 1.0);  // full width at the boundary and at the saddle
      EXPECT_EQ(lines.taper[lines.offsets[i + 1] - 1], 1.0);
    }
  }
  EXPECT_EQ(incoming, 2);
  EXPECT_EQ(outgoing, 2);
}

}  // namespace
}  // namespace stormfield
