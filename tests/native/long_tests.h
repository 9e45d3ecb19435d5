// Tests are quick, so that they can run under sanitizers on every change; STORMFIELD_LONG_TESTS=1 asks for the long
// versions of those that have one: finer meshes, more samples, more random designs.
#pragma once

#include <cstdlib>
#include <string_view>

namespace stormfield::test {

inline bool longTests() {
  const char* wanted = std::getenv("STORMFIELD_LONG_TESTS");
  return wanted != nullptr && std::string_view(wanted) == "1";
}

/// The first of these, or the second in long tests.
template <typename Size>
Size shortOrLong(Size brief, Size thorough) {
  return longTests() ? thorough : brief;
}

}  // namespace stormfield::test
