#include "tracing/streamline.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "tracing/side_by_side.h"

namespace stormfield {
namespace {

using Steady = Integrator<SteadyFlow>;

/// How many steps of a trace pay for preparing a face.
constexpr std::size_t kWorthPreparing = 64;
/// Traces between two reports of the progress.
constexpr std::size_t kReport = 64;

double fastest(const VectorField& field) {
  double squared = 0.0;
  for (const Complex& v : field.values) squared = std::max(squared, std::norm(v));
  return std::sqrt(squared);
}

/// A field on the faces, prepared for following it from some seeds.
class Streamlines {
 public:
  Streamlines(const FlatFaces& faces, const VectorField& field, const std::vector<SurfacePoint>& seeds,
              const TraceOptions& options)
      : seeds_(seeds), options_(options) {
    if (field.values.size() != static_cast<std::size_t>(faces.mesh().vertexCount())) {
      throw InputError("the field to trace belongs to another mesh");
    }
    checkOptions(options);
    checkSeeds(faces.mesh(), seeds);
    const double rate = options.direction == Direction::Backward ? -1.0 : 1.0;
    const Index faceCount = faces.mesh().faceCount();
    if (seeds.size() * kWorthPreparing >= static_cast<std::size_t>(faceCount)) {
      prepared_ = prepareFaces(faces, SteadyFlow(field.values.data(), rate));
    }
    order_.resize(seeds.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return seeds[a].face < seeds[b].face; });
    const SteadyFlow flow(field.values.data(), rate, prepared_.get());
    prototype_.emplace(faces, flow, options, options.minSpeed * fastest(field));
  }

  /// As many keepers as may work at a time.
  std::size_t keeperCount() const {
    return std::min(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()), seeds_.size());
  }

  /// Every keeper takes the next seed when one of its lanes is free, so that all lanes are busy to the end.
  template <typename Keeper>
  void trace(std::vector<Keeper>& keepers, Progress* progress) const {
    std::atomic<std::size_t> begun{0}, done{0};
    tbb::parallel_for(
        std::size_t{0}, keepers.size(),
        [&](std::size_t k) {
          Work<Keeper> work{*this, keepers[k], begun, done, progress};
          traceSideBySide(*prototype_, work);
        },
        tbb::simple_partitioner());
  }

  /// For a single seed, which has no others to run side by side with.
  TraceEnd traceAlone(std::size_t i) {
    return prototype_->run(seeds_[i], 0.0, options_.maxTime, [](const SurfacePoint&, double) {});
  }

 private:
  /// Distributes the seeds, and calls the keeper's begin(lane, seed), step(lane, integrator), end(lane, trace,
  /// TraceEnd).
  template <typename Keeper>
  struct Work {
    const Streamlines& lines;
    Keeper& keeper;
    std::atomic<std::size_t>&begun, &done;
    Progress* progress;
    std::array<std::size_t, FaceSteps::kCount> traces{};

    bool next(int lane, SurfacePoint& seed, double& maxTime) {
      if (progress != nullptr) progress->check();
      if (begun.load(std::memory_order_relaxed) >= lines.seeds_.size()) return false;
      const std::size_t place = begun++;
      if (place >= lines.seeds_.size()) return false;
      const std::size_t trace = traces[lane] = lines.order_[place];
      seed = lines.seeds_[trace];
      maxTime = lines.options_.maxTime;
      keeper.begin(lane, seed);
      return true;
    }
    bool step(int lane, const Steady& integrator) {
      keeper.step(lane, integrator);
      return true;
    }
    void end(int lane, const TraceEnd& traceEnd) {
      keeper.end(lane, traces[lane], traceEnd);
      const std::size_t ended = ++done;
      if (progress == nullptr || ended % kReport != 0) return;
      progress->report(static_cast<double>(ended) / static_cast<double>(lines.seeds_.size()));
    }
  };

  const std::vector<SurfacePoint>& seeds_;
  std::vector<std::size_t> order_;  ///< of the seeds, by face: traces side by side then share faces in the cache
  const TraceOptions& options_;
  std::unique_ptr<FaceFlow[]> prepared_;
  std::optional<Steady> prototype_;
};

/// Keeps the ends.
struct EndKeeper {
  std::vector<TraceEnd>* ends = nullptr;

  void begin(int, const SurfacePoint&) {}
  void step(int, const Steady&) {}
  void end(int, std::size_t trace, const TraceEnd& traceEnd) { (*ends)[trace] = traceEnd; }
};

/// Points one after the other, in blocks that stay where they are while more come.
class PointLog {
 public:
  std::size_t size() const { return size_; }
  /// A place for another point.
  SurfacePoint& add(double time) {
    if (size_ % kBlock == 0) blocks_.push_back(std::make_unique_for_overwrite<Block>());
    Block& block = *blocks_.back();
    const std::size_t at = size_++ % kBlock;
    block.times[at] = lastTime_ = time;
    return block.points[at];
  }
  double lastTime() const { return lastTime_; }
  SurfacePoint& last() { return blocks_.back()->points[(size_ - 1) % kBlock]; }
  void copy(std::size_t first, std::size_t count, SurfacePoint* points, double* times) const {
    while (count > 0) {
      const Block& block = *blocks_[first / kBlock];
      const std::size_t at = first % kBlock, here = std::min(count, kBlock - at);
      points = std::copy_n(block.points + at, here, points);
      times = std::copy_n(block.times + at, here, times);
      first += here;
      count -= here;
    }
  }

 private:
  static constexpr std::size_t kBlock = 1024;
  struct Block {
    SurfacePoint points[kBlock];
    double times[kBlock];
  };
  std::vector<std::unique_ptr<Block>> blocks_;
  std::size_t size_ = 0;
  double lastTime_ = 0.0;
};

/// Where the points of a trace are.
struct Piece {
  const PointLog* log = nullptr;
  std::size_t first = 0;
};

/// Keeps the points, those of a lane in one log.
struct PointKeeper {
  Traces* traces = nullptr;
  std::vector<Piece>* pieces = nullptr;
  std::array<PointLog, FaceSteps::kCount> logs;
  std::array<std::size_t, FaceSteps::kCount> first = {};

  void begin(int lane, const SurfacePoint& seed) {
    PointLog& log = logs[lane];
    first[lane] = log.size();
    log.add(0.0) = seed;
  }
  void step(int lane, const Steady& integrator) {
    PointLog& log = logs[lane];
    // Hand-overs between faces do not move the particle.
    const double time = integrator.elapsed();
    integrator.here(time == log.lastTime() ? log.last() : log.add(time));
  }
  void end(int lane, std::size_t trace, const TraceEnd& traceEnd) {
    const PointLog& log = logs[lane];
    traces->ends[trace] = traceEnd;
    traces->offsets[trace + 1] = log.size() - first[lane];
    (*pieces)[trace] = {&log, first[lane]};
  }
};

}  // namespace

Traces traceStreamlines(const FlatFaces& faces, const VectorField& field, const std::vector<SurfacePoint>& seeds,
                        const TraceOptions& options, Progress* progress) {
  const Streamlines streamlines(faces, field, seeds, options);
  Traces result;
  result.ends.resize(seeds.size());
  result.offsets.assign(seeds.size() + 1, 0);
  std::vector<Piece> pieces(seeds.size());
  std::vector<PointKeeper> keepers(streamlines.keeperCount());
  for (PointKeeper& keeper : keepers) {
    keeper.traces = &result;
    keeper.pieces = &pieces;
  }
  streamlines.trace(keepers, progress);
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  result.points.resize(result.offsets.back());
  result.times.resize(result.offsets.back());
  tbb::parallel_for(std::size_t{0}, seeds.size(), [&](std::size_t i) {
    const std::size_t to = result.offsets[i], count = result.offsets[i + 1] - to;
    pieces[i].log->copy(pieces[i].first, count, result.points.data() + to, result.times.data() + to);
  });
  return result;
}

std::vector<TraceEnd> traceStreamlineEnds(const FlatFaces& faces, const VectorField& field,
                                          const std::vector<SurfacePoint>& seeds, const TraceOptions& options,
                                          Progress* progress) {
  const Streamlines streamlines(faces, field, seeds, options);
  std::vector<TraceEnd> ends(seeds.size());
  std::vector<EndKeeper> keepers(streamlines.keeperCount(), EndKeeper{&ends});
  streamlines.trace(keepers, progress);
  return ends;
}

TraceEnd traceStreamline(const FlatFaces& faces, const VectorField& field, const SurfacePoint& seed,
                         const TraceOptions& options) {
  const std::vector<SurfacePoint> seeds{seed};
  return Streamlines(faces, field, seeds, options).traceAlone(0);
}

}  // namespace stormfield
