#include "topology/detail/section.h"

#include <algorithm>

#include "maps/geometry_map.h"

namespace stormfield {

namespace {

/// Sine of the smallest angle between the flow and an edge that continues a section.
constexpr double kMinSine = 0.1;

bool holds(const std::vector<Index>& halfedges, Index h) {
  return std::find(halfedges.begin(), halfedges.end(), h) != halfedges.end();
}

}  // namespace

Index crossedAt(const VectorField& field, Index vertex, HalfedgeEnd end) {
  const VertexCharts& charts = *field.charts;
  const TriangleMesh& mesh = charts.mesh();
  Index best = kNone;
  double greatest = kMinSine;
  const double speed = std::abs(field.values[vertex]);
  for (Index h = mesh.outgoing(vertex); h != kNone; h = mesh.nextOutgoing(h)) {
    if (mesh.twin(h) == kNone) continue;
    const double left = (field.values[vertex] * std::polar(1.0, -charts.tailAngle(h))).imag() / speed;
    const double sine = end == HalfedgeEnd::Tail ? left : -left;
    if (sine > greatest) {
      greatest = sine;
      best = end == HalfedgeEnd::Tail ? h : mesh.twin(h);
    }
  }
  return best;
}

std::array<double, 2> acrossEnds(const VectorField& field, Index h) {
  const auto [tail, head] = endVectors(field, h);
  return {tail.imag(), head.imag()};
}

Section::Section(const VectorField& field, Index halfedge, int beyond) {
  const TriangleMesh& mesh = field.mesh();
  halfedges_ = {halfedge};
  // Over the head, for as long as the flow crosses to the left there.
  for (int i = 0; i < beyond; ++i) {
    const Index last = halfedges_.back();
    if (acrossEnds(field, last)[1] <= 0.0) break;
    const Index next = crossedAt(field, mesh.head(last), HalfedgeEnd::Tail);
    if (next == kNone || holds(halfedges_, next)) break;
    halfedges_.push_back(next);
  }
  // Over the tail.
  for (int i = 0; i < beyond; ++i) {
    const Index first = halfedges_.front();
    if (acrossEnds(field, first)[0] <= 0.0) break;
    const Index before = crossedAt(field, mesh.tail(first), HalfedgeEnd::Head);
    if (before == kNone || holds(halfedges_, before)) break;
    halfedges_.insert(halfedges_.begin(), before);
  }
  starts_ = {0.0};
  for (const Index h : halfedges_) starts_.push_back(starts_.back() + mesh.edgeLength(mesh.edge(h)));
  high_ = starts_.back();
  // The component across is linear along an edge: the section ends at its zero.
  const auto first = acrossEnds(field, halfedges_.front()), last = acrossEnds(field, halfedges_.back());
  if (first[0] < 0.0 && first[1] > 0.0) low_ = at(0, first[0] / (first[0] - first[1]));
  if (last[1] < 0.0 && last[0] > 0.0) high_ = at(halfedges_.size() - 1, last[0] / (last[0] - last[1]));
}

std::optional<double> Section::at(const TriangleMesh& mesh, const EdgePassage& passage) const {
  for (std::size_t i = 0; i < halfedges_.size(); ++i) {
    if (passage.halfedge == halfedges_[i]) return at(i, passage.fraction);
    if (passage.vertex != kNone && i > 0 && passage.vertex == mesh.tail(halfedges_[i])) return starts_[i];
  }
  return std::nullopt;
}

SurfacePoint Section::point(const TriangleMesh& mesh, double position, Direction direction) const {
  std::size_t i = 0;
  while (i + 1 < halfedges_.size() && position > starts_[i + 1]) ++i;
  const double fraction = std::clamp((position - starts_[i]) / (starts_[i + 1] - starts_[i]), 0.0, 1.0);
  const bool backward = direction == Direction::Backward;
  const Index h = backward ? mesh.twin(halfedges_[i]) : halfedges_[i];
  const int corner = TriangleMesh::corner(h);
  SurfacePoint p;
  p.face = TriangleMesh::face(h);
  p.barycentric[corner] = backward ? fraction : 1.0 - fraction;
  p.barycentric[(corner + 1) % 3] = 1.0 - p.barycentric[corner];
  return p;
}

}  // namespace stormfield
