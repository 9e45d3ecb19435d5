#include "maps/detail/unfolding.h"

#include <algorithm>
#include <cmath>

#include "tracing/dense_step.h"

namespace stormfield {
namespace {

double squaredDistance(Complex p, Complex a, Complex b) {
  const Complex side = b - a, d = p - a;
  const double squared = std::norm(side);
  const double t =
      squared > 0.0 ? std::clamp((d.real() * side.real() + d.imag() * side.imag()) / squared, 0.0, 1.0) : 0.0;
  return std::norm(d - t * side);
}

}  // namespace

double segmentDistance(Complex p, Complex q, Complex a, Complex b) {
  const bool crossesLine = cross(b - a, p - a) * cross(b - a, q - a) < 0.0;
  if (crossesLine && cross(q - p, a - p) * cross(q - p, b - p) < 0.0) return 0.0;
  return std::sqrt(std::min(std::min(squaredDistance(p, a, b), squaredDistance(q, a, b)),
                            std::min(squaredDistance(a, p, q), squaredDistance(b, p, q))));
}

Isometry unfold(const FlatFaces& faces, Index h) {
  const FlatFace& base = faces[TriangleMesh::face(h)];
  const int i = TriangleMesh::corner(h);
  const Index twin = base.twin(i);
  const FlatFace& other = faces[TriangleMesh::face(twin)];
  const int j = TriangleMesh::corner(twin);
  const Complex tail = base.corner(i), head = base.corner((i + 1) % 3);
  Complex rotation = (tail - head) * std::conj(other.corner((j + 1) % 3) - other.corner(j));
  rotation /= magnitude(rotation);
  return {rotation, head - rotation * other.corner(j)};
}

Unfoldings::Unfoldings(const FlatFaces& faces, Index base, Index other) : faces_(&faces), base_(base) {
  if (base == other) {
    count_ = 1;
    return;
  }
  for (int i = 0; i < 3; ++i) {
    const Index twin = faces[base].twin(i);
    if (twin == kNone || TriangleMesh::face(twin) != other) continue;
    unfoldings_[0] = unfold(faces, TriangleMesh::halfedge(base, i));
    count_ = 1;
    side_ = i;
    return;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (faces[base].vertex(i) != faces[other].vertex(j)) continue;
      pivot_ = i;
      unfoldAround(base, other, i, Around::CounterClockwise);
      unfoldAround(base, other, i, Around::Clockwise);
      return;
    }
  }
}

/// Unfolds face after face around a corner of the base until the other face is reached.
void Unfoldings::unfoldAround(Index base, Index other, int corner, Around around) {
  const bool counterClockwise = around == Around::CounterClockwise;
  Isometry toBase;
  Index out = TriangleMesh::halfedge(base, corner);  // of the current face, from the vertex
  while (true) {
    const Index over = counterClockwise ? TriangleMesh::prev(out) : out;
    const Index twin = (*faces_)[TriangleMesh::face(over)].twin(TriangleMesh::corner(over));
    if (twin == kNone) return;
    toBase = toBase.after(unfold(*faces_, over));
    out = counterClockwise ? twin : TriangleMesh::next(twin);
    if (TriangleMesh::face(out) == base) return;
    if (TriangleMesh::face(out) == other) break;
  }
  unfoldings_[count_++] = toBase;
}

double Unfoldings::spread(Complex inBase, Complex inOther) const {
  const Complex point = unfoldings_[0](inOther);
  if (count_ == 2) return std::abs(point - unfoldings_[1](inOther));
  if (pivot_) return std::abs(point - (*faces_)[base_].corner(*pivot_));
  if (!side_) return 0.0;
  // A curve over the common edge has one way. Past the end of the edge it has one on either side of the vertex there:
  // the two unfoldings differ by a rotation of the vertex's total angle.
  const FlatFace& base = (*faces_)[base_];
  const Complex tail = base.corner(*side_), head = base.corner((*side_ + 1) % 3);
  if (segmentDistance(inBase, point, tail, head) <= 1e-6 * std::abs(head - tail)) return 0.0;
  const int corner = cross(point - inBase, tail - inBase) > 0.0 ? *side_ : (*side_ + 1) % 3;
  const VertexCharts& charts = faces_->charts();
  const Index v = base.vertex(corner);
  const double distance = std::abs(point - base.corner(corner));
  if (charts.mesh().isBoundaryVertex(v)) return distance;
  return 2.0 * std::abs(std::sin(0.5 * charts.totalAngle(v))) * distance;
}

}  // namespace stormfield
