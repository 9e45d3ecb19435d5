// Evenly spaced streamlines on a surface, topology first (thesis 3.4; Jobard and Lefer 1997 for the spacing, Mebarki,
// Alliez and Devillers 2005 for seeds in the middle of the widest gaps, Spencer et al. 2009 for surfaces).
//
// The given curves (periodic orbits, separatrices) are the first lines, and every other line keeps its distance from
// them: a separatrix ends where it comes near what it leads to, so that nothing crowds there. Then lines begin around
// the fixed points, then at the distance d next to the lines that exist, each as long as no other line is nearer than d
// / 2; last, wherever a point of the surface is still farther than d from every line. Lines that return to their
// beginning are closed. No point where the field flows is farther than 1.15 d from a line; lines are apart by d / 2 or
// more except where given curves meet. The result does not depend on the number of threads.
//
//   const EvenStreamlines lines = placeStreamlines(faces, field, {.distance = 0.01 * field.mesh().size()});
#pragma once

#include "base/progress.h"
#include "field/vector_field.h"
#include "topology/fixed_points.h"
#include "tracing/flat_faces.h"

namespace stormfield {

/// A streamline that is known already. Consecutive points lie in one face (or on the edges of one).
struct GivenCurve {
  std::vector<SurfacePoint> points;  ///< from the end that must stay; a closed one may repeat its first point
  bool closed = false;               ///< closed curves stay whole, others end where they come near another line
  bool againstFlow = false;          ///< the points run against the flow
  bool endsOnBoundary = false;       ///< its last point lies on the boundary: full width up to there
  bool leadsToPoint = false;         ///< it leads to a source or sink, and ends before the star of lines around it
};

struct StreamlineFeatures {
  std::vector<GivenCurve> curves;  ///< the first ones have precedence: orbits before separatrices
  std::vector<FixedPoint> fixedPoints;
};

struct EvenSpacing {
  double distance = 0.0;   ///< d, mesh units; at least a 2000th of the mesh's size
  double minSpeed = 1e-6;  ///< fraction of the fastest vertex's speed below which the field counts as still
};

/// Line i has the points offsets[i] to offsets[i + 1], in the direction of the flow, hardly more than d / 4 apart.
struct EvenStreamlines {
  std::vector<std::size_t> offsets{0};
  std::vector<SurfacePoint> points;
  std::vector<double> arc;    ///< per point, length along the line, mesh units
  std::vector<double> speed;  ///< per point, mesh units per second
  /// Per point, 0..1, a factor for the width: falls to 0 at ends inside the surface, and falls where a line comes near
  /// an earlier one.
  std::vector<double> taper;
  std::vector<char> closed;  ///< per line; closed lines do not repeat their first point
  std::vector<Index> given;  ///< per line, the given curve it is, kNone for the others
  double quietArea = 0.0;    ///< fraction of the surface where the field is still: no line is wanted there
  /// Where the field flows but no line could be drawn within 1.15 d, e.g. at the corner of a surface that it only
  /// touches.
  std::vector<SurfacePoint> gaps;
};

/// Throws InputError for a distance that is too small or not finite and a speed that is negative or not finite.
void checkSpacing(const TriangleMesh& mesh, const EvenSpacing& spacing);

/// Throws InputError as checkSpacing, and for a field of another mesh, a given curve without points and points that are
/// not on the mesh; Cancelled.
EvenStreamlines placeStreamlines(const FlatFaces& faces, const VectorField& field, const EvenSpacing& spacing,
                                 const StreamlineFeatures& features = {}, Progress* progress = nullptr);

}  // namespace stormfield
