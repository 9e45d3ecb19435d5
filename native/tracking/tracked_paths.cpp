#include "tracking/tracked_paths.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {
namespace {

/// What pieces that are joined may differ by at the lambda that they share.
constexpr double kSameLambda = 1e-9;

bool isLambda(double value) {
  return value >= 0.0 && value <= 1.0;  // false for what is not a number
}

void check(const TrackedPath& path, std::size_t number) {
  const auto refuse = [number](const auto&... why) { throw InputError(message("path ", number, " ", why...)); };
  if (path.samples.empty()) refuse("has no samples; give at least one");
  if (path.index != 1 && path.index != -1) refuse("has index ", path.index, "; give +1 or -1");
  for (std::size_t i = 0; i < path.samples.size(); ++i) {
    const PathSample& sample = path.samples[i];
    if (!isLambda(sample.lambda)) refuse("has a sample at lambda ", sample.lambda, "; give 0 to 1");
    if (i > 0 && sample.lambda < path.samples[i - 1].lambda - kSameLambda) {
      refuse("goes back from lambda ", path.samples[i - 1].lambda, " to ", sample.lambda, "; sort its samples");
    }
    if (sample.point.face < 0) refuse("has a sample on face ", sample.point.face, "; faces count from 0");
  }
}

void check(const Bifurcation& event, std::size_t number, std::size_t pathCount) {
  const auto refuse = [number](const auto&... why) { throw InputError(message("bifurcation ", number, " ", why...)); };
  if (!isLambda(event.lambda)) refuse("is at lambda ", event.lambda, "; give 0 to 1");
  const bool hopf = event.kind == BifurcationKind::Hopf;
  for (std::size_t k = 0; k < event.paths.size(); ++k) {
    const Index path = event.paths[k];
    if (hopf && k == 1) {
      if (path != kNone) refuse("is a hopf and names 2 paths; give one");
    } else if (path < 0 || static_cast<std::size_t>(path) >= pathCount) {
      refuse("names path ", path, " of ", pathCount);
    }
  }
  if (!hopf && event.paths[0] == event.paths[1]) refuse("names path ", event.paths[0], " twice; give two that meet");
}

}  // namespace

FixedPointKind prevailingKind(const std::vector<PathSample>& samples) {
  std::array<double, 5> share{};
  // A path of one sample has no share of lambda: its kind still prevails.
  share[static_cast<std::size_t>(samples.front().kind)] = 1e-300;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const double half = 0.5 * (samples[i + 1].lambda - samples[i].lambda);
    share[static_cast<std::size_t>(samples[i].kind)] += half;
    share[static_cast<std::size_t>(samples[i + 1].kind)] += half;
  }
  return static_cast<FixedPointKind>(std::max_element(share.begin(), share.end()) - share.begin());
}

Tracking makeTracking(std::vector<TrackedPath> paths, std::vector<Bifurcation> bifurcations) {
  for (std::size_t i = 0; i < paths.size(); ++i) {
    check(paths[i], i);
    paths[i].kind = prevailingKind(paths[i].samples);
  }
  for (std::size_t e = 0; e < bifurcations.size(); ++e) check(bifurcations[e], e, paths.size());
  return {std::move(paths), std::move(bifurcations)};
}

}  // namespace stormfield
