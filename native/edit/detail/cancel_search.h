// The search for a field in which a pair is cancelled: fills of one block after the other, until one is verified
// (thesis 4.3).
//
//   CancelSearch search(task, interval, index);
//   if (!search.run(result)) result.reason = search.reason();
#pragma once

#include <string>

#include "edit/cancel.h"
#include "edit/detail/block_sequence.h"

namespace stormfield {

/// A field to be edited, and its topology. Kept by reference.
struct EditTask {
  const FlatFaces& faces;
  const VectorField& field;
  const Topology& topology;
  const CancelOptions& options;
  Progress* progress;
};

class CancelSearch {
 public:
  /// index: of the interval. All are kept by reference but the index.
  CancelSearch(const EditTask& task, const Interval& interval, const ConleyIndex& index);

  /// Whether a field was verified, which then is in the result.
  bool run(EditResult& result);
  /// Why none was.
  std::string reason() const;

 private:
  bool holdsOrbit() const;
  void tryFills(const Block& block, EditResult& result);
  void tryRotations(const Block& block, EditResult& result);
  void tryField(VectorField filled, Fill fill, const Block& block, EditResult& result);
  bool hasWantedPoints(const VectorField& filled, const Block& block);
  Contents newPoints(const VectorField& filled) const;

  const EditTask& task_;
  const Interval& interval_;
  const Contents wanted_;
  BlockSequence blocks_;
  std::vector<Index> zeroFaces_;
  int checks_ = 0, maxChecks_ = 0;
  std::string fault_;
};

/// Why a pair has no block.
std::string noRoom(const TriangleMesh& mesh, const Topology& topology, const Interval& interval);

}  // namespace stormfield
