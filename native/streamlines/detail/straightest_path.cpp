#include "streamlines/detail/straightest_path.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace stormfield {
namespace {

/// Bounds the work where round-off lets a path circle a vertex.
constexpr int kMaxFaces = 100000;
/// Smallest distance from a vertex at which a path crosses an edge, as a fraction of the edge.
constexpr double kBesideVertex = 1e-9;

Complex side(const FlatFace& face, int i) {
  return face.corner((i + 1) % 3) - face.corner(i);
}

SurfacePoint pointIn(Index f, const FlatFace& face, Complex position) {
  SurfacePoint p{f, face.barycentric(position).cwiseMax(0.0)};
  p.barycentric /= p.barycentric.sum();
  return p;
}

}  // namespace

StraightestPath straightestPath(const FlatFaces& faces, const SurfacePoint& from, Complex direction, double length) {
  Index f = from.face;
  Complex position = faces[f].point(from.barycentric), d = direction / std::abs(direction);
  double left = length;
  std::optional<int> entry;
  for (int visited = 0; visited < kMaxFaces; ++visited) {
    const FlatFace& face = faces[f];
    const Eigen::Vector3d b = face.barycentric(position), rate = face.barycentricRate(d);
    // The first side that the path meets, but not the one it has just crossed.
    double exit = std::numeric_limits<double>::infinity();
    std::optional<int> across;
    for (int i = 0; i < 3; ++i) {
      if (rate[i] >= 0.0 || (i + 1) % 3 == entry) continue;
      const double distance = std::max(0.0, b[i]) / -rate[i];
      if (distance < exit) {
        exit = distance;
        across = (i + 1) % 3;
      }
    }
    if (!across || exit >= left) {
      position += left * d;
      left = 0.0;
      break;
    }
    position += exit * d;
    left -= exit;
    const Index twin = face.twin(*across);
    if (twin == kNone) break;
    const Complex s = side(face, *across), onSide = (position - face.corner(*across)) * std::conj(s);
    const double fraction = std::clamp(onSide.real() / std::norm(s), kBesideVertex, 1.0 - kBesideVertex);
    f = TriangleMesh::face(twin);
    entry = TriangleMesh::corner(twin);
    // On in the frame of the next face, where the side has the opposite direction.
    const Complex back = side(faces[f], *entry);
    position = faces[f].corner(*entry) + (1.0 - fraction) * back;
    d *= -back / s;
    d /= std::abs(d);
  }
  return {pointIn(f, faces[f], position), d, length - left};
}

}  // namespace stormfield
