// A swirl on a surface with errors at every vertex: hundreds of Morse sets.
#pragma once

#include <memory>
#include <random>

#include "../tracing/surfaces.h"

namespace stormfield {

inline VectorField roughField(const std::shared_ptr<const VertexCharts>& charts) {
  VectorField field = surfaces::swirlField(charts);
  std::mt19937_64 random(1);
  for (Complex& value : field.values) {
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 - 0.5; };
    const double x = uniform(), y = uniform();
    value += 0.5 * Complex(x, y);
  }
  return field;
}

}  // namespace stormfield
