// Loops over the chunks of a level: in parallel where that is worth it, stopping when cancelled.
#pragma once

#include <tbb/parallel_for.h>

#include "base/progress.h"
#include "solver/detail/surface_hierarchy.h"

namespace stormfield {

/// Levels with less work than this per sweep are not worth other threads.
inline bool isParallel(const SurfaceLevel& level) {
  constexpr std::size_t kSerialFloats = 1 << 15;
  return static_cast<std::size_t>(level.rows()) * level.lambda.stride() >= kSerialFloats;
}

/// Calls body(chunk) for a range of chunks.
template <typename Body>
void forChunks(Index first, Index last, bool parallel, const Progress& progress, const Body& body) {
  auto checked = [&](Index chunk) {
    progress.check();
    body(chunk);
  };
  if (parallel) {
    tbb::parallel_for(first, last, checked);
  } else {
    for (Index chunk = first; chunk < last; ++chunk) checked(chunk);
  }
}

template <typename Body>
void forAllChunks(const SurfaceLevel& level, const Progress& progress, const Body& body) {
  forChunks(0, level.sweep.chunks(), isParallel(level), progress, body);
}

}  // namespace stormfield
