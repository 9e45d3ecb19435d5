// Which fixed point goes where: charges carried from face to face in the order of lambda.
//
// Every face holds as many fixed points of index +1 or -1 as its Poincare index says. At a crossing one face gains a
// unit and the other loses it, so one of four things happens:
//     the face that loses has that charge, the other no opposite one:  it passes over
//     the face that gains has the opposite charge, the other nothing:  the opposite one passes over, the other way
//     both:                                                            the two annihilate on the edge
//     neither:                                                         a pair is created on the edge
// At a boundary edge a charge enters or leaves the mesh. Nothing else can happen, so a path never breaks. In flat faces
// this is what the interpolated field does, exactly: its pairs appear and vanish on edges alone. In curved ones a pair
// may appear a little earlier inside a face, and is seen when one of the two leaves it.
#pragma once

#include <vector>

#include "tracking/detail/crossings.h"

namespace stormfield {

/// A fixed point's way through the faces: crossings[k] leads from faces[k] to faces[k + 1].
struct FaceWay {
  int charge = 0;  ///< its Poincare index, +1 or -1
  std::vector<Index> faces;
  std::vector<Index> crossings;
  Index begin = kNone, end = kNone;      ///< crossings where it appears and vanishes; kNone: first, last sample
  Index partner = kNone, rival = kNone;  ///< way that appears with it, that vanishes with it; kNone at a boundary
};

/// In the order they begin: those of the first sample by face, then by crossing. A way that fixed points at vertices
/// cause by crossing several edges at once (created and annihilated at the same lambda) is taken out, and the two it
/// connects are made one.
std::vector<FaceWay> sweepCharges(const TriangleMesh& mesh, const std::vector<int>& firstIndices,
                                  const std::vector<ZeroCrossing>& crossings, Progress& progress);

}  // namespace stormfield
