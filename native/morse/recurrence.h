// Which strongly connected sets can hold recurrence at all: a set without fixed points holds at most periodic orbits,
// and by Poincare-Bendixson every closed orbit that bounds a disk has a fixed point in it. So a set is empty, and no
// Morse set, when none of its faces can hold a fixed point and all its closed curves can be contracted without crossing
// a face that can: when its holes that are disks without such faces are filled, a disk is left.
//
// A larger set, or more faces that can hold fixed points, never turn a set that counts into one that does not; error
// bounds rely on that.
#pragma once

#include <vector>

#include "field/vector_field.h"
#include "morse/index_sets.h"

namespace stormfield {

/// Per set whether it can hold recurrence. resting: per face whether it can hold a fixed point.
std::vector<char> canRecur(const TriangleMesh& mesh, const FaceSets& sets, const std::vector<char>& resting);

}  // namespace stormfield
