// Cancelling a pair: a repeller and an attractor that flow joins vanish together with the saddles between them, and what
// the Conley index of their block forces remains (thesis 4.3; docs/algorithms/edits.md).
//
// The block grows ring by ring. Each is filled by the constrained Laplace equation, then by directions with as few zeros
// as its border allows. The first field is taken whose topology holds inside the block exactly what the index asks for,
// and outside the same graph as before. Where none does, several edits are tried: the pairs in between one after the other, or
// a move of one entity to the other first. In the end nothing changes, and the reason says which test failed.
//
// All six direct and seven indirect cases of the thesis (figures 4.1, 4.2) are one method: the index decides what remains.
// Vectors outside the block, and at the boundary of the surface, keep their bits.
//
//   const Topology topology = findTopology(faces, field);
//   const EditResult result = cancelPair(faces, field, topology, {EntityKind::FixedPoint, 2}, {EntityKind::FixedPoint, 5});
#pragma once

#include "base/progress.h"
#include "edit/contents.h"
#include "edit/edit_result.h"
#include "edit/interval.h"
#include "tracing/flat_faces.h"

namespace stormfield {

struct CancelOptions {
  TopologyOptions topology = {};
  int maxRings = 12;    ///< of faces around the pair, up to which the block grows
  int maxChecks = 16;   ///< fields whose topology is found, before one change of the field is given up
  bool inSteps = true;  ///< whether several edits are tried where no single change is verified
};

/// What cancelling a pair would do.
struct CancelPlan {
  Interval interval;
  ConleyIndex index;
  Contents left;             ///< what must remain: fewestContents(index)
  std::vector<Index> faces;  ///< of the first block that would be tried, ascending
};

/// Without any change. Throws InputError, in a sentence for users, where the two cannot be cancelled: see findInterval,
/// and where no isolating block is found around them.
CancelPlan planCancel(const VectorField& field, const Topology& topology, const EntityRef& a, const EntityRef& b,
                      const CancelOptions& options = {});

/// topology: of the field, by these options. A pair that cannot be cancelled is a result with its reason, no exception.
/// The same for any number of threads. Throws Cancelled.
EditResult cancelPair(const FlatFaces& faces, const VectorField& field, const Topology& topology, const EntityRef& a,
                      const EntityRef& b, const CancelOptions& options = {}, Progress* progress = nullptr);

}  // namespace stormfield
