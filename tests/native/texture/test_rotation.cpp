#include "texture/rotation.h"

#include <gtest/gtest.h>

#include "fixtures.h"

namespace stormfield {
namespace {

std::vector<double> rotationOf(const TriangleMesh& mesh, const Points& vectors) {
  std::vector<double> result(mesh.vertexCount(), -1.0);
  rotation(mesh, vectors, result.data());
  return result;
}

Points turning(const Points& points, double angularSpeed) {
  Points vectors(points.rows(), 3);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    vectors.row(v) = angularSpeed * Vec3(Vec3::UnitZ().cross(Vec3(points.row(v))));
  }
  return vectors;
}

TEST(Rotation, OfRigidMotionIsTwiceItsAngularSpeed) {
  const auto [points, triangles] = test::grid(12, 0.2);
  for (const double curl : rotationOf(TriangleMesh(points, triangles), turning(points, 1.5))) {
    EXPECT_NEAR(curl, 3.0, 1e-12);
  }
  const Triangles turned = triangles.rowwise().reverse();
  for (const double curl : rotationOf(TriangleMesh(points, turned), turning(points, 1.5))) {
    EXPECT_NEAR(curl, -3.0, 1e-12);
  }
}

TEST(Rotation, OfASourceIsZero) {
  const auto [points, triangles] = test::grid(12, 0.2);
  for (const double curl : rotationOf(TriangleMesh(points, triangles), points)) EXPECT_NEAR(curl, 0.0, 1e-12);
}

TEST(Rotation, IsZeroAtVerticesWithoutFaces) {
  const auto [points, triangles] = test::grid(4, 0.2);
  Points more(points.rows() + 1, 3);
  more << points, Eigen::RowVector3d(5.0, 5.0, 0.0);
  EXPECT_EQ(rotationOf(TriangleMesh(more, triangles), more).back(), 0.0);
}

}  // namespace
}  // namespace stormfield
