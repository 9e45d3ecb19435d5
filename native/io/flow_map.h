// A flow map: a vector field as an image over a UV layer, for shaders that know nothing of the mesh.
//
// Channels R, G, B, A of each pixel that the surface reaches (A = 1; elsewhere all are 0):
//   Basis::Uv      R, G = the velocity of the UV coordinates, UV units per second: texture moved by (R, G) dt flows
//   with
//                  the field; B = speed, mesh units per second.
//   Basis::Object  R, G, B = the vector in object space, mesh units per second.
//
//   const UvRaster raster = rasterizeUv(mesh, uvs, {1024, 1024});     // once per layer
//   const std::string bytes = exrBytes(flowMap(field, uvs, raster, Basis::Uv), false, metadata);
#pragma once

#include <map>
#include <string>
#include <vector>

#include "field/vector_field.h"
#include "io/uv_raster.h"

namespace stormfield {

enum class FlowMapBasis { Uv, Object };

struct FlowMapImage {
  Index width = 0, height = 0;
  std::vector<float> pixels;  ///< RGBA, row by row from the top
};

/// Text and numbers for the file's header: name -> text.
using Metadata = std::map<std::string, std::string>;

/// Throws InputError when field, UV layer and raster do not belong to one mesh; Cancelled.
FlowMapImage flowMap(const VectorField& field, const FaceUvs& uvs, const UvRaster& raster, FlowMapBasis basis,
                     Progress* progress = nullptr);

/// An OpenEXR file in memory: RGBA, 32 bit float or (half) 16 bit, ZIP, metadata as string attributes. Equal input
/// gives equal bytes. Throws InputError when a value cannot be held in 16 bits;
/// Cancelled.
std::string exrBytes(const FlowMapImage& image, bool half, const Metadata& metadata, Progress* progress = nullptr);

}  // namespace stormfield
