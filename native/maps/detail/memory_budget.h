// The memory that a tau map may take.
#pragma once

#include <atomic>
#include <cstddef>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

/// Counts the bytes in use and refuses more than a limit. All members are thread-safe.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t limit) : limit_(limit) {}
  /// Throws InputError beyond the limit.
  void take(std::size_t bytes) {
    const std::size_t now = used_ += bytes;
    std::size_t peak = peak_;
    while (now > peak && !peak_.compare_exchange_weak(peak, now)) {
    }
    if (now > limit_) {
      throw InputError(message("the tau map needs more than ", limit_ >> 20, " MiB; choose a smaller tau"));
    }
  }
  void giveBack(std::size_t bytes) { used_ -= bytes; }
  std::size_t peak() const { return peak_; }

 private:
  std::size_t limit_;
  std::atomic<std::size_t> used_{0}, peak_{0};
};

}  // namespace stormfield
