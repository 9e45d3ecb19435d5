// The constraints of one solve, sorted into the rows of the finest level.
//
// Entry of a soft constraint: weight = sum of weight * area, pull = sum of weight * area * value. Entry of a hard one:
// weight infinite, pull = its value.
#pragma once

#include <algorithm>
#include <limits>

#include "solver/constraint.h"
#include "solver/detail/surface_hierarchy.h"

namespace stormfield {

struct ConstraintRows {
  struct Entry {
    Index sample;
    double weight;
    Complex pull;

    bool hard() const { return weight == std::numeric_limits<double>::infinity(); }
    bool operator==(const Entry&) const = default;
  };
  std::vector<std::size_t> start, stop;  ///< of each row, into entries
  std::vector<Entry> entries;            ///< in a row by sample, each sample once
  bool anyHard = false;

  const Entry* begin(Index row) const { return entries.data() + start[row]; }
  const Entry* end(Index row) const { return entries.data() + stop[row]; }
  bool sameRow(Index row, const ConstraintRows& other) const {
    return std::equal(begin(row), end(row), other.begin(row), other.end(row));
  }
};

/// rowOf: row of each mesh vertex (kNone for unused ones); mass: per row. Throws InputError, naming elements, when
/// there are no constraints, one is out of range or not finite, or two hard ones contradict.
ConstraintRows constraintRows(const ConstraintSet& constraints, const std::vector<Index>& rowOf,
                              const std::vector<double>& mass, Index samples);

}  // namespace stormfield
