#include "morse/recurrence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "fixtures.h"

namespace stormfield::test {
namespace {

using Choice = std::function<bool(const Vec3&)>;

std::vector<Index> facesWhere(const TriangleMesh& mesh, const Choice& isChosen) {
  std::vector<Index> result;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const Vec3 sum = mesh.point(mesh.vertex(f, 0)) + mesh.point(mesh.vertex(f, 1)) + mesh.point(mesh.vertex(f, 2));
    if (isChosen(sum / 3.0)) result.push_back(f);
  }
  return result;
}

/// Whether the set of faces can hold recurrence when those faces can hold fixed points.
bool recurs(
    const Surface& s, const Choice& inSet, const Choice& holdsFixedPoint = [](const Vec3&) { return false; }) {
  const auto mesh = makeMesh(s);
  std::vector<Index> setOf(mesh->faceCount(), kNone);
  std::vector<char> fixedPointFaces(mesh->faceCount(), 0);
  const std::vector<Index> members = facesWhere(*mesh, inSet);
  EXPECT_FALSE(members.empty());
  for (const Index f : members) setOf[f] = 0;
  for (const Index f : facesWhere(*mesh, holdsFixedPoint)) fixedPointFaces[f] = 1;
  return canRecur(*mesh, FaceSets(std::move(setOf), 1), fixedPointFaces)[0] != 0;
}

bool all(const Vec3&) {
  return true;
}
Choice within(double radius, const Vec3& centre = Vec3::Zero()) {
  return [=](const Vec3& p) { return (p - centre).norm() < radius; };
}
Choice ring(double inner, double outer) {
  return [=](const Vec3& p) { return p.norm() > inner && p.norm() < outer; };
}

TEST(CanRecur, ADiskWithAFixedPointOnly) {
  EXPECT_FALSE(recurs(grid(10), within(0.6)));
  EXPECT_TRUE(recurs(grid(10), within(0.6), within(0.15)));
  EXPECT_FALSE(recurs(grid(10), within(0.6), within(0.15, {0.8, 0.8, 0.0}))) << "beside the set";
}

TEST(CanRecur, ARingInThePlaneAroundAFixedPointOnly) {
  EXPECT_FALSE(recurs(grid(16), ring(0.4, 0.8)));
  EXPECT_TRUE(recurs(grid(16), ring(0.4, 0.8), within(0.2)));
}

TEST(CanRecur, ARingAroundAHoleOfTheSurface) {
  EXPECT_TRUE(recurs(annulus(16, 4), all));
  const auto open = [](const Vec3& p) { return p.x() < 0.5; };
  EXPECT_FALSE(recurs(annulus(16, 4), open)) << "an open strip goes around nothing";
}

TEST(CanRecur, ARingOnTheSphereBetweenFixedPointsOnly) {
  const auto equator = [](const Vec3& p) { return std::abs(p.z()) < 0.3; };
  const auto north = [](const Vec3& p) { return p.z() > 0.9; };
  const auto poles = [](const Vec3& p) { return std::abs(p.z()) > 0.9; };
  EXPECT_FALSE(recurs(icosphere(3), equator));
  EXPECT_FALSE(recurs(icosphere(3), equator, north)) << "contracts over the south";
  EXPECT_TRUE(recurs(icosphere(3), equator, poles));
}

TEST(CanRecur, CurvesAroundHandles) {
  EXPECT_TRUE(recurs(torus(20, 12), all));
  EXPECT_TRUE(recurs(torus(20, 12), [](const Vec3& p) { return p.x() > 0.0 && std::abs(p.y()) < 0.3; }))
      << "around the tube";
  EXPECT_FALSE(recurs(torus(40, 24), within(0.3, {1.4, 0.0, 0.0})));
  // The torus without a disk is not planar.
  EXPECT_TRUE(recurs(torus(20, 12), [](const Vec3& p) { return (p - Vec3(1.4, 0.0, 0.0)).norm() > 0.3; }));
}

TEST(CanRecur, OneOfSeveralComponentsOfASet) {
  const Vec3 middle(0.4, 0.4, 0.0);
  const auto diskAndRing = [&](const Vec3& p) {
    return (p - Vec3(-0.6, -0.6, 0.0)).norm() < 0.25 || ((p - middle).norm() > 0.2 && (p - middle).norm() < 0.5);
  };
  EXPECT_FALSE(recurs(grid(20), diskAndRing));
  EXPECT_TRUE(recurs(grid(20), diskAndRing, within(0.1, middle)));
}

TEST(CanRecur, IsMonotoneAndLeavesNoMarks) {
  // Each set as if it were alone; more faces with fixed points never turn yes into no.
  Random random(5);
  const auto mesh = makeMesh(icosphere(2));
  int yes = 0;
  for (int round = 0; round < 200; ++round) {
    const int parts = 2 + random.below(3);
    std::vector<Index> setOf(mesh->faceCount());
    for (Index& set : setOf) set = random.below(parts);
    for (Index s = 0; s < parts; ++s) setOf[s] = s;
    std::vector<char> few(mesh->faceCount(), 0), more;
    for (char& face : few) face = random.below(200) == 0 ? 1 : 0;
    more = few;
    more[random.below(mesh->faceCount())] = 1;
    const FaceSets sets(setOf, parts);
    const std::vector<char> together = canRecur(*mesh, sets, few), later = canRecur(*mesh, sets, more);
    for (Index s = 0; s < parts; ++s) {
      std::vector<Index> alone(mesh->faceCount(), kNone);
      for (const Index f : sets.members(s)) alone[f] = 0;
      EXPECT_EQ(canRecur(*mesh, FaceSets(alone, 1), few)[0], together[s]);
      EXPECT_LE(together[s], later[s]);
      yes += together[s];
    }
  }
  EXPECT_GT(yes, 0);
}

}  // namespace
}  // namespace stormfield::test
