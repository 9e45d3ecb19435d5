#include "morse/morse_model.h"

#include <algorithm>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

std::optional<std::vector<double>> MorseModel::findPersistence(const MorseDecomposition& /*morse*/,
                                                               Progress& /*progress*/) {
  return std::nullopt;
}

double MorseModel::tau() const {
  const std::vector<double> all = taus();
  return *std::max_element(all.begin(), all.end());
}

std::unique_ptr<MorseModel> MorseModel::withinEpsilon(double /*epsilon*/, Progress& /*progress*/) const {
  throw InputError(
      message("a decomposition by '", name(method()), "' has no error bound; make one with the method 'geometry'"));
}

std::unique_ptr<MorseModel> MorseModel::withSetRefined(const std::shared_ptr<const FlatFaces>& /*faces*/,
                                                       const MorseDecomposition& /*morse*/, Index /*set*/,
                                                       Progress& /*progress*/) const {
  throw InputError("only a refined decomposition, or one by 'geometry' with eps 0, can be refined set by set");
}

std::vector<Index> MorseModel::facesBetween(const MorseDecomposition& morse, Index from, Index to) const {
  return connectionRegion(map(), morse.faces, from, to);
}

}  // namespace stormfield
