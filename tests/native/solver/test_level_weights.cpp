// The factors of the lines and the weights of the coarse levels, against dense linear algebra.
#include "solver/detail/level_weights.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <vector>

#include "fixtures.h"
#include "solver/connection_laplacian.h"
#include "solver/detail/line_kernels.h"

namespace stormfield {
namespace {

constexpr double kHard = std::numeric_limits<double>::infinity();

SurfaceHierarchy hierarchyOf(const VertexCharts& charts, Index samples, double lambdaCoupling) {
  return surfaceHierarchy(connectionLaplacian(charts).matrix, samples, lambdaCoupling, Progress());
}

/// Soft and hard weights at random places, ascending in each row.
LevelWeights randomWeights(Index rows, Index samples, test::Random& random) {
  LevelWeights weights;
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < samples; ++j) {
      if (random.below(4) == 0) {
        weights.entries.push_back({j, random.below(3) == 0 ? kHard : std::pow(10.0, random.uniform(-1.0, 3.0))});
      }
    }
    weights.start.push_back(weights.entries.size());
  }
  return weights;
}

/// T of one row, with unit rows and columns where the value is fixed at 0.
Eigen::MatrixXd lineMatrix(const SurfaceLevel& level, const LevelWeights& weights, Index row) {
  const Index samples = level.lambda.samples();
  const double k = static_cast<double>(level.lambdaCoupling[row]);
  Eigen::MatrixXd line = Eigen::MatrixXd::Zero(samples, samples);
  for (Index j = 0; j < samples; ++j) {
    line(j, j) = static_cast<double>(level.diagonal[row]) * static_cast<double>(level.lambda.mass[j]) +
                 k * ((j > 0) + (j + 1 < samples));
    if (j > 0) line(j, j - 1) = line(j - 1, j) = -k;
  }
  for (std::size_t e = weights.start[row]; e < weights.start[row + 1]; ++e) {
    const auto [j, weight] = weights.entries[e];
    if (std::isinf(weight)) {
      line.row(j).setZero();
      line.col(j).setZero();
      line(j, j) = 1.0;
    } else {
      line(j, j) += weight;
    }
  }
  return line;
}

Eigen::VectorXd denseSolution(const SurfaceLevel& level, const LevelWeights& weights, Index row, Eigen::VectorXd y) {
  for (std::size_t e = weights.start[row]; e < weights.start[row + 1]; ++e) {
    if (std::isinf(weights.entries[e].weight)) y[weights.entries[e].sample] = 0.0;
  }
  return lineMatrix(level, weights, row).partialPivLu().solve(y);
}

TEST(LineFactors, SolveTheTridiagonalSystems) {
  const auto charts = test::makeCharts(test::torus(14, 9, 1.0, 0.4, 0.2));
  test::Random random(3);
  for (const Index samples : {1, 2, 3, 4, 7, 20}) {
    const SurfaceHierarchy hierarchy = hierarchyOf(*charts, samples, 500.0);
    for (const SurfaceLevel& level : hierarchy.levels) {
      const Index n = level.lambda.samples();
      const LevelWeights weights = randomWeights(level.rows(), n, random);
      std::vector<float> inverse(static_cast<std::size_t>(level.rows()) * n);
      updatePivots(level, weights, {}, inverse.data());
      const auto expectSolution = [&](Index row, const Eigen::VectorXd& y, const std::vector<float>& x, Index first,
                                      Index step) {
        const Eigen::VectorXd wanted = denseSolution(level, weights, row, y);
        for (Index j = 0; j < n; ++j) {
          EXPECT_NEAR(static_cast<double>(x[first + step * j]), wanted[j], 2e-5 * (1e-3 + wanted.cwiseAbs().maxCoeff()))
              << samples << " samples, row " << row << " of " << level.rows() << ", sample " << j;
        }
      };
      const auto randomLine = [&] {
        Eigen::VectorXd y(n);
        for (double& value : y) value = static_cast<double>(static_cast<float>(random.uniform()));
        return y;
      };
      for (Index chunk = 0; chunk < level.sweep.chunks(); ++chunk) {
        for (Index i = level.sweep.chunkStart[chunk]; i < level.sweep.chunkStart[chunk + 1];) {
          const bool pair = i < level.sweep.pairEnd[chunk];
          const float* factors = inverse.data() + static_cast<std::size_t>(i) * n;
          const Eigen::VectorXd y[4] = {randomLine(), randomLine(), randomLine(), randomLine()};
          const Index width = pair ? 4 : 2;
          std::vector<float> x(width * n);
          for (Index j = 0; j < n; ++j) {
            for (Index k = 0; k < width; ++k) x[width * j + k] = static_cast<float>(y[k][j]);
          }
          if (pair) {
            kernels::solveTwoLines(factors, level.lambdaCoupling[i], level.lambdaCoupling[i + 1], n, x.data());
          } else {
            kernels::solveLine(factors, level.lambdaCoupling[i], n, x.data());
          }
          for (Index k = 0; k < width; ++k) expectSolution(i + k / 2, y[k], x, k, width);
          i += width / 2;
        }
      }
    }
  }
}

TEST(LineFactors, OfRowsWithTheSameWeightsAreKept) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(4));
  const SurfaceHierarchy hierarchy = hierarchyOf(*charts, 9, 100.0);
  const SurfaceLevel& level = hierarchy.levels.front();
  test::Random random(8);
  const LevelWeights before = randomWeights(level.rows(), 9, random);
  LevelWeights after = before;
  for (std::size_t e = before.start[5]; e < before.start[6]; ++e) after.entries[e].weight = 2.0;
  ASSERT_LT(before.start[5], before.start[6]);

  std::vector<float> kept(static_cast<std::size_t>(level.rows()) * 9, -1.0f), anew = kept;
  updatePivots(level, after, before, kept.data());
  updatePivots(level, after, {}, anew.data());
  Index changed = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == -1.0f) continue;
    EXPECT_EQ(kept[i], anew[i]);
    ++changed;
  }
  EXPECT_EQ(changed, 9);
  for (const float value : anew) EXPECT_GE(value, 0.0f);
}

TEST(LevelWeights, AreSharedOutWithTheInterpolation) {
  constexpr double kLimit = 1.3;  // of the diagonal, as level_weights.cpp
  const auto charts = test::makeCharts(test::grid(12, 0.3));
  test::Random random(11);
  for (const Index samples : {8, 9}) {
    const SurfaceHierarchy hierarchy = hierarchyOf(*charts, samples, 1e6);
    ASSERT_GT(hierarchy.levels.size(), 2u);
    const SurfaceLevel &fine = hierarchy.levels[0], &coarse = hierarchy.levels[1];
    ASSERT_LT(coarse.lambda.samples(), samples);
    const LevelWeights weights = randomWeights(fine.rows(), samples, random);
    const LevelWeights result = restricted(weights, fine, coarse.lambda);

    // Rows of the prolongation, times the interpolation in lambda.
    Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(coarse.rows(), coarse.lambda.samples());
    for (Index i = 0; i < fine.rows(); ++i) {
      for (std::size_t e = weights.start[i]; e < weights.start[i + 1]; ++e) {
        const auto [j, weight] = weights.entries[e];
        const double limit = kLimit * static_cast<double>(fine.diagonal[i]);
        const double handed = std::isinf(weight) ? limit : 1.0 / (1.0 / weight + 1.0 / limit);
        for (const auto* c = fine.prolongation.begin(i); c != fine.prolongation.end(i); ++c) {
          const double share = std::hypot(static_cast<double>(c->re), static_cast<double>(c->im)) * handed;
          const bool between = j % 2 == 1 && j + 1 < samples;
          wanted(c->column, j / 2) += between ? 0.5 * share : share;
          if (between) wanted(c->column, j / 2 + 1) += 0.5 * share;
        }
      }
    }
    Eigen::MatrixXd found = Eigen::MatrixXd::Zero(coarse.rows(), coarse.lambda.samples());
    for (Index c = 0; c < coarse.rows(); ++c) {
      for (std::size_t e = result.start[c]; e < result.start[c + 1]; ++e) {
        found(c, result.entries[e].sample) = result.entries[e].weight;
      }
    }
    EXPECT_LT((found - wanted).cwiseAbs().maxCoeff(), 1e-6 * wanted.cwiseAbs().maxCoeff());
  }
}

}  // namespace
}  // namespace stormfield
