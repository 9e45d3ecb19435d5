// The tau map (thesis 6.3, 7.1): the combinatorial map F of moving every point along the flow for a time tau, or for an
// arc length (spatial tau, thesis 7.2). F(T) encloses the image { phi(tau, x) : x in T } of the closed face T with
// padding that grows with what the flow may do between samples (edge_image.h). That is an estimate, not a proof; tests
// look for points that end outside.
//
// The image of a face is bounded by the images of its edges, which are sampled until the curves between samples are
// enclosed (edge_image.h); what lies inside is found by mapping vertices back (tau_rows.h). Flow that leaves through
// the boundary is an edge to outside().
//
//   const CombinatorialMap map = tauMap(faces, field, startingTau(field));
//   const Components parts = stronglyConnectedComponents(map.graph);
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "maps/combinatorial_map.h"
#include "tracing/flat_faces.h"

namespace stormfield {

enum class TauUnit {
  Time,    ///< seconds: phi is the flow of V
  Length,  ///< mesh units: phi is the flow of V at unit speed, which has the same trajectories (unit_speed_flow.h)
};

/// What is not known of a field: each vector by up to epsilon * weight, mesh units per second.
struct FieldError {
  double epsilon = 0.0;
  std::vector<double> weights{};  ///< one per vertex, not negative; empty: 1
};

struct TauMapOptions {
  TauUnit unit = TauUnit::Time;
  /// Largest estimated error of one step of a trace, in mean edge lengths.
  double tolerance = 1e-5;
  /// Bytes that F and the work on it may take; none: half of the memory of the machine.
  std::optional<std::size_t> memoryLimit{};
  /// F holds for all fields within the error (divergence_bound.h); on closed surfaces only.
  FieldError error{};
};

/// What the work took.
struct TauWork {
  std::size_t traces = 0;
  std::size_t peakBytes = 0;  ///< largest sum of the sizes of the arrays at a time
};

/// Rows depend on their own face's tau only, so that parts can be computed on their own (tau_refinement.h). The same
/// bits for any number of threads; at most 64 bytes per edge of F at the peak. Throws InputError for a field of another
/// mesh, for a tau that is not a positive number, and before the work begins when F would not fit into memory (the
/// message names the largest tau that does); for an error that is not a number >= 0, is given with a boundary, or lets
/// fields part too far to say anything; Cancelled.
CombinatorialMap tauMap(const FlatFaces& faces, const VectorField& field, double tau, const TauMapOptions& options = {},
                        Progress* progress = nullptr, TauWork* work = nullptr);

/// With a tau for every face; where it is 0, the face has the edges of the geometry-based map (geometry_map.h).
CombinatorialMap tauMap(const FlatFaces& faces, const VectorField& field, const std::vector<double>& taus,
                        const TauMapOptions& options = {}, Progress* progress = nullptr, TauWork* work = nullptr);

/// A tau to start with: the time (or length) to cross `edges` edges at the mean speed of the field. Throws InputError
/// for a field that is zero everywhere and for a number of edges that is not positive.
double startingTau(const VectorField& field, TauUnit unit = TauUnit::Time, double edges = 4.0);

}  // namespace stormfield
