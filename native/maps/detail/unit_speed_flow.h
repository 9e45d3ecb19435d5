// The flow of a field at unit speed, for the integrator: V / sqrt(|V|^2 + e^2), whose time is arc length (thesis 7.2).
//
// Its trajectories are those of V, so that its Morse decompositions are Morse decompositions of V. The slow speed e, a
// small fraction of the mean speed nearby, keeps the flow continuous at fixed points, which it approaches but never
// crosses.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tracing/flow.h"

namespace stormfield {

/// The slow speed e of each vertex, mesh units per second: a fraction of the mean speed around the vertex, so that it
/// does not vanish at a zero vector. Positive where the field is not zero all around.
std::vector<double> slowSpeeds(const VectorField& field);

class UnitSpeedFlow {
 public:
  static constexpr bool kSteady = true;
  using Cursor = SteadyFlow::Cursor;
  struct Local {
    CarriedVectors vectors;
    std::array<double, 3> slow;
  };

  UnitSpeedFlow(const Complex* values, const double* slowSpeeds, double rate)
      : flow_(values, 1.0), slow_(slowSpeeds), rate_(rate) {}

  Cursor start(double) const { return {}; }
  double remaining(Cursor, double) const { return std::numeric_limits<double>::infinity(); }
  double segmentDuration(Cursor) const { return std::numeric_limits<double>::infinity(); }
  void advance(Cursor&) const {}

  Local enter(const FlatFace& face, Cursor cursor) const {
    return {flow_.enter(face, cursor), {slow_[face.vertex(0)], slow_[face.vertex(1)], slow_[face.vertex(2)]}};
  }
  Complex velocity(const FlatFace& face, const Local& u, Cursor, Complex p, double) const {
    const Eigen::Vector3d b = face.barycentric(p);
    return unit(face.evaluate(u.vectors, p), b[0] * u.slow[0] + b[1] * u.slow[1] + b[2] * u.slow[2]);
  }
  Complex vertexVelocity(Index v, Cursor cursor, double time) const {
    return unit(flow_.vertexVelocity(v, cursor, time), slow_[v]);
  }

 private:
  Complex unit(Complex v, double slow) const {
    const double squared = std::norm(v) + slow * slow;
    return squared > 0.0 ? rate_ / std::sqrt(squared) * v : 0.0;
  }

  SteadyFlow flow_;
  const double* slow_;
  double rate_;
};

}  // namespace stormfield
