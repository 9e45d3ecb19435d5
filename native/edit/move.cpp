#include "edit/move.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include "base/message.h"
#include "edit/detail/block_growth.h"
#include "edit/detail/direction_fill.h"
#include "edit/detail/harmonic_fill.h"
#include "edit/detail/verification.h"
#include "edit/entity_names.h"

namespace stormfield {
namespace {

Vec3 middle(const TriangleMesh& mesh, Index f) {
  return (mesh.point(mesh.vertex(f, 0)) + mesh.point(mesh.vertex(f, 1)) + mesh.point(mesh.vertex(f, 2))) / 3.0;
}

/// Halfedges over which the shortest way by faces leaves each of them; none where walls leave no way. (Dijkstra 1959)
std::optional<std::vector<Index>> wayBetween(const TriangleMesh& mesh, Index from, Index to,
                                             const std::function<bool(Index)>& isWall) {
  std::vector<double> distance(mesh.faceCount(), std::numeric_limits<double>::infinity());
  std::vector<Index> over(mesh.faceCount(), kNone);
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  distance[from] = 0.0;
  queue.push({0.0, from});
  while (!queue.empty()) {
    const auto [d, f] = queue.top();
    queue.pop();
    if (f == to) break;
    if (d > distance[f]) continue;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (mesh.twin(h) == kNone) continue;
      const Index g = TriangleMesh::face(mesh.twin(h));
      const double next = d + (middle(mesh, g) - middle(mesh, f)).norm();
      if (isWall(g) || next >= distance[g]) continue;
      distance[g] = next;
      over[g] = h;
      queue.push({next, g});
    }
  }
  if (from != to && over[to] == kNone) return std::nullopt;
  std::vector<Index> way;
  for (Index f = to; f != from; f = TriangleMesh::face(over[f])) way.push_back(over[f]);
  std::reverse(way.begin(), way.end());
  return way;
}

/// The angle by which a vector in the flat frame of the first face is turned into that of the last.
double turnAlong(const VertexCharts& charts, const std::vector<Index>& way) {
  double turn = 0.0;
  for (const Index h : way) turn += charts.faceAngle(charts.mesh().twin(h)) + std::acos(-1.0) - charts.faceAngle(h);
  return turn;
}

/// The field with this Jacobian around the target, at the corners of its face.
void placePoint(const FlatFaces& faces, const Eigen::Matrix2d& jacobian, const SurfacePoint& target,
                VectorField& field) {
  const FlatFace& face = faces[target.face];
  for (int k = 0; k < 3; ++k) {
    const Complex offset = face.corner(k) - face.point(target.barycentric);
    const Eigen::Vector2d vector = jacobian * Eigen::Vector2d(offset.real(), offset.imag());
    field.values[face.vertex(k)] = Complex(vector[0], vector[1]) / face.carry(k, 1.0);
  }
}

class MoveSearch {
 public:
  MoveSearch(const FlatFaces& faces, const VectorField& field, const Topology& topology, Index point,
             const SurfacePoint& target, const CancelOptions& options, Progress* progress)
      : faces_(faces),
        field_(field),
        topology_(topology),
        point_(point),
        target_(target),
        options_(options),
        progress_(progress) {}

  void run(EditResult& result) {
    const EntityRef entity{EntityKind::FixedPoint, point_};
    Interval interval;
    interval.repeller = interval.attractor = entity;
    const BlockGrowth growth(field_, topology_, interval);
    const FixedPoint& point = topology_.fixedPoints[point_];
    for (const Walls walls : {Walls::EntitiesAndSeparatrices, Walls::Entities}) {
      const auto way =
          wayBetween(field_.mesh(), point.point.face, target_.face, [&](Index f) { return growth.isWall(f, walls); });
      if (!way) continue;
      VectorField placed = field_;
      const Eigen::Rotation2Dd turn(turnAlong(*field_.charts, *way));
      placePoint(faces_, turn * point.jacobian * turn.inverse(), target_, placed);
      std::vector<Index> core{target_.face};
      for (const Index h : *way) core.push_back(TriangleMesh::face(h));
      tryBlocks(growth.withCore(core), walls, placed, result);
      if (result.applied) return;
    }
  }

  std::string reason() const {
    const std::string name = entityName(topology_, field_.mesh(), {EntityKind::FixedPoint, point_});
    if (fault_.empty()) {
      return message("the ", name, " cannot be moved there: other entities or the boundary are in the way; choose a ",
                     "nearer place");
    }
    return message("the ", name, " cannot be moved there: ", fault_, "; choose a nearer place");
  }

 private:
  void tryBlocks(const BlockGrowth& growth, Walls walls, const VectorField& placed, EditResult& result) {
    for (int rings = 2; rings <= options_.maxRings; rings += 1 + rings / 4) {
      const std::optional<Block> block = growth.grown(Growth::Rings, rings, walls);
      if (!block || block->components != 1) continue;
      std::vector<Index> free;
      const Triangles& triangles = field_.mesh().triangles();
      bool inside = true;
      for (int k = 0; k < 3; ++k) {
        inside = inside &&
                 std::binary_search(block->freeVertices.begin(), block->freeVertices.end(), triangles(target_.face, k));
      }
      if (!inside) continue;
      std::copy_if(block->freeVertices.begin(), block->freeVertices.end(), std::back_inserter(free), [&](Index v) {
        return v != triangles(target_.face, 0) && v != triangles(target_.face, 1) && v != triangles(target_.face, 2);
      });
      if (free.empty()) continue;
      tryField(harmonicFill(placed, free), Fill::Harmonic, *block, result);
      if (result.applied) return;
      for (VectorField& filled : directionFills(placed, free)) {
        tryField(std::move(filled), Fill::Directions, *block, result);
        if (result.applied) return;
      }
    }
  }

  void tryField(VectorField filled, Fill fill, const Block& block, EditResult& result) {
    if (progress_ != nullptr) progress_->check();
    if (checks_ >= options_.maxChecks || !hasPointAtTarget(filled)) return;
    ++checks_;
    Topology after = updatedTopology(faces_, filled, field_, topology_, options_.topology);
    Verification found = verifyMoved(field_.mesh(), topology_, after, point_);
    if (!found.fault.empty()) {
      fault_ = found.fault;
      return;
    }
    result.index = block.index;
    accept(result, field_, std::move(filled), std::move(after), std::move(found.left), block.faces, fill);
  }

  /// One fixed point more than those outside, near the target.
  bool hasPointAtTarget(const VectorField& filled) {
    const std::vector<FixedPoint> points = findFixedPoints(filled, options_.topology.fixedPoints);
    const Vec3 place = position(field_.mesh(), target_);
    const double reach = kMoveTolerance * field_.mesh().meanEdgeLength();
    const bool there = std::any_of(points.begin(), points.end(), [&](const FixedPoint& p) {
      return p.kind == topology_.fixedPoints[point_].kind && (p.position - place).norm() <= reach;
    });
    if (there && points.size() == topology_.fixedPoints.size()) return true;
    if (fault_.empty()) fault_ = "further fixed points would appear";
    return false;
  }

  const FlatFaces& faces_;
  const VectorField& field_;
  const Topology& topology_;
  const Index point_;
  const SurfacePoint& target_;
  const CancelOptions& options_;
  Progress* progress_;
  int checks_ = 0;
  std::string fault_;
};

std::string fault(const TriangleMesh& mesh, const Topology& topology, Index point, const SurfacePoint& target) {
  if (point < 0 || point >= static_cast<Index>(topology.fixedPoints.size())) {
    return message("there is no fixed point ", point, " in the topology of the field; analyze the field again");
  }
  if (target.face < 0 || target.face >= mesh.faceCount()) return message("there is no face ", target.face);
  const FixedPoint& p = topology.fixedPoints[point];
  if (p.kind == FixedPointKind::Degenerate) {
    return message("the ", entityName(topology, mesh, {EntityKind::FixedPoint, point}),
                   " has no kind that could be kept; smooth a region around it instead");
  }
  if (mesh.component(mesh.vertex(p.point.face, 0)) != mesh.component(mesh.vertex(target.face, 0))) {
    return "the target lies on another part of the surface; choose a place on the same part";
  }
  return "";
}

}  // namespace

EditResult movePoint(const FlatFaces& faces, const VectorField& field, const Topology& topology, Index point,
                     const SurfacePoint& target, const CancelOptions& options, Progress* progress) {
  EditResult result;
  result.field = field;
  try {
    requireFinite(field);
    result.reason = fault(field.mesh(), topology, point, target);
    if (result.reason.empty()) {
      MoveSearch search(faces, field, topology, point, target, options, progress);
      search.run(result);
      if (!result.applied) result.reason = search.reason();
    }
  } catch (const InputError& problem) {
    result.reason = problem.what();
  }
  if (!result.applied) result.topology = topology;
  return result;
}

}  // namespace stormfield
