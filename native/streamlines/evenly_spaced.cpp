#include "streamlines/evenly_spaced.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/message.h"
#include "streamlines/detail/coverage.h"
#include "streamlines/detail/face_velocity.h"
#include "streamlines/detail/given_curves.h"
#include "streamlines/detail/line_tracer.h"
#include "streamlines/detail/straightest_path.h"
#include "streamlines/detail/taper.h"
#include "tracing/trace.h"

namespace stormfield {
namespace {

// In distances d:
constexpr double kTest = 0.525;          ///< a line ends this near to the samples of another: d / 2 from it in between
constexpr double kSeedRoom = 0.9;        ///< distance from all lines that a seed next to a line needs
constexpr double kSeedSpacing = 0.5;     ///< between seeds along a line
constexpr double kGapResolution = 0.15;  ///< gaps smaller than this are not looked for
constexpr double kMinBeside = 2.0;       ///< length of the shortest line next to another
constexpr double kMinInGap = 0.05;       ///< of the shortest line that fills a gap
constexpr double kMinGiven = 0.5;        ///< of the shortest piece of a given curve
constexpr double kMaxStep = 0.25, kMinStep = 0.025;  ///< between the points of a line: an edge, within these
/// Rays around a source or sink, and the radius of the ring where they begin, in distances d. Their distance there is
/// the radius, a little more than the test distance.
constexpr int kRays = 6;
constexpr double kRing = 0.57;
/// A straightest path that is shorter than this fraction of what was asked has met the boundary.
constexpr double kReached = 0.99;
/// Smallest distance d, in sizes of the mesh.
constexpr double kMinDistance = 1.0 / 2000.0;

double fastestVertex(const VectorField& field) {
  double speed = 0.0;
  for (const Complex& v : field.values) speed = std::max(speed, std::abs(v));
  return speed;
}

void check(const FlatFaces& faces, const VectorField& field, const StreamlineFeatures& features) {
  const TriangleMesh& mesh = faces.mesh();
  if (field.values.size() != static_cast<std::size_t>(mesh.vertexCount())) {
    throw InputError("the field of the streamlines belongs to another mesh");
  }
  for (std::size_t i = 0; i < features.curves.size(); ++i) {
    if (features.curves[i].points.empty()) throw InputError(message("given curve ", i, " has no points; leave it out"));
    checkSeeds(mesh, features.curves[i].points);
  }
}

LineRules makeRules(const TriangleMesh& mesh, const EvenSpacing& spacing) {
  const double d = spacing.distance;
  const double step = std::clamp(mesh.meanEdgeLength(), kMinStep * d, kMaxStep * d);
  // Lines at the distance d have area / (d * step) points in all; no line has twenty times as many.
  const double maxPoints = 20.0 * mesh.totalArea() / (d * step) + 1000.0;
  return {d, kTest * d, step, spacing.minSpeed, static_cast<std::size_t>(maxPoints)};
}

/// Removes the last points that are nearer to the place than this.
void endBefore(std::vector<LinePoint>& points, const Vec3& place, double distance) {
  while (points.size() > 1 && (points.back().position - place).norm() < distance) points.pop_back();
}

/// The steps of the method, in their order: given curves, fixed points, lines next to lines, gaps.
class Placement {
 public:
  Placement(const FlatFaces& faces, const VectorField& field, const EvenSpacing& spacing, Progress* progress)
      : faces_(faces),
        field_(field),
        d_(spacing.distance),
        minSpeed_(spacing.minSpeed * fastestVertex(field)),
        rules_(makeRules(faces.mesh(), spacing)),
        samples_(faces.mesh(), d_),
        tracer_(faces, field, rules_, samples_),
        coverage_(faces, field, d_, kGapResolution * d_, minSpeed_),
        patch_(faces.mesh()),
        progress_(progress) {}

  void placeGiven(const std::vector<GivenCurve>& curves);
  void beginAtFixedPoints(const std::vector<FixedPoint>& points);
  void fillGaps();
  EvenStreamlines result() const;

 private:
  Vec3 at(const SurfacePoint& p) const { return position(faces_.mesh(), p); }
  bool hasRoom(const SurfacePoint& p, double radius);
  bool addLine(const SurfacePoint& seed, Reach reach, double minLength);
  void keep(Line line, std::size_t firstSample);
  void placeCurve(const GivenCurve& curve, Index number, std::vector<Vec3>& starts);
  void growBesideLines();
  double quietArea() const;

  const FlatFaces& faces_;
  const VectorField& field_;
  double d_, minSpeed_;
  LineRules rules_;
  NearLines samples_;
  LineTracer tracer_;
  Coverage coverage_;
  SurfacePatch patch_;
  Progress* progress_;
  std::vector<Line> lines_;
  std::size_t grownBeside_ = 0;  ///< number of lines that have their neighbours
  std::vector<SurfacePoint> gaps_;
};

bool Placement::hasRoom(const SurfacePoint& p, double radius) {
  const Vec3 place = at(p);
  if (coverage_.bound(p.face, place) < radius) return false;
  return !samples_.nearest(place, p.face, radius, patch_, [](const LineSample&) { return true; });
}

void Placement::keep(Line line, std::size_t firstSample) {
  double last = -2.0 * d_;
  for (std::size_t i = firstSample; i < samples_.size(); ++i) {
    if (std::abs(samples_[i].arc - last) < 0.9 * kMaxStep * d_) continue;
    coverage_.add(samples_[i]);
    last = samples_[i].arc;
  }
  lines_.push_back(std::move(line));
  if (progress_ != nullptr) progress_->report(0.95 * coverage_.fraction());
}

bool Placement::addLine(const SurfacePoint& seed, Reach reach, double minLength) {
  const std::size_t firstSample = samples_.size();
  Line line = tracer_.trace(seed, static_cast<Index>(lines_.size()), reach, progress_);
  if (line.points.size() < 2 || (!line.closed && line.length() < minLength)) {
    tracer_.forget();
    return false;
  }
  keep(std::move(line), firstSample);
  return true;
}

/// Closed curves first: separatrices then end next to them.
void Placement::placeGiven(const std::vector<GivenCurve>& curves) {
  std::vector<Vec3> starts;
  for (const bool closed : {true, false}) {
    for (std::size_t i = 0; i < curves.size(); ++i) {
      if (curves[i].closed != closed) continue;
      if (progress_ != nullptr) progress_->check();
      placeCurve(curves[i], static_cast<Index>(i), starts);
    }
  }
}

/// starts: the first points of the given curves that are placed already; this one's is added.
void Placement::placeCurve(const GivenCurve& curve, Index number, std::vector<Vec3>& starts) {
  Line line;
  line.points = evenPoints(faces_.mesh(), curve, rules_.step);
  if (curve.leadsToPoint) endBefore(line.points, line.points.back().position, kRing * d_);
  line.given = number;
  line.closed = curve.closed;
  line.fullStart = true;
  starts.push_back(line.points.front().position);
  const std::size_t firstSample = samples_.size(), whole = line.points.size();
  addGivenCurve(line.points, curve.closed, static_cast<Index>(lines_.size()), rules_, starts, faces_.mesh(), samples_);
  if (line.points.size() < 2 || (!curve.closed && line.length() < kMinGiven * d_)) {
    while (samples_.size() > firstSample) samples_.dropLast();
    starts.pop_back();
    return;
  }
  line.fullEnd = curve.endsOnBoundary && line.points.size() == whole;
  if (curve.againstFlow) {
    std::reverse(line.points.begin(), line.points.end());
    std::swap(line.fullStart, line.fullEnd);
  }
  keep(std::move(line), firstSample);
}

/// A star of lines leaves each source and enters each sink; one line begins next to a focus or center. Saddles have
/// their separatrices.
void Placement::beginAtFixedPoints(const std::vector<FixedPoint>& points) {
  for (const FixedPoint& p : points) {
    if (p.kind == FixedPointKind::Saddle || p.kind == FixedPointKind::Degenerate) continue;
    const double trace = p.jacobian.trace();
    const bool isFocus = trace * trace < 4.0 * p.jacobian.determinant();
    const bool source = p.kind == FixedPointKind::Source;
    for (int ray = 0; ray < (isFocus ? 1 : kRays); ++ray) {
      const Complex direction = std::polar(1.0, 2.0 * std::numbers::pi * ray / kRays);
      const StraightestPath path = straightestPath(faces_, p.point, direction, kRing * d_);
      if (path.length < kReached * kRing * d_ || !hasRoom(path.point, 0.95 * rules_.testDistance)) continue;
      addLine(path.point, isFocus ? Reach::Both : source ? Reach::Forward : Reach::Backward, d_);
    }
  }
}

/// Lines from seeds at the distance d on both sides of every line, line after line.
void Placement::growBesideLines() {
  for (; grownBeside_ < lines_.size(); ++grownBeside_) {
    double sinceSeed = d_;
    for (std::size_t k = 0; k < lines_[grownBeside_].points.size(); ++k) {
      const LinePoint p = lines_[grownBeside_].points[k];
      if (k > 0) sinceSeed += (p.position - lines_[grownBeside_].points[k - 1].position).norm();
      if (sinceSeed < kSeedSpacing * d_) continue;
      sinceSeed = 0.0;
      const Complex velocity = velocityAt(faces_, field_, p.point);
      if (std::abs(velocity) <= minSpeed_) continue;
      for (const double side : {1.0, -1.0}) {
        const StraightestPath path = straightestPath(faces_, p.point, Complex(0.0, side) * velocity, d_);
        if (path.length < kReached * d_ || !hasRoom(path.point, kSeedRoom * d_)) continue;
        addLine(path.point, Reach::Both, kMinBeside * d_);
      }
    }
  }
}

/// Lines next to lines, then through the widest gaps, until no gap takes a line.
void Placement::fillGaps() {
  growBesideLines();
  for (bool added = true; added;) {
    added = false;
    gaps_.clear();
    for (const Gap& gap : coverage_.findGaps(samples_, progress_)) {
      if (!hasRoom(gap.point, d_)) continue;
      if (addLine(gap.point, Reach::Both, kMinInGap * d_)) {
        added = true;
        growBesideLines();
      } else {
        gaps_.push_back(gap.point);
      }
    }
  }
}

double Placement::quietArea() const {
  const TriangleMesh& mesh = faces_.mesh();
  double area = 0.0;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    double speed = 0.0;
    for (int k = 0; k < 3; ++k) speed = std::max(speed, std::abs(field_.values[mesh.vertex(f, k)]));
    if (speed <= minSpeed_) area += mesh.faceArea(f);
  }
  return area / mesh.totalArea();
}

EvenStreamlines Placement::result() const {
  EvenStreamlines result;
  const auto tapers = taperLines(faces_.mesh(), lines_, samples_, rules_, progress_);
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const Line& line = lines_[i];
    double arc = 0.0;
    for (std::size_t k = 0; k < line.points.size(); ++k) {
      if (k > 0) arc += (line.points[k].position - line.points[k - 1].position).norm();
      result.points.push_back(line.points[k].point);
      result.arc.push_back(arc);
      result.speed.push_back(std::abs(velocityAt(faces_, field_, line.points[k].point)));
    }
    result.taper.insert(result.taper.end(), tapers[i].begin(), tapers[i].end());
    result.offsets.push_back(result.points.size());
    result.closed.push_back(line.closed);
    result.given.push_back(line.given);
  }
  result.quietArea = quietArea();
  result.gaps = gaps_;
  return result;
}

}  // namespace

void checkSpacing(const TriangleMesh& mesh, const EvenSpacing& spacing) {
  if (!(spacing.distance >= kMinDistance * mesh.size()) || !std::isfinite(spacing.distance)) {
    throw InputError(message("the distance between streamlines is ", spacing.distance, "; give at least ",
                             kMinDistance * mesh.size(), ", a 2000th of the size of the surface"));
  }
  if (!(spacing.minSpeed >= 0.0) || !std::isfinite(spacing.minSpeed)) {
    throw InputError(message("the least speed of streamlines is ", spacing.minSpeed, "; give a number of 0 or more"));
  }
}

EvenStreamlines placeStreamlines(const FlatFaces& faces, const VectorField& field, const EvenSpacing& spacing,
                                 const StreamlineFeatures& features, Progress* progress) {
  check(faces, field, features);
  checkSpacing(faces.mesh(), spacing);
  Placement placement(faces, field, spacing, progress);
  placement.placeGiven(features.curves);
  placement.beginAtFixedPoints(features.fixedPoints);
  placement.fillGaps();
  return placement.result();
}

}  // namespace stormfield
