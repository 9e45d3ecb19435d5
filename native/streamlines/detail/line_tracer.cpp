#include "streamlines/detail/line_tracer.h"

#include <algorithm>
#include <cmath>

#include "streamlines/detail/face_velocity.h"
#include "streamlines/detail/surface_walk.h"
#include "tracing/integrator.h"

namespace stormfield {
namespace {

/// A line is given room to come back onto its first part, so many distances long.
constexpr double kBeginning = 1.5;
/// It is closed where it comes back so near (parts of the distance, and of its own length), else it is a spiral.
constexpr double kClosingGap = 0.05, kClosingSlope = 0.005;
/// Shortest last piece before an obstacle, in steps.
constexpr double kLastPiece = 0.2;
/// Cosine between the normals of two faces from which on a line keeps the point where it crosses their edge.
constexpr double kBend = 0.995;

double fastestVertex(const VectorField& field) {
  double squared = 0.0;
  for (const Complex& v : field.values) squared = std::max(squared, std::norm(v));
  return std::sqrt(squared);
}

}  // namespace

double Line::length() const {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i].position - points[i - 1].position).norm();
  return closed ? sum + (points.front().position - points.back().position).norm() : sum;
}

/// One half of a line: from the seed along the flow or against it.
struct LineTracer::Side {
  Direction direction;
  std::vector<LinePoint> points;  ///< the seed first
  std::vector<double> arc;        ///< from the seed, positive on both sides
  StopReason reason = StopReason::Length;
  bool closed = false;

  double sign() const { return direction == Direction::Forward ? 1.0 : -1.0; }
};

LineTracer::LineTracer(const FlatFaces& faces, const VectorField& field, const LineRules& rules, NearLines& lines)
    : faces_(faces),
      field_(field),
      rules_(rules),
      fastest_(fastestVertex(field)),
      lines_(lines),
      patch_(faces.mesh()) {}

LineSample LineTracer::sample(const LinePoint& p, Index line, double arc) const {
  return {p.position, faces_.mesh().faceNormal(p.point.face), p.point.face, line, arc};
}

Line LineTracer::trace(const SurfacePoint& seed, Index number, Reach reach, const Progress* progress) {
  samplesBefore_ = lines_.size();
  number_ = number;
  seed_ = {seed, position(faces_.mesh(), seed)};
  const Complex velocity = velocityAt(faces_, field_, seed);
  Line line;
  if (std::abs(velocity) <= rules_.minSpeed * fastest_) return line;
  seedDirection_ = faces_.charts().faceToSpace(seed.face, velocity / std::abs(velocity));
  lines_.add(sample(seed_, number, 0.0));

  Side forward{Direction::Forward, {seed_}, {0.0}}, backward{Direction::Backward, {seed_}, {0.0}};
  if (reach != Reach::Backward) extend(forward, progress);
  if (reach != Reach::Forward && !forward.closed) extend(backward, progress);
  line.points.assign(backward.points.rbegin(), backward.points.rend());
  line.points.insert(line.points.end(), forward.points.begin() + 1, forward.points.end());
  line.closed = forward.closed;
  line.fullStart = backward.reason == StopReason::Boundary;
  line.fullEnd = forward.reason == StopReason::Boundary;
  return line;
}

void LineTracer::forget() {
  while (lines_.size() > samplesBefore_) lines_.dropLast();
}

void LineTracer::extend(Side& side, const Progress* progress) {
  const bool forward = side.direction == Direction::Forward;
  double length = rules_.step;
  std::size_t approach = 0;  // points when the line came near its own beginning
  const auto end = [&](std::size_t count) {
    if (count == side.points.size()) return;
    cutBack(side, count);
    side.reason = StopReason::Length;
  };
  while (side.points.size() < rules_.mostPoints) {
    if (progress != nullptr) progress->check();
    const std::size_t before = side.points.size();
    const bool goesOn = step(side, length);
    if (side.points.size() == before) return end(approach != 0 ? approach : before);
    if (const std::optional<double> miss = forward ? comesBack(side, before) : std::nullopt) {
      const double closing = std::min(kClosingGap * rules_.distance, kClosingSlope * side.arc.back());
      if (std::abs(*miss) <= closing) return join(side);
      return end(pointsBefore(side));  // a spiral: its next turn would be too near
    }

    const double arc = side.sign() * side.arc.back(), beginning = kBeginning * rules_.distance;
    const auto own = [&](const LineSample& s) { return s.line == number_; };
    const auto isBeginning = [&](const LineSample& s) {
      return forward && own(s) && s.arc <= beginning && arc - s.arc > rules_.distance;
    };
    const auto isObstacle = [&](const LineSample& s) {
      return !own(s) || (std::abs(s.arc - arc) > rules_.distance && !isBeginning(s));
    };
    const LinePoint& last = side.points.back();
    if (lines_.nearest(last.position, last.point.face, rules_.testDistance, patch_, isObstacle)) {
      if (approach != 0) return end(approach);
      cutBack(side, before);
      side.reason = StopReason::Length;
      length *= 0.5;
      if (length < kLastPiece * rules_.step) return;
      continue;
    }
    if (arc > rules_.distance &&
        lines_.nearest(last.position, last.point.face, rules_.testDistance, patch_, isBeginning)) {
      if (approach == 0) approach = before;
      if (!goesOn || arc - side.arc[approach - 1] > 2.0 * beginning) return end(approach);
    } else if (approach != 0) {
      return end(approach);
    }
    if (!goesOn) return;
  }
}

/// Adds the points of one piece of this length; false where the streamline ends.
bool LineTracer::step(Side& side, double length) {
  TraceOptions options;
  options.direction = side.direction;
  options.maxLength = length;
  options.tolerance = 1e-5;
  Integrator<SteadyFlow> integrator(faces_, SteadyFlow(field_.values.data(), side.sign()), options,
                                    rules_.minSpeed * fastest_);
  const SurfacePoint from = side.points.back().point;
  SurfacePoint last = from;
  const TraceEnd end = integrator.run(from, 0.0, options.maxTime, [&](const SurfacePoint& p, double) {
    if (p.face != last.face) {
      const TriangleMesh& mesh = faces_.mesh();
      if (mesh.faceNormal(p.face).dot(mesh.faceNormal(last.face)) < kBend) append(side, p);
    }
    last = p;
  });
  append(side, end.point);
  side.reason = end.reason;
  return end.reason == StopReason::Length;
}

void LineTracer::append(Side& side, const SurfacePoint& point) {
  const LinePoint p{point, position(faces_.mesh(), point)};
  const double way = (p.position - side.points.back().position).norm();
  if (way < 1e-3 * rules_.step) return;
  side.points.push_back(p);
  side.arc.push_back(side.arc.back() + way);
  lines_.add(sample(p, number_, side.sign() * side.arc.back()));
}

void LineTracer::cutBack(Side& side, std::size_t count) {
  for (; side.points.size() > count; side.points.pop_back()) {
    side.arc.pop_back();
    lines_.dropLast();
  }
}

/// How far to the left of the seed one of the pieces that end at the points from this one on passes it, in the
/// direction of its flow; nothing where none does within the test distance.
std::optional<double> LineTracer::comesBack(const Side& side, std::size_t from) const {
  if (side.arc.back() < 3.0 * rules_.step) return std::nullopt;
  const TriangleMesh& mesh = faces_.mesh();
  const Vec3 normal = mesh.faceNormal(seed_.point.face);
  for (std::size_t i = from; i < side.points.size(); ++i) {
    const Vec3 a = side.points[i - 1].position - seed_.position, b = side.points[i].position - seed_.position;
    const double before = a.dot(seedDirection_), after = b.dot(seedDirection_);
    if (!(before < 0.0 && after >= 0.0)) continue;
    const Vec3 crossing = a + before / (before - after) * (b - a);
    const bool along = (b - a).dot(seedDirection_) > 0.7 * (b - a).norm();
    const bool sameSide = mesh.faceNormal(side.points[i].point.face).dot(normal) > 0.0;
    if (along && sameSide && crossing.norm() < rules_.testDistance) {
      return crossing.dot(normal.cross(seedDirection_));
    }
  }
  return std::nullopt;
}

/// Number of points before the line last passed its seed.
std::size_t LineTracer::pointsBefore(const Side& side) const {
  std::size_t count = side.points.size();
  while ((side.points[count - 1].position - seed_.position).dot(seedDirection_) >= 0.0) --count;
  return count;
}

/// Closes a line that has come round: the little that it missed its beginning by is spread over its whole length.
void LineTracer::join(Side& side) {
  const double miss = *comesBack(side, pointsBefore(side));
  std::size_t count = pointsBefore(side);
  const double gap = (side.points[count - 1].position - seed_.position).norm();
  const double length = side.arc[count - 1] + gap;
  if (count > 3 && gap < 0.3 * rules_.step) --count;
  const std::vector<LinePoint> points(side.points.begin(), side.points.begin() + static_cast<std::ptrdiff_t>(count));
  const std::vector<double> arc = side.arc;
  cutBack(side, 1);
  for (std::size_t i = 1; i < count; ++i) append(side, toTheLeft(points[i].point, -miss * arc[i] / length));
  side.closed = true;
}

SurfacePoint LineTracer::toTheLeft(const SurfacePoint& p, double distance) const {
  const Complex left = Complex(0.0, distance) * velocityAt(faces_, field_, p);
  return left == 0.0 ? p : walkStraight(faces_, p, left, std::abs(distance)).point;
}

}  // namespace stormfield
