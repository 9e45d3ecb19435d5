#include "design/detail/loop_checks.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

namespace {

/// Places of a loop that are farther apart along it than this many edges count as different.
constexpr double kApart = 4.0;

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
