// Which recurrent components of F can hold recurrence of the flow. A component without fixed points holds at most
// periodic orbits, and a periodic orbit that bounds a disk has a fixed point in it (a corollary of Poincare-Bendixson).
// So a set is empty, and no Morse set, when none of its faces can hold a fixed point and each of its closed curves can
// be contracted without crossing a face that can: when those of its holes that are disks without such faces are filled,
// a disk is left.
//
// The answer is monotone: a larger set, or more faces that can hold fixed points, never turn yes into no. Error bounds
// rely on that.
//
//   canRecur(mesh, FaceSets({0, 0, kNone}, 1), fixedPointFaces(field))[0] != 0;
#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "morse/index_sets.h"

namespace stormfield {

/// Per set whether it can hold recurrence. fixedPointFaces: per face whether it can hold a fixed point. Linear in the
/// faces of the sets and of the holes that are looked into.
std::vector<char> canRecur(const TriangleMesh& mesh, const FaceSets& sets, const std::vector<char>& fixedPointFaces);

}  // namespace stormfield
