// How a trace of tracing/integrator.h leaves a vertex: into the face of the vertex's own vector, along the boundary, or
// not at all.
#pragma once

#include "tracing/detail/integrator_class.h"

namespace stormfield {

/// From the tail of halfedge h into its face: distance along a direction of its flat frame.
template <typename Flow>
void Integrator<Flow>::startAt(Index h, double distance, Complex direction) {
  enter(TriangleMesh::face(h));
  position_ = flat_->corner(TriangleMesh::corner(h)) + distance * direction;
  length_ += distance;
}

template <typename Flow>
bool Integrator<Flow>::leaveVertex(int corner) {
  const VertexCharts& charts = faces_.charts();
  const TriangleMesh& mesh = charts.mesh();
  const Index v = flat_->vertex(corner);
  position_ = flat_->corner(corner);
  positioned_ = true;
  entry_ = SidePoint{};
  slide_ = kNoSide;
  if (timeLeft() <= 0.0) return true;
  const Complex velocity = flow_.vertexVelocity(v, cursor_, time());
  const double speed = std::abs(velocity);
  if (Flow::kSteady && speed * speed <= squaredMinSpeed_) return stop(StopReason::MinSpeed);

  double angle = std::arg(velocity);
  if (angle < 0.0) angle += 2.0 * std::numbers::pi;
  Index leaving = kNone, last = kNone;
  for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
    last = h;
    if (angle >= charts.tailAngle(h) && angle <= charts.tailAngle(h) + charts.scale(v) * mesh.cornerAngle(h)) {
      leaving = h;
      break;
    }
  }
  if (leaving == kNone && !mesh.isBoundaryVertex(v)) leaving = last;  // round-off just below 2 pi
  if (leaving == kNone) return leaveAlongBoundary(v, velocity, last);

  ++end_.crossings;
  const Index face = TriangleMesh::face(leaving);
  const int i = TriangleMesh::corner(leaving);
  const FlatFace& flat = faces_[face];
  const Complex along = flat.corner((i + 1) % 3) - flat.corner(i);
  const double edge = std::abs(along);
  const Complex direction = along / edge * std::polar(1.0, (angle - charts.tailAngle(leaving)) / charts.scale(v));
  double duration = kLeave * edge / speed, distance = kLeave * edge;
  const double left = timeLeft();
  if (!Flow::kSteady && !(duration <= 1e-4 * std::min(left, flow_.segmentDuration(cursor_)))) {
    duration = 0.0;  // too slow to leave in one step: start just beside the vertex
  } else if (duration > left) {
    duration = left;
    distance = left * speed;
  }
  elapsed_ += duration;
  vertex_ = v;
  vertexStep_ = end_.steps;
  startAt(leaving, distance, direction);
  return true;
}

/// At a boundary vertex whose vector points out of the surface.
template <typename Flow>
bool Integrator<Flow>::leaveAlongBoundary(Index v, Complex velocity, Index lastHalfedge) {
  const VertexCharts& charts = faces_.charts();
  const Index first = charts.mesh().outgoing(v), incoming = TriangleMesh::prev(lastHalfedge);
  enter(TriangleMesh::face(first));
  position_ = flat_->corner(TriangleMesh::corner(first));
  if (options_.boundary == BoundaryRule::Stop) return stop(StopReason::Boundary);
  const double onward = velocity.real();
  const double backward = (velocity * std::polar(1.0, -charts.totalAngle(v))).real();
  const double speed = std::max(onward, backward);
  if (speed <= 0.0) return waitAtVertex(TriangleMesh::corner(first));

  const bool alongFirst = onward >= backward;
  const Index h = alongFirst ? first : incoming;
  const int i = TriangleMesh::corner(h), tail = alongFirst ? i : (i + 1) % 3;
  enter(TriangleMesh::face(h));
  const double fraction = std::min(kLeave, timeLeft() * speed / std::abs(side(i)));
  const double distance = fraction * std::abs(side(i));
  elapsed_ += Flow::kSteady || distance / speed <= timeLeft() ? distance / speed : 0.0;
  length_ += distance;
  position_ = flat_->corner(tail) + (alongFirst ? 1.0 : -1.0) * fraction * side(i);
  slide_ = i;
  return true;
}

/// At a boundary vertex whose vector points out of the surface: steady flow stops, unsteady flow waits for the vector
/// to change.
template <typename Flow>
bool Integrator<Flow>::waitAtVertex(int corner) {
  if (Flow::kSteady) return stop(StopReason::Boundary);
  while (end_.steps++ < options_.maxSteps) {
    const double left = timeLeft(), total = maxTime_ - elapsed_;
    if (total <= 0.0) return stop(StopReason::Time);
    const double pause = std::min(left, flow_.segmentDuration(cursor_) / 16.0);
    if (left <= pause) {
      elapsed_ = left >= total ? maxTime_ : elapsed_ + left;
      flow_.advance(cursor_);
      if (left >= total) return stop(StopReason::Time);
    } else {
      elapsed_ += pause;
    }
    const Index v = flat_->vertex(corner);
    const Complex velocity = flow_.vertexVelocity(v, cursor_, time());
    double angle = std::arg(velocity);
    if (angle < 0.0) angle += 2.0 * std::numbers::pi;
    const double totalAngle = faces_.charts().totalAngle(v);
    const bool outward =
        angle > totalAngle && velocity.real() <= 0.0 && (velocity * std::polar(1.0, -totalAngle)).real() <= 0.0;
    if (!outward) return leaveVertex(corner);
  }
  return stop(StopReason::StepLimit);
}

}  // namespace stormfield
