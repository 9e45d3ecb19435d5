// The tau map (thesis 6.3, 7.1; Chen et al. 2008, "Efficient Morse decompositions of vector fields"): the combinatorial
// map F whose row F(T) is an outer approximation of the image phi(tau, T) of the closed face T, for a time tau or an
// arc length (spatial tau, thesis 7.2). Outer approximations: Kalies, Mischaikow and VanderVorst 2005.
//
// The boundary of phi(tau, T) lies in the images of the edges of T, which are sampled until padded chords between
// samples enclose them (edge_image.h). Vertices mapped backwards into T fill its inside (tau_rows.h). Tangencies to the
// boundary of the surface are followed on their own (boundary_tangencies.h). An image that leaves the surface has an
// edge to outside(). The padding is an estimate, not a proof: tests look for points that F does not enclose.
//
//   const CombinatorialMap map = tauMap(faces, field, startingTau(field));
//   const Components components = stronglyConnectedComponents(map.graph);
#pragma once

#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "maps/combinatorial_map.h"
#include "maps/tau_options.h"
#include "tracing/flat_faces.h"

namespace stormfield {

/// tau in the unit of the options. A row depends on the tau of its own face only, so that rows can be computed apart
/// (tau_refinement.h). The same bits for any number of threads; at most 64 bytes per edge of F at the peak.
/// Throws InputError
///   - for a field of another mesh, and for values that are not finite;
///   - for a tau that is not a positive number;
///   - before the work begins, for a tau whose F does not fit into the memory limit (the message names one that fits);
///   - for an error that is not a number >= 0, on a surface with a boundary, or that lets fields diverge too far;
/// and Cancelled.
CombinatorialMap tauMap(const FlatFaces& faces, const VectorField& field, double tau, const TauMapOptions& options = {},
                        Progress* progress = nullptr, TauWork* work = nullptr);

/// The same with one tau per face; where it is 0, the face has its row of the geometry-based map (geometry_map.h).
CombinatorialMap tauMap(const FlatFaces& faces, const VectorField& field, const std::vector<double>& taus,
                        const TauMapOptions& options = {}, Progress* progress = nullptr, TauWork* work = nullptr);

/// A tau to start with: the time (or length) to cross `edges` mean edges at the mean speed of the field. Throws
/// InputError for a field that is zero everywhere and for a number of edges that is not positive.
double startingTau(const VectorField& field, TauUnit unit = TauUnit::Time, double edges = 4.0);

}  // namespace stormfield
