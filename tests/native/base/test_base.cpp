#include <gtest/gtest.h>

#include <thread>

#include "base/message.h"
#include "base/progress.h"
#include "checks.h"

namespace stormfield {
namespace {

TEST(Progress, ReportsAndCancelsAcrossThreads) {
  Progress progress;
  EXPECT_EQ(progress.fraction(), 0.0);
  EXPECT_NO_THROW(progress.check());
  bool stopped = false;
  std::thread worker([&] {
    progress.report(0.25);
    try {
      for (;;) progress.check();
    } catch (const Cancelled&) {
      stopped = true;
    }
  });
  while (progress.fraction() < 0.25) std::this_thread::yield();
  progress.cancel();
  worker.join();
  EXPECT_TRUE(stopped);
  EXPECT_TRUE(progress.cancelled());
}

TEST(Message, JoinsItsParts) {
  EXPECT_EQ(message("vertex ", 3, " of ", 2.5), "vertex 3 of 2.5");
}

TEST(Error, MeshFaultsAreInputFaults) {
  EXPECT_THROW(throw MeshError("x"), InputError);
}

}  // namespace
}  // namespace stormfield
