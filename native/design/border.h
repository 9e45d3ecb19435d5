// What the flow does at the border of the surface: nothing in particular, run along it, or come in over it.
//
// A wall asks for one component of a vector only, and the space-time solve for whole vectors. So the field is solved
// openly first; at the border its part along the border is kept and the part across it taken away (Wall), or the flow is
// turned straight in at the mean speed of the field at the border (Inflow); and the field is solved again with these
// values. Last they are put in place exactly, so that at a border vertex nothing flows across a wall.
#pragma once

#include "base/words.h"
#include "field/parameterized_field.h"
#include "solver/constraint.h"

namespace stormfield {

enum class Border { Open, Wall, Inflow };
template <>
inline constexpr Words kWords<Border>{"border", {"open", "wall", "inflow"}};

/// Of the vertices on the border of a surface, at every sample.
class BorderFlow {
 public:
  BorderFlow(const VertexCharts& charts, Border border);

  /// False where the border is open, or there is none.
  bool acts() const { return !vertices_.empty(); }
  /// The field with the border's values in place of its own there.
  void settle(ParameterizedField& field) const;
  /// Adds the border's values for that field to the constraints, soft ones under the name "border".
  void addTo(ConstraintSet& constraints, const ParameterizedField& field) const;

 private:
  double speedAt(const Complex* values) const;
  Complex valueAt(std::size_t i, Complex value, double speed) const;

  const VertexCharts& charts_;
  Border border_;
  std::vector<Index> vertices_;
  std::vector<Complex> along_;  ///< unit, with the surface on the left
};

}  // namespace stormfield
