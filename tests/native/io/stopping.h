// How soon long work stops after it was cancelled.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <thread>

#include "base/error.h"
#include "base/progress.h"

namespace stormfield {

/// Generous for a machine that does much else. The work itself takes longer than this under sanitizers and in long
/// tests, or is cancelled in many places.
constexpr double kSoon = 0.5;

/// Seconds from cancelling at that fraction of work(progress) until it throws Cancelled.
template <typename Work>
double secondsToStop(double fraction, const Work& work) {
  Progress progress;
  auto running = std::async(std::launch::async, [&] { work(progress); });
  while (progress.fraction() < fraction && running.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  const auto start = std::chrono::steady_clock::now();
  progress.cancel();
  EXPECT_THROW(running.get(), Cancelled) << "cancelled at " << fraction;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace stormfield
