#include "texture/advected_coordinates.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/message.h"
#include "mesh/morton_order.h"
#include "texture/detail/random.h"
#include "texture/stagger.h"
#include "tracing/arrivals.h"

namespace stormfield {
namespace {

void require(bool ok, const char* text) {
  if (!ok) throw InputError(text);
}

AdvectionOptions checked(const AdvectionOptions& o) {
  require(o.framesPerSecond > 0.0 && std::isfinite(o.framesPerSecond), "frames per second must be positive");
  require(o.period >= 2.0 && std::isfinite(o.period), "the period must be two frames or more");
  require(std::isfinite(o.speed), "the speed factor must be finite");
  require(o.deadZone > 0.0 && o.deadZone < 0.25, "the dead zone must lie above 0 and below a quarter of a period");
  require(o.renewal >= 0.0 && std::isfinite(o.renewal), "the renewal must be 0 or more");
  require(o.tolerance > 0.0 && std::isfinite(o.tolerance), "the tolerance must be positive, for example 1e-5");
  return o;
}

LambdaTrack inSeconds(const std::vector<double>& frames, const std::vector<double>& lambdas, double framesPerSecond) {
  LambdaTrack track{frames, lambdas};
  for (double& t : track.times) t /= framesPerSecond;
  return track;
}

double age(double cyclePosition) {
  return cyclePosition - std::floor(cyclePosition);
}

/// The random vector that a cycle adds to the coordinates of a phase (0 or 1).
Vec3 cycleOffset(const AdvectionOptions& options, double size, int phase, double cyclePosition) {
  const auto cycle = static_cast<std::int64_t>(std::floor(cyclePosition));
  const Vec3 random(uniform(options.seed, phase, cycle, 0), uniform(options.seed, phase, cycle, 1),
                    uniform(options.seed, phase, cycle, 2));
  return options.renewal * size * (random - Vec3::Constant(0.5));
}

void store(const Vec3& p, std::vector<float>& to, Index v) {
  for (int axis = 0; axis < 3; ++axis) to[3 * static_cast<std::size_t>(v) + axis] = static_cast<float>(p[axis]);
}

}  // namespace

double blendWeight(double ageA, double deadZone) {
  // 1 where a starts anew (age 0 and 1), 0 where b does (age 1/2).
  const double s = std::clamp((std::abs(ageA - 0.5) - deadZone) / (0.5 - 2.0 * deadZone), 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

AdvectedCoordinates::AdvectedCoordinates(std::shared_ptr<const FlatFaces> faces,
                                         std::shared_ptr<const ParameterizedField> field,
                                         const std::vector<double>& frames, const std::vector<double>& lambdas,
                                         const AdvectionOptions& options, std::vector<double> offsets)
    : faces_(std::move(faces)),
      field_(std::move(field)),
      options_(checked(options)),
      offsets_(std::move(offsets)),
      order_(mortonOrder(mesh())),
      flow_(*faces_, *field_, inSeconds(frames, lambdas, options.framesPerSecond), options.speed) {
  if (offsets_.size() != static_cast<std::size_t>(mesh().vertexCount())) {
    throw InputError(message("there are ", offsets_.size(), " phase offsets for ", mesh().vertexCount(), " vertices"));
  }
  for (std::size_t v = 0; v < offsets_.size(); ++v) {
    if (!std::isfinite(offsets_[v])) throw InputError(message("the phase offset of vertex ", v, " is not finite"));
  }
  const StaggerStep steepest = largestStaggerStep(mesh(), offsets_);
  if (steepest.difference > options_.deadZone) {
    const Index h = mesh().edgeHalfedge(steepest.edge);
    throw InputError(message("the phase offsets of vertices ", mesh().tail(h), " and ", mesh().head(h), " differ by ",
                             steepest.difference, " of a period, more than the dead zone of ", options_.deadZone,
                             "; use smoother offsets or a wider dead zone"));
  }
}

PathlineSeed AdvectedCoordinates::seed(const SurfacePoint& p, double frame, double cyclePosition) const {
  return {p, frame / options_.framesPerSecond, age(cyclePosition) * options_.period / options_.framesPerSecond};
}

std::vector<Vec3> AdvectedCoordinates::carried(const std::vector<PathlineSeed>& seeds, double tolerance,
                                               Progress* progress) const {
  const TraceOptions options{.direction = Direction::Backward, .tolerance = tolerance};
  const std::vector<SurfacePoint> places = traceArrivals(flow_, seeds, options, progress);
  std::vector<Vec3> result(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) { result[i] = position(mesh(), places[i]); });
  return result;
}

AdvectedFrame AdvectedCoordinates::frame(double frame, Progress* progress) const {
  if (!std::isfinite(frame)) throw InputError("the frame is not a finite number");
  const auto cyclePosition = [&](Index v) { return frame / options_.period + offsets_[v]; };
  // Both phases of a vertex lie on one pathline: the younger comes first.
  const auto isYoungerA = [](double c) { return age(c) < age(c + 0.5); };
  std::vector<PathlineSeed> seeds(2 * order_.size());
  tbb::parallel_for(std::size_t{0}, order_.size(), [&](std::size_t i) {
    const SurfacePoint p = vertexPoint(mesh(), order_[i]);
    const double c = cyclePosition(order_[i]);
    const std::size_t a = isYoungerA(c) ? 0 : 1;
    seeds[2 * i + a] = seed(p, frame, c);
    seeds[2 * i + 1 - a] = seed(p, frame, c + 0.5);
  });
  const std::vector<Vec3> coordinates = carried(seeds, options_.tolerance, progress);

  AdvectedFrame result;
  result.phaseA.resize(3 * offsets_.size());
  for (Index v = 0; v < mesh().vertexCount(); ++v) store(mesh().point(v), result.phaseA, v);
  result.phaseB = result.phaseA;
  result.blend.assign(offsets_.size(), 0.0F);
  tbb::parallel_for(std::size_t{0}, order_.size(), [&](std::size_t i) {
    const Index v = order_[i];
    const double c = cyclePosition(v);
    const std::size_t a = isYoungerA(c) ? 0 : 1;
    store(coordinates[2 * i + a] + cycleOffset(options_, mesh().size(), 0, c), result.phaseA, v);
    store(coordinates[2 * i + 1 - a] + cycleOffset(options_, mesh().size(), 1, c + 0.5), result.phaseB, v);
    result.blend[v] = static_cast<float>(blendWeight(age(c), options_.deadZone));
  });
  return result;
}

CarriedError AdvectedCoordinates::error(double frame, Index samples) const {
  require(samples > 0, "the error needs at least one sample");
  // Of another integrator than the one that is judged.
  const auto fine = [&](const std::vector<PathlineSeed>& seeds) {
    const auto ends = tracePathlineEnds(flow_, seeds, {.direction = Direction::Backward, .tolerance = 1e-10});
    std::vector<Vec3> places(ends.size());
    for (std::size_t i = 0; i < ends.size(); ++i) places[i] = position(mesh(), ends[i].point);
    return places;
  };
  const auto coarse = [&](const std::vector<PathlineSeed>& seeds) {
    return carried(seeds, options_.tolerance, nullptr);
  };
  const auto cyclePosition = [&](Index v) { return frame / options_.period + offsets_[v]; };

  std::vector<PathlineSeed> atVertices;
  for (Index v = 0; v < mesh().vertexCount(); v += std::max(Index{1}, mesh().vertexCount() / samples)) {
    if (mesh().outgoing(v) == kNone) continue;
    atVertices.push_back(seed(vertexPoint(mesh(), v), frame, cyclePosition(v)));
  }
  CarriedError result;
  const auto exact = fine(atVertices), found = coarse(atVertices);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double distance = (exact[i] - found[i]).norm() / mesh().meanEdgeLength();
    result.mean += distance / static_cast<double>(exact.size());
    result.largest = std::max(result.largest, distance);
  }

  std::vector<PathlineSeed> atCenters, atCorners;
  for (Index f = 0; f < mesh().faceCount(); f += std::max(Index{1}, mesh().faceCount() / samples)) {
    const double c[3] = {cyclePosition(mesh().vertex(f, 0)), cyclePosition(mesh().vertex(f, 1)),
                         cyclePosition(mesh().vertex(f, 2))};
    const double mean = (c[0] + c[1] + c[2]) / 3.0;
    if (blendWeight(age(mean), options_.deadZone) == 1.0) continue;
    atCenters.push_back(seed({f, Eigen::Vector3d::Constant(1.0 / 3.0)}, frame, mean));
    for (int i = 0; i < 3; ++i) {
      SurfacePoint corner{f, Eigen::Vector3d::Zero()};
      corner.barycentric[i] = 1.0;
      atCorners.push_back(seed(corner, frame, c[i]));
    }
  }
  const auto centers = fine(atCenters), corners = coarse(atCorners);
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const Vec3 interpolated = (corners[3 * i] + corners[3 * i + 1] + corners[3 * i + 2]) / 3.0;
    result.meanBetween +=
        (centers[i] - interpolated).norm() / mesh().meanEdgeLength() / static_cast<double>(centers.size());
  }
  return result;
}

}  // namespace stormfield
