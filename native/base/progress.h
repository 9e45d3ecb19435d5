// Progress and cancellation of long work, shared between a worker and the thread that watches it.
//
// Functions that also run unwatched take a Progress* with the default nullptr; those that always run as jobs (solves,
// Morse sets, tracking) a reference.
#pragma once

#include <atomic>

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

  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

  /// Throws Cancelled once cancel() was called. Long loops call it often enough to stop within 0.1 s.
  void check() const {
    if (cancelled()) throw Cancelled();
  }

 private:
  std::atomic<double> fraction_{0.0};
  std::atomic<bool> cancelled_{false};
  double from_ = 0.0, to_ = 1.0;
};

}  // namespace stormfield
