#include "edit/smooth.h"

#include <cmath>

#include "base/error.h"
#include "base/message.h"
#include "edit/detail/face_region.h"
#include "edit/detail/harmonic_fill.h"

namespace stormfield {
namespace {

constexpr double kMaxResidual = 1e-10;

}  // namespace

SmoothResult smoothRegion(const VectorField& field, const std::vector<Index>& faces) {
  const TriangleMesh& mesh = field.mesh();
  FaceRegion region(mesh);
  for (const Index f : faces) {
    if (f < 0 || f >= mesh.faceCount()) {
      throw InputError(message("there is no face ", f, "; the mesh has ", mesh.faceCount()));
    }
    region.add(f);
    for (int k = 0; k < 3; ++k) {
      const Complex value = field.values[mesh.vertex(f, k)];
      if (std::isfinite(value.real()) && std::isfinite(value.imag())) continue;
      throw InputError(message("the vector of vertex ", mesh.vertex(f, k), " is not finite; replace it first"));
    }
  }
  SmoothResult result;
  result.vertices = region.innerVertices();
  if (result.vertices.empty()) {
    throw InputError(message("the region of ", region.faces().size(),
                             " faces has no vertex inside, around which all faces belong to it; make it larger"));
  }
  result.field = harmonicFill(field, result.vertices);
  result.residual = harmonicResidual(result.field, result.vertices);
  if (!(result.residual <= kMaxResidual)) {
    throw SolverError(message("smoothing left a residual of ", result.residual, " of the largest vector"));
  }
  result.change = changeBetween(field, result.field);
  return result;
}

}  // namespace stormfield
