#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>

#include "base/error.h"
#include "field/interpolation.h"
#include "io/voxel_band.h"
#include "long_tests.h"
#include "polls.h"

namespace stormfield {
namespace {

/// An octahedron's faces, each cut into n x n and pushed onto the unit sphere.
std::shared_ptr<const VertexCharts> sphere(int n) {
  const std::vector<Vec3> corner = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::map<std::array<long, 3>, Index> ids;
  std::vector<Vec3> points;
  const auto vertex = [&](const Vec3& p) {
    const Vec3 unit = p.normalized();
    const std::array<long, 3> key = {std::lround(unit.x() * 1e6), std::lround(unit.y() * 1e6),
                                     std::lround(unit.z() * 1e6)};
    const auto [it, fresh] = ids.emplace(key, static_cast<Index>(points.size()));
    if (fresh) points.push_back(unit);
    return it->second;
  };
  std::vector<std::array<Index, 3>> faces;
  for (int k = 0; k < 8; ++k) {
    Vec3 a = corner[k % 4], b = corner[(k + 1) % 4], c = corner[k < 4 ? 4 : 5];
    if (k >= 4) std::swap(a, b);
    const auto at = [&](int i, int j) { return vertex(a * (n - i - j) + b * i + c * j); };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        faces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j < n - 1) faces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  Points p(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) p.row(i) = points[i];
  Triangles t(faces.size(), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) t.row(i) << faces[i][0], faces[i][1], faces[i][2];
  return std::make_shared<const VertexCharts>(std::make_shared<const TriangleMesh>(p, t));
}

/// Rotation about z.
VectorField rotation(const std::shared_ptr<const VertexCharts>& charts) {
  Points vectors = charts->mesh().points();
  for (Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = Vec3(-vectors(v, 1), vectors(v, 0), 0.0);
  return fromSpace(charts, vectors);
}

/// Several surfaces as one mesh; flipped: with the other orientation.
std::shared_ptr<const TriangleMesh> together(const std::vector<std::shared_ptr<const TriangleMesh>>& meshes,
                                             const std::vector<bool>& flipped) {
  Index points = 0, faces = 0;
  for (const auto& mesh : meshes) {
    points += mesh->vertexCount();
    faces += mesh->faceCount();
  }
  Points p(points, 3);
  Triangles t(faces, 3);
  points = faces = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const TriangleMesh& mesh = *meshes[i];
    p.middleRows(points, mesh.vertexCount()) = mesh.points();
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      for (int k = 0; k < 3; ++k) t(faces + f, k) = points + mesh.vertex(f, flipped[i] ? 2 - k : k);
    }
    points += mesh.vertexCount();
    faces += mesh.faceCount();
  }
  return std::make_shared<const TriangleMesh>(p, t);
}

std::shared_ptr<const TriangleMesh> ball(double radius, const Vec3& center, int n) {
  const auto unit = sphere(n);
  const TriangleMesh& mesh = unit->mesh();
  return std::make_shared<const TriangleMesh>((radius * mesh.points()).rowwise() + center.transpose(),
                                              mesh.triangles());
}

Vec3 centerOf(const VoxelBand& band, std::size_t block, std::size_t i) {
  const int place = band.places[i];
  const auto& o = band.origins[block];
  return band.voxelSize * Vec3(o[0] + place / 64, o[1] + place / 8 % 8, o[2] + place % 8);
}

/// visit(centre of the voxel, its number) for all voxels.
template <typename Visit>
void eachVoxel(const VoxelBand& band, const Visit& visit) {
  for (std::size_t b = 0; b < band.blockCount(); ++b) {
    for (std::size_t i = band.offsets[b]; i < band.offsets[b + 1]; ++i) visit(centerOf(band, b, i), i);
  }
}

TEST(VoxelBand, HoldsExactlyTheVoxelsNearTheSurface) {
  const auto mesh = together({ball(0.7, {0.1, 0.2, -0.3}, 5), ball(0.2, {1.1, 0.0, 0.4}, 2)}, {false, true});
  const ClosestPointQuery query(mesh);
  for (const double halfWidth : {1.0, 2.5, 9.0}) {
    const VoxelBand band = voxelBand(*mesh, query, {0.1, halfWidth});
    std::map<std::array<long, 3>, double> found;
    eachVoxel(band, [&](const Vec3& p, std::size_t i) {
      const std::array<long, 3> voxel{std::lround(p.x() / 0.1), std::lround(p.y() / 0.1), std::lround(p.z() / 0.1)};
      EXPECT_TRUE(found.emplace(voxel, band.distances[i]).second);
    });
    std::size_t expected = 0;
    for (long x = -20; x < 30; ++x) {
      for (long y = -20; y < 25; ++y) {
        for (long z = -22; z < 25; ++z) {
          const Vec3 p = band.voxelSize * Vec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
          const double distance = query.closest(p).distance;
          if (!(distance < 0.1 * halfWidth)) continue;
          ++expected;
          const auto at = found.find({x, y, z});
          ASSERT_NE(at, found.end()) << x << ' ' << y << ' ' << z;
          EXPECT_EQ(std::abs(static_cast<float>(at->second)), static_cast<float>(distance));
        }
      }
    }
    EXPECT_EQ(found.size(), expected);
    EXPECT_EQ(band.voxelCount(), expected);
  }
}

TEST(VoxelBand, HoldsTheFieldOfTheClosestSurfacePoint) {
  const auto charts = sphere(16);
  const ClosestPointQuery query(charts->meshPointer());
  const VoxelBand band = voxelBand(charts->mesh(), query, {0.05, 3.0});
  const VectorField field = rotation(charts);
  const BlockRange all{0, band.blockCount()};
  const std::vector<float> vectors = blockVectors(band, field, all), speeds = blockSpeeds(band, field, all);
  const std::vector<float> distances = blockDistances(band, all);
  std::size_t outside = 0;
  for (const float d : distances) outside += d == kOutsideBand;
  EXPECT_EQ(distances.size() - outside, band.voxelCount());
  double distanceError = 0.0, vectorError = 0.0;
  for (std::size_t b = 0; b < band.blockCount(); ++b) {
    for (std::size_t i = band.offsets[b]; i < band.offsets[b + 1]; ++i) {
      const Vec3 p = centerOf(band, b, i);
      const std::size_t at = b * VoxelBand::kVoxels + band.places[i];
      const Vec3 v = Eigen::Map<const Eigen::Vector3f>(&vectors[3 * at]).cast<double>();
      distanceError = std::max(distanceError, std::abs(distances[at] - (p.norm() - 1.0)));
      vectorError = std::max(vectorError, (v - Vec3(-p.y(), p.x(), 0.0) / p.norm()).norm());
      EXPECT_NEAR(speeds[at], v.norm(), 1e-6);
    }
  }
  EXPECT_LT(distanceError, 0.02);  // the facets' distance from the sphere
  EXPECT_LT(vectorError, 0.07);    // half an edge, seen from inside
  // Some blocks alone are the same.
  const std::vector<float> some = blockVectors(band, field, {3, 5});
  EXPECT_TRUE(std::equal(some.begin(), some.end(), vectors.begin() + 3 * 3 * VoxelBand::kVoxels));
}

TEST(VoxelBand, IsNegativeInWhatTheSurfaceEnclosesWhateverWayNormalsPoint) {
  // A small ball within a large one, and one beside them: what lies in the large one cannot be reached from outside.
  for (int flips = 0; flips < 8; ++flips) {
    const auto mesh = together({ball(1.0, {0, 0, 0}, 8), ball(0.4, {0.1, 0, 0}, 4), ball(0.3, {1.8, 0, 0}, 4)},
                               {(flips & 1) != 0, (flips & 2) != 0, (flips & 4) != 0});
    const VoxelBand band = voxelBand(*mesh, ClosestPointQuery(mesh), {0.06, 2.0});
    eachVoxel(band, [&](const Vec3& p, std::size_t i) {
      // Facets lie inside of the spheres by up to 0.05.
      if (p.norm() < 0.95 || (p - Vec3(1.8, 0, 0)).norm() < 0.25) {
        EXPECT_LE(band.distances[i], 0.0f) << p.transpose();
      } else if (p.norm() > 1.0 && (p - Vec3(1.8, 0, 0)).norm() > 0.3) {
        EXPECT_GE(band.distances[i], 0.0f) << p.transpose();
      }
    });
  }
}

TEST(VoxelBand, SignsHoldNextToSharpEdgesAndVertices) {
  // A thin wedge: the sign of the nearest face alone is wrong beyond its edge.
  Points points(6, 3);
  points << 0, 0, -1, 1, 0.05, -1, 1, -0.05, -1, 0, 0, 1, 1, 0.05, 1, 1, -0.05, 1;
  Triangles triangles(8, 3);
  triangles << 0, 2, 1, 3, 4, 5, 0, 1, 4, 0, 4, 3, 0, 3, 5, 0, 5, 2, 1, 2, 5, 1, 5, 4;
  const auto mesh = std::make_shared<const TriangleMesh>(points, triangles);
  const VoxelBand band = voxelBand(*mesh, ClosestPointQuery(mesh), {0.02, 4.0});
  eachVoxel(band, [&](const Vec3& p, std::size_t i) {
    const bool inside = std::abs(p.z()) <= 1.0 && p.x() <= 1.0 && std::abs(p.y()) <= 0.05 * p.x();
    if (std::abs(band.distances[i]) > 1e-6f) {
      EXPECT_EQ(band.distances[i] < 0.0f, inside) << p.transpose();
    }
  });
}

TEST(VoxelBand, OpenSurfacesHaveAnUnsignedDistance) {
  Points points(4, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  const auto mesh = std::make_shared<const TriangleMesh>(points, triangles);
  const VoxelBand band = voxelBand(*mesh, ClosestPointQuery(mesh), {0.1, 2.0});
  EXPECT_GT(band.voxelCount(), 100u);
  for (const float d : band.distances) EXPECT_GE(d, 0.0f);
}

TEST(VoxelBand, TakesTheMeanEdgeLengthWhenNoSizeIsGiven) {
  const auto charts = sphere(6);
  const VoxelBand band = voxelBand(charts->mesh(), ClosestPointQuery(charts->meshPointer()), {});
  EXPECT_EQ(band.voxelSize, charts->mesh().meanEdgeLength());
}

TEST(VoxelBand, StopsSoon) {
  const auto charts = sphere(32);
  const ClosestPointQuery query(charts->meshPointer());
  const VoxelBandOptions fine{test::shortOrLong(0.04, 0.015), 4.0};
  test::expectStopsSoon([&](Progress& p) { voxelBand(charts->mesh(), query, fine, &p); }, 100, 0.1);
}

TEST(VoxelBand, BadInputIsRefused) {
  const auto charts = sphere(4);
  const ClosestPointQuery query(charts->meshPointer());
  const auto make = [&](VoxelBandOptions options) { return voxelBand(charts->mesh(), query, options); };
  EXPECT_THROW(make({-1.0}), InputError);
  EXPECT_THROW(make({std::nan("")}), InputError);
  EXPECT_THROW(make({1e-5}), InputError);
  EXPECT_THROW(make({0.1, 0.5}), InputError);
  Progress cancelled;
  cancelled.cancel();
  EXPECT_THROW(voxelBand(charts->mesh(), query, {0.1}, &cancelled), Cancelled);
  const auto other = sphere(5);
  const VoxelBand band = make({0.2});
  EXPECT_THROW(blockVectors(band, rotation(other), {0, 1}), InputError);
}

}  // namespace
}  // namespace stormfield
