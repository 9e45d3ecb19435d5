// Checks with names, shared by the tests.
#pragma once

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/types.h"

namespace stormfield::test {

inline void expectNear(const Vec3& actual, const Vec3& wanted, double tolerance, const std::string& what = "") {
  EXPECT_LE((actual - wanted).norm(), tolerance)
      << what << "\n  actual " << actual.transpose() << "\n  wanted " << wanted.transpose();
}

inline void expectNear(Complex actual, Complex wanted, double tolerance, const std::string& what = "") {
  EXPECT_LE(std::abs(actual - wanted), tolerance) << what << "\n  actual " << actual << "\n  wanted " << wanted;
}

inline int sum(const std::vector<int>& values) {
  return std::accumulate(values.begin(), values.end(), 0);
}

/// The action throws exactly this kind of fault, and its message contains every one of these parts.
template <typename Fault, typename Action>
void expectFault(Action&& action, const std::vector<std::string>& parts) {
  try {
    action();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Fault& fault) {
    EXPECT_EQ(typeid(fault), typeid(Fault));
    for (const std::string& part : parts) {
      EXPECT_NE(std::string(fault.what()).find(part), std::string::npos) << "'" << part << "' in: " << fault.what();
    }
  }
}

}  // namespace stormfield::test
