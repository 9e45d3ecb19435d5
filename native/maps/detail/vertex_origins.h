// The second stage of tau map rows: backward mapping (thesis 7.1.2). A vertex lies in the image of a face when the flow
// takes it from there.
#pragma once

#include <compare>
#include <vector>

#include "maps/detail/boundary_tangencies.h"
#include "maps/detail/forward_images.h"
#include "maps/detail/row_task.h"

namespace stormfield {

/// Where the flow takes a vertex from: a face, or none. As large as an index.
class VertexOrigin {
 public:
  constexpr VertexOrigin() = default;  ///< not requested
  constexpr explicit VertexOrigin(Index face) : code_(face) {}
  /// Requested, but not traced yet.
  static constexpr VertexOrigin pending() { return VertexOrigin(kPending); }
  /// The trajectory entered the surface after the start, or was outside a window.
  static constexpr VertexOrigin none() { return VertexOrigin(kNoFace); }

  constexpr bool isRequested() const { return code_ != kNotRequested; }
  constexpr bool isFace() const { return code_ >= 0; }
  constexpr Index face() const { return code_; }
  constexpr auto operator<=>(const VertexOrigin&) const = default;

 private:
  static constexpr Index kNotRequested = -3, kPending = -2, kNoFace = -1;
  Index code_ = kNotRequested;
};

/// The origins of all vertices that may lie in an image, by vertex. These are the vertices of the faces that edge
/// images and tangencies meet, those of the faces whose rows are computed (an image may hold them while its boundary is
/// outside the windows or has left the surface all around), and, from each vertex that lies in an image, its
/// neighbours.
std::vector<VertexOrigin> vertexOrigins(RowTask& task, const ForwardImages& images,
                                        const std::vector<TangencyEdge>& tangencies);

}  // namespace stormfield
