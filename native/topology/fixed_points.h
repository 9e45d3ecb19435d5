// The fixed points of an instantaneous field: where it is zero, their Poincare index and their kind from the Jacobian
// (thesis 2.2.1, 2.2.3; Helman and Hesselink 1989).
//
// Every face whose border the field winds around holds one (field/poincare_index.h); zero_search.h finds where.
//
//   const std::vector<FixedPoint> points = findFixedPoints(field);
#pragma once

#include <vector>

#include "field/vector_field.h"
#include "topology/entities.h"

namespace stormfield {

struct FixedPointOptions {
  /// A fraction: |trace| below this times the rotation speed counts as a center, |det| below its square (relative to
  /// the Jacobian) as degenerate.
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
