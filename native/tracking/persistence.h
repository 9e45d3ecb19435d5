// The persistent part of a tracking: the history of fixed points without those that live shortly or are weak (thesis
// 11.2.2).
//
// As pairs of critical points are cancelled in the order of their persistence (Edelsbrunner, Letscher and Zomorodian
// 2002), a short path is removed together with its two bifurcations, the shortest first:
//     a pair that is created and annihilated together is removed as a whole;
//     of a fold (a path is annihilated with the short one, shortly after another was created with it) the two long
//     paths become one, which crosses the fold on its chord; a path that exchanges a short one with the boundary loses
//     its last piece.
// The indices of the paths at any lambda still have the same sum on a closed mesh, and every path that is left lives
// long enough.
//
//   const Tracking persistentOnes = persistent(tracking, {.minLife = 0.02});
#pragma once

#include "tracking/tracked_paths.h"

namespace stormfield {

struct PersistenceOptions {
  double minLife = 0.0;      ///< paths that live shorter are removed, interval of lambda
  double minStrength = 0.0;  ///< then weaker ones are left out, 1/s; a bifurcation stays while one of its paths does
};

/// Throws InputError for options that are negative or not finite.
Tracking persistent(const Tracking& tracking, const PersistenceOptions& options);

}  // namespace stormfield
