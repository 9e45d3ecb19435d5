#include "long_tests.h"
#include "solver/connection_laplacian.h"
#include "solver/solver_checks.h"

namespace stormfield {
namespace {

using namespace solving;

TEST(SpaceTimeSolver, MeetsThesisEquationOnItsOwnGrid) {
  // An interior row of the system on the thesis's planar setting is a multiple of eq. 11.3: neighbours in lambda weigh
  // omega = 10 against spatial weights that add up to 1.
  const ChartsPointer grid = test::makeCharts(test::grid(64));
  const SurfaceMatrix matrix = connectionLaplacian(*grid).matrix;
  ASSERT_EQ(matrix.rows(), 65 * 65);
  const double coupling = SpaceTimeSolver::lambdaCoupling({});
  Index interior = 0;
  for (Index i = 0; i < matrix.rows(); ++i) {
    if (matrix.start[i + 1] - matrix.start[i] != 4) continue;
    if (std::abs(matrix.mass[i] - 1.0 / 4096) > 1e-12) continue;
    ++interior;
    double spatial = 0.0;
    for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) spatial += std::abs(matrix.value[k]);
    EXPECT_NEAR(matrix.diagonal[i], spatial, 1e-12);
    EXPECT_NEAR(coupling * matrix.mass[i] / spatial, 10.0, 1e-9);
  }
  EXPECT_EQ(interior, 63 * 63);
}

TEST(SpaceTimeSolver, SolutionIsTheMeanOfItsNeighbours) {
  // Eq. 11.3 itself, on the solved field: V = (sum of w V_neighbour + 10 (V_before + V_after)) / 21. On another grid of
  // n x n cells and other samples the weight that gives 10 there is 10 (n / 64 * 99 / (samples - 1))^2.
  const Index n = test::shortOrLong(16, 64), samples = test::shortOrLong(34, 100);
  const ChartsPointer grid = test::makeCharts(test::grid(n));
  ConstraintSet constraints;
  constraints.elementNames = {"corner", "middle"};
  constraints.add(0, 0, 1.0, kHard, 0);
  constraints.add((n + 1) * (n / 2) + n / 2, samples / 2, Complex(0, 2), kHard, 1);
  const double coarser = n / 64.0 * 99.0 / (samples - 1);
  const SpaceTimeOptions options{.samples = samples, .lambdaWeight = 10.0 * coarser * coarser, .tolerance = 1e-10};
  Progress progress;
  const ParameterizedField field = SpaceTimeSolver(grid, options).solve(constraints, progress).field;
  const auto space = [&](Index i, Index k, Index j) {
    const Index v = k * (n + 1) + i;
    return grid->toSpace(v, field.sample(j)[v]);
  };
  for (const auto& [i, k, j] : {std::array<Index, 3>{n / 3, n / 2 - 2, samples / 2},
                                {n / 2 + 1, n / 2, samples / 2 - 1},
                                {2, n - 4, 2},
                                {n / 2 + 3, 7, samples - 3}}) {
    const Vec3 mean = (0.25 * (space(i - 1, k, j) + space(i + 1, k, j) + space(i, k - 1, j) + space(i, k + 1, j)) +
                       10.0 * (space(i, k, j - 1) + space(i, k, j + 1))) /
                      21.0;
    EXPECT_LT((mean - space(i, k, j)).norm(), 1e-7 * mean.norm());
  }
}

}  // namespace
}  // namespace stormfield
