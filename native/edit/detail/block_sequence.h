// The blocks of a pair to be cancelled, one after the other: isolating ones, from the smallest growth on, then the others
// (thesis 4.3).
//
// An isolating block around the interval alone has the index of the interval; one of another index is left out. So are
// blocks that cover a whole surface, and those that do not hang together.
//
//   BlockSequence blocks(field, topology, interval, index, 12);
//   for (std::size_t i = 0; const Block* block = blocks.at(i); ++i) use(*block);
#pragma once

#include <deque>
#include <set>
#include <vector>

#include "edit/detail/block_growth.h"

namespace stormfield {

/// Blocks are made when they are asked for, and kept.
class BlockSequence {
 public:
  BlockSequence(const VectorField& field, const Topology& topology, const Interval& interval, const ConleyIndex& index,
                int maxRings);

  /// nullptr behind the last one. The block stays where it is.
  const Block* at(std::size_t number);

 private:
  struct Step {
    Growth growth;
    int rings;
    Walls walls;
  };
  void makeOne();

  const TriangleMesh& mesh_;
  const BlockGrowth growth_;
  const ConleyIndex index_;
  std::vector<Step> steps_;
  std::size_t step_ = 0;
  std::set<std::vector<Index>> known_;
  std::deque<Block> blocks_, later_;
};

}  // namespace stormfield
