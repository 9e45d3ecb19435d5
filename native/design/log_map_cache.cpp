#include "design/log_map_cache.h"

#include <utility>

namespace stormfield {

std::shared_ptr<const LogMap> SampleLogMaps::find(const TriangleMesh& mesh, const SurfacePoint& source, double radius) {
  for (const auto* maps : {&used_, &before_}) {
    for (const std::shared_ptr<const LogMap>& map : *maps) {
      if (!map->reaches(source, radius)) continue;
      const std::shared_ptr<const LogMap> found = map;
      if (maps == &before_) used_.push_back(found);
      if (found->radius == radius) return found;
      return std::make_shared<const LogMap>(found->within(mesh, radius));
    }
  }
  return nullptr;
}

void SampleLogMaps::add(std::shared_ptr<const LogMap> map) {
  used_.push_back(std::move(map));
}

void SampleLogMaps::keepUsed(std::size_t maxEntries) {
  before_.clear();
  std::size_t entries = 0;
  for (std::shared_ptr<const LogMap>& map : used_) {
    if (entries + map->entries.size() > maxEntries) continue;
    entries += map->entries.size();
    before_.push_back(std::move(map));
  }
  used_.clear();
}

}  // namespace stormfield
