// Paths that matter: the history of fixed points without what lives shortly or is weak (thesis 11.2.2).
//
// In mesh x lambda the zeros form curves; a path is a part of one on which lambda grows, and a bifurcation is where the
// curve turns back. A short path is taken out together with its two turns, the shortest first: a pair that appears and
// vanishes together goes; of a fold (one path vanishes with the short one shortly after another appears with it) the
// two long parts become one path, which crosses the fold on its chord; what comes from or goes to the boundary within
// so little loses its last piece. The indices of the paths at any lambda still have the same sum on a closed mesh, and
// every path that is left lives long enough.
#pragma once

#include "tracking/tracking.h"

namespace stormfield {

struct PersistenceOptions {
  double minLife = 0.0;      ///< paths that live shorter are taken out, part of lambda
  double minStrength = 0.0;  ///< then weaker ones are left out, 1/s; a bifurcation stays while one of its paths does
};

/// Throws InputError for options that are negative or not finite.
Tracking persistent(const Tracking& tracking, const PersistenceOptions& options);

}  // namespace stormfield
