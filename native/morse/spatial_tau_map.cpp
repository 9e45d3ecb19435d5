#include "morse/spatial_tau_map.h"

namespace stormfield {

CombinatorialMap spatialTauMap(const FlatFaces& faces, const VectorField& field, double distance, TauMapOptions options,
                               Progress* progress) {
  options.unit = TauUnit::Length;
  return tauMap(faces, field, distance, options, progress);
}

}  // namespace stormfield
