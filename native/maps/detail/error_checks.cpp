#include "maps/detail/error_checks.h"

#include <cmath>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

void checkEpsilon(double epsilon) {
  if (epsilon >= 0.0 && std::isfinite(epsilon)) return;
  throw InputError(message("the error bound eps is ", epsilon, "; give a number >= 0"));
}

void checkWeights(const TriangleMesh& mesh, const std::vector<double>& weights) {
  if (weights.empty()) return;
  if (weights.size() != static_cast<std::size_t>(mesh.vertexCount())) {
    throw InputError(message("the error bound has ", weights.size(), " weights, but the mesh has ", mesh.vertexCount(),
                             " vertices; give one weight per vertex"));
  }
  for (std::size_t v = 0; v < weights.size(); ++v) {
    if (weights[v] >= 0.0 && std::isfinite(weights[v])) continue;
    throw InputError(message("the weight of the error at vertex ", v, " is ", weights[v], "; give a number >= 0"));
  }
}

void checkFieldError(const TriangleMesh& mesh, const FieldError& error) {
  checkEpsilon(error.epsilon);
  if (error.epsilon == 0.0) return;
  checkWeights(mesh, error.weights);
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    if (mesh.twin(h) != kNone) continue;
    throw InputError(message("an error bound of maps of the flow needs a closed surface, but edge ", mesh.edge(h),
                             " is on a boundary; choose the method 'geometry' or set eps to 0"));
  }
}

}  // namespace stormfield
