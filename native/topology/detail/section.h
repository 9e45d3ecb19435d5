// A section: edges of the mesh in a row, all crossed by the flow from their right to their left. Return maps live on it
// (Poincare section; thesis 3.1). Because it continues over vertices, it also cuts an orbit that runs through a vertex.
//
//   const Section section(field, halfedge, 2);
//   const std::optional<double> position = section.at(field.mesh(), passage);
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "field/vector_field.h"
#include "topology/detail/crossing_trace.h"

namespace stormfield {

/// Positions along a section are lengths in mesh units, from the tail of its first halfedge.
class Section {
 public:
  Section() = default;
  /// halfedge: an inner one, whose face the flow enters. The section continues by up to `beyond` edges over each end.
  Section(const VectorField& field, Index halfedge, int beyond);

  const std::vector<Index>& halfedges() const { return halfedges_; }
  /// Between low and high the flow crosses to the left; beyond, it is tangent or crosses back.
  double low() const { return low_; }
  double high() const { return high_; }
  /// Position of a passage, if it crosses this section.
  std::optional<double> at(const TriangleMesh& mesh, const EdgePassage& passage) const;
  double at(std::size_t edge, double fraction) const {
    return starts_[edge] + fraction * (starts_[edge + 1] - starts_[edge]);
  }
  /// The point at a position, in the face that a trace of this direction enters.
  SurfacePoint point(const TriangleMesh& mesh, double position, Direction direction) const;

 private:
  std::vector<Index> halfedges_;
  std::vector<double> starts_;  ///< position of each tail, and of the last head
  double low_ = 0.0, high_ = 0.0;
};

enum class HalfedgeEnd { Tail, Head };

/// The inner halfedge with this end at a vertex that the flow crosses to the left as squarely as possible; kNone where
/// the flow runs along all of them.
Index crossedAt(const VectorField& field, Index vertex, HalfedgeEnd end);

/// Components of the field across a halfedge to its left, at its tail and at its head; linear between.
std::array<double, 2> acrossEnds(const VectorField& field, Index halfedge);

}  // namespace stormfield
