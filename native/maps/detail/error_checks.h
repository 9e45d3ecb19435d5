// Checks of an error bound, with the same messages for every map.
#pragma once

#include <vector>

#include "maps/tau_options.h"
#include "mesh/triangle_mesh.h"

namespace stormfield {

/// Throws InputError for an epsilon that is not a number >= 0.
void checkEpsilon(double epsilon);
/// Throws InputError for a number of weights that is neither 0 nor the vertex count, and for weights that are not
/// numbers >= 0 (the message names the vertex).
void checkWeights(const TriangleMesh& mesh, const std::vector<double>& weights);
/// Both, for maps of the flow. Throws InputError also for an epsilon > 0 on a surface with a boundary: a trajectory may
/// leave over it in one field and pass it in another.
void checkFieldError(const TriangleMesh& mesh, const FieldError& error);

}  // namespace stormfield
