// Loops over the chunks of a level: in parallel where that is worth it, stopping when cancelled.
#pragma once

#include <tbb/parallel_for.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "base/progress.h"
#include "solver/detail/surface_hierarchy.h"

namespace stormfield {

/// The length of a vector from the squared lengths of its chunks, added in their order.
inline double lengthOf(const std::vector<double>& squares) {
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0));
}

/// Levels with less work than this per sweep are not worth other threads.
inline bool isParallel(const SurfaceLevel& level) {
  constexpr std::size_t kSerialFloats = 1 << 15;
  return static_cast<std::size_t>(level.rows()) * level.lambda.stride() >= kSerialFloats;
}

/// Calls body(chunk) for a range of the level's chunks.
template <typename Body>
void forChunks(const SurfaceLevel& level, Index first, Index last, const Progress& progress, const Body& body) {
  auto checked = [&](Index chunk) {
    progress.check();
    body(chunk);
  };
  if (isParallel(level)) {
    tbb::parallel_for(first, last, checked);
  } else {
    for (Index chunk = first; chunk < last; ++chunk) checked(chunk);
  }
}

template <typename Body>
void forAllChunks(const SurfaceLevel& level, const Progress& progress, const Body& body) {
  forChunks(level, 0, level.sweep.chunks(), progress, body);
}

}  // namespace stormfield
