#include "morse/detail/geometry_model.h"

#include <utility>

#include "morse/detail/tau_models.h"

namespace stormfield {
namespace {

/// Fractions of the progress at which the map, and the sets when their persistence follows, are found.
constexpr double kMapFound = 0.3, kSetsFound = 0.4;

}  // namespace

GeometryModel::GeometryModel(std::shared_ptr<const VectorField> field, double epsilon,
                             const std::vector<double>& weights, Persistence persistence, Progress& progress)
    : field_(std::move(field)), epsilon_(epsilon), persistence_(persistence) {
  progress.range(0.0, kMapFound);
  bounded_ = std::make_shared<const ErrorBoundedMap>(errorBoundedMap(*field_, weights, progress));
  map_ = mapWithinEpsilon(*bounded_, epsilon);
}

GeometryModel::GeometryModel(const GeometryModel& other, double epsilon)
    : field_(other.field_),
      bounded_(other.bounded_),
      epsilon_(epsilon),
      map_(mapWithinEpsilon(*bounded_, epsilon)),
      persistence_(other.persistence_),
      levels_(other.levels_) {}

MorseDecomposition GeometryModel::decomposition(const KeptSets& kept, Progress& progress) const {
  progress.range(kMapFound, persistence_ == Persistence::Find ? kSetsFound : 1.0);
  return morseDecomposition(*field_, map_, {{}, fixedPointFacesWithinEpsilon(*bounded_, epsilon_), kept}, progress);
}

std::optional<std::vector<double>> GeometryModel::findPersistence(const MorseDecomposition& morse, Progress& progress) {
  if (persistence_ == Persistence::Skip) return std::nullopt;
  progress.range(kSetsFound, 1.0);
  if (!levels_) levels_ = std::make_shared<const MergeLevels>(mergeLevels(*bounded_, progress));
  return persistenceOf(*levels_, morse.faces, epsilon_);
}

std::vector<double> GeometryModel::taus() const {
  return std::vector<double>(field_->mesh().faceCount(), 0.0);
}

std::unique_ptr<MorseModel> GeometryModel::withinEpsilon(double epsilon, Progress& /*progress*/) const {
  return std::unique_ptr<MorseModel>(new GeometryModel(*this, epsilon));
}

std::unique_ptr<MorseModel> GeometryModel::withSetRefined(const std::shared_ptr<const FlatFaces>& faces,
                                                          const MorseDecomposition& morse, Index set,
                                                          Progress& progress) const {
  if (epsilon_ != 0.0) return MorseModel::withSetRefined(faces, morse, set, progress);
  return TauRefinementModel(TauRefinement(faces, field_), std::nullopt).withSetRefined(faces, morse, set, progress);
}

}  // namespace stormfield
