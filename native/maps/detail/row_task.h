// What the stages of a computation of tau map rows share (tau_rows.h): inputs, numbering, limits and counts.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "base/progress.h"
#include "maps/detail/block_lists.h"
#include "maps/detail/memory_budget.h"
#include "maps/detail/stepwise_advection.h"
#include "maps/prepared_flow.h"
#include "maps/set_windows.h"

namespace stormfield {

/// Slots of the marked elements (vertices or edges) of a mesh, in ascending order.
class SlotNumbering {
 public:
  explicit SlotNumbering(std::size_t size) : slots_(size, kNone) {}
  void mark(Index element) { slots_[element] = 0; }
  void number() {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (slots_[i] == kNone) continue;
      slots_[i] = static_cast<Index>(elements_.size());
      elements_.push_back(static_cast<Index>(i));
    }
  }
  Index slot(Index element) const { return slots_[element]; }
  const std::vector<Index>& elements() const { return elements_; }
  std::size_t bytes() const { return sizeof(Index) * (slots_.size() + elements_.size()); }

 private:
  std::vector<Index> slots_, elements_;
};

struct RowTask {
  /// windows: null to follow images everywhere.
  RowTask(const PreparedFlow& preparedFlow, const std::vector<Index>& rowFaces, double rowTau,
          const SetWindows* setWindows, std::size_t memoryLimit, Progress* rowProgress)
      : flow(preparedFlow),
        mesh(preparedFlow.mesh()),
        faces(rowFaces),
        tau(rowTau),
        windows(setWindows),
        steps(preparedFlow.stepCount(rowTau)),
        progress(rowProgress),
        budget(memoryLimit),
        vertices(mesh.vertexCount()),
        edges(mesh.edgeCount()) {
    for (const Index f : faces) {
      for (int i = 0; i < 3; ++i) {
        vertices.mark(mesh.vertex(f, i));
        edges.mark(mesh.edge(TriangleMesh::halfedge(f, i)));
      }
    }
    vertices.number();
    edges.number();
    allItems_ = vertices.elements().size() + 2 * edges.elements().size() + faces.size();
    budget.take(vertices.bytes() + edges.bytes());
  }

  /// Reports further items as done: a vertex and a row are one, an edge is two.
  void advance(std::size_t items) {
    if (progress == nullptr) return;
    progress->check();
    if (windows != nullptr) return;  // rows of one set of many: the refinement reports
    progress->report(std::min(1.0, static_cast<double>(doneItems_ += items) / static_cast<double>(allItems_)));
  }

  bool isInWindow(int step, const AdvectedPoint& image) const {
    return windows == nullptr || windows->contains(step, image.point.face);
  }

  /// Advects `count` points in parallel by steps of tau / steps; start and visit as in StepwiseAdvection.
  template <typename Start, typename Visit>
  void advectStepwise(std::size_t count, Direction direction, const Start& start, const Visit& visit) {
    constexpr std::size_t kBlock = BlockLists::kBlockSize;
    tbb::parallel_for(std::size_t{0}, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
      const std::size_t end = std::min(count, (block + 1) * kBlock);
      StepwiseAdvection queue(block * kBlock, end, tau / steps, start, visit);
      flow.advector(direction, progress)->advectAll(queue);
      if (direction == Direction::Forward) advance(end - block * kBlock);
    });
    traces += count;
  }

  const PreparedFlow& flow;
  const TriangleMesh& mesh;
  const std::vector<Index>& faces;  ///< whose rows are computed, ascending
  const double tau;
  const SetWindows* const windows;
  const int steps;
  Progress* const progress;
  MemoryBudget budget;
  SlotNumbering vertices, edges;  ///< of the faces
  std::atomic<std::size_t> traces{0};

 private:
  std::atomic<std::size_t> doneItems_{0};
  std::size_t allItems_ = 0;
};

}  // namespace stormfield
