// Fixed points of an instantaneous field: where it is zero, and what the flow does there (thesis 2.2.1, 2.2.3).
#pragma once

#include <array>
#include <vector>

#include "field/interpolation.h"
#include "mesh/surface_point.h"

namespace stormfield {

enum class FixedPointKind { Source, Sink, Saddle, Center, Degenerate };

/// Lower-case word used in files and messages.
const char* name(FixedPointKind kind);

/// Where a trajectory leaves or enters a fixed point between two hyperbolic sectors. At an ordinary saddle these are
/// the two directions of each eigenvector.
struct SeparatrixDirection {
  Index face = kNone;  ///< into which it leads
  Complex direction;   ///< unit vector in the flat frame of that face
  Vec3 inSpace = Vec3::Zero();
  bool outgoing = true;
};

struct FixedPoint {
  SurfacePoint point;
  Vec3 position = Vec3::Zero();
  int index = 0;  ///< Poincare index
  FixedPointKind kind = FixedPointKind::Degenerate;
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();  ///< in the face's flat frame, 1/s
  double rotation = 0.0;  ///< curl at the point, 1/s: > 0 turns counter-clockwise seen from outside
  /// Of the Jacobian, 1/s: by falling real part, or a conjugate pair with the positive imaginary part first.
  std::array<Complex, 2> eigenvalues{};
  /// Unit vectors in space, zero where the eigenvalues are not real.
  std::array<Vec3, 2> eigenvectors{Vec3::Zero(), Vec3::Zero()};
  /// Of points with a negative index, counter-clockwise; alternately outgoing and incoming.
  std::vector<SeparatrixDirection> separatrices;
};

struct FixedPointOptions {
  /// |trace| below this part of the rotation speed counts as a center, |det| below it (squared) as degenerate.
  double relativeTolerance = 1e-3;
};

/// Kind of a zero with this Poincare index: see relativeTolerance.
FixedPointKind classify(const Eigen::Matrix2d& jacobian, int index, double relativeTolerance);

/// One for each face with a Poincare index other than zero, in face order; faces that share the zero of a vertex report
/// it once. The sum of the indices is the Euler characteristic on a closed mesh. Zeros whose indices cancel within one
/// face (strongly curved, coarse meshes only: a linear blend has at most one) are not reported. Faces are searched in
/// parallel; the result does not depend on the thread count.
std::vector<FixedPoint> findFixedPoints(const VectorField& field, const FixedPointOptions& options = {});

}  // namespace stormfield
