// Where singularity paths meet: merge, split and continuation (thesis 11.1.4, second way).
//
// In a merge two paths of index +1 end in one point at one lambda, where a third path starts; a split is the reverse. A
// continuation is a path that starts where another one ends.
#pragma once

#include <vector>

#include "design/element.h"

namespace stormfield {

struct Junction {
  enum class Kind { Merge, Split, Continuation };
  Kind kind = Kind::Merge;
  std::vector<Index> ending, starting;  ///< indices into the elements
  double lambda = 0.0;
  Vec3 point = Vec3::Zero();  ///< the end of the single path

  /// The two that become one, or come from one.
  const std::vector<Index>& pair() const { return kind == Kind::Merge ? ending : starting; }
  Index single() const { return kind == Kind::Merge ? starting.front() : ending.front(); }
};

/// Ends count as one point when they are closer than the mean edge length or a quarter of the smaller radius.
/// Throws InputError naming the elements when more than three paths meet, or a saddle takes part in a merge or split.
std::vector<Junction> findJunctions(const std::vector<DesignElement>& elements, double meanEdgeLength);

/// The elements with the ends that meet moved to the common point.
std::vector<DesignElement> joinedEnds(std::vector<DesignElement> elements, const std::vector<Junction>& junctions);

}  // namespace stormfield
