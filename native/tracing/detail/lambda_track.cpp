#include "tracing/detail/lambda_track.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {
namespace {

void check(const LambdaTrack& track) {
  if (track.times.empty() || track.times.size() != track.lambdas.size()) {
    throw InputError(message("a lambda track needs as many times as lambdas, at least one; it has ", track.times.size(),
                             " and ", track.lambdas.size()));
  }
  for (std::size_t i = 0; i < track.times.size(); ++i) {
    if (!std::isfinite(track.times[i]) || !std::isfinite(track.lambdas[i])) {
      throw InputError(message("sample ", i, " of the lambda track is not finite"));
    }
    if (i > 0 && !(track.times[i] > track.times[i - 1])) {
      throw InputError(message("the times of a lambda track must increase, but sample ", i, " does not"));
    }
  }
}

/// Lambda as a position in the field's samples: 2.25 is a quarter of the interval from sample 2 to sample 3.
double samplePosition(const std::vector<double>& lambdas, double lambda) {
  if (lambda <= lambdas.front()) return 0.0;
  if (lambda >= lambdas.back()) return static_cast<double>(lambdas.size() - 1);
  const auto upper = std::upper_bound(lambdas.begin(), lambdas.end(), lambda);
  const auto j = static_cast<std::size_t>(upper - lambdas.begin()) - 1;
  return static_cast<double>(j) + (lambda - lambdas[j]) / (lambdas[j + 1] - lambdas[j]);
}

/// The segment between two times that share one interval of samples.
TimeSegment segmentBetween(Index samples, double begin, double end, double from, double to) {
  TimeSegment s;
  s.begin = s.origin = begin;
  s.end = end;
  s.sample = std::clamp(static_cast<Index>(std::floor(0.5 * (from + to))), Index{0}, std::max(Index{0}, samples - 2));
  s.theta0 = from - s.sample;
  s.slope = (to - from) / (end - begin);
  return s;
}

TimeSegment constantSegment(Index samples, double begin, double end, double value) {
  TimeSegment s;
  s.begin = begin;
  s.end = end;
  s.sample = std::clamp(static_cast<Index>(std::floor(value)), Index{0}, std::max(Index{0}, samples - 2));
  s.theta0 = value - s.sample;
  return s;
}

bool continues(const TimeSegment& a, const TimeSegment& b) {
  return a.sample == b.sample && std::abs(a.slope - b.slope) <= 1e-9 * std::abs(a.slope) &&
         std::abs(a.theta(b.begin) - b.theta(b.begin)) <= 1e-12;
}

}  // namespace

std::vector<TimeSegment> timeSegments(const std::vector<double>& fieldLambdas, const LambdaTrack& track) {
  check(track);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto samples = static_cast<Index>(fieldLambdas.size());
  std::vector<TimeSegment> result;
  const auto append = [&](const TimeSegment& s) {
    if (!result.empty() && continues(result.back(), s)) {
      result.back().end = s.end;
    } else {
      result.push_back(s);
    }
  };

  append(
      constantSegment(samples, -kInfinity, track.times.front(), samplePosition(fieldLambdas, track.lambdas.front())));
  std::vector<double> knots;
  for (std::size_t i = 0; i + 1 < track.times.size(); ++i) {
    const double t0 = track.times[i], t1 = track.times[i + 1];
    const double from = track.lambdas[i], to = track.lambdas[i + 1];
    knots = {t0, t1};
    for (const double lambda : fieldLambdas) {
      const double t = t0 + (t1 - t0) * (lambda - from) / (to - from);
      if (t > t0 && t < t1) knots.push_back(t);
    }
    std::sort(knots.begin(), knots.end());
    knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
    const auto positionAt = [&](double t) {
      return samplePosition(fieldLambdas, t == t1 ? to : from + (to - from) * ((t - t0) / (t1 - t0)));
    };
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      append(segmentBetween(samples, knots[k], knots[k + 1], positionAt(knots[k]), positionAt(knots[k + 1])));
    }
  }
  append(constantSegment(samples, track.times.back(), kInfinity, samplePosition(fieldLambdas, track.lambdas.back())));
  return result;
}

}  // namespace stormfield
