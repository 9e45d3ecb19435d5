// A swirl on a surface with errors at every vertex: hundreds of Morse sets.
#pragma once

#include <memory>

#include "fixtures.h"

namespace stormfield {

inline VectorField roughField(const std::shared_ptr<const VertexCharts>& charts) {
  VectorField field = sampled(charts, analytic::swirl());
  test::Random random(1);
  for (Complex& value : field.values) {
    const double x = random.uniform(-0.5, 0.5), y = random.uniform(-0.5, 0.5);
    value += 0.5 * Complex(x, y);
  }
  return field;
}

}  // namespace stormfield
