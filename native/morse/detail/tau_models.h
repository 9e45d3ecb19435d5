// Maps of the flow for a time, or for an arc length (maps/tau_map.h): at one tau for all faces, and with the taus that
// a refinement has come to.
#pragma once

#include "maps/tau_map.h"
#include "morse/morse_model.h"
#include "morse/tau_refinement.h"

namespace stormfield {

class TauModel : public MorseModel {
 public:
  /// Throws InputError for a tau or a method that it does not fit, and Cancelled.
  TauModel(const FlatFaces& faces, std::shared_ptr<const VectorField> field, TauUnit unit, double tau,
           Progress& progress);

  MorseMethod method() const override { return unit_ == TauUnit::Length ? MorseMethod::Spatial : MorseMethod::Tau; }
  const CombinatorialMap& map() const override { return map_; }
  MorseDecomposition decomposition(const KeptSets& kept, Progress& progress) const override;
  std::vector<double> taus() const override { return taus_; }

 protected:
  TauModel(std::shared_ptr<const VectorField> field, TauUnit unit, std::vector<double> taus, CombinatorialMap map);

 private:
  std::shared_ptr<const VectorField> field_;
  TauUnit unit_;
  std::vector<double> taus_;
  CombinatorialMap map_;
};

/// What a refinement has come to, also when it was cancelled.
class TauRefinementModel final : public TauModel {
 public:
  TauRefinementModel(TauRefinement refinement, std::optional<RefinementStop> stop);

  MorseDecomposition decomposition(const KeptSets& kept, Progress& progress) const override;
  std::optional<RefinementStop> stop() const override { return stop_; }
  std::unique_ptr<MorseModel> withSetRefined(const std::shared_ptr<const FlatFaces>& faces,
                                             const MorseDecomposition& morse, Index set,
                                             Progress& progress) const override;

 private:
  TauRefinement refinement_;
  std::optional<RefinementStop> stop_;
};

}  // namespace stormfield
