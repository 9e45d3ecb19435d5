// Two singular elements of index +1 that merge into one, or split from one: their joint field (thesis 11.1.4, second
// way).
//
// In a plane the field rot * (z - a) (z - b) conj(z - s), with s between a and b, has exactly the two zeros and one
// saddle, and the index +1 around them: when a and b meet, the saddle annihilates with one of them and the other goes
// on. On the surface the three factors become the arrival directions of the three logarithmic maps,
//     V(v) = speed * rot * e_a(v) e_b(v) conj(e_s(v)),
// which needs no common chart. At a the directions of b and s agree and cancel, so each keeps its own kind.
//
// Far apart they are separate discs. While one disc enters the other the separate fields fade (share 1 - joint) and the
// joint field appears (share joint); when the distance goes to 0 speed, kind and region become those of the single
// element. Everything is continuous in lambda.
#pragma once

#include "design/detail/singular_field.h"

namespace stormfield {

struct SingularPair {
  SingularState a, b;
  SingularState single;   ///< the element they become, for its kind, speed and radius
  double distance = 0.0;  ///< along the surface between a and b, mesh units

  /// Share of the joint field, 0 while the discs touch, 1 once one centre lies in the other disc.
  double joint() const;
  /// 0 far apart, 1 at the meeting point: weight of the single element in kind, speed and region.
  double closeness() const;
};

/// The joint field at one vertex.
struct PairTarget {
  Index vertex = kNone;
  Complex value;
  double cover = 0.0;  ///< smooth union of the two discs' falloffs
  double scale = 0.0;  ///< length over which the field changes here, mesh units
  bool core = false;
};

/// The saddle lies between a and b. Maps of a, b and saddle must reach both discs.
std::vector<PairTarget> pairTargets(const TriangleMesh& mesh, const SingularPair& pair, const LogMap& mapA,
                                    const LogMap& mapB, const LogMap& mapSaddle);

}  // namespace stormfield
