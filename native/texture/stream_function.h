// The stream function of a field: the potential psi whose level curves the flow follows.
//
// psi minimizes the integral of |V - grad psi x n|^2 over the surface (n outwards): the co-exact component of V in the
// Helmholtz-Hodge decomposition V = grad phi + grad psi x n + harmonic, with natural boundary conditions (Polthier,
// Preuss 2003, Identifying Vector Field Singularities Using a Discrete Hodge Decomposition). psi grows to the left of
// the flow: on a sphere, eastward rotation about z has psi proportional to +z. psi has mean zero on every component and
// is linear in V, so it changes continuously with lambda; units are squared mesh units per second.
//
//   const StreamFunctionSolver solver(charts);  // factorizes the cotangent Laplacian once per mesh
//   const std::vector<double> psi = solver.solve(field.values.data());
//
// Several fields are solved for together, since a pass over the factor costs as much as the arithmetic for four of them.
// What a field gives does not depend on those beside it.
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "field/parameterized_field.h"

namespace stormfield {

class StreamFunctionSolver {
 public:
  /// Throws SolverError where the Laplacian cannot be factorized (faces without area in double precision).
  explicit StreamFunctionSolver(std::shared_ptr<const VertexCharts> charts);
  ~StreamFunctionSolver();
  StreamFunctionSolver(StreamFunctionSolver&&) noexcept;

  /// Most fields that are solved for together.
  static constexpr int kTogether = 4;

  /// One value per vertex, from one tangent vector per vertex; 0 at vertices that no face uses.
  std::vector<double> solve(const Complex* values) const;
  /// The same of `count` fields, at most kTogether, that follow each other in memory.
  std::vector<double> solve(const Complex* values, int count) const;

 private:
  struct Factor;
  std::unique_ptr<const Factor> factor_;
};

/// psi of every sample, samples x vertices, in parallel. solver: of the field's surface.
std::vector<double> streamFunctions(const ParameterizedField& field, const StreamFunctionSolver& solver,
                                    Progress* progress = nullptr);

}  // namespace stormfield
