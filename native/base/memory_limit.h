// What maps may take of the machine's memory when nobody says.
#pragma once

#include <unistd.h>

#include <cstddef>

namespace stormfield {

/// In bytes.
inline std::size_t halfOfMemory() {
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE)) / 2;
}

}  // namespace stormfield
