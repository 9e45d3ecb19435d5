// The field at a surface point, in the flat frame of its face.
#pragma once

#include "field/vector_field.h"
#include "tracing/flat_faces.h"

namespace stormfield {

inline Complex velocityAt(const FlatFaces& faces, const VectorField& field, const SurfacePoint& p) {
  const FlatFace& face = faces[p.face];
  const auto& u = field.values;
  return face.evaluate(face.carry(u[face.vertex(0)], u[face.vertex(1)], u[face.vertex(2)]), face.point(p.barycentric));
}

}  // namespace stormfield
