#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "base/error.h"
#include "io/flow_map.h"
#include "long_tests.h"
#include "polls.h"

namespace stormfield {
namespace {

/// A tilted, sheared rectangle of two faces; UV (0,0)..(1,1) maps to origin + u a + v b exactly.
struct Plane {
  Vec3 a{2.0, 0.0, 1.0}, b{0.5, 3.0, 0.0};
  std::shared_ptr<const VertexCharts> charts;
  FaceUvs uvs;

  Plane() {
    Points points(4, 3);
    points.row(0) = Vec3::Zero();
    points.row(1) = a;
    points.row(2) = a + b;
    points.row(3) = b;
    Triangles triangles(2, 3);
    triangles << 0, 1, 2, 0, 2, 3;
    charts = std::make_shared<const VertexCharts>(std::make_shared<const TriangleMesh>(points, triangles));
    const Eigen::Vector2d o(0, 0), u(1, 0), uv(1, 1), v(0, 1);
    uvs = {{{o, u, uv}}, {{o, uv, v}}};
  }
  VectorField constant(const Vec3& vector) const { return fromSpace(charts, vector.transpose().replicate(4, 1)); }
};

TEST(FlowMap, UvBasisIsTheVelocityOfTheTexture) {
  const Plane plane;
  const Vec3 vector = 0.3 * plane.a - 0.7 * plane.b;
  const UvRaster raster = rasterizeUv(plane.charts->mesh(), plane.uvs, {8, 8, 0});
  const FlowMapImage image = flowMap(plane.constant(vector), plane.uvs, raster, FlowMapBasis::Uv);
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
    EXPECT_NEAR(image.pixels[i], 0.3, 1e-6);
    EXPECT_NEAR(image.pixels[i + 1], -0.7, 1e-6);
    EXPECT_NEAR(image.pixels[i + 2], vector.norm(), 1e-6);
    EXPECT_EQ(image.pixels[i + 3], 1.0f);
  }
}

TEST(FlowMap, ObjectBasisIsTheVectorItself) {
  const Plane plane;
  const Vec3 vector = plane.a - plane.b;
  const UvRaster raster = rasterizeUv(plane.charts->mesh(), plane.uvs, {4, 4, 0});
  const FlowMapImage image = flowMap(plane.constant(vector), plane.uvs, raster, FlowMapBasis::Object);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(image.pixels[20 + k], vector[k], 1e-6);
}

TEST(FlowMap, WhereNothingShowsAllChannelsAreZero) {
  Plane plane;
  for (auto& face : plane.uvs) {
    for (auto& corner : face) corner *= 0.25;
  }
  const UvRaster raster = rasterizeUv(plane.charts->mesh(), plane.uvs, {16, 16, 1});
  const FlowMapImage image = flowMap(plane.constant(plane.a), plane.uvs, raster, FlowMapBasis::Uv);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(image.pixels[k], 0.0f);  // top left: v = 1
  EXPECT_EQ(image.pixels[4 * (15 * 16) + 3], 1.0f);              // bottom left: v = 0
}

TEST(FlowMap, StopsSoonWhileItDraws) {
  const Plane plane;
  const Index side = test::shortOrLong(1024, 2048);
  const VectorField field = plane.constant(plane.a);
  const UvRaster raster = rasterizeUv(plane.charts->mesh(), plane.uvs, {side, side, 0});
  const auto draw = [&](Progress* p) { return flowMap(field, plane.uvs, raster, FlowMapBasis::Uv, p); };
  test::expectStopsSoon([&](Progress& p) { draw(&p); }, 30, 0.05);
}

TEST(FlowMap, AnotherMeshIsRefused) {
  const Plane plane;
  const UvRaster raster = rasterizeUv(plane.charts->mesh(), plane.uvs, {4, 4, 0});
  FaceUvs fewer(plane.uvs.begin(), plane.uvs.end() - 1);
  EXPECT_THROW(flowMap(plane.constant(plane.a), fewer, raster, FlowMapBasis::Uv), InputError);
}

}  // namespace
}  // namespace stormfield
