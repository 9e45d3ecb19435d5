// What a cache holds of a field at its samples: for each vertex the vector in space and, of the field that moves
// texture, its speed, stream function and rotation. In single precision, as files and shaders have it.
//
//   const FlowAttributes found = flowAttributes(field, 0, field.sampleCount(), streams);
//   const float speed = found.speed[j * field.vertexCount() + v];
#pragma once

#include <vector>

#include "base/progress.h"
#include "texture/stream_function.h"

namespace stormfield {

/// Samples x vertices (x 3 for vectors), mesh units and seconds.
struct FlowAttributes {
  std::vector<float> vectors, speed, stream, rotation;
};

/// Of `count` samples from `first` on, in parallel. streams: of the field's surface. Throws Cancelled.
FlowAttributes flowAttributes(const ParameterizedField& field, Index first, Index count,
                              const StreamFunctionSolver& streams, Progress* progress = nullptr);

/// The vectors alone.
std::vector<float> vectorsInSpace(const ParameterizedField& field, Index first, Index count,
                                  Progress* progress = nullptr);

}  // namespace stormfield
