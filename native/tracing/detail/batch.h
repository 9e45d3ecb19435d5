// Many independent traces in parallel, with results in the order of the seeds whatever the number of threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <vector>

#include "base/progress.h"
#include "tracing/trace.h"

namespace stormfield {

/// ends[i] = trace(i, integrator) with one integrator per task.
template <typename MakeIntegrator, typename Trace>
std::vector<TraceEnd> traceEach(std::size_t count, const MakeIntegrator& makeIntegrator, const Trace& trace,
                                Progress* progress) {
  constexpr std::size_t kGrain = 64;
  std::vector<TraceEnd> ends(count);
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      auto integrator = makeIntegrator();
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        if (progress != nullptr) progress->check();
                        ends[i] = trace(i, integrator);
                      }
                      if (progress != nullptr) {
                        progress->report(static_cast<double>(done += range.size()) / static_cast<double>(count));
                      }
                    });
  return ends;
}

/// As traceEach, and keeps the points: trace(i, integrator, visit).
template <typename MakeIntegrator, typename Trace>
Traces recordEach(std::size_t count, const MakeIntegrator& makeIntegrator, const Trace& trace, Progress* progress) {
  // Seeds share buffers in fixed groups: one allocation per group, not per trace.
  constexpr std::size_t kGroup = 64;
  struct Group {
    std::vector<SurfacePoint> points;
    std::vector<double> times;
  };
  Traces result;
  result.ends.resize(count);
  result.offsets.assign(count + 1, 0);
  std::vector<Group> groups((count + kGroup - 1) / kGroup);
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t g) {
    Group& group = groups[g];
    auto integrator = makeIntegrator();
    for (std::size_t i = g * kGroup; i < std::min(count, (g + 1) * kGroup); ++i) {
      if (progress != nullptr) progress->check();
      const std::size_t before = group.points.size();
      result.ends[i] = trace(i, integrator, [&](const SurfacePoint& p, double time) {
        // Hand-overs between faces and time segments do not move the particle.
        if (group.points.size() > before && time == group.times.back()) {
          group.points.back() = p;
          return;
        }
        group.points.push_back(p);
        group.times.push_back(time);
      });
      result.offsets[i + 1] = group.points.size() - before;
    }
    if (progress != nullptr) progress->report(static_cast<double>(++done) / static_cast<double>(groups.size()));
  });
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  result.points.resize(result.offsets.back());
  result.times.resize(result.offsets.back());
  tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t g) {
    const auto at = static_cast<std::ptrdiff_t>(result.offsets[g * kGroup]);
    std::copy(groups[g].points.begin(), groups[g].points.end(), result.points.begin() + at);
    std::copy(groups[g].times.begin(), groups[g].times.end(), result.times.begin() + at);
  });
  return result;
}

}  // namespace stormfield
