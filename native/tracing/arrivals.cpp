#include "tracing/arrivals.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/error.h"
#include "base/message.h"
#include "tracing/detail/unsteady_step.h"
#include "tracing/integrator.h"

namespace stormfield {
namespace {

using Particles = lanes::UnsteadyParticles;

/// Estimated error of a step as a fraction of the tolerance: the errors of many add up, and a path of the integrator
/// alone rarely comes near its tolerance. And of a step of the integrator here, which always tries the longest first.
constexpr double kShare = 0.05, kSmallShare = 0.3;
/// Seeds that one task follows.
constexpr std::size_t kBlock = 512;

bool isSamePath(const PathlineSeed& a, const PathlineSeed& b) {
  return a.time == b.time && a.point.face == b.point.face && a.point.barycentric == b.point.barycentric;
}

void check(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds, const TraceOptions& options) {
  checkOptions(options);
  std::vector<SurfacePoint> points(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    points[i] = seeds[i].point;
    if (!std::isfinite(seeds[i].time) || !(seeds[i].maxTime >= 0.0) || !std::isfinite(seeds[i].maxTime)) {
      throw InputError(message("seed ", i, " needs a finite time and a finite duration of 0 s or more"));
    }
    if (i > 0 && isSamePath(seeds[i - 1], seeds[i]) && seeds[i].maxTime < seeds[i - 1].maxTime) {
      throw InputError(message("seed ", i,
                               " is followed for a shorter time than the one before it at the same place; "
                               "list them by their times"));
    }
  }
  checkSeeds(flow.faces->mesh(), points);
}

TraceOptions smaller(TraceOptions options) {
  options.tolerance *= kSmallShare;
  return options;
}

/// Follows a range of seeds.
class Follower {
 public:
  Follower(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds, const TraceOptions& options,
           std::vector<SurfacePoint>& places)
      : faces_(*flow.faces),
        field_(*flow.field),
        segments_(flow.segments),
        seeds_(seeds),
        places_(places),
        options_(options),
        backward_(options.direction == Direction::Backward),
        rate_(backward_ ? -flow.speed : flow.speed),
        allowed_(kShare * options.tolerance * faces_.mesh().meanEdgeLength()),
        flow_(field_, segments_, options.direction, flow.speed),
        integrator_(faces_, flow_, smaller(options), 0.0) {}

  void follow(std::size_t first, std::size_t last) {
    next_ = first;
    last_ = last;
    static const lanes::UnsteadyStep step = lanes::unsteadyStep();
    for (Path& path : paths_) path.seed = last;
    while (true) {
      int busy = 0;
      for (int lane = 0; lane < Particles::kCount; ++lane) busy += prepare(paths_[lane], lane) ? 1 : 0;
      if (busy == 0) return;
      step(particles_);
      for (int lane = 0; lane < Particles::kCount; ++lane) {
        if (paths_[lane].seed < last_) take(paths_[lane], lane);
      }
    }
  }

 private:
  /// A particle on its way to the places of its seeds.
  struct Path {
    std::size_t seed = 0;  ///< whose place is next; the last of the range: none
    Index face = kNone;
    int entry = -1;  ///< the corner opposite to the side of entry
    double b[3] = {};
    double elapsed = 0.0, target = 0.0;  ///< seconds
    UnsteadyFlow::Cursor cursor = 0;
    Index steps = 0;
  };

  double time(const Path& path) const {
    const double start = seeds_[path.seed].time;
    return backward_ ? start - path.elapsed : start + path.elapsed;
  }
  SurfacePoint here(const Path& path) const { return {path.face, {path.b[0], path.b[1], path.b[2]}}; }

  /// Sets the lane's next step; false, and a step that nobody takes, where there is nothing left to do.
  bool prepare(Path& path, int lane) {
    while (true) {
      if (path.seed == last_ && !begin(path)) return set(lane);
      if (path.elapsed >= path.target || path.steps >= options_.maxSteps) {
        arrive(path);
        continue;
      }
      const double left = path.target - path.elapsed;
      double segment = flow_.remaining(path.cursor, time(path));
      while (segment <= 0.0) {
        flow_.advance(path.cursor);
        segment = flow_.remaining(path.cursor, time(path));
      }
      set(path, std::min(left, segment), lane);
      return true;
    }
  }

  bool begin(Path& path) {
    if (next_ == last_) return false;
    path.seed = next_++;
    while (next_ < last_ && isSamePath(seeds_[path.seed], seeds_[next_])) ++next_;
    path.elapsed = 0.0;
    path.target = seeds_[path.seed].maxTime;
    path.steps = 0;
    path.cursor = flow_.start(seeds_[path.seed].time);
    goOn(path, seeds_[path.seed].point);
    // Out of the vertex, or into the face that the flow leads to.
    if (path.target > 0.0) takeSmallSteps(path);
    return true;
  }
  /// Sets a point as the particle's, inside its face.
  static void goOn(Path& path, const SurfacePoint& p) {
    path.face = p.face;
    path.entry = -1;
    for (int i = 0; i < 3; ++i) path.b[i] = p.barycentric[i];
  }
  /// The particle has come to the place of its seed, or stays where it is for ever.
  void arrive(Path& path) {
    places_[path.seed] = here(path);
    const std::size_t next = path.seed + 1;
    if (next < last_ && isSamePath(seeds_[path.seed], seeds_[next])) {
      path.seed = next;
      path.target = seeds_[next].maxTime;
    } else {
      path.seed = last_;
    }
  }

  bool set(int lane) {
    for (int i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 2; ++axis) particles_.rate[i][axis][lane] = particles_.change[i][axis][lane] = 0.0;
      particles_.tanHalf[i][lane] = particles_.doubleTwist[i][lane] = 0.0F;
    }
    particles_.start[0][lane] = particles_.start[1][lane] = 0.25;
    particles_.entry[lane] = -1.0;
    particles_.maxDuration[lane] = 1.0;
    particles_.foot[lane] = particles_.height[lane] = 1.0F;
    particles_.allowed[lane] = 1.0F;
    return false;
  }
  void set(const Path& path, double maxDuration, int lane) {
    const FlatFace& face = faces_[path.face];
    const TimeSegment& segment = segments_[path.cursor];
    const Complex* a = field_.sample(segment.sample);
    const Complex* b = field_.sample(std::min(segment.sample + 1, field_.sampleCount() - 1));
    const double theta = segment.theta(time(path)), slope = backward_ ? -segment.slope : segment.slope;
    const Complex g1 = face.gradient(1);
    const double g2 = face.gradient(2).imag();
    for (int i = 0; i < 3; ++i) {
      const Index v = face.vertex(i);
      const Complex difference = b[v] - a[v];
      const Complex now = face.carry(i, rate_ * (a[v] + theta * difference));
      const Complex later = face.carry(i, rate_ * slope * difference);
      particles_.rate[i][0][lane] = now.real() * g1.real() + now.imag() * g1.imag();
      particles_.rate[i][1][lane] = now.imag() * g2;
      particles_.change[i][0][lane] = later.real() * g1.real() + later.imag() * g1.imag();
      particles_.change[i][1][lane] = later.imag() * g2;
      particles_.tanHalf[i][lane] = face.tanHalf(i);
      particles_.doubleTwist[i][lane] = face.doubleTwist(i);
    }
    particles_.start[0][lane] = path.b[1];
    particles_.start[1][lane] = path.b[2];
    particles_.entry[lane] = path.entry;
    particles_.maxDuration[lane] = maxDuration;
    const Complex third = face.corner(2);
    particles_.foot[lane] = static_cast<float>(third.real() * g1.real());
    particles_.height[lane] = static_cast<float>(third.imag() * g1.real());
    particles_.allowed[lane] = face.isExtreme() ? -1.0F : static_cast<float>(allowed_ / face.longestSide());
  }

  void take(Path& path, int lane) {
    ++path.steps;
    const int exit = static_cast<int>(particles_.exit[lane]);
    if (exit == Particles::kNoStep) return takeSmallSteps(path);
    const double duration = particles_.duration[lane], x = particles_.end[0][lane], y = particles_.end[1][lane];
    const double left = path.target - path.elapsed;
    if (exit == Particles::kInside) {
      const bool segmentEnds = duration >= flow_.remaining(path.cursor, time(path));
      path.elapsed = duration < left ? path.elapsed + duration : path.target;
      if (segmentEnds) flow_.advance(path.cursor);
      path.entry = -1;
      path.b[0] = 1.0 - x - y;
      path.b[1] = x;
      path.b[2] = y;
      return;
    }
    // The side opposite to a corner begins at the next one.
    const FlatFace& face = faces_[path.face];
    const int tail = exit == 2 ? 0 : exit + 1, head = tail == 2 ? 0 : tail + 1;
    const double ends[3] = {1.0 - x - y, x, y};
    const double fraction = ends[head] / (ends[tail] + ends[head]);
    path.elapsed = duration < left ? path.elapsed + duration : path.target;
    const Index twin = face.twin(tail);
    if (twin == kNone) {
      // On the boundary, where the particle stays.
      path.b[exit] = 0.0;
      path.b[tail] = 1.0 - fraction;
      path.b[head] = fraction;
      path.steps = options_.maxSteps;
      return;
    }
    path.face = TriangleMesh::face(twin);
    faces_.prefetch(path.face);
    const int back = TriangleMesh::corner(twin), forth = back == 2 ? 0 : back + 1;
    path.entry = 3 - back - forth;
    path.b[back] = fraction;
    path.b[forth] = 1.0 - fraction;
    path.b[path.entry] = 0.0;
  }

  /// By the integrator, until the particle has gone on.
  void takeSmallSteps(Path& path) {
    const double left = path.target - path.elapsed;
    bool going = integrator_.begin(here(path), time(path), left);
    while (going && integrator_.elapsed() == 0.0 && !integrator_.isOver()) {
      going = integrator_.takeSmallStep();
      ++path.steps;
    }
    const TraceEnd end = integrator_.end();
    const bool stopped = !going && end.reason != StopReason::Time;
    path.elapsed = end.time < left ? path.elapsed + end.time : path.target;
    goOn(path, end.point);
    if (stopped) {
      path.steps = options_.maxSteps;
      return;
    }
    path.cursor = flow_.start(time(path));
    const SidePoint& entry = integrator_.entry();
    if (entry.side >= 0) path.entry = (entry.side + 2) % 3;
  }

  const FlatFaces& faces_;
  const ParameterizedField& field_;
  const std::vector<TimeSegment>& segments_;
  const std::vector<PathlineSeed>& seeds_;
  std::vector<SurfacePoint>& places_;
  const TraceOptions& options_;
  bool backward_;
  double rate_, allowed_;
  UnsteadyFlow flow_;
  Integrator<UnsteadyFlow> integrator_;
  std::size_t next_ = 0, last_ = 0;
  std::array<Path, Particles::kCount> paths_;
  Particles particles_;
};

}  // namespace

std::vector<SurfacePoint> traceArrivals(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds,
                                        const TraceOptions& options, Progress* progress) {
  check(flow, seeds, options);
  std::vector<SurfacePoint> places(seeds.size());
  // Blocks that begin where a pathline does.
  std::vector<std::size_t> blocks{0};
  while (blocks.back() < seeds.size()) {
    std::size_t end = std::min(seeds.size(), blocks.back() + kBlock);
    while (end < seeds.size() && isSamePath(seeds[end - 1], seeds[end])) ++end;
    blocks.push_back(end);
  }
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t{0}, blocks.size() - 1, [&](std::size_t k) {
    if (progress != nullptr) progress->check();
    Follower(flow, seeds, options, places).follow(blocks[k], blocks[k + 1]);
    if (progress != nullptr) {
      progress->report(static_cast<double>(done += blocks[k + 1] - blocks[k]) / static_cast<double>(seeds.size()));
    }
  });
  return places;
}

}  // namespace stormfield
