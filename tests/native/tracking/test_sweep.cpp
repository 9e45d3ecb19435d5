#include "tracking/detail/sweep.h"

#include <gtest/gtest.h>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

/// Two faces on either side of one inner edge, whose canonical halfedge lies in face 0 (`left`) or 1.
struct TwoFaces {
  std::shared_ptr<const TriangleMesh> mesh =
      makeMesh(surface({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}));
  Index inner = kNone, border = kNone, gains = kNone, loses = kNone;

  TwoFaces() {
    for (Index e = 0; e < mesh->edgeCount(); ++e) {
      const Index h = mesh->edgeHalfedge(e);
      if (mesh->twin(h) == kNone) {
        if (border == kNone) border = e;
        continue;
      }
      inner = e;
      gains = TriangleMesh::face(h);
      loses = TriangleMesh::face(mesh->twin(h));
    }
  }
  std::vector<ChargePath> sweep(const std::vector<int>& firstIndices,
                                const std::vector<ZeroCrossing>& crossings) const {
    Progress progress;
    return sweepCharges(*mesh, firstIndices, crossings, progress);
  }
  std::vector<int> indices(int ofGains, int ofLoses) const {
    std::vector<int> result(2);
    result[gains] = ofGains;
    result[loses] = ofLoses;
    return result;
  }
};

using Faces = std::vector<Index>;

TEST(ChargeSweep, ChargesWithoutCrossingsStay) {
  const TwoFaces m;
  const auto paths = m.sweep(m.indices(2, -1), {});
  ASSERT_EQ(paths.size(), 3u);
  int sum = 0;
  for (const ChargePath& path : paths) {
    sum += path.charge;
    EXPECT_EQ(path.faces.size(), 1u);
    EXPECT_EQ(path.begin, kNone);
    EXPECT_EQ(path.end, kNone);
    EXPECT_EQ(path.createdWith, kNone);
  }
  EXPECT_EQ(sum, 1);
}

TEST(ChargeSweep, AChargeCrossesFromTheFaceThatLosesIt) {
  const TwoFaces m;
  for (const int charge : {1, -1}) {
    const auto paths = m.sweep(m.indices(0, charge), {{0.5, 0.3, m.inner, charge}});
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_EQ(paths[0].charge, charge);
    EXPECT_EQ(paths[0].faces, (Faces{m.loses, m.gains}));
    EXPECT_EQ(paths[0].crossings, (Faces{0}));
  }
}

TEST(ChargeSweep, TheOppositeChargeCrossesTheOtherWay) {
  const TwoFaces m;
  const auto paths = m.sweep(m.indices(-1, 0), {{0.5, 0.3, m.inner, 1}});
  ASSERT_EQ(paths.size(), 1u);
  EXPECT_EQ(paths[0].charge, -1);
  EXPECT_EQ(paths[0].faces, (Faces{m.gains, m.loses}));
}

TEST(ChargeSweep, OppositeChargesAnnihilate) {
  const TwoFaces m;
  const auto paths = m.sweep(m.indices(-1, 1), {{0.5, 0.3, m.inner, 1}});
  ASSERT_EQ(paths.size(), 2u);
  for (const Index i : {0, 1}) {
    EXPECT_EQ(paths[i].end, 0);
    EXPECT_EQ(paths[i].annihilatedWith, 1 - i);
    EXPECT_EQ(paths[i].createdWith, kNone);
    EXPECT_EQ(paths[i].faces.size(), 1u);
  }
}

TEST(ChargeSweep, APairIsCreatedBetweenEmptyFaces) {
  const TwoFaces m;
  const auto paths = m.sweep(m.indices(0, 0), {{0.5, 0.3, m.inner, -1}});
  ASSERT_EQ(paths.size(), 2u);
  EXPECT_EQ(paths[0].charge, -1);
  EXPECT_EQ(paths[0].faces, Faces{m.gains});
  EXPECT_EQ(paths[1].charge, 1);
  EXPECT_EQ(paths[1].faces, Faces{m.loses});
  for (const Index i : {0, 1}) {
    EXPECT_EQ(paths[i].begin, 0);
    EXPECT_EQ(paths[i].createdWith, 1 - i);
    EXPECT_EQ(paths[i].end, kNone);
  }
}

TEST(ChargeSweep, ChargesEnterAndLeaveOverTheBoundary) {
  const TwoFaces m;
  const Index face = TriangleMesh::face(m.mesh->edgeHalfedge(m.border));
  std::vector<int> none(2, 0), one(2, 0);
  one[face] = 1;
  const auto entered = m.sweep(none, {{0.5, 0.3, m.border, 1}});
  ASSERT_EQ(entered.size(), 1u);
  EXPECT_EQ(entered[0].begin, 0);
  EXPECT_EQ(entered[0].createdWith, kNone);
  EXPECT_EQ(entered[0].faces, Faces{face});
  const auto left = m.sweep(one, {{0.5, 0.3, m.border, -1}});
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].end, 0);
  EXPECT_EQ(left[0].annihilatedWith, kNone);
}

TEST(ChargeSweep, TheFirstChargeToComeIsTheFirstToLeave) {
  const TwoFaces m;
  // Two charges in one face; one leaves, a third comes, then two more leave.
  const auto paths =
      m.sweep(m.indices(0, 2), {{0.2, 0.3, m.inner, 1}, {0.4, 0.3, m.inner, 1}, {0.6, 0.3, m.inner, -1}});
  ASSERT_EQ(paths.size(), 2u);
  EXPECT_EQ(paths[0].crossings, (Faces{0, 2}));
  EXPECT_EQ(paths[1].crossings, (Faces{1}));
}

TEST(ChargeSweep, APairWithoutLifeIsRemoved) {
  const TwoFaces m;
  EXPECT_TRUE(m.sweep(m.indices(0, 0), {{0.5, 0.0, m.inner, 1}, {0.5, 0.0, m.inner, -1}}).empty());
  EXPECT_EQ(m.sweep(m.indices(0, 0), {{0.4, 0.0, m.inner, 1}, {0.5, 0.0, m.inner, -1}}).size(), 2u);
}

TEST(ChargeSweep, PathsThatAPathWithoutLifeConnectsAreOne) {
  // A pair is created beside a charge, and its opposite half annihilates that charge: one fixed point if at the same
  // lambda, as in a vertex, else three paths.
  const TwoFaces m;
  const auto crossings = [&](double end) {
    return std::vector<ZeroCrossing>{{0.5, 0.0, m.inner, 1}, {end, 0.0, m.inner, -1}};
  };
  const auto joined = m.sweep(m.indices(1, 0), crossings(0.5));
  ASSERT_EQ(joined.size(), 1u);
  EXPECT_EQ(joined[0].charge, 1);
  EXPECT_EQ(joined[0].faces, (Faces{m.gains, m.loses, m.gains}));
  EXPECT_EQ(joined[0].crossings, (Faces{1, 0}));
  EXPECT_EQ(joined[0].begin, kNone);
  EXPECT_EQ(joined[0].end, kNone);

  const auto apart = m.sweep(m.indices(1, 0), crossings(0.6));
  ASSERT_EQ(apart.size(), 3u);
  EXPECT_EQ(apart[0].annihilatedWith, 2);
  EXPECT_EQ(apart[2].annihilatedWith, 0);
  EXPECT_EQ(apart[1].createdWith, 2);
  EXPECT_EQ(apart[1].end, kNone);
}

}  // namespace
}  // namespace stormfield::test
