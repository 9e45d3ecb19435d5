#include "solver/space_time_solver.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "base/message.h"
#include "solver/connection_laplacian.h"
#include "solver/detail/chunk_loop.h"
#include "solver/detail/krylov.h"
#include "solver/detail/space_time_residual.h"

namespace stormfield {
namespace {

/// One run in single precision gains at most about this; what is left goes through the residual in double precision.
constexpr double kSinglePrecisionGain = 1e-5;
/// What single precision can tell of a field's error.
constexpr double kBestAccuracy = 1e-5;
/// Room for the difference between the residual that is carried along and the true one.
constexpr double kSafety = 0.99;

/// The power of two below a positive length: dividing by it loses nothing.
double scaleOf(double length) {
  return std::exp2(std::ilogb(length));
}

/// Sum of the absolute values, or something that is not finite.
double sumOfValues(const FieldValues& values) {
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, values.size(), 1 << 15), 0.0,
      [&](const auto& range, double sum) {
        for (std::size_t k = range.begin(); k != range.end(); ++k) {
          sum += std::abs(values[k].real()) + std::abs(values[k].imag());
        }
        return sum;
      },
      std::plus<>());
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

struct SpaceTimeState::Data {
  explicit Data(std::shared_ptr<const SpaceTimeSolver::System> of)
      : system(std::move(of)), multigrid(system->hierarchy), vectors(system->floats()) {}

  std::shared_ptr<const SpaceTimeSolver::System> system;
  ConstraintRows rows;
  bool residualKnown = false;  ///< vectors.r is the residual of vectors.x under rows
  bool solved = false;         ///< vectors.x is the solution under rows
  double error = 0.0;          ///< estimated, of it
  Multigrid multigrid;
  KrylovVectors vectors;
  double scale = 0.0;  ///< the solution is scale * vectors.x; 0: there is none
};

SpaceTimeState::SpaceTimeState() = default;
SpaceTimeState::~SpaceTimeState() = default;
SpaceTimeState::SpaceTimeState(SpaceTimeState&&) noexcept = default;
SpaceTimeState& SpaceTimeState::operator=(SpaceTimeState&&) noexcept = default;

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
  if (!(options_.accuracy >= kBestAccuracy)) {
    throw InputError(message("the accuracy must be at least ", kBestAccuracy, ", not ", options_.accuracy,
                             ": for more, lower the tolerance"));
  }
  if (options_.maxIterations < 1) throw InputError("the solver needs at least one iteration");
  system_ = std::make_shared<const System>(connectionLaplacian(*charts_), options_.samples, lambdaCoupling(options_),
                                           charts_->mesh().vertexCount(), progress);
}

SpaceTimeState SpaceTimeSolver::startFrom(const ParameterizedField& field) const {
  const std::size_t vertices = static_cast<std::size_t>(charts_->mesh().vertexCount());
  if (field.sampleCount() != options_.samples || field.values.size() != vertices * options_.samples) {
    throw InputError(message("a warm start must have ", options_.samples, " samples of lambda and ", vertices,
                             " vertices: solve without it"));
  }
  const double sum = sumOfValues(field.values);
  if (!std::isfinite(sum)) throw InputError("the warm start has values that are not finite: solve without it");
  SpaceTimeState state;
  if (sum == 0.0) return state;
  state.data_ = std::make_unique<SpaceTimeState::Data>(system_);
  state.data_->scale = scaleOf(sum / static_cast<double>(field.values.size()));
  system_->residual.toRows(field.values.data(), state.data_->scale, state.data_->vectors.x.data(), Progress());
  return state;
}

/// The steps of one solve.
class SpaceTimeSolver::Solve {
 public:
  Solve(const SpaceTimeSolver& solver, SpaceTimeState::Data& state, Progress& progress)
      : charts_(solver.charts_),
        options_(solver.options_),
        residual_(solver.system_->residual),
        mass_(solver.system_->hierarchy.matrix.mass),
        state_(state),
        operator_(state.multigrid.finest(), mass_, state.rows),
        progress_(progress) {}

  SpaceTimeResult run(const ConstraintSet& constraints) {
    progress_.report(0.0);
    ConstraintRows rows = constraintRows(constraints, residual_.rowOf(), mass_, options_.samples);
    findComponents(constraints);
    std::swap(state_.rows, rows);
    if (std::exchange(state_.residualKnown, false)) before_ = &rows;
    const bool solved = std::exchange(state_.solved, false) && sameConstraints(rows);
    rightSide_ = residual_.rightSide(state_.rows, progress_);
    if (rightSide_ == 0.0) {
      // All constraints are zero, and so is the field.
      state_.scale = 0.0;
      allocateField();
      std::fill(result_.field.values.begin(), result_.field.values.end(), Complex());
    } else {
      state_.multigrid.constrain(state_.rows, progress_);
      Squares first = start();
      rows = {};
      inSinglePrecision(std::move(first), solved);
      if (result_.residual > options_.tolerance) inDoublePrecision();
      state_.solved = true;
    }
    progress_.report(1.0);
    return std::move(result_);
  }

 private:
  /// Finds the components that stay zero.
  void findComponents(const ConstraintSet& constraints) {
    const TriangleMesh& mesh = charts_->mesh();
    constrained_.assign(mesh.componentCount(), 0);
    for (const Index v : constraints.vertex) {
      if (mesh.component(v) != kNone) constrained_[mesh.component(v)] = 1;
    }
    for (Index c = 0; c < mesh.componentCount(); ++c) {
      if (!constrained_[c]) result_.componentsWithoutConstraint.push_back(c);
    }
    if (static_cast<Index>(result_.componentsWithoutConstraint.size()) == mesh.componentCount()) {
      throw InputError("no constraint lies on the surface, only on loose vertices: move an element onto a face");
    }
  }
  void allocateField() {
    result_.field.charts = charts_;
    result_.field.lambdas = evenLambdas(options_.samples);
    result_.field.values = FieldValues(static_cast<std::size_t>(options_.samples) * charts_->mesh().vertexCount(),
                                       std::exchange(state_.vectors.work, {}));
  }

  /// Puts hard values and the zeros of components without constraint in their places; whether there are any.
  bool enforce() {
    if (!state_.rows.anyHard && result_.componentsWithoutConstraint.empty()) return false;
    const std::size_t stride = state_.multigrid.finest().lambda.stride();
    for (Index row = 0; row < static_cast<Index>(mass_.size()); ++row) {
      float* own = state_.vectors.x.data() + row * stride;
      if (!constrained_[charts_->mesh().component(residual_.vertexOf()[row])]) std::fill(own, own + stride, 0.0f);
      for (const auto* e = state_.rows.begin(row); e != state_.rows.end(row); ++e) {
        if (!e->hard()) continue;
        own[2 * e->sample] = static_cast<float>(e->pull.real() / state_.scale);
        own[2 * e->sample + 1] = static_cast<float>(e->pull.imag() / state_.scale);
      }
    }
    return true;
  }

  using Squares = std::vector<double>;  ///< of a residual, per chunk
  Squares residual(const ConstraintRows* before = nullptr) const {
    return operator_.residual(state_.vectors.x.data(), state_.scale, state_.vectors.r.data(), before, progress_);
  }

  /// The first residual: of the state's solution, or of zero where that is no worse.
  Squares start() {
    if (state_.scale > 0.0) {
      // Only new constraints change the residual, if nothing is put in its place.
      const bool sameSolution = !enforce();
      Squares squares = residual(sameSolution ? before_ : nullptr);
      if (lengthOf(squares) * state_.scale < rightSide_) return squares;
    }
    state_.scale = scaleOf(rightSide_);
    std::fill(state_.vectors.x.data(), state_.vectors.x.data() + state_.vectors.x.size(), 0.0f);
    enforce();
    return residual();
  }

  /// Returns the estimated error.
  double iterate(Squares squares, double residual, double error) {
    const KrylovGoal goal{residual, error, options_.maxIterations - result_.iterations};
    const KrylovOutcome outcome =
        krylovSolve(state_.multigrid, operator_, state_.vectors, std::move(squares), goal, progress_);
    result_.iterations += outcome.steps;
    return outcome.error;
  }
  bool sameConstraints(const ConstraintRows& before) const {
    for (Index row = 0; row < static_cast<Index>(mass_.size()); ++row) {
      if (!state_.rows.sameRow(row, before)) return false;
    }
    return true;
  }

  /// A start that was not solved for needs a step even where its residual is small: its error is not known.
  void inSinglePrecision(Squares squares, bool solved) {
    const double unit = rightSide_ / state_.scale;
    double length = lengthOf(squares);
    if (length > options_.tolerance * unit || (length > 0.0 && !solved)) {
      const double target = std::max(kSafety * options_.tolerance * unit, kSinglePrecisionGain * length);
      state_.error = iterate(std::move(squares), target, options_.accuracy);
      if (!(state_.error <= options_.accuracy)) {
        throw SolverError(message("after ", result_.iterations, " iterations the field is still ", state_.error,
                                  " of its length from the solution: raise the accuracy or the smallest weights"));
      }
      length = lengthOf(residual());
    } else if (length == 0.0) {
      state_.error = 0.0;
    }
    result_.error = state_.error;
    state_.residualKnown = true;
    result_.residual = length / unit;
    allocateField();
    residual_.toField(state_.rows, state_.vectors.x.data(), state_.scale, result_.field.values.data(), progress_);
  }

  /// Iterative refinement: what is left is solved for anew, from the residual in double precision.
  void inDoublePrecision() {
    KrylovVectors& v = state_.vectors;
    Complex* field = result_.field.values.data();
    double scale = rightSide_ * result_.residual;
    double before = std::numeric_limits<double>::infinity();
    const double solutionScale = std::exchange(state_.scale, 0.0);
    state_.residualKnown = false;
    while (true) {
      Squares squares = residual_.evaluate(state_.rows, field, v.r.data(), scale, progress_);
      result_.residual = lengthOf(squares) / rightSide_;
      if (result_.residual <= options_.tolerance) break;
      if (!(result_.residual <= 0.5 * before) || result_.iterations >= options_.maxIterations) {
        throw SolverError(message("the solver stopped at the relative residual ", result_.residual, " after ",
                                  result_.iterations, " iterations, above the tolerance ", options_.tolerance,
                                  ": raise the tolerance or the smallest weights"));
      }
      before = result_.residual;
      const double unit = rightSide_ / scale;
      for (double& square : squares) square /= scale * scale;
      std::fill(v.x.data(), v.x.data() + v.x.size(), 0.0f);
      iterate(std::move(squares), std::max(kSafety * options_.tolerance, kSinglePrecisionGain * before) * unit,
              std::numeric_limits<double>::infinity());
      residual_.add(v.x.data(), scale, field, progress_);
      scale = rightSide_ * std::max(kSinglePrecisionGain * before, 1e-300);
    }
    v.work = {};
    residual_.toRows(field, solutionScale, v.x.data(), progress_);
    state_.scale = solutionScale;
  }

  const std::shared_ptr<const VertexCharts>& charts_;
  const SpaceTimeOptions& options_;
  const SpaceTimeResidual& residual_;
  const std::vector<double>& mass_;  ///< of the rows
  SpaceTimeState::Data& state_;
  SpaceTimeOperator operator_;
  Progress& progress_;
  std::vector<char> constrained_;           ///< per component
  const ConstraintRows* before_ = nullptr;  ///< the constraints that the state's residual belongs to
  double rightSide_ = 0.0;
  SpaceTimeResult result_;
};

SpaceTimeResult SpaceTimeSolver::solve(const ConstraintSet& constraints, Progress& progress,
                                       SpaceTimeState& state) const {
  if (!state.data_) state.data_ = std::make_unique<SpaceTimeState::Data>(system_);
  if (state.data_->system != system_) throw InputError("the state to start from belongs to another solver");
  return Solve(*this, *state.data_, progress).run(constraints);
}

SpaceTimeResult SpaceTimeSolver::solve(const ConstraintSet& constraints, Progress& progress) const {
  SpaceTimeState state;
  return solve(constraints, progress, state);
}

}  // namespace stormfield
