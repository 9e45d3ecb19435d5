// Many lists of faces of different length, made in parallel without an allocation per list.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/types.h"

namespace stormfield {

/// Lists of faces in blocks that are filled in parallel. Blocks have the same size whatever the number of threads.
class BlockLists {
 public:
  static constexpr std::size_t kBlockSize = 128;

  explicit BlockLists(std::size_t count) : lists_(count), blocks_((count + kBlockSize - 1) / kBlockSize) {}

  std::size_t blockCount() const { return blocks_.size(); }
  std::size_t begin(std::size_t block) const { return block * kBlockSize; }
  std::size_t end(std::size_t block) const { return std::min(lists_.size(), (block + 1) * kBlockSize); }

  /// Appends list i. Each list once, in any order within a block.
  void append(std::size_t i, const std::vector<Index>& list) {
    auto& block = blocks_[i / kBlockSize];
    lists_[i] = {static_cast<std::uint32_t>(block.size()), static_cast<std::uint32_t>(list.size())};
    block.insert(block.end(), list.begin(), list.end());
  }
  void finish(std::size_t block) { blocks_[block].shrink_to_fit(); }

  std::span<const Index> list(std::size_t i) const {
    return {blocks_[i / kBlockSize].data() + lists_[i].begin, lists_[i].size};
  }
  std::size_t blockBytes(std::size_t block) const { return sizeof(Index) * blocks_[block].size(); }
  void release(std::size_t block) { std::vector<Index>().swap(blocks_[block]); }

 private:
  struct List {
    std::uint32_t begin, size;
  };
  std::vector<List> lists_;
  std::vector<std::vector<Index>> blocks_;
};

}  // namespace stormfield
