// Long loops in slices, so that cancelling takes effect within one of them.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "base/progress.h"

namespace stormfield {

/// body(begin, end) for slices of at most `size` numbers that together are 0..count, in parallel. Reports the
/// fraction done to `progress` (may be null), and throws Cancelled.
template <typename Body>
void inSlices(std::size_t count, std::size_t size, Progress* progress, const Body& body) {
  std::atomic<std::size_t> done{0};
  // Another partitioner would make longer slices.
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, size),
      [&](const tbb::blocked_range<std::size_t>& slice) {
        if (progress != nullptr) progress->check();
        body(slice.begin(), slice.end());
        done += slice.size();
        if (progress != nullptr) progress->report(static_cast<double>(done) / static_cast<double>(count));
      },
      tbb::simple_partitioner());
}

/// Like values.resize(count, value) on an empty vector: the system's own work for large memory is in slices, too.
template <typename T>
void resizeInSlices(std::vector<T>& values, std::size_t count, const T& value, const Progress* progress) {
  constexpr std::size_t kSlice = (std::size_t{1} << 22) / sizeof(T);
  values.reserve(count);
  while (values.size() < count) {
    if (progress != nullptr) progress->check();
    values.resize(std::min(values.size() + kSlice, count), value);
  }
}

}  // namespace stormfield
