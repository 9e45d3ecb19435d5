// Unfolded faces against the lengths and angles of the mesh, against the plane where the surface is flat, and near
// faces against all faces.
#include "maps/detail/unfolding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "flat_fields.h"

namespace stormfield::test {
namespace {

Complex inPlane(const FlatFaces& faces, const Isometry& isometry, Index f, int corner) {
  return isometry(faces[f].corner(corner));
}

TEST(Unfolding, KeepsTheLengthsAndAnglesOfTheMesh) {
  for (const NamedSurface& s : closedSurfaces()) {
    const FlatFaces faces(makeCharts(s.surface));
    const TriangleMesh& mesh = faces.mesh();
    for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
      const Index base = TriangleMesh::face(h), twin = mesh.twin(h), other = TriangleMesh::face(twin);
      const Isometry toBase = unfold(faces, h);
      const int i = TriangleMesh::corner(h), j = TriangleMesh::corner(twin);
      const Complex tail = faces[base].corner(i), head = faces[base].corner((i + 1) % 3);
      const Complex apex = faces[base].corner((i + 2) % 3);
      // The common edge is the same, from head to tail.
      EXPECT_NEAR(std::abs(inPlane(faces, toBase, other, j) - head), 0.0, 1e-12) << s.name;
      EXPECT_NEAR(std::abs(inPlane(faces, toBase, other, (j + 1) % 3) - tail), 0.0, 1e-12) << s.name;
      // The third corner has its lengths to both, on the other side.
      const Complex unfolded = inPlane(faces, toBase, other, (j + 2) % 3);
      const double toTail = mesh.edgeLength(mesh.edge(TriangleMesh::halfedge(other, (j + 1) % 3)));
      const double toHead = mesh.edgeLength(mesh.edge(TriangleMesh::halfedge(other, (j + 2) % 3)));
      EXPECT_NEAR(std::abs(unfolded - tail), toTail, 1e-12 * toTail) << s.name;
      EXPECT_NEAR(std::abs(unfolded - head), toHead, 1e-12 * toHead) << s.name;
      EXPECT_GT(cross(head - tail, apex - tail), 0.0) << s.name;
      EXPECT_LT(cross(head - tail, unfolded - tail), 0.0) << s.name;
      // At the tail the two corner angles add up.
      const double angle = std::arg((apex - tail) / (unfolded - tail));
      const double sum = mesh.cornerAngle(TriangleMesh::halfedge(base, i)) +
                         mesh.cornerAngle(TriangleMesh::halfedge(other, (j + 1) % 3));
      EXPECT_NEAR(std::remainder(angle - sum, 2.0 * kPi), 0.0, 1e-10) << s.name;
    }
  }
}

TEST(Unfolding, OfAFlatSurfaceIsThePlane) {
  const FlatFaces faces(makeCharts(grid(5, 0.3)));
  const TriangleMesh& mesh = faces.mesh();
  Random random(4);
  int acrossEdge = 0, aroundVertex = 0;
  for (Index base = 0; base < mesh.faceCount(); ++base) {
    for (Index other = 0; other < mesh.faceCount(); ++other) {
      const Unfoldings unfoldings(faces, base, other);
      int shared = 0;
      bool atInnerVertex = false;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          if (mesh.vertex(base, i) != mesh.vertex(other, j)) continue;
          ++shared;
          atInnerVertex = !mesh.isBoundaryVertex(mesh.vertex(base, i));
        }
      }
      if (shared == 0) {
        EXPECT_EQ(unfoldings.count(), 0);
      }
      if (shared >= 2) {
        EXPECT_EQ(unfoldings.count(), 1);
      }
      if (shared == 1) {
        EXPECT_EQ(unfoldings.count(), atInnerVertex ? 2 : 1);
      }
      acrossEdge += shared == 2;
      aroundVertex += shared == 1 && atInnerVertex;
      const Eigen::Vector3d b = random.barycentric();
      const Complex inOther = faces[other].point(b);
      for (int i = 0; i < unfoldings.count(); ++i) {
        // The same point of the plane has these coordinates in the base, outside of it.
        const Eigen::Vector3d inBase = faces[base].barycentric(unfoldings[i](inOther));
        const Eigen::Vector3d wanted = barycentricIn(mesh, base, position(mesh, {other, b}));
        EXPECT_LE((inBase - wanted).norm(), 1e-10) << base << ", " << other;
      }
      if (shared == 1 && atInnerVertex) {
        EXPECT_NEAR(unfoldings.spread(faces[base].corner(0), inOther), 0.0, 1e-10);
      }
    }
  }
  EXPECT_GT(acrossEdge, 50);
  EXPECT_GT(aroundVertex, 200);
}

TEST(Unfolding, SpreadsByTheAngleThatIsMissingAtTheVertex) {
  // Five angles of 60 degrees: the two ways around a vertex of an icosahedron differ by a rotation of 60 degrees.
  const FlatFaces faces(makeCharts(icosphere(0)));
  const TriangleMesh& mesh = faces.mesh();
  Random random(2);
  int compared = 0;
  for (Index base = 0; base < mesh.faceCount(); ++base) {
    for (Index other = 0; other < mesh.faceCount(); ++other) {
      int common = -1, shared = 0;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          if (mesh.vertex(base, i) != mesh.vertex(other, j)) continue;
          common = j;
          ++shared;
        }
      }
      if (shared != 1) continue;
      const Unfoldings unfoldings(faces, base, other);
      ASSERT_EQ(unfoldings.count(), 2);
      const Complex inOther = faces[other].point(random.barycentric());
      const double distance = std::abs(inOther - faces[other].corner(common));
      EXPECT_NEAR(unfoldings.spread(faces[base].corner(0), inOther), distance, 1e-10);
      ++compared;
    }
  }
  EXPECT_EQ(compared, 20 * 6);
}

TEST(Unfolding, DistancesOfSegmentsAreThoseOfTheirPoints) {
  Random random(8);
  const auto point = [&] { return Complex(random.uniform(), random.uniform()); };
  for (int round = 0; round < 200; ++round) {
    const Complex p = point(), q = point(), a = point(), b = point();
    constexpr int kSamples = 100;
    double least = HUGE_VAL;
    for (int i = 0; i <= kSamples; ++i) {
      for (int j = 0; j <= kSamples; ++j) {
        const double s = static_cast<double>(i) / kSamples, t = static_cast<double>(j) / kSamples;
        least = std::min(least, std::abs(p + s * (q - p) - a - t * (b - a)));
      }
    }
    EXPECT_LE(segmentDistance(p, q, a, b), least + 1e-12);
    EXPECT_GE(segmentDistance(p, q, a, b), least - 0.03);  // the samples are that far apart
    // What is beside the line is farther from the segment.
    const double distance = random.uniform(0.0, 0.3);
    if (isBeside(p, q, a, b, distance)) {
      EXPECT_GT(segmentDistance(p, q, a, b), distance);
    }
  }
}

TEST(NearFaces, AreAllFacesOfAFlatSurfaceWithinTheDistance) {
  const FlatFaces faces(makeCharts(grid(6, 0.3)));
  const TriangleMesh& mesh = faces.mesh();
  NearFaces near(faces);
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    const Index base = random.below(mesh.faceCount());
    const Complex from = faces[base].point(random.barycentric());
    const Complex to = from + Complex(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3));
    const double distance = random.uniform(0.0, 0.3);
    std::vector<Index> found, boundary;
    near.collect(base, from, to, distance, found, [&](Index h) { boundary.push_back(h); });
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      // Lay the corners of the face into the frame of the base by their positions in the plane.
      Complex corners[3];
      double least = f == base ? 0.0 : HUGE_VAL;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d b = barycentricIn(mesh, base, mesh.point(mesh.vertex(f, k)));
        corners[k] = faces[base].point(b);
      }
      for (int k = 0; k < 3; ++k) {
        const double toSide = segmentDistance(from, to, corners[k], corners[(k + 1) % 3]);
        least = std::min(least, toSide);
        if (std::abs(toSide - distance) < 1e-9) continue;
        const Index h = TriangleMesh::halfedge(f, k);
        const bool isFound = std::find(boundary.begin(), boundary.end(), h) != boundary.end();
        EXPECT_EQ(isFound, mesh.twin(h) == kNone && toSide < distance) << "halfedge " << h;
      }
      if (std::abs(least - distance) < 1e-9) continue;
      EXPECT_EQ(std::binary_search(found.begin(), found.end(), f), least < distance || f == base) << "face " << f;
    }
  }
}

}  // namespace
}  // namespace stormfield::test
