// Distances between lines and from the surface to lines, by brute force over all pieces of all lines.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "field/interpolation.h"
#include "fixtures.h"
#include "long_tests.h"
#include "streamlines/evenly_spaced.h"

namespace stormfield::test {

struct Segment {
  Vec3 from, to, normal;
  Index line, component;
};

inline double distance(const Segment& s, const Vec3& p) {
  const Vec3 along = s.to - s.from;
  const double square = along.squaredNorm();
  const double t = square > 0.0 ? std::clamp((p - s.from).dot(along) / square, 0.0, 1.0) : 0.0;
  return (p - s.from - t * along).norm();
}

inline std::vector<Segment> segmentsOf(const TriangleMesh& mesh, const EvenStreamlines& lines) {
  std::vector<Segment> result;
  for (std::size_t i = 0; i + 1 < lines.offsets.size(); ++i) {
    const std::size_t begin = lines.offsets[i], end = lines.offsets[i + 1];
    for (std::size_t k = begin; k < end; ++k) {
      if (k + 1 == end && !lines.closed[i]) continue;
      const SurfacePoint &a = lines.points[k], &b = lines.points[k + 1 == end ? begin : k + 1];
      result.push_back({position(mesh, a), position(mesh, b), mesh.faceNormal(a.face), static_cast<Index>(i),
                        mesh.component(mesh.vertex(a.face, 0))});
    }
  }
  return result;
}

/// To the nearest piece whose face is turned less than the angle of this cosine and that is not of line `except`;
/// infinite when there is none.
inline double distanceToLines(const TriangleMesh& mesh, const std::vector<Segment>& segments, const SurfacePoint& p,
                              double cosine, Index except = kNone) {
  const Vec3 place = position(mesh, p), normal = mesh.faceNormal(p.face);
  const Index component = mesh.component(mesh.vertex(p.face, 0));
  double nearest = std::numeric_limits<double>::infinity();
  for (const Segment& s : segments) {
    if (s.line == except || s.component != component || s.normal.dot(normal) <= cosine) continue;
    nearest = std::min(nearest, distance(s, place));
  }
  return nearest;
}

/// Part of the points of all lines that have another line nearer than this.
inline double crowdedPart(const TriangleMesh& mesh, const EvenStreamlines& lines, double nearerThan) {
  const auto segments = segmentsOf(mesh, lines);
  const std::size_t each = shortOrLong(3, 1);  // of so many points, which are close to each other
  std::size_t crowded = 0, looked = 0;
  for (std::size_t i = 0; i + 1 < lines.offsets.size(); ++i) {
    for (std::size_t k = lines.offsets[i]; k < lines.offsets[i + 1]; ++k) {
      if (k % each != 0) continue;
      ++looked;
      crowded += distanceToLines(mesh, segments, lines.points[k], 0.0, static_cast<Index>(i)) < nearerThan;
    }
  }
  return static_cast<double>(crowded) / static_cast<double>(std::max<std::size_t>(1, looked));
}

/// The largest distance to a line of points all over the surface where the field flows.
inline double largestGap(const VectorField& field, const EvenStreamlines& lines, double cosine = -0.72) {
  const int pointsPerFace = shortOrLong(1, 4);
  const TriangleMesh& mesh = field.mesh();
  const auto segments = segmentsOf(mesh, lines);
  Random random(11);
  double largest = 0.0;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    for (int i = 0; i < pointsPerFace; ++i) {
      const SurfacePoint p{f, random.barycentric()};
      if (evaluate(field, p).norm() < 1e-4) continue;
      largest = std::max(largest, distanceToLines(mesh, segments, p, cosine));
    }
  }
  return largest;
}

}  // namespace stormfield::test
