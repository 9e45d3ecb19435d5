// Classes of 0..n-1 that are joined step by step; each is named by its least member.
#pragma once

#include <numeric>
#include <utility>
#include <vector>

#include "base/types.h"

namespace stormfield {

class UnionFind {
 public:
  explicit UnionFind(Index count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  Index find(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Whether they were in two classes.
  bool join(Index a, Index b) {
    a = find(a);
    b = find(b);
    if (a > b) std::swap(a, b);
    parent_[b] = a;
    return a != b;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace stormfield
