// The map of pieces of edges that a refinement has come to (transit_refinement.h), also when it was cancelled.
#pragma once

#include "morse/detail/geometry_model.h"
#include "morse/morse_model.h"
#include "morse/transit_refinement.h"

namespace stormfield {

class TransitModel final : public MorseModel {
 public:
  TransitModel(TransitRefinement refinement, std::optional<RefinementStop> stop, Persistence persistence);

  MorseMethod method() const override { return MorseMethod::Geometry; }
  const CombinatorialMap& map() const override { return map_; }
  MorseDecomposition decomposition(const KeptSets& kept, Progress& progress) const override;
  std::optional<std::vector<double>> findPersistence(const MorseDecomposition& morse, Progress& progress) override;
  std::vector<double> taus() const override;
  double epsilon() const override { return refinement_.options().epsilon; }
  std::optional<RefinementStop> stop() const override { return stop_; }
  std::unique_ptr<MorseModel> withinEpsilon(double epsilon, Progress& progress) const override;
  std::unique_ptr<MorseModel> withSetRefined(const std::shared_ptr<const FlatFaces>& faces,
                                             const MorseDecomposition& morse, Index set,
                                             Progress& progress) const override;
  std::vector<Index> facesBetween(const MorseDecomposition& morse, Index from, Index to) const override;

 private:
  TransitRefinement refinement_;
  CombinatorialMap map_;
  std::optional<RefinementStop> stop_;
  Persistence persistence_;
};

}  // namespace stormfield
