// Lambda as a function of time (the keyframes of the artist, d lambda = s dt): linear between samples, constant
// outside.
//
// A field that is linear in lambda between its samples, followed along a track, is linear in time on segments: those
// are what the integrator steps over without error.
#pragma once

#include <vector>

#include "field/parameterized_field.h"

namespace stormfield {

struct LambdaTrack {
  std::vector<double> times;    ///< seconds, strictly increasing, at least one
  std::vector<double> lambdas;  ///< one per time; outside the field's samples they are clamped to them
};

/// On begin <= t <= end the field is (1 - theta) sample + theta (sample + 1), theta = theta0 + slope (t - origin).
struct TimeSegment {
  double begin = 0.0, end = 0.0;  ///< seconds; the first and last reach to infinity
  double origin = 0.0, theta0 = 0.0, slope = 0.0;
  Index sample = 0;

  double theta(double t) const { return theta0 + slope * (t - origin); }
};

/// The segments in order, without gaps, from minus to plus infinity; neighbours that continue each other are joined.
/// Throws InputError for a track that is empty, not increasing, or not finite.
std::vector<TimeSegment> timeSegments(const std::vector<double>& fieldLambdas, const LambdaTrack& track);

}  // namespace stormfield
