#include "edit/detail/block_border.h"

#include <numbers>

#include "maps/geometry_map.h"

namespace stormfield {
namespace {

Exit exitOver(const EndVectors& ends) {
  const auto [tail, head] = ends;
  if (tail.imag() >= 0.0 && head.imag() >= 0.0) return Exit::None;
  if (tail.imag() > 0.0) return Exit::AtHead;
  return head.imag() > 0.0 ? Exit::AtTail : Exit::Whole;
}

/// Whether the flow runs from the exit to the entry where it changes its sign on the edge.
bool isInternallyTangent(const EndVectors& ends) {
  const auto [tail, head] = ends;
  return tail.imag() * head.imag() < 0.0 && head.real() * tail.imag() - tail.real() * head.imag() < 0.0;
}

/// The component across beside an end: that of the end, or where it is 0, that of the other end.
double across(Complex end, Complex otherEnd) {
  return end.imag() != 0.0 ? end.imag() : otherEnd.imag();
}

/// Whether a trajectory inside N touches the tail of a border halfedge: the fan of N there has a reflex angle.
bool touchesTail(const VectorField& field, const FaceSets& sets, Index h) {
  const TriangleMesh& mesh = field.mesh();
  const auto isInside = [&](Index i) { return i != kNone && sets.setOf(TriangleMesh::face(i)) == 0; };
  const double scale = field.charts->scale(mesh.tail(h));
  Index last = TriangleMesh::prev(h);
  double angle = scale * mesh.cornerAngle(h);
  for (; isInside(mesh.twin(last)); last = TriangleMesh::prev(mesh.twin(last))) {
    angle += scale * mesh.cornerAngle(mesh.twin(last));
  }
  if (angle <= std::numbers::pi) return false;
  const EndVectors leaving = endVectors(field, h), arriving = endVectors(field, last);
  return across(leaving.tail, leaving.head) * across(arriving.head, arriving.tail) < 0.0;
}

}  // namespace

BlockBorder blockBorder(const VectorField& field, const FaceSets& sets) {
  const TriangleMesh& mesh = field.mesh();
  BlockBorder border;
  border.pair.exits.reserve(3 * sets.members(0).size());
  for (const Index f : sets.members(0)) {
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index twin = mesh.twin(h);
      if (twin != kNone && sets.setOf(TriangleMesh::face(twin)) == 0) {
        border.pair.exits.push_back(Exit::None);
        continue;
      }
      const EndVectors ends = endVectors(field, h);
      border.pair.exits.push_back(exitOver(ends));
      if (isInternallyTangent(ends)) border.internalTangencies.push_back({h, false});
      if (touchesTail(field, sets, h)) border.internalTangencies.push_back({h, true});
    }
  }
  return border;
}

}  // namespace stormfield
