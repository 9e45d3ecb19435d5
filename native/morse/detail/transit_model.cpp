#include "morse/detail/transit_model.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "morse/transit_persistence.h"

namespace stormfield {

TransitModel::TransitModel(TransitRefinement refinement, std::optional<RefinementStop> stop, Persistence persistence)
    : refinement_(std::move(refinement)), map_(refinement_.map().map()), stop_(stop), persistence_(persistence) {}

MorseDecomposition TransitModel::decomposition(const KeptSets& kept, Progress& /*progress*/) const {
  Progress own;
  return refinement_.decomposition(map_, kept, own);
}

std::optional<std::vector<double>> TransitModel::findPersistence(const MorseDecomposition& morse, Progress& progress) {
  if (persistence_ == Persistence::Skip || progress.cancelled()) return std::nullopt;
  try {
    return transitPersistence(refinement_, morse.withinFaces->nodes, progress);
  } catch (const Cancelled&) {
    stop_ = RefinementStop::Cancelled;
    return std::nullopt;
  }
}

std::vector<double> TransitModel::taus() const {
  return std::vector<double>(refinement_.field().mesh().faceCount(), 0.0);
}

std::unique_ptr<MorseModel> TransitModel::withinEpsilon(double epsilon, Progress& progress) const {
  return std::make_unique<TransitModel>(refinement_.withinEpsilon(epsilon, &progress), stop_, persistence_);
}

std::unique_ptr<MorseModel> TransitModel::withSetRefined(const std::shared_ptr<const FlatFaces>& /*faces*/,
                                                         const MorseDecomposition& morse, Index set,
                                                         Progress& progress) const {
  TransitRefinement refinement = refinement_;
  refinement.refineNodes(morse.withinFaces->nodes.members(set), &progress);
  return std::make_unique<TransitModel>(std::move(refinement), stop_, persistence_);
}

std::vector<Index> TransitModel::facesBetween(const MorseDecomposition& morse, Index from, Index to) const {
  std::vector<Index> faces, result;
  for (const Index node : connectionRegion(map_, morse.withinFaces->nodes, from, to)) {
    refinement_.map().appendFaces(node, faces);
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  const auto isMet = [&](Index set, Index face) {
    return std::binary_search(morse.facesMet(set).begin(), morse.facesMet(set).end(), face);
  };
  std::copy_if(faces.begin(), faces.end(), std::back_inserter(result),
               [&](Index f) { return !isMet(from, f) && !isMet(to, f); });
  return result;
}

}  // namespace stormfield
