// How processor time grows with the size of a problem: e between two sizes where time goes as size^e.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

namespace stormfield {

/// Processor time of all threads, in seconds, the shortest of some runs.
template <typename Work>
double processorTime(int runs, const Work& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const std::clock_t began = std::clock();
    work();
    best = std::min(best, static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
  }
  return best;
}

class Growth {
 public:
  void add(double size, double amount) { points_.push_back({size, amount}); }

  /// One counter for each step from a size to the next: the exponent.
  void report(benchmark::State& state, const std::string& name) const {
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const Point &a = points_[i - 1], &b = points_[i];
      state.counters[name + ", " + thousands(a.size) + " to " + thousands(b.size)] =
          std::log(b.amount / a.amount) / std::log(b.size / a.size);
    }
  }

 private:
  struct Point {
    double size, amount;
  };
  static std::string thousands(double size) { return std::to_string(std::lround(1e-3 * size)) + "k"; }

  std::vector<Point> points_;
};

}  // namespace stormfield
