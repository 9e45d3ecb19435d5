#include "maps/detail/forward_images.h"

#include <span>

#include "maps/detail/edge_image.h"

namespace stormfield {
namespace {

/// Images of the vertices after every step, as far as they were followed.
struct VertexImages {
  std::vector<AdvectedPoint> images;  ///< `steps` for each slot
  std::vector<int> known;             ///< how many of them, for each slot
  int steps;

  std::span<const AdvectedPoint> of(Index slot) const {
    return {images.data() + static_cast<std::size_t>(slot) * steps, static_cast<std::size_t>(known[slot])};
  }
};

VertexImages advectVertices(RowTask& task) {
  const std::vector<Index>& vertices = task.vertices.elements();
  const int steps = task.steps;
  VertexImages result{std::vector<AdvectedPoint>(vertices.size() * steps), std::vector<int>(vertices.size(), 0), steps};
  task.budget.take(sizeof(AdvectedPoint) * result.images.size());
  task.advectStepwise(
      vertices.size(), Direction::Forward, [&](std::size_t i) { return vertexPoint(task.mesh, vertices[i]); },
      [&](std::size_t i, int step, const AdvectedPoint& image) {
        result.images[i * steps + step - 1] = image;
        result.known[i] = step;
        return step < steps && task.isInWindow(step, image);
      });
  return result;
}

}  // namespace

ForwardImages forwardImages(RowTask& task) {
  const TriangleMesh& mesh = task.mesh;
  const std::vector<Index>& edges = task.edges.elements();
  VertexImages vertexImages = advectVertices(task);
  const auto imagesOf = [&](Index vertex) { return vertexImages.of(task.vertices.slot(vertex)); };
  ForwardImages result{BlockLists(edges.size()), std::vector<char>(edges.size(), 0)};
  tbb::parallel_for(std::size_t{0}, result.faces.blockCount(), [&](std::size_t block) {
    const std::size_t begin = result.faces.begin(block), end = result.faces.end(block);
    std::vector<EdgeToSample> chosen;
    for (std::size_t i = begin; i < end; ++i) {
      const Index h = mesh.edgeHalfedge(edges[i]);
      chosen.push_back({edges[i], imagesOf(mesh.tail(h)), imagesOf(mesh.head(h))});
    }
    EdgeImageSampler sampler(task.flow, task.tau, task.steps, task.windows, task.progress);
    sampler.sample(chosen, [&](std::size_t i, const EdgeImage& image) {
      result.faces.append(begin + i, image.faces);
      result.leavesSurface[begin + i] = image.leavesSurface;
    });
    result.faces.finish(block);
    task.budget.take(result.faces.blockBytes(block));
    task.traces += sampler.traces();
    task.advance(2 * (end - begin));
  });
  task.budget.giveBack(sizeof(AdvectedPoint) * vertexImages.images.size());
  return result;
}

}  // namespace stormfield
