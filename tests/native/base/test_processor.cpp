// What the processor can do, against what the operating system says of it.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "base/processor.h"

namespace stormfield {
namespace {

TEST(Processor, AgreesWithTheOperatingSystem) {
  std::ifstream file("/proc/cpuinfo");
  if (!file) GTEST_SKIP() << "no /proc/cpuinfo on this system";
  std::string line, word;
  bool listed = false;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    while (words >> word) listed = listed || word == "avx2";
  }
  EXPECT_EQ(hasAvx2(), listed);
}

}  // namespace
}  // namespace stormfield
