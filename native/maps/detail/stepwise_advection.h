// Advection in equal steps, which may end early.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "maps/point_advector.h"

namespace stormfield {

/// Advects points in equal steps, side by side, each as long as `visit` asks for. start(i) is the point i,
/// visit(i, k, image) receives its image after k steps and returns whether to continue. An image that has left the
/// surface stays where it left.
template <typename Start, typename Visit>
class StepwiseAdvection final : public AdvectionQueue {
 public:
  StepwiseAdvection(std::size_t first, std::size_t last, double stepTau, Start start, Visit visit)
      : next_(first), last_(last), stepTau_(stepTau), start_(std::move(start)), visit_(std::move(visit)) {}

  bool next(int lane, AdvectedPoint& from, double& tau) override {
    auto& [image, index, steps] = points_[lane];
    if (steps == 0) {
      if (next_ == last_) return false;
      index = next_++;
      image = {.point = start_(index)};
    }
    from = image;
    tau = stepTau_;
    return true;
  }
  void arrive(int lane, const AdvectedPoint& at) override {
    auto& [image, index, steps] = points_[lane];
    bool continues = visit_(index, ++steps, at);
    while (continues && at.leftSurface) continues = visit_(index, ++steps, at);
    image = at;
    if (!continues) steps = 0;
  }

 private:
  struct Point {
    AdvectedPoint image;
    std::size_t index = 0;
    int steps = 0;
  };
  std::size_t next_, last_;
  double stepTau_;
  Start start_;
  Visit visit_;
  std::array<Point, kMaxLanes> points_;
};

}  // namespace stormfield
