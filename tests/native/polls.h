// How often long work asks whether it was cancelled, and what it does when it was, counted instead of timed: work that
// asks often enough stops soon on every machine.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "base/error.h"
#include "base/progress.h"

namespace stormfield::test {

/// The polls (Progress::check and ::cancelled) of work that ran to its end.
struct Polls {
  std::int64_t count = 0;
  double longestStep = 0.0;  ///< largest fraction of the whole that was done between two of them
};

/// work(progress), undisturbed.
template <typename Work>
Polls pollsOf(const Work& work) {
  Polls polls;
  Progress progress;
  std::mutex mutex;
  double last = 0.0;
  const auto look = [&] {
    const double now = progress.fraction();
    polls.longestStep = std::max(polls.longestStep, now - last);
    last = now;
  };
  progress.watch([&] {
    const std::lock_guard lock(mutex);
    ++polls.count;
    look();
  });
  work(progress);
  look();
  return polls;
}

/// A progress that is cancelled at its nth poll (counted from 1).
class CancelledAt : public Progress {
 public:
  explicit CancelledAt(std::int64_t poll) {
    watch([this, poll] {
      if (++polls_ == poll) cancel();
    });
  }

 private:
  std::atomic<std::int64_t> polls_{0};
};

/// Work that ends with Cancelled wherever it is cancelled, and never does more than `longestStep` of the whole (and at
/// least `count` polls in all) between two polls.
template <typename Work>
void expectStopsSoon(const Work& work, std::int64_t count, double longestStep) {
  const Polls polls = pollsOf(work);
  EXPECT_GE(polls.count, count);
  EXPECT_LE(polls.longestStep, longestStep);
  for (const double fraction : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9}) {
    CancelledAt progress(1 + static_cast<std::int64_t>(fraction * static_cast<double>(polls.count)));
    EXPECT_THROW(work(progress), Cancelled) << "cancelled at " << fraction << " of " << polls.count << " polls";
  }
}

}  // namespace stormfield::test
