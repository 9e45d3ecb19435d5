// The samples of lambda on one level of the multigrid hierarchy, and linear interpolation between the levels.
//
// On the finest level every sample has mass 1 and neighbours are coupled by 1 (times the vertex's own coupling). The
// next level keeps every other sample; the samples between are the mean of their neighbours, and a last one that has no
// coarse successor copies its predecessor. Masses and couplings are the (lumped) Galerkin products.
#pragma once

#include <vector>

#include "base/types.h"

namespace stormfield {

struct LambdaGrid {
  std::vector<float> mass;  ///< per sample
  float coupling = 1.0f;    ///< between neighbouring samples

  Index samples() const { return static_cast<Index>(mass.size()); }
  /// Floats in a row of complex values; rows are padded to whole vector registers, and the padding stays zero.
  std::size_t stride() const { return 2 * ((mass.size() + 3) / 4 * 4); }
};

LambdaGrid finestLambdaGrid(Index samples);
LambdaGrid coarsened(const LambdaGrid& fine);

/// Both act on one row of complex values, padded on both grids; the padding is zero before and after.
void restrictLambda(const float* fine, Index fineSamples, float* coarse);
void addProlongedLambda(const float* coarse, Index fineSamples, float* fine);

}  // namespace stormfield
