// What a block must hold by its Conley index: the fewest entities that have this index together (thesis 2.3, 4.3).
//
// Each of the b0 classes is a sink or an attracting orbit, each of the b2 classes a source or a repelling orbit; an
// orbit takes one of the b1 classes along, and the others are saddles. Fewest are as many orbits as b1 allows. A
// connected block with a border has b0 + b2 <= 1, so that the choice is unique.
//
//   const std::string left = describe(fewestContents({0, 0, 1}));   // "one source"
#pragma once

#include <string>

#include "morse/conley_index.h"
#include "topology/topology.h"

namespace stormfield {

/// Numbers of entities by kind; other: centers, and what is degenerate.
struct Contents {
  int sources = 0, sinks = 0, saddles = 0, attractingOrbits = 0, repellingOrbits = 0, other = 0;

  friend bool operator==(const Contents&, const Contents&) = default;
  void add(FixedPointKind kind);
  void add(OrbitKind kind);
  int fixedPoints() const { return sources + sinks + saddles + other; }
};

/// For a connected block with a border.
Contents fewestContents(const ConleyIndex& index);
/// "nothing", "one sink", "one attracting orbit and one saddle".
std::string describe(const Contents& contents);

}  // namespace stormfield
