// The images of three neighbouring samples of an edge, laid into one plane, and how far the image of the edge may
// deviate from the two chords between them.
#pragma once

#include <array>
#include <optional>

#include "maps/detail/unfolding.h"
#include "maps/prepared_flow.h"

namespace stormfield {

/// The images of the ends a and b of an interval and of its middle, in the plane of the middle's face.
struct ChordShape {
  Unfoldings toA, toB;   ///< of the faces of a and b into the plane of the middle's face
  Complex middle{};      ///< in that plane
  Complex inA{}, inB{};  ///< a and b in the frames of their own faces
  /// Distance of the middle from the midpoint of a and b, in the unfoldings where it is least: an upper bound on its
  /// distance from the straight line between them.
  double deviation = 0.0;
  std::array<double, 2> chords{};  ///< lengths from the middle to a and to b
  double longestChord = 0.0;
  double faceSize = 0.0;  ///< of the middle's face
  /// By how much the ways around a vertex disagree about a or b (Unfoldings::spread).
  double spread = 0.0;

  /// False: the images are not in the same or in neighbouring faces; nothing but toA and toB is set.
  bool isComparable() const { return toA.count() > 0 && toB.count() > 0; }
};

ChordShape chordShape(const FlatFaces& faces, const SurfacePoint& a, const SurfacePoint& middle, const SurfacePoint& b);

/// What is known of an interval's image before a step.
struct DeviationBefore {
  double deviation;              ///< from its chords, mesh units
  std::array<double, 2> chords;  ///< lengths
};
enum class DeviationModel {
  Careful,   ///< images of whole faces
  InWindow,  ///< images within a Morse set, over long times: the deviation is a fraction of the chords at most
};

/// Estimate of the deviation of an interval's image from its chords after a step of stepTau that leads to `shape`.
/// An image deviates no more than the flow lengthens any vector. The flow also keeps the area between a chord and the
/// curve but for its divergence, so that the deviation grows by no more than that over the growth of the chord; this
/// holds where chords are short enough to resolve the curve. A step bends chords that lie in more than one face.
double deviationAfterStep(const PreparedFlow& flow, double stepTau, DeviationModel model, const DeviationBefore& before,
                          const std::array<Index, 3>& faces, const ChordShape& shape);

}  // namespace stormfield
