#include "solver/detail/row_sums.h"

#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fixtures.h"

namespace stormfield::kernels {
namespace {

TEST(RowSums, GiveTheSameBitsOnAnyProcessor) {
  test::Random random(3);
  const auto number = [&] { return static_cast<float>(random.uniform()); };
  for (const std::size_t stride : {8u, 24u, 40u, 200u}) {
    std::vector<float> x(7 * stride), own(stride), mass(stride), b(stride), line(stride + 4);
    for (auto* values : {&x, &own, &mass, &b, &line}) {
      for (float& value : *values) value = number();
    }
    std::vector<Coupling> couplings;
    for (const Index column : {0, 3, 4, 6, 2}) couplings.push_back({column, number(), number()});
    const Coupling* first = couplings.data();
    const Coupling* last = first + couplings.size();
    auto all = [&](const RowSums& sums) {
      std::vector<std::vector<float>> results(6, own);
      sums.sum(first, last, x.data(), stride, results[0].data());
      sums.add(first, last, x.data(), stride, results[1].data());
      sums.image(first, last, x.data(), stride, 1.7f, 0.4f, line.data() + 2, results[2].data());
      sums.residual(first, last, x.data(), stride, mass.data(), b.data(), results[3].data());
      sums.residual(first, last, x.data(), stride, mass.data(), nullptr, results[4].data());
      double products[5];
      sums.products(own.data(), b.data(), mass.data(), stride, products);
      results[5].assign(products, products + 5);
      return results;
    };
    EXPECT_EQ(all(rowSums()), all(RowSumsOf<16>::table()));
    const std::vector<std::vector<float>> results = all(rowSums());
    const std::vector<float>& sum = results[0];
    for (std::size_t j = 0; j < stride; j += 2) {
      std::complex<float> expected;
      for (const Coupling& c : couplings) {
        const float* other = x.data() + c.column * stride + j;
        expected += std::complex<float>(c.re, c.im) * std::complex<float>(other[0], other[1]);
      }
      EXPECT_NEAR(sum[j], expected.real(), 1e-5f);
      EXPECT_NEAR(sum[j + 1], expected.imag(), 1e-5f);
    }
    for (std::size_t k = 0; k < stride; ++k) {
      EXPECT_NEAR(results[2][k], sum[k] + 1.7f * line[k + 2] - 0.4f * (line[k] + line[k + 4]), 1e-5f);
    }
    const std::array<std::pair<const float*, const float*>, 5> pairs = {{{mass.data(), own.data()},
                                                                         {own.data(), b.data()},
                                                                         {mass.data(), b.data()},
                                                                         {b.data(), b.data()},
                                                                         {own.data(), own.data()}}};
    for (std::size_t i = 0; i < 5; ++i) {
      const double expected = std::inner_product(pairs[i].first, pairs[i].first + stride, pairs[i].second, 0.0);
      EXPECT_NEAR(results[5][i], expected, 1e-4 * static_cast<double>(stride));
    }
  }
}

}  // namespace
}  // namespace stormfield::kernels
