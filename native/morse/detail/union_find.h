// Disjoint classes of 0 .. n-1 that are joined step by step (union-find: Galler & Fischer 1964), each named by its
// least member. Paths are halved as they are followed, so that n joins and finds take O(n log n) time at most (Tarjan &
// van Leeuwen 1984).
//
//   UnionFind classes(4);
//   classes.join(1, 3);     // true: they were two
//   classes.find(3);        // 1
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
