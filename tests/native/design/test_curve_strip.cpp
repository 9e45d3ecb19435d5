// The strip beside a curve, against distances in the plane.
#include "design/detail/curve_strip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "checks.h"
#include "fixtures.h"
#include "mesh/closest_point.h"

namespace stormfield {
namespace {

struct Square {
  std::shared_ptr<const VertexCharts> charts = test::makeCharts(test::grid(30, 0.3));
  ClosestPointQuery query{charts->meshPointer()};

  SurfacePath path(const Vec3& from, const Vec3& to) const {
    DesignElement element;
    element.name = "stream";
    element.type = ElementType::Streamline;
    element.points = {from, to};
    return {charts->mesh(), query, element};
  }
};

TEST(CurveStrip, HoldsTheVerticesWithinItsWidthAndTheirDistances) {
  const Square square;
  const Vec3 from(-0.51, -0.2, 0.0), to(0.43, 0.3, 0.0), along = (to - from).normalized();
  const TriangleMesh& mesh = square.charts->mesh();
  const double halfWidth = 0.2;
  std::map<Index, StripEntry> strip;
  for (const StripEntry& entry : curveStrip(*square.charts, square.path(from, to), halfWidth)) {
    strip[entry.vertex] = entry;
  }
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const double t = std::clamp((mesh.point(v) - from).dot(along), 0.0, (to - from).norm());
    const double distance = (mesh.point(v) - from - t * along).norm();
    const auto entry = strip.find(v);
    if (entry == strip.end()) {
      EXPECT_GE(distance, halfWidth - 1e-9) << v;
      continue;
    }
    EXPECT_TRUE(distance < halfWidth || entry->second.onCurve) << v;
    EXPECT_NEAR(entry->second.distance, distance, 1e-9) << v;
    test::expectNear(square.charts->toSpace(v, entry->second.direction), along, 1e-9);
  }
}

TEST(CurveStrip, AlwaysHoldsTheFacesOfTheCurve) {
  const Square square;
  const SurfacePath path = square.path({-0.5, 0.1, 0.0}, {0.5, 0.1, 0.0});
  const std::vector<StripEntry> strip = curveStrip(*square.charts, path, 1e-9);
  EXPECT_GT(strip.size(), 30u);
  for (const StripEntry& entry : strip) EXPECT_TRUE(entry.onCurve);
  for (const SurfacePoint& p : path.points()) {
    for (int k = 0; k < 3; ++k) {
      const Index v = square.charts->mesh().vertex(p.face, k);
      EXPECT_TRUE(std::any_of(strip.begin(), strip.end(), [&](const StripEntry& e) { return e.vertex == v; }));
    }
  }
}

}  // namespace
}  // namespace stormfield
