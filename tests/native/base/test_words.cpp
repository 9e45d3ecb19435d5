#include "base/words.h"

#include <gtest/gtest.h>

namespace stormfield {
namespace {

enum class Weather { Calm, Storm, Rain };

}  // namespace

template <>
inline constexpr Words kWords<Weather>{"weather", {"calm", "storm", "rain"}};

namespace {

TEST(Words, NameTheValuesInTheirOrder) {
  EXPECT_STREQ(name(Weather::Calm), "calm");
  EXPECT_STREQ(name(Weather::Rain), "rain");
  EXPECT_EQ(fromName<Weather>("storm"), Weather::Storm);
}

TEST(Words, UnknownOnesAreRefusedWithTheKnown) {
  try {
    fromName<Weather>("snow");
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "there is no weather 'snow'; choose calm, storm or rain");
  }
}

}  // namespace
}  // namespace stormfield
