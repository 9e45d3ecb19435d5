// The space-time system in double precision: its right-hand side, the residual of a field, and the change between the
// two layouts of a field: the caller's [sample][vertex] in double precision, and the solver's [row][sample] in single
// precision, divided by a scale.
#pragma once

#include "base/progress.h"
#include "solver/detail/constraint_rows.h"

namespace stormfield {

class SpaceTimeResidual {
 public:
  /// vertex: mesh vertex of each row.
  SpaceTimeResidual(const SurfaceHierarchy& hierarchy, double lambdaCoupling, std::vector<Index> vertex,
                    Index meshVertices);

  const std::vector<Index>& rowOf() const { return rowOf_; }
  const std::vector<Index>& vertexOf() const { return vertex_; }

  /// Length of the right-hand side: of b - A x where x holds the hard values and zeros.
  double rightSide(const ConstraintRows& constraints, const Progress& progress) const;
  /// b - A x for the field x (zeros where null), in which the hard values are in their places: its squared length per
  /// chunk. residual gets it in rows, divided by scale.
  std::vector<double> evaluate(const ConstraintRows& constraints, const Complex* field, float* residual, double scale,
                               const Progress& progress) const;

  /// rows = field / scale, rounded.
  void toRows(const Complex* field, double scale, float* rows, const Progress& progress) const;
  /// field = scale * rows, with the exact hard values, and zeros at vertices without a row.
  void toField(const ConstraintRows& constraints, const float* rows, double scale, Complex* field,
               const Progress& progress) const;
  /// field += scale * rows.
  void add(const float* rows, double scale, Complex* field, const Progress& progress) const;

 private:
  /// Rows of the chunk, then those outside that they are coupled to.
  std::vector<Index> localRows(Index chunk) const;
  Index samples() const { return hierarchy_.levels.front().lambda.samples(); }
  std::size_t stride() const { return hierarchy_.levels.front().lambda.stride(); }
  template <typename Body>
  void forValues(const Progress& progress, const Body& body) const;

  const SurfaceHierarchy& hierarchy_;
  double lambdaCoupling_;
  std::vector<Index> vertex_, rowOf_;
  /// Per chunk: rows outside it that its rows are coupled to; local column of every coupling (chunk rows first).
  std::vector<std::size_t> haloStart_;
  std::vector<Index> halo_, localColumn_;
};

}  // namespace stormfield
