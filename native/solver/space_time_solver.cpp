#include "solver/space_time_solver.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "base/message.h"
#include "solver/connection_laplacian.h"
#include "solver/krylov.h"
#include "solver/space_time_residual.h"

namespace stormfield {
namespace {

/// One run in single precision gains at most about this; what is left goes through the residual in double precision.
constexpr double kSinglePrecisionGain = 1e-5;
/// From this tolerance on a warm start may be rounded to single precision.
constexpr double kRoundedTolerance = 1e-5;
/// Room for the difference between the residual that is carried along and the true one.
constexpr double kSafety = 0.99;

std::vector<double> uniformLambdas(Index samples) {
  std::vector<double> lambdas(samples, 0.0);
  for (Index j = 1; j < samples; ++j) lambdas[j] = static_cast<double>(j) / (samples - 1);
  return lambdas;
}

void checkWarmStart(const ParameterizedField& field, Index samples, Index vertices) {
  if (field.sampleCount() != samples || field.values.size() != static_cast<std::size_t>(samples) * vertices) {
    throw InputError(message("a warm start must have ", samples, " samples of lambda and ", vertices,
                             " vertices: solve without it"));
  }
  const bool finite = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, field.values.size(), 1 << 15), true,
      [&](const auto& range, bool before) {
        // Not a number and infinities stay what they are in a sum of absolute values times zero.
        double sum = 0.0;
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
          sum += 0.0 * field.values[k].real() + 0.0 * field.values[k].imag();
        }
        return before && sum == 0.0;
      },
      std::logical_and<>());
  if (!finite) throw InputError("the warm start has values that are not finite: solve without it");
}

}  // namespace

struct SpaceTimeSolver::System {
  SurfaceHierarchy hierarchy;
  SpaceTimeResidual residual;

  static std::vector<Index> reordered(const std::vector<Index>& vertex, const std::vector<Index>& order) {
    std::vector<Index> result;
    result.reserve(order.size());
    for (const Index i : order) result.push_back(vertex[i]);
    return result;
  }
  System(const ConnectionLaplacian& laplacian, Index samples, double lambdaCoupling, Index meshVertices,
         const Progress& progress)
      : hierarchy(surfaceHierarchy(laplacian.matrix, samples, lambdaCoupling, progress)),
        residual(hierarchy, lambdaCoupling, reordered(laplacian.vertex, hierarchy.finest.order), meshVertices) {}

  std::size_t floats() const {
    return static_cast<std::size_t>(hierarchy.matrix.rows()) * hierarchy.levels.front().lambda.stride();
  }
};

double SpaceTimeSolver::lambdaCoupling(const SpaceTimeOptions& options) {
  const double perSample = 64.0 * (options.samples - 1) / 99.0;
  return 4.0 * options.lambdaWeight * perSample * perSample;
}

SpaceTimeSolver::SpaceTimeSolver(std::shared_ptr<const VertexCharts> charts, SpaceTimeOptions options,
                                 const Progress& progress)
    : charts_(std::move(charts)), options_(options) {
  if (options_.samples < 1) throw InputError(message("samples must be at least 1, not ", options_.samples));
  if (!(options_.lambdaWeight > 0.0) || !std::isfinite(options_.lambdaWeight)) {
    throw InputError(message("the lambda weight must be above zero, not ", options_.lambdaWeight));
  }
  if (!(options_.tolerance > 0.0) || options_.tolerance >= 1.0) {
    throw InputError(message("the tolerance must be between 0 and 1, not ", options_.tolerance));
  }
  if (options_.maxIterations < 1) throw InputError("the solver needs at least one iteration");
  system_ = std::make_unique<System>(connectionLaplacian(*charts_), options_.samples, lambdaCoupling(options_),
                                     charts_->mesh().vertexCount(), progress);
}

SpaceTimeSolver::~SpaceTimeSolver() = default;
SpaceTimeSolver::SpaceTimeSolver(SpaceTimeSolver&&) noexcept = default;

SpaceTimeResult SpaceTimeSolver::solve(const ConstraintSet& constraints, Progress& progress,
                                       const ParameterizedField* warmStart) const {
  const System& system = *system_;
  const TriangleMesh& mesh = charts_->mesh();
  const Index samples = options_.samples;
  if (warmStart) checkWarmStart(*warmStart, samples, mesh.vertexCount());
  progress.report(0.0);
  const ConstraintRows rows =
      constraintRows(constraints, system.residual.rowOf(), system.hierarchy.matrix.mass, samples);

  SpaceTimeResult result;
  result.field.charts = charts_;
  result.field.lambdas = uniformLambdas(samples);
  std::vector<char> constrained(mesh.componentCount(), 0);
  for (const Index v : constraints.vertex) {
    if (mesh.component(v) != kNone) constrained[mesh.component(v)] = 1;
  }
  for (Index c = 0; c < mesh.componentCount(); ++c) {
    if (!constrained[c]) result.componentsWithoutConstraint.push_back(c);
  }
  if (static_cast<Index>(result.componentsWithoutConstraint.size()) == mesh.componentCount()) {
    throw InputError("no constraint lies on the surface, only on loose vertices: move an element onto a face");
  }
  std::vector<char> active;
  for (const Index v : system.residual.vertexOf()) active.push_back(constrained[mesh.component(v)]);

  SpaceTimeResidual::Field x;
  const double rightSide = system.residual.evaluate(rows, active, x, nullptr, nullptr, 1.0, progress);
  auto allocateField = [&] { result.field.values.resize(static_cast<std::size_t>(samples) * mesh.vertexCount()); };
  if (rightSide == 0.0) {
    // Every value asked for is zero, and so is the field.
    allocateField();
    return result;
  }

  FieldBuffer r(system.floats());
  FieldBuffer correction;
  double scale = rightSide;
  bool fromZero = true;
  if (warmStart && options_.tolerance >= kRoundedTolerance) {
    // Rounded to single precision the start is as good, and needs no second look at the caller's array.
    correction = FieldBuffer(system.floats());
    system.residual.toRows(warmStart->values.data(), scale, correction.data(), progress);
    x.correction = correction.data();
    x.scale = scale;
    fromZero = false;
  } else if (warmStart) {
    x.base = warmStart->values.data();
  }
  result.residual = system.residual.evaluate(rows, active, x, nullptr, r.data(), scale, progress) / rightSide;
  std::unique_ptr<Multigrid> multigrid;
  for (int run = 0; result.residual > options_.tolerance || run == 0; ++run) {
    const double before = result.residual;
    if (before > options_.tolerance) {
      if (!multigrid) multigrid = std::make_unique<Multigrid>(system.hierarchy, rows, progress);
      if (correction.size() == 0) correction = FieldBuffer(system.floats());
      const double unit = rightSide / scale;
      const double target = std::max(kSafety * options_.tolerance, kSinglePrecisionGain * before);
      result.iterations += krylovSolve(*multigrid, r.data(), correction.data(), fromZero, before * unit, target * unit,
                                       options_.maxIterations - result.iterations, progress);
      x.correction = correction.data();
    }
    x.scale = scale;
    if (run == 0) {
      allocateField();
      result.residual =
          system.residual.evaluate(rows, active, x, result.field.values.data(), nullptr, 1.0, progress) / rightSide;
    } else {
      system.residual.add(correction.data(), scale, result.field.values.data(), progress);
    }
    if (run > 0 || result.residual > options_.tolerance) {
      // What is left is solved for anew, from the residual in double precision.
      x = {result.field.values.data(), nullptr, 1.0};
      fromZero = true;
      scale = rightSide * std::max(result.residual, 1e-300);
      result.residual = system.residual.evaluate(rows, active, x, nullptr, r.data(), scale, progress) / rightSide;
    }
    if (result.residual > options_.tolerance &&
        (result.residual > 0.5 * before || result.iterations >= options_.maxIterations)) {
      throw SolverError(message("the solver stopped at the relative residual ", result.residual, " after ",
                                result.iterations, " iterations, above the tolerance ", options_.tolerance,
                                ": raise the tolerance or the smallest weights"));
    }
  }
  progress.report(1.0);
  return result;
}

}  // namespace stormfield
