#include "bindings/arrays.h"

namespace stormfield::bindings {

std::string describe(const Shape& shape) {
  static constexpr const char* names = "nmk";
  std::string text = "(";
  int any = 0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (i > 0) text += ", ";
    if (shape[i] == kLeading)
      text += "...";
    else if (shape[i] == kAny)
      text += names[any++ % 3];
    else
      text += std::to_string(shape[i]);
  }
  return text + (shape.size() == 1 ? ",)" : ")");
}

void checkShape(const py::array& array, const char* name, const Shape& wanted) {
  const bool leading = !wanted.empty() && wanted.front() == kLeading;
  const auto fixed = static_cast<py::ssize_t>(wanted.size()) - (leading ? 1 : 0);
  bool fits = leading ? array.ndim() >= fixed : array.ndim() == fixed;
  for (py::ssize_t i = 0; fits && i < fixed; ++i) {
    const py::ssize_t length = wanted[wanted.size() - 1 - i];
    fits = length == kAny || length == array.shape(array.ndim() - 1 - i);
  }
  if (fits) return;
  const Shape actual(array.shape(), array.shape() + array.ndim());
  throw InputError(message(name, " has shape ", describe(actual), "; reshape it to ", describe(wanted)));
}

}  // namespace stormfield::bindings
