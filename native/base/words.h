// The words by which files, messages and Python know the values of an enum, in the order of the values.
//
//     enum class Direction { Forward, Backward };
//     template <>
//     inline constexpr Words kWords<Direction>{"direction", {"forward", "backward"}};
//
//   const char* word = name(Direction::Backward);  // "backward"
//   fromName<Direction>(word);                     // throws InputError where it is none of them
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "base/error.h"

namespace stormfield {

template <std::size_t N>
struct Words {
  const char* noun;  ///< what messages call the enum
  std::array<const char*, N> list;

  constexpr Words(const char* what, const char* const (&words)[N]) : noun(what), list(std::to_array(words)) {}
};

/// Specialised beside each enum that has words.
template <typename E>
inline constexpr int kWords = 0;

template <typename E>
concept HasWords = requires {
  kWords<E>.list;
};

template <HasWords E>
constexpr const char* name(E value) {
  return kWords<E>.list[static_cast<std::size_t>(value)];
}

/// Throws InputError that lists the words.
template <HasWords E>
E fromName(std::string_view word) {
  const auto& list = kWords<E>.list;
  std::string known;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (word == list[i]) return static_cast<E>(i);
    known += (i == 0 ? "" : i + 1 == list.size() ? " or " : ", ") + std::string(list[i]);
  }
  throw InputError("there is no " + std::string(kWords<E>.noun) + " '" + std::string(word) + "'; choose " + known);
}

}  // namespace stormfield
