// Rows of a tau map: outer approximations F(T) of the images phi(tau, T) of some faces, all with one tau (thesis 7.1).
//
// Forward: the boundary of an image lies in the images of the three edges of T, as lists of faces. Backward: a vertex
// lies inside the image when the flow takes it from T, and then all faces around it belong to F(T). Traced back are the
// vertices of the faces that edge images meet and, from each vertex that lies inside, its neighbours; within a Morse
// set, all vertices of the set. Tangencies to the boundary of the surface add the faces of tangent trajectories.
//
//   const PreparedFlow flow(faces, field, TauUnit::Time, 1e-5);
//   const TauRows rows = tauRows(flow, {0, 1, 2}, 0.5, std::size_t{1} << 30);
#pragma once

#include <cstddef>
#include <vector>

#include "base/progress.h"
#include "maps/combinatorial_map.h"
#include "maps/prepared_flow.h"
#include "maps/set_windows.h"
#include "maps/tau_options.h"

namespace stormfield {

/// Row i belongs to faces[i]; targets ascend; the face count stands for what has left the surface.
struct TauRows {
  std::vector<std::size_t> offsets{0};
  std::vector<Index> targets;
};

/// The rows of `faces` (ascending, each once). Throws InputError when they need more than memoryLimit bytes, and
/// Cancelled. The same bits for any number of threads.
TauRows tauRows(const PreparedFlow& flow, const std::vector<Index>& faces, double tau, std::size_t memoryLimit,
                Progress* progress = nullptr, TauWork* work = nullptr);
/// The rows of a Morse set's faces, from images that are followed only while they stay in the windows. Throws as above,
/// by the memory limit of the windows.
TauRows tauRowsWithinSet(const PreparedFlow& flow, const std::vector<Index>& faces, double tau,
                         const SetWindows& windows, Progress* progress = nullptr, TauWork* work = nullptr);
/// The rows of `faces` in the geometry-based map, which stands for tau = 0.
TauRows geometryRows(const CombinatorialMap& geometry, const std::vector<Index>& faces);

/// Some faces with their rows.
struct RowGroup {
  std::vector<Index> faces;
  TauRows rows;
};
/// The map of all rows. Each face has its row in exactly one of the groups.
CombinatorialMap mapFromRowGroups(Index faceCount, std::vector<RowGroup> groups);

}  // namespace stormfield
