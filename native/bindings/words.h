// Enums of the core as Python knows them: str in and out, typing.Literal in signatures and stubs.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <string_view>

#include "base/words.h"

namespace pybind11::detail {

template <stormfield::HasWords E>
struct type_caster_enum_type_enabled<E> : std::false_type {};

/// typing.Literal['first', 'second'], as text of this many characters.
template <stormfield::HasWords E>
struct LiteralText {
  static constexpr std::string_view kHead = "typing.Literal[", kBetween = ", ";
  static constexpr std::size_t kSize = [] {
    std::size_t size = kHead.size() + 1;
    for (const std::string_view word : stormfield::kWords<E>.list) size += word.size() + 2 + kBetween.size();
    return size - kBetween.size();
  }();

  char text[kSize + 1] = {};

  constexpr LiteralText() {
    std::size_t at = 0;
    const auto add = [&](std::string_view piece) {
      for (const char c : piece) text[at++] = c;
    };
    add(kHead);
    for (const std::string_view word : stormfield::kWords<E>.list) {
      if (at > kHead.size()) add(kBetween);
      add("'");
      add(word);
      add("'");
    }
    add("]");
  }
};

template <stormfield::HasWords E>
class type_caster<E> {
  static constexpr LiteralText<E> kLiteral{};

 public:
  PYBIND11_TYPE_CASTER(E, descr<LiteralText<E>::kSize>(kLiteral.text));

  /// Throws InputError on an unknown word.
  bool load(handle source, bool) {
    if (!isinstance<str>(source)) return false;
    value = stormfield::fromName<E>(source.cast<std::string>());
    return true;
  }
  static handle cast(E word, return_value_policy, handle) { return str(stormfield::name(word)).release(); }
};

}  // namespace pybind11::detail
