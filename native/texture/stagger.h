// Phase offsets over the surface, so that the renewal of the texture is never seen as one pulse of the whole object.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace stormfield {

struct StaggerOptions {
  /// Cycles by which offsets differ over the object. More hides the renewal better, but texture is stretched by the
  /// difference in age of neighbouring points: by speed times period times the slope of the offsets.
  double cycles = 1.0;
  /// Lumps of equal offset per size of the object.
  double frequency = 1.5;
  std::uint64_t seed = 0;
};

/// Smooth solid noise at the vertices, in cycles. It is flattened as far as needed for the offsets of the ends of every
/// edge to differ by at most largestStep, which a very coarse mesh may demand.
std::vector<double> stagger(const TriangleMesh& mesh, const StaggerOptions& options, double largestStep);

/// The largest difference over an edge, and that edge.
struct StaggerStep {
  double difference = 0.0;
  Index edge = kNone;
};
StaggerStep largestStaggerStep(const TriangleMesh& mesh, const std::vector<double>& offsets);

}  // namespace stormfield
