// The border of the surface: a wall that nothing crosses, inflow over it, and no change where it is open.
#include "design/border.h"

#include <gtest/gtest.h>

#include <cmath>

#include "design/design_solve.h"
#include "storm_checks.h"

namespace stormfield {
namespace {

DesignElement stream(std::vector<Vec3> points) {
  DesignElement element;
  element.name = "river";
  element.type = ElementType::Streamline;
  element.points = std::move(points);
  element.radius = 0.2;
  return element;
}

ParameterizedField solved(const test::ChartsPointer& charts, const DesignElement& element, Border border) {
  DesignOptions options;
  options.samples = 3;
  options.border = border;
  options.evenSpeed = 0.5;
  Progress progress;
  return DesignSolver(charts, options).solve({element}, progress).field;
}

/// Flow outward at the vertices of the border, over the speed of the stream: least and largest.
std::pair<double, double> outflow(const ParameterizedField& field) {
  const VertexCharts& charts = *field.charts;
  const TriangleMesh& mesh = charts.mesh();
  std::vector<Complex> along(mesh.vertexCount());
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    if (mesh.twin(h) != kNone) continue;
    along[mesh.tail(h)] += std::polar(1.0, charts.tailAngle(h));
    along[mesh.head(h)] += std::polar(1.0, charts.headAngle(h));
  }
  double least = 1e9, largest = -1e9;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (!mesh.isBoundaryVertex(v)) continue;
    const double out = -(field.sample(1)[v] * std::conj(along[v]) / std::abs(along[v])).imag() / (0.2 * mesh.size());
    least = std::min(least, out), largest = std::max(largest, out);
  }
  return {least, largest};
}

TEST(BorderFlow, NothingCrossesAWall) {
  const auto ring = test::makeCharts(test::annulus(72, 14));
  const auto [least, largest] = outflow(solved(ring, stream({{-1.5, -1.0, 0}, {-1.5, 1.0, 0}}), Border::Wall));
  EXPECT_GT(least, -1e-9);
  EXPECT_LT(largest, 1e-9);
  EXPECT_GT(outflow(solved(ring, stream({{-1.5, -1.0, 0}, {-1.5, 1.0, 0}}), Border::Open)).second, 0.2);
}

TEST(BorderFlow, InflowComesInEverywhere) {
  const auto charts = test::makeCharts(test::grid(20, 0.2));
  EXPECT_LT(outflow(solved(charts, stream({{-0.4, 0, 0}, {0.4, 0, 0}}), Border::Inflow)).second, -0.01);
}

TEST(BorderFlow, AClosedSurfaceHasNone) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(8));
  EXPECT_FALSE(BorderFlow(*charts, Border::Wall).acts());
  EXPECT_FALSE(BorderFlow(*test::makeCharts(test::grid(4)), Border::Open).acts());
}

}  // namespace
}  // namespace stormfield
