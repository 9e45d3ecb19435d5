// Constraints for tests and benchmarks of the solver: two storms on a surface around the origin that move with lambda.
#pragma once

#include <cmath>

#include "mesh/vertex_charts.h"
#include "solver/constraint.h"

namespace stormfield::storms {

struct StormOptions {
  Index samples = 100;
  double radius = 0.15;  ///< in sizes of the mesh
  double weight = 1000;  ///< 1 / size^2
  double shift = 0.0;    ///< of the second storm along its path, radians
};

/// Discs of rotating vectors around two centres that approach each other along circles of latitude. The value and the
/// disc are given in space, so that they mean the same on any mesh of the surface.
inline ConstraintSet storms(const VertexCharts& charts, const StormOptions& options) {
  const TriangleMesh& mesh = charts.mesh();
  const double radius = options.radius * mesh.size();
  const double distance = mesh.points().rowwise().norm().maxCoeff();
  ConstraintSet constraints;
  constraints.elementNames = {"west storm", "east storm"};
  for (Index j = 0; j < options.samples; ++j) {
    const double lambda = options.samples > 1 ? static_cast<double>(j) / (options.samples - 1) : 0.0;
    for (Index storm = 0; storm < 2; ++storm) {
      const double angle = (storm == 0 ? -1.0 : 1.0) * (1.0 - 0.7 * lambda) + (storm == 1 ? options.shift : 0.0);
      const double height = storm == 0 ? -0.3 : 0.3;
      const Vec3 axis(std::cos(angle) * std::sqrt(1.0 - height * height),
                      std::sin(angle) * std::sqrt(1.0 - height * height), height);
      const Vec3 centre = distance * axis;
      for (Index v = 0; v < mesh.vertexCount(); ++v) {
        const Vec3 offset = mesh.point(v) - centre;
        if (offset.squaredNorm() > radius * radius) continue;
        constraints.add(v, j, charts.toTangent(v, axis.cross(offset) / radius), options.weight, storm);
      }
    }
  }
  return constraints;
}

}  // namespace stormfield::storms
