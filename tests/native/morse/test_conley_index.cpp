#include "morse/conley_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

#include "checks.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

using ChooseExit = std::function<Exit(const TriangleMesh&, Index halfedge)>;

ConleyIndex indexOf(const TriangleMesh& mesh, const std::vector<char>& inside, const ChooseExit& choose,
                    Corners corners = Corners::Apart) {
  std::vector<Index> setOf(mesh.faceCount(), kNone);
  for (Index f = 0; f < mesh.faceCount(); ++f) setOf[f] = inside[f] != 0 ? 0 : kNone;
  const FaceSets sets(std::move(setOf), 1);
  IndexPair pair;
  pair.corners = corners;
  for (const Index f : sets.members(0)) {
    for (Index h = 3 * f; h < 3 * f + 3; ++h) pair.exits.push_back(choose(mesh, h));
  }
  return conleyIndex(mesh, sets, 0, pair);
}

ConleyIndex indexOfWhole(const Surface& surface, const ChooseExit& choose) {
  const auto mesh = makeMesh(surface);
  return indexOf(*mesh, std::vector<char>(mesh->faceCount(), 1), choose);
}

Vec3 middle(const TriangleMesh& mesh, Index h) {
  return 0.5 * (mesh.point(mesh.tail(h)) + mesh.point(mesh.head(h)));
}

Exit none(const TriangleMesh& /*mesh*/, Index /*h*/) {
  return Exit::None;
}
Exit whole(const TriangleMesh& /*mesh*/, Index /*h*/) {
  return Exit::Whole;
}
/// The left and right sides of a square.
Exit leftAndRight(const TriangleMesh& mesh, Index h) {
  return std::abs(middle(mesh, h).x()) > 0.999 ? Exit::Whole : Exit::None;
}
/// The outer loop of the annulus.
Exit outer(const TriangleMesh& mesh, Index h) {
  return middle(mesh, h).norm() > 1.5 ? Exit::Whole : Exit::None;
}

// The table of thesis 2.3.2 ------------------------------------------------------------------------------------------

TEST(ConleyIndex, OfFixedPoints) {
  EXPECT_EQ(indexOfWhole(grid(4), none), (ConleyIndex{1, 0, 0}));
  EXPECT_EQ(indexOfWhole(grid(4), leftAndRight), (ConleyIndex{0, 1, 0}));
  EXPECT_EQ(indexOfWhole(grid(4), whole), (ConleyIndex{0, 0, 1}));
}

TEST(ConleyIndex, OfPeriodicOrbits) {
  EXPECT_EQ(indexOfWhole(annulus(12, 3), none), (ConleyIndex{1, 1, 0}));
  EXPECT_EQ(indexOfWhole(annulus(12, 3), whole), (ConleyIndex{0, 1, 1}));
}

TEST(ConleyIndex, OfNothing) {
  EXPECT_EQ(indexOfWhole(annulus(12, 3), outer), (ConleyIndex{0, 0, 0}));
  const auto right = [](const TriangleMesh& mesh, Index h) {
    return middle(mesh, h).x() > 0.999 ? Exit::Whole : Exit::None;
  };
  EXPECT_EQ(indexOfWhole(grid(4), right), (ConleyIndex{0, 0, 0}));
}

TEST(ConleyIndex, KindsHaveNames) {
  const auto named = [](int b0, int b1, int b2) { return std::string(name(kindOf({b0, b1, b2}))); };
  EXPECT_EQ(named(0, 0, 1), "source");
  EXPECT_EQ(named(1, 0, 0), "sink");
  EXPECT_EQ(named(0, 1, 0), "saddle");
  EXPECT_EQ(named(1, 1, 0), "attracting");
  EXPECT_EQ(named(0, 1, 1), "repelling");
  EXPECT_EQ(named(0, 0, 0), "trivial");
  EXPECT_EQ(named(0, 2, 0), "other");
  EXPECT_EQ(named(1, 2, 1), "other");
}

// Any genus, any boundary --------------------------------------------------------------------------------------------

TEST(ConleyIndex, OfClosedSurfacesIsTheirHomology) {
  EXPECT_EQ(indexOfWhole(icosphere(2), none), (ConleyIndex{1, 0, 1}));
  EXPECT_EQ(indexOfWhole(torus(14, 9), none), (ConleyIndex{1, 2, 1}));
  EXPECT_EQ(indexOfWhole(plateWithHoles(2), none), (ConleyIndex{1, 4, 1}));
  EXPECT_EQ(indexOfWhole(plateWithHoles(3), none), (ConleyIndex{1, 6, 1}));
  EXPECT_EQ(indexOfWhole(joined(icosphere(1), torus(8, 6), {4, 0, 0}), none), (ConleyIndex{2, 2, 2}));
}

TEST(ConleyIndex, OfTorusesWithHoles) {
  // Without k faces: k boundary loops on genus 1; the first `exits` of them are exit.
  const auto mesh = makeMesh(torus(14, 9));
  for (int holes = 1; holes <= 3; ++holes) {
    for (int exits = 0; exits <= holes; ++exits) {
      std::vector<char> inside(mesh->faceCount(), 1);
      std::set<Index> exitHoles;
      for (int i = 0; i < holes; ++i) {
        inside[70 * i] = 0;
        if (i < exits) exitHoles.insert(70 * i);
      }
      const auto choose = [&](const TriangleMesh& m, Index h) {
        return exitHoles.count(TriangleMesh::face(m.twin(h))) != 0 ? Exit::Whole : Exit::None;
      };
      const ConleyIndex index = indexOf(*mesh, inside, choose);
      EXPECT_EQ(index.b0, exits == 0 ? 1 : 0);
      EXPECT_EQ(index.b2, exits == holes ? 1 : 0);
      EXPECT_EQ(index.euler(), -holes);
    }
  }
}

TEST(ConleyIndex, PartsOfBoundaryEdgesCountAtTheirEnds) {
  // One triangle: exit over parts of two of its edges, at different corners, is a saddle's; at one corner nothing's.
  const Surface triangle = surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const auto exits = [](Exit a, Exit b, Exit c) {
    return [=](const TriangleMesh& /*mesh*/, Index h) { return h == 0 ? a : h == 1 ? b : c; };
  };
  EXPECT_EQ(indexOfWhole(triangle, exits(Exit::AtTail, Exit::AtTail, Exit::None)), (ConleyIndex{0, 1, 0}));
  EXPECT_EQ(indexOfWhole(triangle, exits(Exit::AtHead, Exit::AtTail, Exit::None)), (ConleyIndex{0, 0, 0}));
  EXPECT_EQ(indexOfWhole(triangle, exits(Exit::Whole, Exit::Whole, Exit::AtTail)), (ConleyIndex{0, 0, 0}));
  EXPECT_EQ(indexOfWhole(triangle, exits(Exit::Whole, Exit::Whole, Exit::Whole)), (ConleyIndex{0, 0, 1}));
}

TEST(ConleyIndex, CornersThatTouchAreApartOrTogether) {
  // Two triangles with one common vertex.
  const auto mesh = makeMesh(grid(2));
  std::vector<char> inside(mesh->faceCount(), 0);
  Index middleVertex = kNone;
  for (Index v = 0; v < mesh->vertexCount(); ++v) {
    if (mesh->point(v).norm() < 1e-9) middleVertex = v;
  }
  std::vector<Index> around;
  for (Index h = mesh->outgoing(middleVertex); h != kNone; h = mesh->nextOutgoing(h)) {
    around.push_back(TriangleMesh::face(h));
  }
  inside[around[0]] = inside[around[3]] = 1;
  EXPECT_EQ(indexOf(*mesh, inside, none, Corners::Apart), (ConleyIndex{2, 0, 0}));
  EXPECT_EQ(indexOf(*mesh, inside, none, Corners::Together), (ConleyIndex{1, 0, 0}));
}

TEST(ConleyIndex, UpperBoundsAgreeWithThePoincareSum) {
  for (int b = 0; b < 64; ++b) {
    const ConleyIndex bound{b % 4, b / 4 % 4, b / 16};
    for (int euler = -5; euler <= 7; ++euler) {
      ConleyIndex wanted;
      bool possible = false;
      for (int i = 0; i < 64; ++i) {
        const ConleyIndex index{i % 4, i / 4 % 4, i / 16};
        const bool below = index.b0 <= bound.b0 && index.b1 <= bound.b1 && index.b2 <= bound.b2;
        if (!below || index.euler() != euler) continue;
        possible = true;
        wanted = {std::max(wanted.b0, index.b0), std::max(wanted.b1, index.b1), std::max(wanted.b2, index.b2)};
      }
      const ConleyIndex found = matchPoincareSum(bound, euler);
      if (possible) {
        EXPECT_EQ(found, wanted);
        continue;
      }
      EXPECT_EQ(found.euler(), euler);
      EXPECT_TRUE(found.b0 >= bound.b0 && found.b1 >= bound.b1 && found.b2 >= bound.b2);
      const int raised = found.b0 + found.b1 + found.b2 - bound.b0 - bound.b1 - bound.b2;
      EXPECT_EQ(raised, std::abs(euler - bound.euler()));
    }
  }
  // What is left of one face when a map misses where flow leaves it.
  EXPECT_EQ(matchPoincareSum({0, 0, 0}, -1), (ConleyIndex{0, 1, 0}));
  EXPECT_EQ(matchPoincareSum({1, 0, 0}, -1), (ConleyIndex{1, 2, 0}));
  EXPECT_EQ(matchPoincareSum({0, 0, 0}, 1), (ConleyIndex{0, 0, 1}));
  EXPECT_EQ(matchPoincareSum({0, 0, 0}, 2), (ConleyIndex{1, 0, 1}));
}

TEST(ConleyIndex, RefusesPairsThatDoNotFit) {
  const auto mesh = makeMesh(grid(2)), other = makeMesh(grid(3));
  const FaceSets sets({0, 0, kNone, kNone, kNone, kNone, kNone, kNone}, 1);
  const IndexPair good{.exits = std::vector<Exit>(6, Exit::None)};
  EXPECT_EQ(conleyIndex(*mesh, sets, 0, good), (ConleyIndex{1, 0, 0}));
  expectFault<InputError>([&] { conleyIndex(*other, sets, 0, good); }, {"8 faces", "18", "same mesh"});
  expectFault<InputError>([&] { conleyIndex(*mesh, sets, 1, good); }, {"no set 1"});
  expectFault<InputError>([&] { conleyIndex(*mesh, sets, -1, good); }, {"no set -1"});
  const IndexPair few{.exits = std::vector<Exit>(5, Exit::None)};
  expectFault<InputError>([&] { conleyIndex(*mesh, sets, 0, few); }, {"5 exits", "2 faces", "three for each"});
  IndexPair apart = good;
  apart.exitVertices = {0};
  expectFault<InputError>([&] { conleyIndex(*mesh, sets, 0, apart); }, {"exit vertices", "corners"});
  IndexPair unsorted{good.exits, {3, 0}, Corners::Together};
  expectFault<InputError>([&] { conleyIndex(*mesh, sets, 0, unsorted); }, {"ascend"});
}

// Against the ranks of the boundary matrices --------------------------------------------------------------------------

int rankMod2(std::vector<std::vector<char>> rows) {
  int rank = 0;
  const std::size_t columns = rows.empty() ? 0 : rows[0].size();
  for (std::size_t c = 0; c < columns; ++c) {
    const auto pivot = std::find_if(rows.begin() + rank, rows.end(), [&](const auto& row) { return row[c] != 0; });
    if (pivot == rows.end()) continue;
    std::iter_swap(rows.begin() + rank, pivot);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (static_cast<int>(r) == rank || rows[r][c] == 0) continue;
      for (std::size_t k = 0; k < columns; ++k) rows[r][k] ^= rows[rank][k];
    }
    ++rank;
  }
  return rank;
}

/// H(N, L) over Z/2 of closed unions of faces and of boundary edges, from the chain complex itself.
ConleyIndex byRanks(const TriangleMesh& mesh, const std::vector<char>& inside, const std::set<Index>& exitEdges) {
  std::set<Index> vertices, edges, faces, gone;
  for (const Index e : exitEdges) {
    gone.insert(mesh.tail(mesh.edgeHalfedge(e)));
    gone.insert(mesh.head(mesh.edgeHalfedge(e)));
  }
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    if (inside[f] == 0) continue;
    faces.insert(f);
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (exitEdges.count(mesh.edge(h)) == 0) edges.insert(mesh.edge(h));
      if (gone.count(mesh.tail(h)) == 0) vertices.insert(mesh.tail(h));
    }
  }
  const auto place = [](const std::set<Index>& cells, Index cell) {
    return static_cast<std::size_t>(std::distance(cells.begin(), cells.find(cell)));
  };
  std::vector<std::vector<char>> d2, d1;
  for (const Index f : faces) {
    std::vector<char> row(edges.size(), 0);
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (edges.count(mesh.edge(h)) != 0) row[place(edges, mesh.edge(h))] ^= 1;
    }
    d2.push_back(row);
  }
  for (const Index e : edges) {
    std::vector<char> row(vertices.size(), 0);
    for (const Index v : {mesh.tail(mesh.edgeHalfedge(e)), mesh.head(mesh.edgeHalfedge(e))}) {
      if (vertices.count(v) != 0) row[place(vertices, v)] ^= 1;
    }
    d1.push_back(row);
  }
  const int r1 = rankMod2(d1), r2 = rankMod2(d2);
  return {static_cast<int>(vertices.size()) - r1, static_cast<int>(edges.size()) - r1 - r2,
          static_cast<int>(faces.size()) - r2};
}

TEST(ConleyIndex, AgreesWithRanks) {
  Random random(3);
  const std::vector<Surface> surfaces{grid(4), torus(7, 5), cylinder(6, 3), plateWithHoles(1, 1), icosphere(1)};
  for (int round = 0; round < 400; ++round) {
    const auto mesh = makeMesh(surfaces[round % surfaces.size()]);
    const int parts = 2 + random.below(4);
    std::vector<char> inside(mesh->faceCount());
    for (char& face : inside) face = random.below(parts) != 0 ? 1 : 0;
    std::set<Index> exitEdges;
    std::vector<Exit> exits(mesh->halfedgeCount(), Exit::None);
    const int exitParts = 1 + random.below(3);
    for (Index h = 0; h < mesh->halfedgeCount(); ++h) {
      const Index twin = mesh->twin(h);
      const bool boundary = twin == kNone || inside[TriangleMesh::face(twin)] == 0;
      if (inside[TriangleMesh::face(h)] == 0 || !boundary || random.below(exitParts) != 0) continue;
      exits[h] = Exit::Whole;
      exitEdges.insert(mesh->edge(h));
    }
    const auto choose = [&](const TriangleMesh& /*mesh*/, Index h) { return exits[h]; };
    EXPECT_EQ(indexOf(*mesh, inside, choose, Corners::Together), byRanks(*mesh, inside, exitEdges)) << round;
  }
}

}  // namespace
}  // namespace stormfield::test
