// A section: edges of the mesh in a row, all crossed by the flow from their right to their left. Return maps live on it
// (thesis 3.1). Because it goes on over vertices, an orbit that runs through a vertex is crossed like any other.
#pragma once

#include <optional>
#include <vector>

#include "field/vector_field.h"
#include "topology/detail/crossing_trace.h"

namespace stormfield {

/// Positions along a section are lengths in mesh units, from the tail of its first halfedge.
class Section {
 public:
  Section() = default;
  /// The halfedge whose face the flow enters, and up to so many edges beyond each of its ends.
  Section(const VectorField& field, Index halfedge, int beyond);

  const std::vector<Index>& halfedges() const { return halfedges_; }
  /// Where the flow crosses in the one direction; everywhere else it is tangent or comes back.
  double low() const { return low_; }
  double high() const { return high_; }
  /// Position of a passage, if it is one over this section.
  std::optional<double> at(const TriangleMesh& mesh, const EdgePassage& passage) const;
  double at(std::size_t edge, double fraction) const {
    return starts_[edge] + fraction * (starts_[edge + 1] - starts_[edge]);
  }
  /// The point at a position, in the face that the walk enters.
  SurfacePoint point(const TriangleMesh& mesh, double position, Direction direction) const;

 private:
  std::vector<Index> halfedges_;
  std::vector<double> starts_;  ///< position of each tail, and of the last head
  double low_ = 0.0, high_ = 0.0;
};

/// The inner halfedge at a vertex that the flow crosses to the left as squarely as possible, beginning or ending there;
/// kNone where there is none.
Index crossedAt(const VectorField& field, Index vertex, bool begins);

/// Components of the field across a halfedge to its left, at its tail and at its head; linear between.
std::array<double, 2> acrossEnds(const VectorField& field, Index halfedge);

}  // namespace stormfield
