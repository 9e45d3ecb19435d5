// A limit of wall time for work that reports its progress.
//
//   const Deadline deadline(2.5, &progress);
//   work(deadline.progress());      // throws Cancelled after 2.5 s, or when progress is cancelled
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <thread>

#include "base/progress.h"

namespace stormfield {

/// Cancels work when its seconds are over, or when the caller's progress is cancelled, to which it reports what is
/// done.
class Deadline {
 public:
  Deadline(double maxSeconds, Progress* caller) : caller_(caller) {
    if (maxSeconds == std::numeric_limits<double>::infinity()) return;
    end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                              std::chrono::duration<double>(std::clamp(maxSeconds, 0.0, kMaxSeconds)));
    watched_ = std::make_unique<Progress>();
    watcher_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        if (isOver() || (caller_ != nullptr && caller_->cancelled())) watched_->cancel();
        if (caller_ != nullptr) caller_->report(watched_->fraction());
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
  }

  Progress* progress() const { return watched_ != nullptr ? watched_.get() : caller_; }
  bool isOver() const { return watched_ != nullptr && Clock::now() >= end_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kMaxSeconds = 1e9;

  Progress* caller_;
  Clock::time_point end_{};
  std::unique_ptr<Progress> watched_;
  std::jthread watcher_;
};

}  // namespace stormfield
