#include "design/detail/loop_checks.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <unordered_set>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

namespace {

/// Places of a loop that are farther apart along it than this many edges count as different.
constexpr double kApart = 4.0;
/// Fine samples of a loop follow each other on the surface, no farther from the first than so many times their distance.
constexpr double kDetour = 2.0;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// A piece of the loop between two fine samples.
struct Piece {
  Vec3 from, to, normal;
  double arc = 0.0;
};

/// Whether two pieces of one sheet cross, seen along its normal.
bool crosses(const Piece& a, const Piece& b) {
  if (a.normal.dot(b.normal) <= 0.0) return false;
  const Vec3 x = (a.to - a.from).normalized(), y = a.normal.cross(x);
  const double reach = (a.to - a.from).norm() + (b.to - b.from).norm();
  if (std::abs((b.from - a.from).dot(a.normal)) > reach) return false;
  const auto flat = [&](const Vec3& p) { return Eigen::Vector2d((p - a.from).dot(x), (p - a.from).dot(y)); };
  const Eigen::Vector2d end = flat(a.to), from = flat(b.from), to = flat(b.to);
  const auto opposite = [](double one, double other) { return (one > 0.0) != (other > 0.0); };
  return opposite(cross(end, from), cross(end, to)) && opposite(cross(to - from, -from), cross(to - from, end - from));
}

std::vector<Piece> piecesOf(const TriangleMesh& mesh, const SurfacePath& path) {
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k + 1 < path.positions().size(); ++k)
    if (path.arc()[k + 1] > path.arc()[k])
      pieces.push_back(
          {path.positions()[k], path.positions()[k + 1], mesh.faceNormal(path.points()[k].face), path.arc()[k]});
  return pieces;
}

double distanceToEdge(const TriangleMesh& mesh, Index h, const Vec3& p) {
  const Vec3 tail = mesh.point(mesh.tail(h)), along = mesh.point(mesh.head(h)) - tail;
  const double part = std::clamp((p - tail).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - tail - part * along).norm();
}

/// Whether the surface leads from one face to another over edges within that distance of a place.
bool connects(const TriangleMesh& mesh, Index from, Index to, const Vec3& place, double distance) {
  std::unordered_set<Index> seen{from};
  std::deque<Index> waiting{from};
  while (!waiting.empty()) {
    const Index f = waiting.front();
    waiting.pop_front();
    if (f == to) return true;
    for (int corner = 0; corner < 3; ++corner) {
      const Index h = TriangleMesh::halfedge(f, corner), twin = mesh.twin(h);
      if (twin != kNone && distanceToEdge(mesh, h, place) <= distance && seen.insert(TriangleMesh::face(twin)).second)
        waiting.push_back(TriangleMesh::face(twin));
    }
  }
  return false;
}

std::string at(const Vec3& p) {
  return message("(", shortNumber(p.x()), ", ", shortNumber(p.y()), ", ", shortNumber(p.z()), ")");
}

}  // namespace

void checkLoop(const TriangleMesh& mesh, const SurfacePath& path, const DesignElement& element) {
  const double edge = mesh.meanEdgeLength(), length = path.length();
  double across = 0.0;
  for (const Vec3& p : path.positions()) across = std::max(across, (p - path.positions().front()).norm());
  if (across < edge)
    throw InputError(describe(element) + " is " + shortNumber(across) + " across, smaller than an edge of the mesh (" +
                     shortNumber(edge) + "): draw it larger, or refine the mesh");
  for (std::size_t k = 0; k + 1 < path.points().size(); ++k) {
    const Vec3 &from = path.positions()[k], &to = path.positions()[k + 1];
    const double near = kDetour * std::max((to - from).norm(), 0.5 * edge);
    if (!connects(mesh, path.points()[k].face, path.points()[k + 1].face, from, near))
      throw InputError(describe(element) + " jumps from " + at(from) + " to " + at(to) +
                       ", which the surface does not join nearby: draw more points there, along the surface");
  }
  const std::vector<Piece> pieces = piecesOf(mesh, path);
  const auto search = [&](const auto& check) {
    for (std::size_t i = 0; i < pieces.size(); ++i)
      for (std::size_t j = i + 2; j < pieces.size(); ++j) {
        const bool neighbours = i == 0 && j + 1 == pieces.size();
        if (!neighbours && (pieces[i].from - pieces[j].from).norm() < 2.0 * edge) check(pieces[i], pieces[j]);
      }
  };
  search([&](const Piece& a, const Piece& b) {
    if (crosses(a, b))
      throw InputError(describe(element) + " crosses itself near " + at(a.from) +
                       ": a periodic orbit never does; draw a simple loop");
  });
  search([&](const Piece& a, const Piece& b) {
    const double along = std::min(b.arc - a.arc, length - (b.arc - a.arc));
    if ((a.from - b.from).norm() < edge && along > kApart * edge && a.normal.dot(b.normal) > 0.0)
      throw InputError(describe(element) + " comes back to itself near " + at(a.from) + ", closer than an edge (" +
                       shortNumber(edge) + "): draw it wider apart there, or refine the mesh");
  });
}

}  // namespace stormfield
