#include "edit/smooth.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "checks.h"
#include "edit/region.h"
#include "edited_fields.h"
#include "mesh/closest_point.h"

namespace stormfield::test {
namespace {

void expectSmoothed(const VectorField& field, const std::vector<Index>& faces, const std::string& what) {
  const SmoothResult result = smoothRegion(field, faces);
  EXPECT_LE(result.residual, 1e-10) << what;
  std::size_t changed = 0;
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    if (field.values[v] == result.field.values[v]) continue;
    ++changed;
    EXPECT_TRUE(std::binary_search(result.vertices.begin(), result.vertices.end(), static_cast<Index>(v))) << what;
  }
  EXPECT_EQ(changed, result.vertices.size()) << what;
  // Indices outside stay, and so their sum inside.
  EXPECT_EQ(sum(poincareIndicesIn(result.field, faces)), sum(poincareIndicesIn(field, faces))) << what;
  // Smoothing what is smooth changes nothing but the last bits.
  EXPECT_LE(smoothRegion(result.field, faces).change.largest, 1e-9) << what;
}

std::vector<Index> facesWhere(const TriangleMesh& mesh, const std::function<bool(const Vec3&)>& isInside) {
  std::vector<Index> faces;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && isInside(mesh.point(mesh.vertex(f, k)));
    if (inside) faces.push_back(f);
  }
  return faces;
}

TEST(Smooth, DiscAnnulusPantsAndAllButOneFace) {
  const VectorField field = randomField(makeCharts(icosphere(4)), 5);
  const TriangleMesh& mesh = field.mesh();
  expectSmoothed(field, facesWhere(mesh, [](const Vec3& p) { return p.z() > 0.5; }), "disc");
  expectSmoothed(field, facesWhere(mesh, [](const Vec3& p) { return std::abs(p.z()) < 0.5; }), "annulus");
  expectSmoothed(field, facesWhere(mesh, [](const Vec3& p) { return p.z() < 0.9 && p.x() < 0.9 && p.y() < 0.9; }),
                 "pants");
  std::vector<Index> nearlyAll(mesh.faceCount() - 1);
  for (Index f = 0; f < mesh.faceCount() - 1; ++f) nearlyAll[f] = f;
  expectSmoothed(field, nearlyAll, "all but one face");
}

TEST(Smooth, RegionWithHandle) {
  const VectorField field = randomField(makeCharts(torus(40, 20)), 5);
  expectSmoothed(field, facesWhere(field.mesh(), [](const Vec3& p) { return p.x() < 1.2; }), "handle");
}

/// In the plane each component is a mean of its neighbours', by weights that are exact for linear ones on this mesh.
TEST(Smooth, KeepsLinearFieldsInThePlane) {
  const VectorField linear =
      sampledOn(grid(20), [](const Vec3& p) { return Vec3(1.0 + p.x() - 2.0 * p.y(), 0.5 * p.x() + p.y(), 0.0); });
  const auto inner = facesWhere(linear.mesh(), [](const Vec3& p) { return p.norm() < 0.8; });
  VectorField rough = linear;
  Random random(3);
  for (const Index v : smoothRegion(linear, inner).vertices)
    rough.values[v] += Complex(random.uniform(), random.uniform());
  const Points smooth = toSpace(smoothRegion(rough, inner).field), wanted = toSpace(linear);
  EXPECT_LE((smooth - wanted).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Smooth, RefusesRegionsItCannotSmooth) {
  VectorField field = randomField(makeCharts(icosphere(2)), 5);
  std::vector<Index> all(field.mesh().faceCount());
  for (Index f = 0; f < field.mesh().faceCount(); ++f) all[f] = f;
  expectFault<InputError>([&] { smoothRegion(field, {}); }, {"region of 0 faces", "make it larger"});
  expectFault<InputError>([&] { smoothRegion(field, {7}); }, {"region of 1 faces"});
  expectFault<InputError>([&] { smoothRegion(field, {-1}); }, {"there is no face -1"});
  expectFault<InputError>([&] { smoothRegion(field, {99999}); }, {"there is no face 99999"});
  expectFault<InputError>([&] { smoothRegion(field, all); }, {"covers a whole surface"});
  field.values[3] = std::numeric_limits<double>::quiet_NaN();
  expectFault<InputError>([&] { smoothRegion(field, all); }, {"vertex 3 is not finite"});
}

TEST(Region, DiscAndLoopOfOneCircleAgree) {
  const auto mesh = makeMesh(icosphere(4));
  const ClosestPointQuery query(mesh);
  const double height = 0.8, radius = std::sqrt(1.0 - height * height);
  std::vector<Vec3> circle;
  for (int i = 0; i < 60; ++i) {
    const double a = 2.0 * kPi * i / 60;
    circle.emplace_back(radius * std::cos(a), radius * std::sin(a), height);
  }
  const std::vector<Index> disc =
      facesInDisc(*mesh, query.closest(Vec3(0, 0, 1)).point, std::hypot(radius, 1.0 - height));
  const std::vector<Index> loop = facesInLoop(*mesh, query, circle);
  EXPECT_TRUE(std::includes(loop.begin(), loop.end(), disc.begin(), disc.end()));
  EXPECT_LT(loop.size(), disc.size() * 3 / 2);
  expectFault<InputError>([&] { facesInLoop(*mesh, query, {circle[0], circle[1]}); }, {"three points"});
}

}  // namespace
}  // namespace stormfield::test
