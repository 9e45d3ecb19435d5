// Where fixed points cross from face to face while lambda grows (thesis 11.2.2; Tricoche et al. 2002;
// docs/architecture.md, decision 3).
//
// On an edge the field blends its two carried end vectors, p from the tail and q from the head, both linear in lambda
// between two samples. It is zero somewhere on the edge where p and q are opposed: cross(p, q) = 0, a quadratic in
// lambda, and dot(p, q) < 0. There the rotation along the edge jumps by 2 pi, and a unit of Poincare index changes
// sides.
//
// Round-off does not decide how many crossings an edge has. The rotations along the edge at both samples, and the
// rotation of each vertex vector between them, give the signed number as an integer, so that the indices before and
// after always fit, whatever the values; the roots say only when and where.
#pragma once

#include <vector>

#include "base/progress.h"
#include "field/parameterized_field.h"

namespace stormfield {

struct ZeroCrossing {
  double lambda = 0.0;
  double along = 0.0;  ///< fraction of the edge: 0 at the tail of its canonical halfedge, 1 at the head
  Index edge = kNone;
  /// What the index of the face of the canonical halfedge grows by, +1 or -1; that of the other face shrinks by it.
  int charge = 0;
};

/// All crossings of all edges, by lambda and then by edge; 24 bytes each. Parallel over lambda and edges; the result
/// does not depend on the thread count. Zero vectors count as infinitesimal ones along the x axis of their chart,
/// opposed ones rotate by +pi along the canonical halfedge (see field/poincare_index.h). Throws Cancelled.
std::vector<ZeroCrossing> zeroCrossings(const ParameterizedField& field, Progress& progress);

/// Poincare index of every face at the first sample, by the same rotations.
std::vector<int> firstIndices(const ParameterizedField& field);

}  // namespace stormfield
