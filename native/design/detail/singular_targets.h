// All singular elements of a design at one lambda: separate discs, overlapping discs that shrink, joined pairs.
//
// Discs of elements that overlap without being joined shrink until they touch, so that their constraints do not
// contradict; different elements at one place are a contradiction. The corners of the face that holds an element are
// always constrained, so that an element smaller than the mesh resolves becomes the three constraints of thesis 5.2.2.
#pragma once

#include <vector>

#include "design/detail/junction.h"
#include "design/detail/region.h"
#include "design/detail/singular_field.h"
#include "design/detail/singular_pair.h"
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
  /// One element with its path over lambda.
  struct SingularTrack {
    Index element = kNone;
    SurfacePath path;
    LambdaSpan span;
    Index partner = kNone;     ///< the track it merges with or splits from
    Index single = kNone;      ///< the element they become or come from
    Vec3 axis = Vec3::Zero();  ///< from the partner to this element shortly before they meet
  };
  /// A track that acts at the given lambda.
  struct ActiveElement {
    const SingularTrack* track = nullptr;
    SingularState state;
    double share = 0.0;
  };

  SingularTrack makeTrack(Index element, const std::vector<Junction>& junctions) const;
  void findAxis(SingularTrack& a, SingularTrack& b, const Junction& junction) const;
  SingularState stateOf(Index element, const SurfacePoint& point, double lambda) const;
  std::vector<ActiveElement> activeAt(double lambda, double step) const;
  void shrinkOverlapping(std::vector<ActiveElement>& active, double lambda, LogMapScratch& scratch) const;
  double distanceBetween(const SingularState& a, const SingularState& b, LogMapScratch& scratch) const;
  void addDisc(const ActiveElement& active, double share, LogMapScratch& scratch, std::vector<Target>& targets) const;
  /// Adds the joint field of a pair; returns the share that is left for each element alone.
  double addPair(ActiveElement a, ActiveElement b, double lambda, LogMapScratch& scratch,
                 std::vector<Target>& targets) const;
  double density(double radius) const;

  const VertexCharts& charts_;
  const ClosestPointQuery& query_;
  const std::vector<DesignElement>& elements_;
  double stiffness_ = 0.0;
  std::vector<SingularTrack> tracks_;
};

}  // namespace stormfield
