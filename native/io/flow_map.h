// A flow map: a vector field as an image over a UV layer, for shaders that know nothing of the mesh.
//
// Channels R, G, B, A of each pixel that the surface reaches (A = 1; elsewhere all are 0):
//     FlowMapBasis::Uv      R, G = the velocity of the UV coordinates, UV units per second; B = speed, mesh units per
//                           second: texture moved by (R, G) dt flows with the field
//     FlowMapBasis::Object  R, G, B = the vector in object space, mesh units per second
//
//   const UvRaster raster = rasterizeUv(mesh, uvs, {1024, 1024});  // once per layer
//   const FlowMapImage image = flowMap(field, uvs, raster, FlowMapBasis::Uv);
#pragma once

#include <vector>

#include "base/words.h"
#include "field/vector_field.h"
#include "io/uv_raster.h"

namespace stormfield {

enum class FlowMapBasis { Uv, Object };
template <>
inline constexpr Words kWords<FlowMapBasis>{"basis", {"uv", "object"}};

struct FlowMapImage {
  Index width = 0, height = 0;
  std::vector<float> pixels;  ///< RGBA, row by row from the top
};

/// Throws InputError when field, UV layer and raster do not belong to one mesh; Cancelled.
FlowMapImage flowMap(const VectorField& field, const FaceUvs& uvs, const UvRaster& raster, FlowMapBasis basis,
                     Progress* progress = nullptr);

}  // namespace stormfield
