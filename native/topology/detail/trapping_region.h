// A neighbourhood of a sink or source that no trajectory leaves: a streamline that enters it has found its limit set.
//
// Inside a face the field around the point is linear but for the curvature. With J its Jacobian, the Lyapunov equation
// J'M + MJ = -1 gives a quadratic form that falls along all trajectories of the linear field (Lyapunov 1892; Khalil
// 2002, chapter 4), so that they enter its ellipses. The largest ellipse that fits into the face is taken, and shrunk
// until the field itself crosses it inwards at 32 samples. Points on edges and at vertices, and degenerate ones, get
// small disks in all faces around them, which are not tested.
//
//   const TrappingRegion region = trappingRegion(field, fixedPoint);
//   const bool trapped = region.forward && region.ellipses.front().contains(p);
#pragma once

#include <vector>

#include "field/vector_field.h"
#include "topology/entities.h"

namespace stormfield {

/// In one face: (p - centre)' metric (p - centre) <= 1, in the face's flat frame.
struct TrappingEllipse {
  Index face = kNone;
  Complex centre;
  Eigen::Matrix2d metric = Eigen::Matrix2d::Zero();

  bool contains(Complex p) const {
    const Eigen::Vector2d d(p.real() - centre.real(), p.imag() - centre.imag());
    return d.dot(metric * d) <= 1.0;
  }
};

struct TrappingRegion {
  bool forward = false, backward = false;  ///< which streamlines end here: those with, those against the flow
  std::vector<TrappingEllipse> ellipses;   ///< one per face
  SurfacePoint seed = {};                  ///< near the point, on a streamline that comes from there or goes there
};

/// Empty for a fixed point of negative index. Around a center no trajectory leaves the largest ellipse of the linear
/// field, and the seed is where streamlines around it first leave the face; a weak focus that counts as a center keeps
/// what enters the ellipse.
TrappingRegion trappingRegion(const VectorField& field, const FixedPoint& p);

}  // namespace stormfield
