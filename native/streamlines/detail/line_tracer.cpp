#include "streamlines/detail/line_tracer.h"

#include <algorithm>
#include <cmath>

#include "streamlines/detail/face_velocity.h"
#include "streamlines/detail/straightest_path.h"
#include "tracing/integrator.h"

namespace stormfield {
namespace {

/// Length of a line's beginning over the distance d: the line may come near it, as it may close there.
constexpr double kBeginning = 1.5;
/// A line that misses its seed by less than both (over d, and over its own length) is closed, else it is a spiral.
constexpr double kClosingGap = 0.05, kClosingSlope = 0.005;
/// Shortest last piece before an obstacle, in steps.
constexpr double kLastPiece = 0.2;
/// A line passes its seed where it runs along the seed's direction within the angle of this cosine.
constexpr double kAlong = 0.7;
/// Largest estimated error of one step, in mean edge lengths.
constexpr double kTolerance = 1e-5;
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
  std::optional<std::size_t> approach = {};  ///< number of points when the line came near its own beginning

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

/// The end of one half of a line, and which samples of the line itself are near it only because they precede it.
struct LineTracer::OwnArc {
  Index number;
  bool forward;
  double arc, distance;

  /// A sample on the first piece of the line, to which a forward half may return.
  bool isBeginning(const LineSample& s) const {
    return forward && s.line == number && s.arc <= kBeginning * distance && arc - s.arc > distance;
  }
  bool isObstacle(const LineSample& s) const {
    return s.line != number || (std::abs(s.arc - arc) > distance && !isBeginning(s));
  }
};

LineTracer::OwnArc LineTracer::ownArc(const Side& side) const {
  return {number_, side.direction == Direction::Forward, side.sign() * side.arc.back(), rules_.distance};
}

/// Piece by piece until the line closes, ends, or is too near to another one. While it runs along its own beginning it
/// continues, as it may close; if it does not, it ends where it came near.
void LineTracer::extend(Side& side, const Progress* progress) {
  double length = rules_.step;
  while (side.points.size() < rules_.maxPoints) {
    if (progress != nullptr) progress->check();
    const std::size_t before = side.points.size();
    const bool continues = step(side, length);
    if (side.points.size() == before) return endAt(side, side.approach.value_or(before));
    if (closesOrSpirals(side, before)) return;
    if (nearsOtherLine(side)) {
      if (side.approach) return endAt(side, *side.approach);
      // As far as half a piece, a quarter, ... leads.
      endAt(side, before);
      length *= 0.5;
      if (length < kLastPiece * rules_.step) return;
      continue;
    }
    if (nearsOwnBeginning(side)) {
      if (!side.approach) side.approach = before;
      const double along = side.arc.back() - side.arc[*side.approach - 1];
      if (!continues || along > 2.0 * kBeginning * rules_.distance) return endAt(side, *side.approach);
    } else if (side.approach) {
      return endAt(side, *side.approach);
    }
    if (!continues) return;
  }
}

/// Where a forward half passes its seed, it is closed or ended: the next loop of a spiral would be too near.
bool LineTracer::closesOrSpirals(Side& side, std::size_t from) {
  if (side.direction != Direction::Forward) return false;
  const std::optional<double> miss = passesSeed(side, from);
  if (!miss) return false;
  if (std::abs(*miss) <= std::min(kClosingGap * rules_.distance, kClosingSlope * side.arc.back())) {
    close(side);
  } else {
    endAt(side, pointsBeforeSeed(side));
  }
  return true;
}

bool LineTracer::nearsOtherLine(const Side& side) {
  const LinePoint& last = side.points.back();
  const OwnArc own = ownArc(side);
  return lines_
      .nearest(last.position, last.point.face, rules_.testDistance, patch_,
               [&](const LineSample& s) { return own.isObstacle(s); })
      .has_value();
}

bool LineTracer::nearsOwnBeginning(const Side& side) {
  const LinePoint& last = side.points.back();
  const OwnArc own = ownArc(side);
  if (own.arc <= rules_.distance) return false;
  return lines_
      .nearest(last.position, last.point.face, rules_.testDistance, patch_,
               [&](const LineSample& s) { return own.isBeginning(s); })
      .has_value();
}

void LineTracer::endAt(Side& side, std::size_t count) {
  if (count == side.points.size()) return;
  cutBack(side, count);
  side.reason = StopReason::Length;
}

/// Adds the points of one piece of this length; false where the streamline itself ends.
bool LineTracer::step(Side& side, double length) {
  TraceOptions options;
  options.direction = side.direction;
  options.maxLength = length;
  options.tolerance = kTolerance;
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
  const double length = (p.position - side.points.back().position).norm();
  if (length < 1e-3 * rules_.step) return;
  side.points.push_back(p);
  side.arc.push_back(side.arc.back() + length);
  lines_.add(sample(p, number_, side.sign() * side.arc.back()));
}

void LineTracer::cutBack(Side& side, std::size_t count) {
  for (; side.points.size() > count; side.points.pop_back()) {
    side.arc.pop_back();
    lines_.dropLast();
  }
}

/// How far to the left of the seed the line passes it in the direction of the flow there, by one of the pieces that end
/// at the points from this one on; nothing where none does so within the test distance.
std::optional<double> LineTracer::passesSeed(const Side& side, std::size_t from) const {
  if (side.arc.back() < 3.0 * rules_.step) return std::nullopt;
  const TriangleMesh& mesh = faces_.mesh();
  const Vec3 normal = mesh.faceNormal(seed_.point.face);
  for (std::size_t i = from; i < side.points.size(); ++i) {
    const Vec3 a = side.points[i - 1].position - seed_.position, b = side.points[i].position - seed_.position;
    const double before = a.dot(seedDirection_), after = b.dot(seedDirection_);
    if (!(before < 0.0 && after >= 0.0)) continue;
    const Vec3 crossing = a + before / (before - after) * (b - a);
    const bool along = (b - a).dot(seedDirection_) > kAlong * (b - a).norm();
    const bool sameSide = mesh.faceNormal(side.points[i].point.face).dot(normal) > 0.0;
    if (along && sameSide && crossing.norm() < rules_.testDistance) {
      return crossing.dot(normal.cross(seedDirection_));
    }
  }
  return std::nullopt;
}

/// Number of points before the line last passed its seed.
std::size_t LineTracer::pointsBeforeSeed(const Side& side) const {
  std::size_t count = side.points.size();
  while ((side.points[count - 1].position - seed_.position).dot(seedDirection_) >= 0.0) --count;
  return count;
}

/// Closes a line: the distance by which it missed its seed is spread over its whole length.
void LineTracer::close(Side& side) {
  const double miss = *passesSeed(side, pointsBeforeSeed(side));
  std::size_t count = pointsBeforeSeed(side);
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
  return left == 0.0 ? p : straightestPath(faces_, p, left, std::abs(distance)).point;
}

}  // namespace stormfield
