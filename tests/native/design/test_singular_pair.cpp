// The joint field of two singular elements: its zeros and its limits in the plane.
#include "design/detail/singular_pair.h"

#include <gtest/gtest.h>

#include <cmath>

#include "field/poincare_index.h"
#include "fixtures.h"
#include "mesh/closest_point.h"

namespace stormfield {
namespace {

struct Plane {
  std::shared_ptr<const VertexCharts> charts = test::makeCharts(test::grid(40, 0.2));
  ClosestPointQuery query{charts->meshPointer()};
  LogMapScratch scratch{charts->mesh()};

  SingularState state(const Vec3& p, SingularKind kind, double radius) {
    return {query.closest(p).point, kind, 1.0, radius, 0.0};
  }
  LogMap map(const SurfacePoint& p) { return logMap(*charts, p, 4.0, scratch); }
};

/// The faces in which the targets rotate by a full turn, as (index, centroid).
std::vector<std::pair<int, Vec3>> zeros(const Plane& plane, const std::vector<PairTarget>& targets) {
  const TriangleMesh& mesh = plane.charts->mesh();
  VectorField field = test::zeroField(plane.charts);
  std::vector<char> known(mesh.vertexCount(), 0);
  for (const PairTarget& t : targets) {
    field.values[t.vertex] = t.value;
    known[t.vertex] = 1;
  }
  const std::vector<int> indices = poincareIndices(field);
  std::vector<std::pair<int, Vec3>> result;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    if (indices[f] == 0 || !known[mesh.vertex(f, 0)] || !known[mesh.vertex(f, 1)] || !known[mesh.vertex(f, 2)]) {
      continue;
    }
    result.emplace_back(indices[f], position(mesh, {f, Eigen::Vector3d::Constant(1.0 / 3.0)}));
  }
  return result;
}

TEST(SingularPair, HasBothZerosAndTheSaddleBetween) {
  Plane plane;
  for (const SingularKind kind : {SingularKind::VortexCcw, SingularKind::Sink, SingularKind::SpiralOutCw}) {
    const Vec3 a(-0.31, 0.07, 0.0), b(0.29, -0.03, 0.0), middle = 0.5 * (a + b);
    SingularPair pair{plane.state(a, kind, 0.6), plane.state(b, kind, 0.6), plane.state(middle, kind, 0.6),
                      (a - b).norm()};
    const auto found = zeros(plane, pairTargets(plane.charts->mesh(), pair, plane.map(pair.a.point),
                                                plane.map(pair.b.point), plane.map(plane.query.closest(middle).point)));
    ASSERT_EQ(found.size(), 3u);
    const double edge = plane.charts->mesh().meanEdgeLength();
    for (const auto& [index, place] : found) {
      const Vec3 wanted = index < 0 ? middle : (place.x() < 0.0 ? a : b);
      EXPECT_LT((place - wanted).norm(), edge) << "index " << index;
    }
    EXPECT_EQ(found[0].first + found[1].first + found[2].first, 1);
  }
}

TEST(SingularPair, EachElementKeepsItsOwnKind) {
  Plane plane;
  const Vec3 a(-0.4, 0.0, 0.0), b(0.4, 0.0, 0.0);
  const SingularPair pair{plane.state(a, SingularKind::VortexCcw, 0.5), plane.state(b, SingularKind::VortexCcw, 0.5),
                          plane.state(Vec3::Zero(), SingularKind::VortexCcw, 0.5), 0.8};
  const auto targets = pairTargets(plane.charts->mesh(), pair, plane.map(pair.a.point), plane.map(pair.b.point),
                                   plane.map(plane.query.closest(Vec3(0.0, 0.0, 0.0)).point));
  int checked = 0;
  for (const PairTarget& t : targets) {
    const Vec3 p = plane.charts->mesh().point(t.vertex);
    for (const Vec3& center : {a, b}) {
      const Vec3 away = p - center;
      if (away.norm() > 0.12 || away.norm() < 0.05) continue;
      const Vec3 around = Vec3::UnitZ().cross(away).normalized();
      EXPECT_GT(plane.charts->toSpace(t.vertex, t.value).normalized().dot(around), 0.9);
      ++checked;
    }
  }
  EXPECT_GT(checked, 20);
}

TEST(SingularPair, GoesFromSeparateDiscsToTheSingleElement) {
  Plane plane;
  SingularPair pair{plane.state({-0.3, 0, 0}, SingularKind::Sink, 0.3),
                    plane.state({0.3, 0, 0}, SingularKind::Sink, 0.2), plane.state({0, 0, 0}, SingularKind::Sink, 0.4),
                    0.5};
  EXPECT_EQ(pair.joint(), 0.0);  // the discs touch
  EXPECT_EQ(pair.closeness(), 0.0);
  pair.distance = 0.3;  // one centre on the rim of the other disc
  EXPECT_EQ(pair.joint(), 1.0);
  pair.distance = 0.0;
  EXPECT_EQ(pair.closeness(), 1.0);
  double before = 0.0;
  for (double d = 0.5; d >= 0.0; d -= 0.01) {
    pair.distance = d;
    EXPECT_GE(pair.joint(), before);
    before = pair.joint();
  }
}

}  // namespace
}  // namespace stormfield
