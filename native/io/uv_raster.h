// Which surface point every pixel of a UV layer shows.
//
// A UV layer maps each face f to a triangle in [0, 1]^2 (u right, v up; pixel row 0 is v = 1). A pixel belongs to the
// face whose UV triangle contains its centre, or else to the closest face that touches it (so that slivers show, too);
// the smaller index wins. Then the region grows by `margin` pixels: a pixel outside shows the closest point of a face
// that a neighbour shows, so that texture filtering finds no seam.
// Faces without UV area (or outside the unit square) show nowhere; overlaps are counted, not refused.
#pragma once

#include <array>
#include <vector>

#include "base/progress.h"
#include "mesh/surface_point.h"

namespace stormfield {

struct UvRasterOptions {
  Index width = 1024, height = 1024;  ///< pixels, 1..32768
  Index margin = 8;                   ///< pixels around each island, >= 0
};

struct UvRaster {
  Index width = 0, height = 0;
  std::vector<SurfacePoint> points;  ///< row by row from the top; face kNone where nothing shows
  Index coveredPixels = 0;           ///< whose centre lies inside a face
  Index overlappingPixels = 0;       ///< whose centre lies strictly inside two faces or more
  Index zeroAreaFaces = 0;           ///< without UV area
  Index outsideFaces = 0;            ///< that reach beyond the unit square
};

/// UV coordinates of the three corners of each face.
using FaceUvs = std::vector<std::array<Eigen::Vector2d, 3>>;

/// Deterministic for any thread count. Throws InputError on a size that does not match the mesh, a coordinate that is
/// not finite (names the face), options out of range, or a layer in which no face has area; Cancelled.
UvRaster rasterizeUv(const TriangleMesh& mesh, const FaceUvs& uvs, const UvRasterOptions& options,
                     Progress* progress = nullptr);

}  // namespace stormfield
