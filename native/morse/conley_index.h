// The Conley index (Conley 1978; Mischaikow & Mrozek 2002, Conley Index) of a region of faces as Betti numbers of its
// index pair (N, L): the ranks of the relative homology H(N, L) over Z/2, where L is the exit set on the boundary of N
// (thesis 2.3.2, 8.2.3).
//
//     b0 = components of N that L does not meet,
//     b2 = components of N whose whole boundary is in L,
//     b1 = b0 + b2 - (chi(N) - chi(L)),
//
// which takes time linear in the faces of N, for any genus and any number of boundary loops.
//
// With a geometry-based map N is an isolating block: flow crosses each of its boundary edges in one direction, and
// touches N at its vertices from outside only. So corners of N that merely touch are apart: at a vertex where two fans
// of N meet, each has a copy of it. The index is then exact, and b0 - b1 + b2 is the sum of the Poincare indices
// inside, less the internal tangencies (exit_set.h) at the surface's own boundary.
//
// With a tau map, N and L are closed unions of faces and the numbers are an upper bound of the index (thesis 8.2.3) as
// long as F encloses the flow. The Poincare sum, which is exact, makes the bound smaller. Where the bound leaves no
// index with that sum, F has missed edges (tau_map.h) and the sum makes it larger (matchPoincareSum).
//
//   // One triangle that flow leaves over two of its edges.
//   const FaceSets sets({0}, 1);
//   const IndexPair pair{.exits = {Exit::Whole, Exit::Whole, Exit::None}};
//   const ConleyIndex index = conleyIndex(mesh, sets, 0, pair);
//   kindOf(index) == MorseKind::Trivial;      // (0, 0, 0)
#pragma once

#include "base/words.h"
#include "mesh/triangle_mesh.h"
#include "morse/index_sets.h"

namespace stormfield {

struct ConleyIndex {
  int b0 = 0, b1 = 0, b2 = 0;

  int euler() const { return b0 - b1 + b2; }
  friend bool operator==(const ConleyIndex&, const ConleyIndex&) = default;
};

/// What the index says about the flow inside (thesis 2.3.2).
enum class MorseKind {
  Source,      ///< (0, 0, 1)
  Sink,        ///< (1, 0, 0)
  Saddle,      ///< (0, 1, 0)
  Attracting,  ///< (1, 1, 0): an attracting periodic orbit
  Repelling,   ///< (0, 1, 1): a repelling periodic orbit
  Trivial,     ///< (0, 0, 0): possibly nothing, possibly a pair that cancels
  Other        ///< more than one of them
};

template <>
inline constexpr Words kWords<MorseKind>{"kind of Morse set",
                                         {"source", "sink", "saddle", "attracting", "repelling", "trivial", "other"}};

MorseKind kindOf(const ConleyIndex& index);

/// Where flow leaves N over a boundary edge, seen along the halfedge in N. AtTail and AtHead: over the piece of the
/// edge from that end to a sign change of the field across it. The closed piece belongs to L, its end included.
enum class Exit : char { None, AtTail, AtHead, Whole };

/// Whether corners of N at one vertex that share no edge of N are copies of it, or one point.
enum class Corners : char { Apart, Together };

/// L, for a set N of faces. exits has three entries for each face of N, in its order; those of halfedges between two
/// faces of N are ignored.
struct IndexPair {
  std::vector<Exit> exits;
  std::vector<Index> exitVertices{};  ///< further vertices of N that belong to L, ascending; only with corners together
  Corners corners = Corners::Apart;
};

/// The index of one of the sets. Throws InputError for a set that does not exist, and for a pair with another number of
/// exits or with exitVertices that do not ascend or are given with corners apart.
ConleyIndex conleyIndex(const TriangleMesh& mesh, const FaceSets& sets, Index set, const IndexPair& pair);

/// An upper bound that agrees with the sum of the Poincare indices: the least upper bound of the indices up to `bound`
/// with b0 - b1 + b2 = poincareSum. Where there are none, exits are missing from L: a least triple from `bound` on with
/// that sum, b2 raised before b0, since missing exits make b2 too small and never b0.
ConleyIndex matchPoincareSum(const ConleyIndex& bound, int poincareSum);

}  // namespace stormfield
