#include "solver/detail/lambda_grid.h"

#include <gtest/gtest.h>

#include <vector>

#include "fixtures.h"

namespace stormfield {
namespace {

/// A padded row of random complex values.
std::vector<float> randomRow(const LambdaGrid& grid, test::Random& random) {
  std::vector<float> row(grid.stride(), 0.0f);
  for (Index k = 0; k < 2 * grid.samples(); ++k) row[k] = static_cast<float>(random.uniform());
  return row;
}

TEST(LambdaGrid, InterpolatesLinearlyAndRestrictsWithTheAdjoint) {
  test::Random random(5);
  for (Index samples = 4; samples <= 21; ++samples) {
    const LambdaGrid fine = finestLambdaGrid(samples), coarse = coarsened(fine);
    const std::vector<float> c = randomRow(coarse, random), f = randomRow(fine, random);
    std::vector<float> prolonged(fine.stride(), 0.0f), restricted(coarse.stride(), 0.0f);
    addProlongedLambda(c.data(), samples, prolonged.data());
    restrictLambda(f.data(), samples, restricted.data());
    for (Index j = 0; j < samples; ++j) {
      for (Index k = 0; k < 2; ++k) {
        const float before = c[j / 2 * 2 + k];
        const float after = j + 1 < samples ? c[(j + 1) / 2 * 2 + k] : before;
        EXPECT_NEAR(prolonged[2 * j + k], 0.5f * (before + after), 1e-6f) << samples << " samples, at " << j;
      }
    }
    for (std::size_t k = 2 * static_cast<std::size_t>(samples); k < fine.stride(); ++k) EXPECT_EQ(prolonged[k], 0.0f);
    for (std::size_t k = 2 * static_cast<std::size_t>(coarse.samples()); k < coarse.stride(); ++k) {
      EXPECT_EQ(restricted[k], 0.0f);
    }
    double there = 0.0, back = 0.0;
    for (std::size_t k = 0; k < f.size(); ++k) there += static_cast<double>(f[k]) * static_cast<double>(prolonged[k]);
    for (std::size_t k = 0; k < c.size(); ++k) back += static_cast<double>(c[k]) * static_cast<double>(restricted[k]);
    EXPECT_NEAR(there, back, 1e-5);
  }
}

TEST(LambdaGrid, CoarsensByTheGalerkinProducts) {
  for (Index samples = 2; samples <= 21; ++samples) {
    LambdaGrid fine = finestLambdaGrid(samples);
    for (int level = 0; level < 2 && fine.samples() > 1; ++level) {
      const LambdaGrid coarse = coarsened(fine);
      const Index n = fine.samples(), m = coarse.samples();
      ASSERT_EQ(m, (n + 1) / 2);
      Eigen::MatrixXd p = Eigen::MatrixXd::Zero(n, m);
      for (Index j = 0; j < n; ++j) {
        const bool between = j % 2 == 1 && j + 1 < n;
        p(j, j / 2) = between ? 0.5 : 1.0;
        if (between) p(j, j / 2 + 1) = 0.5;
      }
      const auto difference = [](const LambdaGrid& grid) {
        Eigen::MatrixXd t = Eigen::MatrixXd::Zero(grid.samples(), grid.samples());
        const double k = static_cast<double>(grid.coupling);
        for (Index j = 0; j + 1 < grid.samples(); ++j) t.block<2, 2>(j, j) += Eigen::Matrix2d{{k, -k}, {-k, k}};
        return t;
      };
      EXPECT_LT((p.transpose() * difference(fine) * p - difference(coarse)).cwiseAbs().maxCoeff(), 1e-12) << samples;
      const Eigen::VectorXd mass = Eigen::Map<const Eigen::VectorXf>(fine.mass.data(), n).cast<double>();
      const Eigen::VectorXd lumped = Eigen::Map<const Eigen::VectorXf>(coarse.mass.data(), m).cast<double>();
      EXPECT_LT((p.transpose() * mass - lumped).cwiseAbs().maxCoeff(), 1e-12) << samples;
      fine = coarse;
    }
  }
}

}  // namespace
}  // namespace stormfield
