// The spatial tau map (thesis 7.2): every point moves along its trajectory for the same arc length, so that slow
// regions are followed as far as fast ones. A tau map with TauUnit::Length.
#pragma once

#include "morse/tau_map.h"

namespace stormfield {

/// As tauMap, with `distance` in mesh units for every face.
CombinatorialMap spatialTauMap(const FlatFaces& faces, const VectorField& field, double distance,
                               TauMapOptions options = {}, Progress* progress = nullptr);

}  // namespace stormfield
