#include "morse/detail/tau_models.h"

#include <utility>

namespace stormfield {
namespace {

/// Fraction of the progress at which the map is found.
constexpr double kMapFound = 0.9;

CombinatorialMap mapAt(const FlatFaces& faces, const VectorField& field, TauUnit unit, double tau, Progress& progress) {
  progress.range(0.0, kMapFound);
  TauMapOptions options;
  options.unit = unit;
  return tauMap(faces, field, tau, options, &progress);
}

}  // namespace

TauModel::TauModel(const FlatFaces& faces, std::shared_ptr<const VectorField> field, TauUnit unit, double tau,
                   Progress& progress)
    : field_(std::move(field)),
      unit_(unit),
      taus_(field_->mesh().faceCount(), tau),
      map_(mapAt(faces, *field_, unit, tau, progress)) {}

TauModel::TauModel(std::shared_ptr<const VectorField> field, TauUnit unit, std::vector<double> taus,
                   CombinatorialMap map)
    : field_(std::move(field)), unit_(unit), taus_(std::move(taus)), map_(std::move(map)) {}

MorseDecomposition TauModel::decomposition(const KeptSets& kept, Progress& progress) const {
  progress.range(kMapFound, 1.0);
  MorseOptions options;
  for (const double tau : taus_) options.mapped.push_back(tau > 0.0 ? 1 : 0);
  options.kept = kept;
  return morseDecomposition(*field_, map_, options, progress);
}

TauRefinementModel::TauRefinementModel(TauRefinement refinement, std::optional<RefinementStop> stop)
    : TauModel(refinement.field(), refinement.options().map.unit, refinement.taus(), refinement.map()),
      refinement_(std::move(refinement)),
      stop_(stop) {}

MorseDecomposition TauRefinementModel::decomposition(const KeptSets& kept, Progress& /*progress*/) const {
  Progress own;
  return TauModel::decomposition(kept, own);
}

std::unique_ptr<MorseModel> TauRefinementModel::withSetRefined(const std::shared_ptr<const FlatFaces>& /*faces*/,
                                                               const MorseDecomposition& morse, Index set,
                                                               Progress& progress) const {
  TauRefinement refinement = refinement_;
  // Sets that were kept although nothing can recur in them are none of the refinement's.
  const Index its = refinement.sets().setOf(morse.faces.members(set).front());
  if (its != kNone) refinement.refineSet(its, &progress);
  return std::make_unique<TauRefinementModel>(std::move(refinement), std::nullopt);
}

}  // namespace stormfield
