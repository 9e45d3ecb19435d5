#include "tracing/particle_lines.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "base/error.h"
#include "base/message.h"
#include "mesh/closest_point.h"

namespace stormfield {
namespace {

/// Between neighbours nearer in parameter than this fraction of the whole family no particle joins.
constexpr double kNearest = 1e-9;
/// Upper limit on the particles that join between two neighbours at once; more follow when the gap is still too wide.
constexpr double kMaxAtOnce = 8.0;
/// A gap that stays wider than this many spacings is a tear.
constexpr double kTorn = 2.0;

struct Particle {
  double parameter = 0.0;
  double released = 0.0;  ///< seconds
  SurfacePoint point;
  bool stopped = false;  ///< by the boundary or the limit on steps
};

using Line = std::vector<Particle>;

/// The family of particles of each line: the one of a parameter, as it is released.
using Release = std::function<Particle(std::size_t line, double parameter)>;

void check(const std::vector<double>& times, double start, const LineOptions& options) {
  if (!std::isfinite(start)) throw InputError("the time at which particles are released must be finite");
  double previous = start;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!(times[i] >= previous) || !std::isfinite(times[i])) {
      throw InputError(message("time ", i, " of the lines is ", times[i], " s, before ", previous,
                               " s; give times in increasing order, not before the release"));
    }
    previous = times[i];
  }
  if (!(options.spacing > 0.0)) throw InputError("the spacing of particles must be positive, in mesh units");
  if (!(options.interval > 0.0)) throw InputError("the interval between releases must be positive, in seconds");
  if (options.maxParticles < 2) throw InputError("a line needs at least 2 particles");
}

/// Follows lines from one time to the next, and fills their gaps.
class Follower {
 public:
  Follower(const UnsteadyField& flow, const LineOptions& options, Release release, Progress* progress)
      : flow_(flow), options_(options), release_(std::move(release)), progress_(progress) {
    trace_.tolerance = options.tolerance;
    trace_.boundary = options.boundary;
  }

  /// Takes all particles from a time (or their later release) to another.
  void advance(std::vector<Line>& lines, double from, double to) const {
    std::vector<Particle*> moving;
    for (Line& line : lines) {
      for (Particle& particle : line) {
        if (!particle.stopped) moving.push_back(&particle);
      }
    }
    std::vector<PathlineSeed> seeds(moving.size());
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const double begin = std::max(from, moving[i]->released);
      seeds[i] = {moving[i]->point, begin, std::max(0.0, to - begin)};
    }
    const auto ends = tracePathlineEnds(flow_, seeds, trace_, progress_);
    for (std::size_t i = 0; i < moving.size(); ++i) {
      moving[i]->point = ends[i].point;
      moving[i]->stopped = ends[i].reason != StopReason::Time;
    }
  }

  /// Lets particles join where neighbours are too far apart at a time.
  void fill(std::vector<Line>& lines, double time) const {
    for (bool complete = false; !complete;) {
      std::vector<Line> joining(lines.size());
      complete = true;
      for (std::size_t i = 0; i < lines.size(); ++i) {
        joining[i] = between(lines[i], i);
        complete = complete && joining[i].empty();
        if (lines[i].size() + joining[i].size() > static_cast<std::size_t>(options_.maxParticles)) {
          throw InputError(message("line ", i, " needs more than ", options_.maxParticles, " particles at ", time,
                                   " s; choose a larger spacing or a shorter time"));
        }
      }
      if (complete) return;
      advance(joining, -std::numeric_limits<double>::infinity(), time);
      for (std::size_t i = 0; i < lines.size(); ++i) {
        Line merged(lines[i].size() + joining[i].size());
        std::merge(lines[i].begin(), lines[i].end(), joining[i].begin(), joining[i].end(), merged.begin(),
                   [](const Particle& a, const Particle& b) { return a.parameter < b.parameter; });
        lines[i] = std::move(merged);
      }
    }
  }

  ParticleLines snapshot(const std::vector<Line>& lines, double time) const {
    ParticleLines result;
    result.time = time;
    result.offsets.push_back(0);
    for (const Line& line : lines) {
      for (std::size_t k = 0; k < line.size(); ++k) {
        result.points.push_back(line[k].point);
        result.ages.push_back(time - line[k].released);
        result.parameters.push_back(line[k].parameter);
        result.torn.push_back(k + 1 < line.size() && gap(line[k], line[k + 1]) > kTorn * options_.spacing);
      }
      result.offsets.push_back(result.points.size());
    }
    return result;
  }

 private:
  double gap(const Particle& a, const Particle& b) const {
    const TriangleMesh& mesh = flow_.faces->mesh();
    return (position(mesh, a.point) - position(mesh, b.point)).norm();
  }

  Line between(const Line& line, std::size_t index) const {
    Line joining;
    if (line.empty()) return joining;
    const double nearest = kNearest * (line.back().parameter - line.front().parameter);
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      const double from = line[k].parameter, width = line[k + 1].parameter - from;
      const double wanted =
          std::ceil(std::max(gap(line[k], line[k + 1]) / options_.spacing,
                             (line[k + 1].released - line[k].released) / options_.interval * 0.999999));
      const int pieces = static_cast<int>(std::min(wanted, kMaxAtOnce));
      if (!(width > nearest * pieces)) continue;
      for (int piece = 1; piece < pieces; ++piece) joining.push_back(release_(index, from + width * piece / pieces));
    }
    return joining;
  }

  const UnsteadyField& flow_;
  LineOptions options_;
  Release release_;
  Progress* progress_;
  TraceOptions trace_;
};

void beginPhase(Progress* progress, std::size_t phase, std::size_t phases) {
  if (progress != nullptr) {
    progress->range(static_cast<double>(phase) / static_cast<double>(phases),
                    static_cast<double>(phase + 1) / static_cast<double>(phases));
  }
}

}  // namespace

std::vector<ParticleLines> traceStreaklines(const UnsteadyField& flow, const std::vector<SurfacePoint>& seeds,
                                            double start, const std::vector<double>& times, const LineOptions& options,
                                            Progress* progress) {
  check(times, start, options);
  checkSeeds(flow.faces->mesh(), seeds);
  const Release release = [&](std::size_t line, double when) { return Particle{when, when, seeds[line], false}; };
  const Follower follower(flow, options, release, progress);
  std::vector<Line> lines(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) lines[i].push_back(release(i, start));
  std::vector<ParticleLines> result;
  double before = start;
  for (std::size_t k = 0; k < times.size(); ++k) {
    beginPhase(progress, k, times.size());
    follower.advance(lines, before, times[k]);
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      if (lines[i].back().parameter < times[k]) lines[i].push_back(release(i, times[k]));
    }
    follower.fill(lines, times[k]);
    result.push_back(follower.snapshot(lines, times[k]));
    before = times[k];
  }
  return result;
}

std::vector<ParticleLines> traceTimelines(const UnsteadyField& flow,
                                          const std::vector<std::vector<SurfacePoint>>& curves, double start,
                                          const std::vector<double>& times, const LineOptions& options,
                                          Progress* progress) {
  check(times, start, options);
  const TriangleMesh& mesh = flow.faces->mesh();
  for (const auto& curve : curves) checkSeeds(mesh, curve);
  std::optional<ClosestPointQuery> surface;
  const auto pointBetween = [&](const SurfacePoint& a, const SurfacePoint& b, double fraction) {
    if (a.face == b.face) return SurfacePoint{a.face, (1.0 - fraction) * a.barycentric + fraction * b.barycentric};
    if (!surface) surface.emplace(flow.faces->charts().meshPointer());
    const Vec3 chord = (1.0 - fraction) * position(mesh, a) + fraction * position(mesh, b);
    return surface->closest(chord, fraction < 0.5 ? a : b).point;
  };
  const Release release = [&](std::size_t line, double parameter) {
    const auto& curve = curves[line];
    const auto k = static_cast<std::size_t>(parameter);
    const double fraction = parameter - static_cast<double>(k);
    return Particle{parameter, start, fraction > 0.0 ? pointBetween(curve[k], curve[k + 1], fraction) : curve[k],
                    false};
  };
  const Follower follower(flow, options, release, progress);
  std::vector<Line> lines(curves.size());
  for (std::size_t i = 0; i < curves.size(); ++i) {
    for (std::size_t k = 0; k < curves[i].size(); ++k) lines[i].push_back(release(i, static_cast<double>(k)));
  }
  std::vector<ParticleLines> result;
  double before = start;
  for (std::size_t k = 0; k < times.size(); ++k) {
    beginPhase(progress, k, times.size());
    follower.advance(lines, before, times[k]);
    follower.fill(lines, times[k]);
    result.push_back(follower.snapshot(lines, times[k]));
    before = times[k];
  }
  return result;
}

}  // namespace stormfield
