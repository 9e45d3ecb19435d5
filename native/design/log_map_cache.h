// Log maps of a design, kept from one edit to the next: an edit of one element leaves those of the others as they are.
//
// A map depends on its source and radius alone, and is the restriction to the radius of any larger one around the same
// source (logMap settles vertices in the order of their distance). So what is found here is what would be computed
// anew, bit for bit. Kept are the maps that the last design used, sample by sample, as far as they fit.
//
//   LogMapCache kept;
//   const ConstraintSet first = elementConstraints(charts, elements, {}, &progress, &kept);
//   const ConstraintSet moved = elementConstraints(charts, movedElements, {}, &progress, &kept);
#pragma once

#include <memory>
#include <vector>

#include "design/log_map.h"

namespace stormfield {

/// The maps at one sample of lambda: of the last design, and those that this one has used so far.
class SampleLogMaps {
 public:
  /// Null where none reaches as far.
  std::shared_ptr<const LogMap> find(const TriangleMesh& mesh, const SurfacePoint& source, double radius);
  void add(std::shared_ptr<const LogMap> map);
  /// For a design to come; what one that failed used is forgotten.
  void start() { used_.clear(); }
  /// The design is done with this sample: what it used takes the place of what the last one did, in the order of use
  /// and at most maxEntries entries.
  void keepUsed(std::size_t maxEntries);

 private:
  std::vector<std::shared_ptr<const LogMap>> before_, used_;
};

/// Of one mesh: it must not be handed to designs on another one. Whatever it holds, results are the same.
class LogMapCache {
 public:
  /// For a design with that many samples.
  void start(std::size_t samples) {
    samples_.resize(samples);
    for (SampleLogMaps& maps : samples_) maps.start();
  }
  SampleLogMaps& operator[](std::size_t sample) { return samples_[sample]; }

 private:
  std::vector<SampleLogMaps> samples_;
};

}  // namespace stormfield
