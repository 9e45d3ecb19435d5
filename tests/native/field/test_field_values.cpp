#include "field/field_values.h"

#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

namespace stormfield {
namespace {

TEST(FieldValues, StartAsZerosAndCopyAndMoveWhole) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{3}, std::size_t{200000}}) {
    FieldValues zeros(size);
    EXPECT_EQ(zeros, std::vector<Complex>(size));
    if (size > 0) zeros[size - 1] = Complex(1.0, 2.0);
    FieldValues copy = zeros;
    EXPECT_EQ(copy, zeros);
    if (size > 0) {
      EXPECT_NE(copy.data(), zeros.data());
    }
    const Complex* data = zeros.data();
    const FieldValues moved = std::move(zeros);
    EXPECT_EQ(moved.data(), data);
    EXPECT_EQ(moved, copy);
    EXPECT_EQ(zeros.size(), 0u);  // NOLINT(bugprone-use-after-move): moved from, they are empty
    zeros = copy;
    EXPECT_EQ(zeros, moved);
  }
}

TEST(FieldValues, TakePagesOverWhereTheyAreLargeEnough) {
  for (const std::size_t bytes : {std::size_t{1} << 12, std::size_t{5} << 20}) {
    Pages pages(bytes);
    EXPECT_EQ(pages.bytes(), bytes);
    std::fill_n(static_cast<char*>(pages.data()), bytes, 'x');
    const void* data = pages.data();
    const FieldValues same(bytes / sizeof(Complex), std::move(pages));
    EXPECT_EQ(same.data(), data);
    EXPECT_EQ(pages.bytes(), 0u);  // NOLINT(bugprone-use-after-move)
    const FieldValues larger(bytes / sizeof(Complex) + 1, Pages(bytes));
    EXPECT_EQ(larger.size(), bytes / sizeof(Complex) + 1);
  }
}

}  // namespace
}  // namespace stormfield
