#include "edit/detail/block_sequence.h"

#include <iterator>
#include <optional>
#include <utility>

namespace stormfield {
namespace {

bool coversSurface(const TriangleMesh& mesh, const Block& block) {
  const Index component = mesh.component(mesh.vertex(block.faces.front(), 0));
  Index faces = 0;
  for (Index f = 0; f < mesh.faceCount(); ++f) faces += mesh.component(mesh.vertex(f, 0)) == component;
  return static_cast<std::size_t>(faces) == block.faces.size();
}

}  // namespace

BlockSequence::BlockSequence(const VectorField& field, const Topology& topology, const Interval& interval,
                             const ConleyIndex& index, int maxRings)
    : mesh_(field.mesh()), growth_(field, topology, interval), index_(index) {
  for (const Walls walls : {Walls::EntitiesAndSeparatrices, Walls::Entities}) {
    for (int rings = 1; rings <= maxRings; rings += 1 + rings / 4) {
      for (const Growth growth : {Growth::Rings, Growth::Hull}) steps_.push_back({growth, rings, walls});
    }
  }
}

const Block* BlockSequence::at(std::size_t number) {
  while (number >= blocks_.size() && step_ < steps_.size()) {
    makeOne();
    if (step_ < steps_.size()) continue;
    std::move(later_.begin(), later_.end(), std::back_inserter(blocks_));
  }
  return number < blocks_.size() ? &blocks_[number] : nullptr;
}

void BlockSequence::makeOne() {
  const auto& [growth, rings, walls] = steps_[step_++];
  std::optional<Block> block = growth_.grown(growth, rings, walls);
  if (!block || block->components != 1 || coversSurface(mesh_, *block)) return;
  if (!known_.insert(block->faces).second) return;
  if (!block->isolating) {
    later_.push_back(std::move(*block));
  } else if (block->index == index_) {
    blocks_.push_back(std::move(*block));
  }
}

}  // namespace stormfield
