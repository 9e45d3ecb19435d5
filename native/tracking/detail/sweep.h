// Which fixed point goes where: topological charges carried from face to face in the order of lambda.
//
// A charge is a fixed point of index +1 or -1. Every face holds as many as its Poincare index says. At a crossing one
// face gains a unit of index and the other loses it, so that one of four things happens:
//     the face that loses has that charge, the other no opposite one:  it crosses
//     the face that gains has the opposite charge, the other nothing:  the opposite one crosses, in the other direction
//     both:                                                            the two annihilate on the edge
//     neither:                                                         a pair is created on the edge
// At a boundary edge a charge enters or leaves the mesh. Nothing else can happen, so a path never breaks. In flat faces
// this is what the interpolated field does, exactly: its pairs appear and vanish on edges alone. In curved ones a pair
// may appear a little earlier inside a face, and is seen when one of the two leaves it.
#pragma once

#include <vector>

#include "tracking/detail/crossings.h"

namespace stormfield {

/// The path of one charge as a sequence of segments, each within one face x lambda: crossings[k] leads from the segment
/// in faces[k] to the one in faces[k + 1].
struct ChargePath {
  int charge = 0;  ///< Poincare index, +1 or -1
  std::vector<Index> faces;
  std::vector<Index> crossings;
  Index begin = kNone, end = kNone;  ///< crossings where it appears and vanishes; kNone: first, last sample
  /// The path that is created, that is annihilated with it; kNone at a boundary and at the first, last sample.
  Index createdWith = kNone, annihilatedWith = kNone;
};

/// In the order they begin: those of the first sample by face, then by crossing. A path that fixed points at vertices
/// cause by crossing several edges at once (created and annihilated at the same lambda) is removed, and the two that it
/// connects become one.
std::vector<ChargePath> sweepCharges(const TriangleMesh& mesh, const std::vector<int>& firstIndices,
                                     const std::vector<ZeroCrossing>& crossings, Progress& progress);

}  // namespace stormfield
