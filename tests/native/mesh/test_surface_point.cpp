#include "mesh/surface_point.h"

#include <gtest/gtest.h>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

TEST(SurfacePoint, LiesAtItsVertex) {
  const auto mesh = makeMesh(torus(7, 5));
  for (Index v = 0; v < mesh->vertexCount(); ++v) {
    const SurfacePoint p = vertexPoint(*mesh, v);
    EXPECT_EQ(position(*mesh, p), mesh->point(v));
    EXPECT_EQ(nearestVertex(*mesh, p), v);
  }
}

TEST(SurfacePoint, RefusesVerticesOffTheSurface) {
  Surface s = tetrahedron();
  s.points.conservativeResize(5, 3);
  s.points.row(4).setZero();
  const auto mesh = makeMesh(s);
  expectFault<InputError>([&] { vertexPoint(*mesh, 4); }, {"vertex 4", "not on the surface"});
  expectFault<InputError>([&] { vertexPoint(*mesh, 5); }, {"vertex 5"});
}

}  // namespace
}  // namespace stormfield::test
