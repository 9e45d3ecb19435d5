// The geometry-based map of all fields within an error bound (maps/error_bound.h), whose edges each have the epsilon
// from which they are there, so that the map of another epsilon takes no new work on the field.
#pragma once

#include "maps/error_bound.h"
#include "morse/morse_model.h"
#include "morse/persistence.h"

namespace stormfield {

/// Whether a model finds when its sets merge.
enum class Persistence : char { Skip, Find };

class GeometryModel final : public MorseModel {
 public:
  /// weights: one per vertex, or empty for 1. Throws InputError for weights that cannot be used, and Cancelled.
  GeometryModel(std::shared_ptr<const VectorField> field, double epsilon, const std::vector<double>& weights,
                Persistence persistence, Progress& progress);

  MorseMethod method() const override { return MorseMethod::Geometry; }
  const CombinatorialMap& map() const override { return map_; }
  MorseDecomposition decomposition(const KeptSets& kept, Progress& progress) const override;
  std::optional<std::vector<double>> findPersistence(const MorseDecomposition& morse, Progress& progress) override;
  std::vector<double> taus() const override;
  double epsilon() const override { return epsilon_; }
  std::unique_ptr<MorseModel> withinEpsilon(double epsilon, Progress& progress) const override;
  std::unique_ptr<MorseModel> withSetRefined(const std::shared_ptr<const FlatFaces>& faces,
                                             const MorseDecomposition& morse, Index set,
                                             Progress& progress) const override;

 private:
  GeometryModel(const GeometryModel& other, double epsilon);

  std::shared_ptr<const VectorField> field_;
  std::shared_ptr<const ErrorBoundedMap> bounded_;
  double epsilon_;
  CombinatorialMap map_;
  Persistence persistence_;
  std::shared_ptr<const MergeLevels> levels_;  ///< of all epsilons; null until they are asked for
};

}  // namespace stormfield
