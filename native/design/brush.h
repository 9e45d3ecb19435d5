// Brush strokes: what an artist combs into a solved field (thesis 11.1.3.1, figure 11.4).
//
// A stroke changes the field on the strip beside its curve and nowhere else, after the global solve and after all strokes
// before it in the design. With the influence w of a vertex, 1 on the curve and 0 at the rim, the direction t of the
// closest point of the curve, the stroke's speed s and the field V before it:
//   Replace    V + w (s t - V)
//   Add        V + w s t
//   Strength   V, of length |V| + w (s - |V|): only speeds change
//   Smooth     V + w (H - V), where H is the smoothest field in the strip that has V around it (thesis eq. 11.2)
// w is 1 up to (1 - falloff) of the radius and falls smoothly from there: falloff 0 is a hard edge. The values outside
// of the strip, and of its lambda, are the same bits as before.
#pragma once

#include <vector>

#include "base/progress.h"
#include "design/element.h"
#include "field/parameterized_field.h"

namespace stormfield {

/// Applies the brush strokes among the elements, in their order; other elements are passed over. The same for any number
/// of threads. Throws InputError naming a stroke that lies off the surface, covers no vertex, or would smooth a whole
/// part of the surface, and Cancelled.
void applyBrushes(ParameterizedField& field, const std::vector<DesignElement>& elements, Progress* progress = nullptr);

}  // namespace stormfield
