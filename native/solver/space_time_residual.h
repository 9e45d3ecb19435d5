// The residual of the space-time system in double precision, and the change between the two layouts of a field: the
// caller's [sample][vertex] in double precision, and the solver's [row][sample] in single precision.
#pragma once

#include "solver/constraint_rows.h"

namespace stormfield {

class SpaceTimeResidual {
 public:
  /// vertex: mesh vertex of each row; active: 0 for rows of components without constraint, which stay zero.
  SpaceTimeResidual(const SurfaceHierarchy& hierarchy, double lambdaCoupling, std::vector<Index> vertex,
                    Index meshVertices);

  const std::vector<Index>& rowOf() const { return rowOf_; }
  const std::vector<Index>& vertexOf() const { return vertex_; }

  struct Field {
    const Complex* base = nullptr;      ///< [sample][vertex], zero when null
    const float* correction = nullptr;  ///< [row][sample], zero when null
    double scale = 1.0;                 ///< of the correction
  };
  /// Length of b - A x for x = base + scale * correction, with hard values put in their places and zero in rows that
  /// are not active. Writes x (field, [sample][vertex], not the array that is read) and the residual divided by
  /// residualScale (rows, [row][sample]) where these are given.
  double evaluate(const ConstraintRows& constraints, const std::vector<char>& active, const Field& x, Complex* field,
                  float* residual, double residualScale, const Progress& progress) const;
  /// correction = field / scale, rounded to single precision.
  void toRows(const Complex* field, double scale, float* correction, const Progress& progress) const;
  /// base += scale * correction in place.
  void add(const float* correction, double scale, Complex* base, const Progress& progress) const;

 private:
  /// Rows of the chunk, then those outside that they are coupled to.
  std::vector<Index> localRows(Index chunk) const;

  const SurfaceHierarchy& hierarchy_;
  double lambdaCoupling_;
  std::vector<Index> vertex_, rowOf_;
  /// Per chunk: rows outside it that its rows are coupled to; local column of every coupling (chunk rows first).
  std::vector<std::size_t> haloStart_;
  std::vector<Index> halo_, localColumn_;
};

}  // namespace stormfield
