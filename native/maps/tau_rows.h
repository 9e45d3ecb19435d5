// Rows of a tau map: the images F(T) of some faces at one tau, each from its own boundary (thesis 7.1).
//
// F(T) is what the images of the edges of T meet and what they enclose. A vertex lies inside the image when the flow
// takes it back into T (backward mapping, thesis 7.1.2); then all faces around it belong to F(T). Asked are the
// vertices of the faces met and, from those inside, their neighbours; inside a Morse set, all vertices of the set.
#pragma once

#include <vector>

#include "maps/point_advector.h"
#include "maps/set_windows.h"

namespace stormfield {

/// Row i belongs to faces[i]; targets ascend; faceCount stands for what has left the surface.
struct TauRows {
  std::vector<std::size_t> offsets{0};
  std::vector<Index> targets;
};

/// Images are followed in so many steps, a power of two, which the field changes little in.
int advectionStepCount(const PreparedFlow& flow, double tau);

/// The rows of `faces` (ascending, each once). Throws InputError when they need more than memoryLimit bytes, and
/// Cancelled.
TauRows tauRows(const PreparedFlow& flow, const std::vector<Index>& faces, double tau, std::size_t memoryLimit,
                Progress* progress = nullptr, TauWork* work = nullptr);
/// The rows of a Morse set's faces, of images that are followed only while they come back to the set.
TauRows tauRowsWithinSet(const PreparedFlow& flow, const std::vector<Index>& faces, double tau,
                         const SetWindows& windows, Progress* progress = nullptr, TauWork* work = nullptr);
/// Their rows in the geometry-based map, which stands for tau = 0.
TauRows geometryRows(const CombinatorialMap& geometry, const std::vector<Index>& faces);

/// Some faces with their rows.
struct RowGroup {
  std::vector<Index> faces;
  TauRows rows;
};
/// The map of all rows. Every face must have its row in one of the parts, which are taken apart.
CombinatorialMap mapFromRowGroups(Index faceCount, std::vector<RowGroup> parts);

}  // namespace stormfield
