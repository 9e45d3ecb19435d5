// The field on mesh x lambda that meets the constraints and is as smooth as it can be (thesis 11.1.3.1, eq. 11.3).
//
// V_ij is the vector at vertex i in its chart at lambda_j = j / (samples - 1). The solution minimises
//     sum_j sum_edges w_e |V_head,j - transport V_tail,j|^2  +  sum_i k_i sum_j |V_i,j+1 - V_i,j|^2
//         + sum over soft constraints of weight A_i / A |V_ij - value|^2
// with hard constraints met exactly; boundaries of the surface and the ends of lambda are natural. w_e are the weights
// of connectionLaplacian, A_i the vertex areas and A the whole area (size^2).
//
// The coupling along lambda. Thesis eq. 11.3 weighs both neighbours in lambda with omega = 10 against spatial weights
// that add up to 1. An energy that means the same at any resolution has k_i = c^2 (A_i / A) / dlambda^2. The two
// agree at the thesis's own planar setting, a grid of 65 x 65 vertices on a square and 100 samples, where A_i / A =
// 1 / 64^2, dlambda = 1 / 99 and the spatial weights add up to 4:
//     c^2 = 4 omega 64^2 / 99^2,    k_i = 4 omega (64 (samples - 1) / 99)^2 A_i / A.
//
// How it is solved. The system is Hermitian and positive definite, matrix-free: a sparse matrix on the surface, three
// numbers per vertex for lambda. Its coupling along lambda is up to some 10 times that of an edge on ordinary meshes
// (and far less on fine ones with few samples), so the smoother solves each vertex's whole line of samples exactly,
// Gauss-Seidel over the vertices (line relaxation: Trottenberg, Oosterlee, Schueller 2001, Multigrid, chapter 5). The
// surface is coarsened by classical algebraic multigrid (Ruge, Stueben 1987) with interpolation along the connection;
// lambda is halved along with it where its coupling is strong. One V-cycle preconditions conjugate gradients
// (detail/krylov.h). Arithmetic is float32; below what that reaches, iterative refinement solves for the residual in
// double precision: at a tolerance of 1e-11 fields agree with a direct solve to 1e-8. Cost, memory and measured errors:
// docs/performance.md.
//
// Edits are cheap: the state keeps the solution in the solver's own layout, its residual (rows whose constraints stay
// keep theirs) and the factors of the lines (rows whose weights stay keep theirs); the first cycle's sweeps leave out
// chunks of rows where the residual is small, which is all that lies far from the edit; and the result is written into
// the memory that the iteration worked in. The residual at the end is computed anew, in single precision unless the
// tolerance is out of its reach. The solve stops when both residual and estimated error are small enough.
//
// Constraints at vertices that no face uses have no effect. Throws InputError without constraints and for bad ones
// (constraint_rows.h), SolverError when the tolerance or the accuracy is out of reach, Cancelled.
//
//   const SpaceTimeSolver solver(charts);
//   SpaceTimeState state;
//   const SpaceTimeResult first = solver.solve(constraints, progress, state);
//   const SpaceTimeResult again = solver.solve(movedConstraints, progress, state);
#pragma once

#include <memory>

#include "base/progress.h"
#include "field/parameterized_field.h"
#include "solver/constraint.h"

namespace stormfield {

struct SpaceTimeOptions {
  Index samples = 100;       ///< of lambda in [0, 1]
  double lambdaWeight = 10;  ///< omega of thesis eq. 11.3 at the thesis's setting
  double tolerance = 1e-4;   ///< of the true residual, relative to the right-hand side
  /// Of the field: estimated difference to the exact one (krylov.h), relative, in the mean square; at least 1e-5.
  double accuracy = 5e-3;
  int maxIterations = 200;  ///< of the Krylov method

  bool operator==(const SpaceTimeOptions&) const = default;
};

struct SpaceTimeResult {
  ParameterizedField field;
  int iterations = 0;
  double residual = 0.0;  ///< true relative residual of the field: computed anew, not updated along
  double error = 0.0;     ///< estimated difference to the exact field, relative, in the mean square
  /// Components of the mesh without any constraint: their field is zero.
  std::vector<Index> componentsWithoutConstraint;
};

/// What a solve leaves for the next one of the same solver: its solution, the factors of its lines, and its memory. An
/// empty one starts from zero. After an exception it may be used again.
class SpaceTimeState {
 public:
  SpaceTimeState();
  ~SpaceTimeState();
  SpaceTimeState(SpaceTimeState&&) noexcept;
  SpaceTimeState& operator=(SpaceTimeState&&) noexcept;

 private:
  friend class SpaceTimeSolver;
  struct Data;
  std::unique_ptr<Data> data_;
};

class SpaceTimeSolver {
 public:
  /// Builds the hierarchy, which all solves share. Throws InputError for options out of range.
  explicit SpaceTimeSolver(std::shared_ptr<const VertexCharts> charts, SpaceTimeOptions options = {},
                           const Progress& progress = Progress());

  SpaceTimeResult solve(const ConstraintSet& constraints, Progress& progress) const;
  /// Starts from the solution in the state and leaves its own there: after an edit only the change is solved for.
  SpaceTimeResult solve(const ConstraintSet& constraints, Progress& progress, SpaceTimeState& state) const;

  /// A state whose solution is this field, rounded to single precision. Throws InputError unless it has as many samples
  /// and vertices as the solver, all finite.
  SpaceTimeState startFrom(const ParameterizedField& field) const;

  const SpaceTimeOptions& options() const { return options_; }
  /// k_i / (A_i / A) above.
  static double lambdaCoupling(const SpaceTimeOptions& options);

 private:
  friend class SpaceTimeState;
  struct System;
  class Solve;
  std::shared_ptr<const VertexCharts> charts_;
  SpaceTimeOptions options_;
  std::shared_ptr<const System> system_;
};

}  // namespace stormfield
