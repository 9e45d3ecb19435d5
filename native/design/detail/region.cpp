#include "design/detail/region.h"

namespace stormfield {

namespace {

constexpr double kSameLambda = 1e-9;

}  // namespace

bool LambdaSpan::contains(double lambda) const {
  const bool afterStart = startJoined && !ownsStart ? lambda > start + kSameLambda : lambda >= start - kSameLambda;
  const bool beforeEnd = endJoined && !ownsEnd ? lambda < end - kSameLambda : lambda <= end + kSameLambda;
  return afterStart && beforeEnd;
}

double LambdaSpan::share(double lambda, double step) const {
  if ((startJoined && lambda <= 0.5 * (start + end) && !contains(lambda)) ||
      (endJoined && lambda >= 0.5 * (start + end) && !contains(lambda)))
    return 0.0;
  constexpr int kPieces = 16;
  double sum = 0.0;
  for (int k = 0; k < kPieces; ++k) {
    const double l = lambda + step * ((k + 0.5) / kPieces - 0.5);
    // Lambda is mirrored at 0 and 1: an element that acts there acts on the whole cell.
    const double before = startJoined || start <= 0.0 ? 0.0 : (start - l) / fade;
    const double after = endJoined || end >= 1.0 ? 0.0 : (l - end) / fade;
    sum += 1.0 - smoothStep(std::max(before, after));
  }
  return sum / kPieces;
}

}  // namespace stormfield
