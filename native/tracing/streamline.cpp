#include "tracing/streamline.h"

#include <tbb/parallel_for.h>

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

/// Seeds that one task traces side by side, and how many steps of a trace pay for preparing a face.
constexpr std::size_t kGroup = 64, kWorthPreparing = 64;

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
    const SteadyFlow flow(field.values.data(), rate, prepared_.get());
    prototype_.emplace(faces, flow, options, options.minimalSpeed * fastest(field));
  }

  std::size_t groupCount() const { return (seeds_.size() + kGroup - 1) / kGroup; }

  /// visitors: one for each group of seeds.
  template <typename Visitor>
  void trace(std::vector<Visitor>& visitors, Progress* progress) const {
    std::atomic<std::size_t> done{0};
    tbb::parallel_for(std::size_t{0}, visitors.size(), [&](std::size_t g) {
      if (progress != nullptr) progress->check();
      visitors[g].progress = progress;
      traceSideBySide(*prototype_, seeds_, options_.maximalTime, g * kGroup, std::min(seeds_.size(), (g + 1) * kGroup),
                      visitors[g]);
      if (progress != nullptr) progress->report(static_cast<double>(++done) / static_cast<double>(visitors.size()));
    });
  }

 private:
  const std::vector<SurfacePoint>& seeds_;
  const TraceOptions& options_;
  std::unique_ptr<FaceFlow[]> prepared_;
  std::optional<Steady> prototype_;
};

/// Keeps the ends.
struct EndKeeper {
  std::vector<TraceEnd>* ends = nullptr;
  Progress* progress = nullptr;

  void begin(int, std::size_t) {
    if (progress != nullptr) progress->check();
  }
  void step(int, const Steady&) {}
  void end(int, std::size_t trace, const TraceEnd& traceEnd) { (*ends)[trace] = traceEnd; }
};

/// Keeps the points, those of a lane in one buffer.
struct PointKeeper {
  struct Buffer {
    std::vector<SurfacePoint> points;
    std::vector<double> times;
    std::size_t first = 0;  ///< of the trace at hand
  };
  struct Piece {
    int lane;
    std::size_t first;
  };
  Traces* traces = nullptr;
  const std::vector<SurfacePoint>* seeds = nullptr;
  Progress* progress = nullptr;
  std::array<Buffer, FaceSteps::kCount> buffers = {};
  std::array<Piece, kGroup> pieces = {};

  void begin(int lane, std::size_t trace) {
    if (progress != nullptr) progress->check();
    Buffer& buffer = buffers[lane];
    buffer.first = buffer.points.size();
    buffer.points.push_back((*seeds)[trace]);
    buffer.times.push_back(0.0);
  }
  void step(int lane, const Steady& integrator) {
    Buffer& buffer = buffers[lane];
    // Hand-overs between faces do not move the particle.
    if (integrator.elapsed() == buffer.times.back()) {
      buffer.points.back() = integrator.here();
      return;
    }
    buffer.points.push_back(integrator.here());
    buffer.times.push_back(integrator.elapsed());
  }
  void end(int lane, std::size_t trace, const TraceEnd& traceEnd) {
    traces->ends[trace] = traceEnd;
    traces->offsets[trace + 1] = buffers[lane].points.size() - buffers[lane].first;
    pieces[trace % kGroup] = {lane, buffers[lane].first};
  }
};

}  // namespace

Traces traceStreamlines(const FlatFaces& faces, const VectorField& field, const std::vector<SurfacePoint>& seeds,
                        const TraceOptions& options, Progress* progress) {
  const Streamlines streamlines(faces, field, seeds, options);
  Traces result;
  result.ends.resize(seeds.size());
  result.offsets.assign(seeds.size() + 1, 0);
  std::vector<PointKeeper> keepers(streamlines.groupCount(), PointKeeper{.traces = &result, .seeds = &seeds});
  streamlines.trace(keepers, progress);
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  result.points.resize(result.offsets.back());
  result.times.resize(result.offsets.back());
  tbb::parallel_for(std::size_t{0}, seeds.size(), [&](std::size_t i) {
    const auto [lane, first] = keepers[i / kGroup].pieces[i % kGroup];
    const PointKeeper::Buffer& from = keepers[i / kGroup].buffers[lane];
    const std::size_t to = result.offsets[i], count = result.offsets[i + 1] - to;
    std::copy_n(from.points.data() + first, count, result.points.data() + to);
    std::copy_n(from.times.data() + first, count, result.times.data() + to);
  });
  return result;
}

std::vector<TraceEnd> traceStreamlineEnds(const FlatFaces& faces, const VectorField& field,
                                          const std::vector<SurfacePoint>& seeds, const TraceOptions& options,
                                          Progress* progress) {
  const Streamlines streamlines(faces, field, seeds, options);
  std::vector<TraceEnd> ends(seeds.size());
  std::vector<EndKeeper> keepers(streamlines.groupCount(), EndKeeper{.ends = &ends});
  streamlines.trace(keepers, progress);
  return ends;
}

TraceEnd traceStreamline(const FlatFaces& faces, const VectorField& field, const SurfacePoint& seed,
                         const TraceOptions& options) {
  return traceStreamlineEnds(faces, field, {seed}, options).front();
}

}  // namespace stormfield
