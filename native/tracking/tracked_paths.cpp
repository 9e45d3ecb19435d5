#include "tracking/tracked_paths.h"

#include <algorithm>

namespace stormfield {

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

}  // namespace stormfield
