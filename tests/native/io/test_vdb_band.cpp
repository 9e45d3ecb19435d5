#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>

#include "base/error.h"
#include "io/stopping.h"
#include "io/vdb_band.h"
#include "long_tests.h"

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

openvdb::GridPtrVec read(const std::string& bytes, openvdb::MetaMap& metadata) {
  openvdb::initialize();
  std::istringstream in(bytes, std::ios_base::binary);
  openvdb::io::Stream stream(in, false);
  metadata = *stream.getMetadata();
  return *stream.getGrids();
}

TEST(VdbBand, HoldsTheFieldOfTheClosestSurfacePoint) {
  const auto charts = sphere(16);
  const ClosestPointQuery query(charts->meshPointer());
  const VdbBand band(charts->meshPointer(), query, {0.05, 3.0});
  const VectorField field = rotation(charts);
  openvdb::MetaMap metadata;
  const auto grids =
      read(band.bytes({{"sf_advection", &field}}, "sf_advection", {{"stormfield:lambda", "0.5"}}), metadata);
  ASSERT_EQ(grids.size(), 3u);
  EXPECT_EQ(metadata.metaValue<std::string>("stormfield:lambda"), "0.5");
  std::map<std::string, openvdb::GridBase::Ptr> byName;
  for (const auto& grid : grids) {
    byName[grid->getName()] = grid;
    EXPECT_EQ(grid->activeVoxelCount(), band.voxelCount());
    EXPECT_NEAR(grid->voxelSize()[0], 0.05, 1e-12);
  }
  const auto vectors = openvdb::gridPtrCast<openvdb::Vec3SGrid>(byName["sf_advection"]);
  const auto speed = openvdb::gridPtrCast<openvdb::FloatGrid>(byName["sf_speed"]);
  const auto distance = openvdb::gridPtrCast<openvdb::FloatGrid>(byName["sf_distance"]);
  double distanceError = 0.0, vectorError = 0.0, speedError = 0.0;
  for (auto voxel = vectors->cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Vec3d p = vectors->indexToWorld(voxel.getCoord());
    const double r = p.length();
    const double d = distance->getConstAccessor().getValue(voxel.getCoord());
    distanceError = std::max(distanceError, std::abs(d - (r - 1.0)));
    const openvdb::Vec3d expected = openvdb::Vec3d(-p.y(), p.x(), 0.0) / r;
    vectorError = std::max(vectorError, (openvdb::Vec3d(*voxel) - expected).length());
    speedError =
        std::max(speedError, std::abs(speed->getConstAccessor().getValue(voxel.getCoord()) - double(voxel->length())));
  }
  EXPECT_LT(distanceError, 0.02);  // the facets' distance from the sphere
  EXPECT_LT(vectorError, 0.07);    // half an edge, seen from inside
  EXPECT_LT(speedError, 1e-6);
}

TEST(VdbBand, EqualInputGivesEqualBytesAndOtherInputAnotherIdentifier) {
  const auto charts = sphere(6);
  const ClosestPointQuery query(charts->meshPointer());
  const VectorField field = rotation(charts);
  const auto make = [&](const char* text) {
    return VdbBand(charts->meshPointer(), query, {0.2}).bytes({{"sf_advection", &field}}, "", {{"note", text}});
  };
  EXPECT_EQ(make("a"), make("a"));
  EXPECT_NE(make("a").substr(21, 36), make("b").substr(21, 36));
  EXPECT_EQ(make("a")[21 + 8], '-');
}

TEST(VdbBand, FilesHaveATableOfGridsThatOpenVdbReadsOneByOne) {
  const auto charts = sphere(6);
  const VectorField field = rotation(charts);
  const VdbBand band(charts->meshPointer(), ClosestPointQuery(charts->meshPointer()), {});
  EXPECT_NEAR(band.voxelSize(), charts->mesh().meanEdgeLength(), 1e-12);
  const std::string path = testing::TempDir() + "stormfield_band.vdb";
  std::ofstream(path, std::ios_base::binary) << band.bytes({{"sf_advection", &field}}, "sf_advection", {});
  openvdb::io::File file(path);
  file.open();
  EXPECT_TRUE(file.hasGrid("sf_speed"));
  EXPECT_EQ(file.readGrid("sf_advection")->activeVoxelCount(), band.voxelCount());
  file.close();
  std::remove(path.c_str());
}

TEST(VdbBand, OpenSurfacesHaveAnUnsignedDistance) {
  Points points(4, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  const auto charts = std::make_shared<const VertexCharts>(std::make_shared<const TriangleMesh>(points, triangles));
  const VdbBand band(charts->meshPointer(), ClosestPointQuery(charts->meshPointer()), {0.1, 2.0});
  openvdb::MetaMap metadata;
  const auto grids = read(band.bytes({}, "", {}), metadata);
  const auto distance = openvdb::gridPtrCast<openvdb::FloatGrid>(grids.front());
  EXPECT_GT(distance->activeVoxelCount(), 100u);
  for (auto voxel = distance->cbeginValueOn(); voxel; ++voxel) EXPECT_GE(*voxel, 0.0f);
}

TEST(VdbBand, StopsSoonInEveryPhase) {
  const auto charts = sphere(32);
  const ClosestPointQuery query(charts->meshPointer());
  const VectorField field = rotation(charts);
  const VdbBandOptions fine{test::shortOrLong(0.04, 0.015), 4.0};
  for (const double fraction : {0.0, 0.1, 0.3, 0.5, 0.6, 0.75}) {
    EXPECT_LT(secondsToStop(fraction, [&](Progress& p) { VdbBand(charts->meshPointer(), query, fine, &p); }), kSoon);
  }
  const VdbBand band(charts->meshPointer(), query, fine);
  for (const double fraction : {0.0, 0.2, 0.3}) {
    const auto write = [&](Progress& p) { band.bytes({{"sf_advection", &field}}, "sf_advection", {}, &p); };
    EXPECT_LT(secondsToStop(fraction, write), kSoon);
  }
}

TEST(VdbBand, BadInputIsRefused) {
  const auto charts = sphere(4);
  const ClosestPointQuery query(charts->meshPointer());
  const auto make = [&](VdbBandOptions options) { VdbBand(charts->meshPointer(), query, options); };
  EXPECT_THROW(make({-1.0}), InputError);
  EXPECT_THROW(make({std::nan("")}), InputError);
  EXPECT_THROW(make({1e-5}), InputError);
  EXPECT_THROW(make({0.1, 0.5}), InputError);
  Progress cancelled;
  cancelled.cancel();
  EXPECT_THROW(VdbBand(charts->meshPointer(), query, {0.1}, &cancelled), Cancelled);
}

}  // namespace
}  // namespace stormfield
