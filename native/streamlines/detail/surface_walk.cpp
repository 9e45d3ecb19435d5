#include "streamlines/detail/surface_walk.h"

#include <algorithm>
#include <limits>

namespace stormfield {
namespace {

constexpr int kNoSide = -1;
/// Bounds the work where round-off lets a path circle a vertex.
constexpr int kMostFaces = 100000;
/// As near to a corner as a path may cross an edge.
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

SurfaceWalk walkStraight(const FlatFaces& faces, const SurfacePoint& from, Complex direction, double length) {
  Index f = from.face;
  Complex position = faces[f].point(from.barycentric), d = direction / std::abs(direction);
  double left = length;
  int entry = kNoSide;
  for (int visited = 0; visited < kMostFaces; ++visited) {
    const FlatFace& face = faces[f];
    const Eigen::Vector3d b = face.barycentric(position), rate = face.barycentricRate(d);
    double exit = std::numeric_limits<double>::infinity();
    int across = kNoSide;
    for (int i = 0; i < 3; ++i) {
      if (rate[i] >= 0.0 || (i + 1) % 3 == entry) continue;
      const double distance = std::max(0.0, b[i]) / -rate[i];
      if (distance < exit) {
        exit = distance;
        across = (i + 1) % 3;
      }
    }
    if (across == kNoSide || exit >= left) {
      position += left * d;
      left = 0.0;
      break;
    }
    position += exit * d;
    left -= exit;
    const Index twin = face.twin(across);
    if (twin == kNone) break;
    const Complex s = side(face, across), onSide = (position - face.corner(across)) * std::conj(s);
    const double fraction = std::clamp(onSide.real() / std::norm(s), kBesideVertex, 1.0 - kBesideVertex);
    f = TriangleMesh::face(twin);
    entry = TriangleMesh::corner(twin);
    const Complex back = side(faces[f], entry);
    position = faces[f].corner(entry) + (1.0 - fraction) * back;
    d *= -back / s;
    d /= std::abs(d);
  }
  return {pointIn(f, faces[f], position), d, length - left};
}

}  // namespace stormfield
