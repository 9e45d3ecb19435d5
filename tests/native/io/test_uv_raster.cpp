#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/uv_raster.h"
#include "long_tests.h"
#include "polls.h"

namespace stormfield {
namespace {

/// An n x n grid of quads over the unit square, raised to a bowl; its UV layer is (x, y) scaled about the centre.
struct Sheet {
  TriangleMesh mesh;
  FaceUvs uvs;
};

Sheet sheet(Index n, double scale = 1.0) {
  Points points((n + 1) * (n + 1), 3);
  for (Index j = 0; j <= n; ++j) {
    for (Index i = 0; i <= n; ++i) {
      const double x = double(i) / n, y = double(j) / n;
      points.row(j * (n + 1) + i) << x, y, 0.3 * (x * x + y * y);
    }
  }
  Triangles triangles(2 * n * n, 3);
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      triangles.row(2 * (j * n + i)) << a, b, c;
      triangles.row(2 * (j * n + i) + 1) << a, c, d;
    }
  }
  FaceUvs uvs;
  for (Index f = 0; f < triangles.rows(); ++f) {
    std::array<Eigen::Vector2d, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d xy = points.row(triangles(f, k)).head<2>();
      corners[k] = Eigen::Vector2d(0.5, 0.5) + scale * (xy - Eigen::Vector2d(0.5, 0.5));
    }
    uvs.push_back(corners);
  }
  return {TriangleMesh(points, triangles), uvs};
}

Eigen::Vector2d uvAt(const FaceUvs& uvs, const SurfacePoint& p) {
  return p.barycentric[0] * uvs[p.face][0] + p.barycentric[1] * uvs[p.face][1] + p.barycentric[2] * uvs[p.face][2];
}

TEST(UvRaster, EveryPixelShowsItsOwnPlace) {
  const Sheet s = sheet(7);
  const UvRaster raster = rasterizeUv(s.mesh, s.uvs, {64, 32, 0});
  EXPECT_EQ(raster.coveredPixels, 64 * 32);
  EXPECT_EQ(raster.overlappingPixels, 0);
  EXPECT_EQ(raster.zeroAreaFaces, 0);
  EXPECT_EQ(raster.outsideFaces, 0);
  for (Index y = 0; y < 32; ++y) {
    for (Index x = 0; x < 64; ++x) {
      const SurfacePoint& p = raster.points[y * 64 + x];
      ASSERT_NE(p.face, kNone);
      EXPECT_GE(p.barycentric.minCoeff(), 0.0);
      EXPECT_NEAR((uvAt(s.uvs, p) - Eigen::Vector2d((x + 0.5) / 64, 1.0 - (y + 0.5) / 32)).norm(), 0.0, 1e-12);
    }
  }
}

TEST(UvRaster, MarginContinuesTheIslandWithItsClosestPoints) {
  const Sheet s = sheet(4, 0.5);
  const UvRaster raster = rasterizeUv(s.mesh, s.uvs, {64, 64, 6});
  const auto face = [&](Index x, Index y) { return raster.points[y * 64 + x].face; };
  EXPECT_EQ(raster.coveredPixels, 32 * 32);
  EXPECT_NE(face(9, 32), kNone);  // the island begins at 16 and touches 15
  EXPECT_EQ(face(8, 32), kNone);
  for (Index x = 9; x < 16; ++x) {
    const Eigen::Vector2d uv = uvAt(s.uvs, raster.points[32 * 64 + x]);
    EXPECT_NEAR(uv.x(), 0.25, 1e-12);
    EXPECT_NEAR(uv.y(), 1.0 - 32.5 / 64, 1e-12);
  }
}

TEST(UvRaster, FacesThinnerThanAPixelStillShow) {
  Points points(4, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  const TriangleMesh mesh(points, triangles);
  // Both faces lie in a sliver that contains no pixel centre.
  const Eigen::Vector2d a(0.1, 0.501), b(0.9, 0.501), c(0.9, 0.505), d(0.1, 0.505);
  const UvRaster raster = rasterizeUv(mesh, {{{{a, b, c}}, {{a, c, d}}}}, {16, 16, 0});
  EXPECT_EQ(raster.coveredPixels, 0);
  Index shown = 0;
  for (const SurfacePoint& p : raster.points) shown += p.face != kNone;
  EXPECT_GE(shown, 12);
}

TEST(UvRaster, OverlapsAndFacesWithoutAreaAreCounted) {
  Sheet s = sheet(2);
  s.uvs[1] = s.uvs[0];
  for (auto& corner : s.uvs[7]) corner = Eigen::Vector2d(0.3, 0.3);
  s.uvs[6][0] = Eigen::Vector2d(3.0, 0.5);
  const UvRaster raster = rasterizeUv(s.mesh, s.uvs, {32, 32, 2});
  EXPECT_GT(raster.overlappingPixels, 90);
  EXPECT_EQ(raster.zeroAreaFaces, 1);
  EXPECT_EQ(raster.outsideFaces, 1);
  for (const SurfacePoint& p : raster.points) EXPECT_NE(p.face, 7);
}

TEST(UvRaster, MirroredFacesShowAsWell) {
  Sheet s = sheet(3);
  for (auto& face : s.uvs) {
    for (auto& corner : face) corner.x() = 1.0 - corner.x();
  }
  EXPECT_EQ(rasterizeUv(s.mesh, s.uvs, {20, 20, 0}).coveredPixels, 400);
}

TEST(UvRaster, TheResultDoesNotDependOnTheThreadCount) {
  const Sheet s = sheet(9, 0.8);
  const auto draw = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return rasterizeUv(s.mesh, s.uvs, {100, 90, 5});
  };
  const UvRaster one = draw(1), four = draw(4);
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    ASSERT_EQ(one.points[i].face, four.points[i].face);
    ASSERT_EQ(one.points[i].barycentric, four.points[i].barycentric);
  }
}

TEST(UvRaster, StopsSoonInEveryPhase) {
  const Sheet s = sheet(30, 0.7);
  const Index side = test::shortOrLong(256, 1024);
  test::expectStopsSoon([&](Progress& p) { rasterizeUv(s.mesh, s.uvs, {side, side, 16}, &p); }, 5000, 0.1);
}

TEST(UvRaster, BadInputIsRefused) {
  Sheet s = sheet(2);
  FaceUvs fewer(s.uvs.begin(), s.uvs.end() - 1), broken = s.uvs, flat = s.uvs;
  broken[3][1].x() = std::numeric_limits<double>::quiet_NaN();
  for (auto& face : flat) face = {face[0], face[0], face[0]};
  EXPECT_THROW(rasterizeUv(s.mesh, fewer, {}), InputError);
  EXPECT_THROW(rasterizeUv(s.mesh, broken, {}), InputError);
  EXPECT_THROW(rasterizeUv(s.mesh, flat, {}), InputError);
  EXPECT_THROW(rasterizeUv(s.mesh, s.uvs, {0, 16, 0}), InputError);
  EXPECT_THROW(rasterizeUv(s.mesh, s.uvs, {16, 40000, 0}), InputError);
  EXPECT_THROW(rasterizeUv(s.mesh, s.uvs, {16, 16, -1}), InputError);
  Progress cancelled;
  cancelled.cancel();
  EXPECT_THROW(rasterizeUv(s.mesh, s.uvs, {}, &cancelled), Cancelled);
}

}  // namespace
}  // namespace stormfield
