#include "maps/tau_rows.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include "maps/detail/boundary_tangencies.h"
#include "maps/detail/forward_images.h"
#include "maps/detail/row_task.h"
#include "maps/detail/vertex_origins.h"

namespace stormfield {
namespace {

void sortUnique(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// The last stage: joins the images of a face's edges, tangencies and the vertices inside its image to its row.
class RowAssembly {
 public:
  RowAssembly(RowTask& task, const ForwardImages& images, const std::vector<TangencyEdge>& tangencies,
              const std::vector<VertexOrigin>& origins)
      : task_(task), mesh_(task.mesh), images_(images), tangencies_(tangencies), origins_(origins) {
    if (task.windows != nullptr) listSetVertices();
  }

  TauRows run() {
    BlockLists rows(task_.faces.size());
    tbb::enumerable_thread_specific<Scratch> scratches([this] {
      task_.budget.take(sizeof(std::uint32_t) * mesh_.vertexCount());
      return Scratch{{}, {}, std::vector<std::uint32_t>(mesh_.vertexCount(), 0)};
    });
    tbb::parallel_for(std::size_t{0}, rows.blockCount(), [&](std::size_t block) {
      Scratch& scratch = scratches.local();
      for (std::size_t i = rows.begin(block); i < rows.end(block); ++i) {
        if (task_.progress != nullptr) task_.progress->check();
        computeRow(task_.faces[i], scratch);
        rows.append(i, scratch.row);
      }
      rows.finish(block);
      task_.budget.take(rows.blockBytes(block));
      task_.advance(rows.end(block) - rows.begin(block));
    });
    return joined(rows);
  }

 private:
  /// What one thread needs for a row.
  struct Scratch {
    std::vector<Index> row, stack;
    std::vector<std::uint32_t> stamps;  ///< per vertex: the last row that visited it
    std::uint32_t stamp = 0;
  };
  /// A vertex of the set, by the face that the flow takes it from.
  struct SetVertex {
    VertexOrigin origin;
    Index vertex;

    auto operator<=>(const SetVertex&) const = default;
  };

  void listSetVertices() {
    for (const Index v : task_.vertices.elements()) setVertices_.push_back({origins_[v], v});
    std::sort(setVertices_.begin(), setVertices_.end());
  }

  void computeRow(Index face, Scratch& scratch) const {
    std::vector<Index>& row = scratch.row;
    row.clear();
    bool leaves = addBoundaryOfImage(face, row);
    sortUnique(row);
    addInsideOfImage(face, scratch);
    // A fixed point stays, though the image around it may be thinner than samples of the edges show.
    if (task_.flow.holdsFixedPoint(face)) {
      row.push_back(face);
      sortUnique(row);
    }
    for (const Index f : row) {
      for (int k = 0; k < 3 && !leaves; ++k) leaves = task_.flow.flowsOut(TriangleMesh::halfedge(f, k));
    }
    if (leaves) row.push_back(mesh_.faceCount());
  }

  /// Whether some of it may have left the surface.
  bool addBoundaryOfImage(Index face, std::vector<Index>& row) const {
    bool leaves = false;
    for (int k = 0; k < 3; ++k) {
      const Index slot = task_.edges.slot(mesh_.edge(TriangleMesh::halfedge(face, k)));
      const auto image = images_.faces.list(slot);
      row.insert(row.end(), image.begin(), image.end());
      leaves |= images_.leavesSurface[slot] != 0;
    }
    for (auto it = std::lower_bound(tangencies_.begin(), tangencies_.end(), TangencyEdge{face, 0});
         it != tangencies_.end() && it->face == face; ++it) {
      row.push_back(it->image);
    }
    return leaves;
  }

  /// Adds the faces around the vertices inside the image: those at its boundary first, then from each its neighbours.
  void addInsideOfImage(Index face, Scratch& scratch) const {
    auto& [row, stack, stamps, stamp] = scratch;
    ++stamp;
    stack.clear();
    const auto visit = [&](Index v) {
      if (stamps[v] == stamp) return;
      stamps[v] = stamp;
      if (origins_[v] == VertexOrigin(face)) stack.push_back(v);
    };
    for (const Index f : row) {
      for (int k = 0; k < 3; ++k) visit(mesh_.vertex(f, k));
    }
    for (int k = 0; k < 3; ++k) visit(mesh_.vertex(face, k));
    if (task_.windows != nullptr) {
      const auto [first, last] =
          std::equal_range(setVertices_.begin(), setVertices_.end(), SetVertex{VertexOrigin(face), kNone},
                           [](const SetVertex& a, const SetVertex& b) { return a.origin < b.origin; });
      for (auto it = first; it != last; ++it) visit(it->vertex);
    }
    if (stack.empty()) return;
    while (!stack.empty()) {
      const Index v = stack.back();
      stack.pop_back();
      for (Index h = mesh_.outgoing(v); h != kNone; h = mesh_.nextOutgoing(h)) {
        row.push_back(TriangleMesh::face(h));
        visit(mesh_.head(h));
        visit(mesh_.tail(TriangleMesh::prev(h)));
      }
    }
    sortUnique(row);
  }

  /// One array of all rows. Releases the blocks as it copies them, so that memory does not hold all rows twice.
  TauRows joined(BlockLists& rows) {
    const std::size_t count = task_.faces.size();
    TauRows result;
    result.offsets.resize(count + 1, 0);
    for (std::size_t i = 0; i < count; ++i) result.offsets[i + 1] = result.offsets[i] + rows.list(i).size();
    task_.budget.take(sizeof(Index) * result.offsets.back());
    result.targets.resize(result.offsets.back());
    tbb::parallel_for(std::size_t{0}, rows.blockCount(), [&](std::size_t block) {
      for (std::size_t i = rows.begin(block); i < rows.end(block); ++i) {
        const auto row = rows.list(i);
        std::copy(row.begin(), row.end(), result.targets.begin() + static_cast<std::ptrdiff_t>(result.offsets[i]));
      }
      rows.release(block);
    });
    return result;
  }

  RowTask& task_;
  const TriangleMesh& mesh_;
  const ForwardImages& images_;
  const std::vector<TangencyEdge>& tangencies_;
  const std::vector<VertexOrigin>& origins_;
  std::vector<SetVertex> setVertices_;  ///< ascending; empty without windows
};

TauRows computeRows(RowTask& task, TauWork* work) {
  const std::vector<TangencyEdge> tangencies = boundaryTangencyEdges(task.flow, task.tau, task.progress);
  const ForwardImages images = forwardImages(task);
  const std::vector<VertexOrigin> origins = vertexOrigins(task, images, tangencies);
  TauRows rows = RowAssembly(task, images, tangencies, origins).run();
  if (work != nullptr) {
    work->traces += task.traces;
    work->peakBytes = std::max(work->peakBytes, task.budget.peak());
  }
  return rows;
}

}  // namespace

TauRows tauRows(const PreparedFlow& flow, const std::vector<Index>& faces, double tau, std::size_t memoryLimit,
                Progress* progress, TauWork* work) {
  RowTask task(flow, faces, tau, nullptr, memoryLimit, progress);
  return computeRows(task, work);
}

TauRows tauRowsWithinSet(const PreparedFlow& flow, const std::vector<Index>& faces, double tau,
                         const SetWindows& windows, Progress* progress, TauWork* work) {
  RowTask task(flow, faces, tau, &windows, windows.memoryLimit, progress);
  return computeRows(task, work);
}

TauRows geometryRows(const CombinatorialMap& geometry, const std::vector<Index>& faces) {
  TauRows rows;
  for (const Index f : faces) {
    rows.targets.insert(rows.targets.end(), geometry.graph.begin(f), geometry.graph.end(f));
    rows.offsets.push_back(rows.targets.size());
  }
  return rows;
}

CombinatorialMap mapFromRowGroups(Index faceCount, std::vector<RowGroup> groups) {
  CombinatorialMap map;
  auto& [offsets, targets] = map.graph;
  if (groups.size() == 1) {  // all faces in their order
    offsets = std::move(groups[0].rows.offsets);
    targets = std::move(groups[0].rows.targets);
    offsets.push_back(targets.size());
    return map;
  }
  offsets.assign(static_cast<std::size_t>(faceCount) + 2, 0);
  for (const auto& [faces, rows] : groups) {
    for (std::size_t i = 0; i < faces.size(); ++i) offsets[faces[i] + 1] = rows.offsets[i + 1] - rows.offsets[i];
  }
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  targets.resize(offsets.back());
  for (const auto& [faces, rows] : groups) {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      std::copy(rows.targets.begin() + static_cast<std::ptrdiff_t>(rows.offsets[i]),
                rows.targets.begin() + static_cast<std::ptrdiff_t>(rows.offsets[i + 1]),
                targets.begin() + static_cast<std::ptrdiff_t>(offsets[faces[i]]));
    }
  }
  return map;
}

}  // namespace stormfield
