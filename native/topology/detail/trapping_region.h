// Where a streamline is as good as in a sink or source: a neighbourhood that it cannot leave again.
//
// Inside a face the field around the point is linear but for the curvature: the Lyapunov equation J'M + MJ = -1 gives
// an ellipse that all flow enters, as large as fits into the face; its border is checked. Points on edges and at
// vertices get small disks in all faces around them.
#pragma once

#include <vector>

#include "topology/fixed_points.h"
#include "tracing/trace.h"

namespace stormfield {

/// In one face: (p - centre)' metric (p - centre) <= 1.
struct BasinPart {
  Index face = kNone;
  Complex centre;
  Eigen::Matrix2d metric = Eigen::Matrix2d::Zero();

  bool contains(Complex p) const {
    const Eigen::Vector2d d(p.real() - centre.real(), p.imag() - centre.imag());
    return d.dot(metric * d) <= 1.0;
  }
};

struct NodeBasin {
  bool forward = false, backward = false;  ///< which streamlines end here
  std::vector<BasinPart> parts;
  SurfacePoint seed;  ///< near the point, on the other streamlines
};

/// Empty for a fixed point of negative index. A center that is a weak focus in truth keeps what comes into its face;
/// the seed of a center is where streamlines around it first leave the face.
NodeBasin nodeBasin(const VectorField& field, const FixedPoint& p);

}  // namespace stormfield
