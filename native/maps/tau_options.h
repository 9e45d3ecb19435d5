// Types that all parts of the tau map share (tau_map.h): the unit of tau, the error of a field, options and counts.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/words.h"

namespace stormfield {

enum class TauUnit {
  Time,    ///< seconds: phi is the flow of V
  Length,  ///< mesh units: phi is the flow of V at unit speed, which has the same trajectories (unit_speed_flow.h)
};
template <>
inline constexpr Words kWords<TauUnit>{"unit of tau", {"time", "length"}};

/// The error of a field: the vector at vertex v is known up to epsilon * weights[v], mesh units per second.
struct FieldError {
  double epsilon = 0.0;
  std::vector<double> weights{};  ///< one per vertex, not negative; empty: 1
};

struct TauMapOptions {
  TauUnit unit = TauUnit::Time;
  /// Largest estimated error of one step of a trace, in mean edge lengths.
  double tolerance = 1e-5;
  /// Bytes that F and the work on it may take; none: half of the memory of the machine.
  std::optional<std::size_t> memoryLimit{};
  /// F holds for all fields within the error (divergence_bound.h); on closed surfaces only.
  FieldError error{};
};

/// Counts of what the computation of a map took.
struct TauWork {
  std::size_t traces = 0;
  std::size_t peakBytes = 0;  ///< largest sum of the sizes of all arrays at one time
};

}  // namespace stormfield
