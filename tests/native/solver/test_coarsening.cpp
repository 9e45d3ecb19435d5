// One step of coarsening, and the order of the sweeps, against their definitions.
#include "solver/detail/coarsening.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "fixtures.h"
#include "solver/connection_laplacian.h"
#include "solver/detail/sweep_order.h"

namespace stormfield {
namespace {

Eigen::MatrixXcd dense(const SurfaceMatrix& matrix) {
  Eigen::MatrixXcd result = Eigen::MatrixXcd::Zero(matrix.rows(), matrix.rows());
  for (Index i = 0; i < matrix.rows(); ++i) {
    result(i, i) = matrix.diagonal[i];
    for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) result(i, matrix.column[k]) = matrix.value[k];
  }
  return result;
}

Eigen::MatrixXcd dense(const Interpolation& interpolation, Index columns) {
  Eigen::MatrixXcd result = Eigen::MatrixXcd::Zero(interpolation.rows(), columns);
  for (Index i = 0; i < interpolation.rows(); ++i) {
    for (std::size_t k = interpolation.start[i]; k < interpolation.start[i + 1]; ++k) {
      result(i, interpolation.column[k]) = interpolation.value[k];
    }
  }
  return result;
}

std::vector<SurfaceMatrix> matrices() {
  return {connectionLaplacian(*test::makeCharts(test::dividedIcosahedron(5))).matrix,
          connectionLaplacian(*test::makeCharts(test::grid(13, 0.4))).matrix,
          connectionLaplacian(*test::makeCharts(test::torus(18, 9, 1.0, 0.4, 0.3))).matrix};
}

TEST(Coarsening, IsTheGalerkinProduct) {
  for (const SurfaceMatrix& fine : matrices()) {
    const Coarsening step = coarsen(fine);
    ASSERT_LT(step.matrix.rows(), 0.6 * fine.rows());
    const Eigen::MatrixXcd p = dense(step.interpolation, step.matrix.rows());
    const Eigen::MatrixXcd product = p.adjoint() * dense(fine) * p;
    EXPECT_LT((dense(step.matrix) - product).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Coarsening, InterpolatesByMeansOfCarriedVectorsAndKeepsTheMass) {
  for (const SurfaceMatrix& fine : matrices()) {
    const Coarsening step = coarsen(fine);
    const Eigen::MatrixXcd p = dense(step.interpolation, step.matrix.rows());
    for (Index i = 0; i < fine.rows(); ++i) EXPECT_NEAR(p.row(i).cwiseAbs().sum(), 1.0, 1e-12);
    double before = 0.0, after = 0.0;
    for (const double mass : fine.mass) before += mass;
    for (const double mass : step.matrix.mass) after += mass;
    EXPECT_NEAR(after, before, 1e-12);
    const Eigen::MatrixXcd r = dense(adjoint(step.interpolation, step.matrix.rows()), fine.rows());
    EXPECT_EQ((r - p.adjoint()).cwiseAbs().maxCoeff(), 0.0);
  }
}

TEST(SweepOrder, LetsRowsOfOneColourAndPairsRunSideBySide) {
  for (const SurfaceMatrix& matrix : matrices()) {
    const SweepOrder sweep = sweepOrder(matrix, 16);
    std::vector<Index> sorted = sweep.order;
    std::sort(sorted.begin(), sorted.end());
    for (Index i = 0; i < matrix.rows(); ++i) ASSERT_EQ(sorted[i], i);

    const SurfaceMatrix swept = permuted(matrix, sweep.order);
    const auto coupled = [&](Index i, Index k) {
      const auto first = swept.column.begin() + static_cast<std::ptrdiff_t>(swept.start[i]);
      const auto last = swept.column.begin() + static_cast<std::ptrdiff_t>(swept.start[i + 1]);
      return std::find(first, last, k) != last;
    };
    std::vector<Index> chunkOf(matrix.rows()), colourOf(sweep.chunks());
    for (Index colour = 0; colour < sweep.colours(); ++colour) {
      for (Index c = sweep.colourStart[colour]; c < sweep.colourStart[colour + 1]; ++c) colourOf[c] = colour;
    }
    for (Index c = 0; c < sweep.chunks(); ++c) {
      for (Index i = sweep.chunkStart[c]; i < sweep.chunkStart[c + 1]; ++i) chunkOf[i] = c;
      for (Index i = sweep.chunkStart[c]; i < sweep.pairEnd[c]; i += 2) EXPECT_FALSE(coupled(i, i + 1));
    }
    for (Index i = 0; i < swept.rows(); ++i) {
      for (std::size_t k = swept.start[i]; k < swept.start[i + 1]; ++k) {
        const Index a = chunkOf[i], b = chunkOf[swept.column[k]];
        EXPECT_TRUE(a == b || colourOf[a] != colourOf[b]);
      }
    }
  }
}

}  // namespace
}  // namespace stormfield
