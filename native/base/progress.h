// Progress and cancellation of long work, shared between a worker and the thread that watches it.
//
// Functions that also run unwatched take a Progress* with the default nullptr; those that always run as jobs (solves,
// Morse sets, tracking) a reference.
#pragma once

#include <atomic>
#include <functional>
#include <utility>

#include "base/error.h"

namespace stormfield {

/// Written by the worker (report, check), read and cancelled by the watcher. All members are thread-safe.
class Progress {
 public:
  /// Done so far, 0..1 of the current range.
  void report(double fraction) noexcept {
    fraction_.store(from_ + fraction * (to_ - from_), std::memory_order_relaxed);
  }
  /// What follows is the subrange from..to of the whole; called by the worker between its phases, while nothing
  /// reports.
  void range(double from, double to) noexcept {
    from_ = from;
    to_ = to;
    report(0.0);
  }
  double fraction() const noexcept { return fraction_.load(std::memory_order_relaxed); }

  void cancel() noexcept { state_.fetch_or(kCancelled, std::memory_order_relaxed); }
  bool cancelled() const noexcept {
    const int state = state_.load(std::memory_order_relaxed);
    if (state == 0) return false;
    if ((state & kWatched) == 0) return true;
    onPoll_();
    return (state_.load(std::memory_order_relaxed) & kCancelled) != 0;
  }

  /// Throws Cancelled once cancel() was called. Long loops call it often enough to stop within 0.1 s.
  void check() const {
    if (cancelled()) throw Cancelled();
  }

  /// Called at every check() and cancelled() from now on, by whichever thread asks: tests count them, and cancel at one
  /// of them. Set before the work begins.
  void watch(std::function<void()> onPoll) {
    onPoll_ = std::move(onPoll);
    state_.fetch_or(kWatched, std::memory_order_relaxed);
  }

 private:
  static constexpr int kCancelled = 1, kWatched = 2;

  std::atomic<double> fraction_{0.0};
  std::atomic<int> state_{0};
  std::function<void()> onPoll_;
  double from_ = 0.0, to_ = 1.0;
};

}  // namespace stormfield
