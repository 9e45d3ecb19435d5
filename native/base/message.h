// Text of error messages from mixed parts: message("vertex ", v, " is not finite").
#pragma once

#include <sstream>
#include <string>

namespace stormfield {

template <typename... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream out;
  (out << ... << parts);
  return out.str();
}

}  // namespace stormfield
