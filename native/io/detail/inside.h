// Which side of a closed surface a point lies on: in what the surface encloses, or where it can be reached from far
// away.
#pragma once

#include <vector>

#include "mesh/closest_point.h"

namespace stormfield {

/// Of a mesh without boundary, which must outlive it. Normals may point either way, in every component.
class EnclosedSpace {
 public:
  explicit EnclosedSpace(const TriangleMesh& mesh);

  /// closest: the surface point that is closest to p.
  bool contains(const Vec3& p, const SurfacePoint& closest) const;

 private:
  struct Component {
    bool normalsPointOut = true;  ///< away from the bounded side of the component
    bool enclosed = false;        ///< the whole component lies within another one
  };

  const TriangleMesh& mesh_;
  std::vector<Component> components_;
};

}  // namespace stormfield
