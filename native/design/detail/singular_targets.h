// All singular elements of a design at one lambda: separate discs, discs that give way to each other, joined pairs.
//
// Discs of storms that are close without being joined shrink until they just touch, so that they do not fight; storms
// that share a place are a contradiction. The containing face's corners always take part, so that an element smaller
// than the mesh resolves becomes the three constraints of thesis 5.2.2.
#pragma once

#include <vector>

#include "design/detail/junction.h"
#include "design/detail/region.h"
#include "design/detail/singular_field.h"
#include "design/detail/storm_pair.h"
#include "design/detail/surface_path.h"

namespace stormfield {

class SingularTargets {
 public:
  /// `elements` are all elements of the design, ends joined; those of other types are passed over. `stiffness` is the
  /// weight of a disc's centre in units of 1 / radius^2. The references must outlive the object.
  SingularTargets(const VertexCharts& charts, const ClosestPointQuery& query,
                  const std::vector<DesignElement>& elements, const std::vector<Junction>& junctions, double stiffness);

  /// Appends the targets of the sample at lambda, with cells of width step. Throws InputError on a contradiction.
  void addAt(double lambda, double step, LogMapScratch& scratch, std::vector<Target>& targets) const;

 private:
  struct Storm {
    Index element = kNone;
    SurfacePath path;
    LambdaSpan span;
    Index partner = kNone;     ///< the storm it merges with or splits from
    Index single = kNone;      ///< the element they become or come from
    Vec3 axis = Vec3::Zero();  ///< from the partner to this storm shortly before they meet
  };
  struct Present {
    const Storm* storm = nullptr;
    SingularState state;
    double share = 0.0;
  };

  Storm makeStorm(Index element, const std::vector<Junction>& junctions) const;
  void findAxis(Storm& a, Storm& b, const Junction& junction) const;
  SingularState stateOf(Index element, const SurfacePoint& point) const;
  std::vector<Present> presentAt(double lambda, double step) const;
  void giveWay(std::vector<Present>& present, double lambda, LogMapScratch& scratch) const;
  double distanceBetween(const SingularState& a, const SingularState& b, LogMapScratch& scratch) const;
  void addDisc(const Present& storm, double share, LogMapScratch& scratch, std::vector<Target>& targets) const;
  /// Adds the joint field of a pair; the share that is left for each storm alone.
  double addPair(Present a, Present b, LogMapScratch& scratch, std::vector<Target>& targets) const;
  double density(double radius) const;

  const VertexCharts& charts_;
  const ClosestPointQuery& query_;
  const std::vector<DesignElement>& elements_;
  double stiffness_ = 0.0;
  std::vector<Storm> storms_;
};

}  // namespace stormfield
