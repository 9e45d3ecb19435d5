// Simplifying a field: linked pairs are cancelled one after the other, the least persistent first (thesis 4.3, 6.4).
//
// The persistence of a pair is the least error bound epsilon at which both lie in one strongly connected component of the
// geometry-based map of the given field (morse/persistence.h): fields within that bound exist of which no Morse decomposition tells them
// apart. Each cancellation is verified (edit/cancel.h), and a pair that cannot be cancelled is left. Pairs that would leave
// as many entities as before are not tried.
//
//   const SimplifyResult simpler = simplifyField(faces, field, findTopology(faces, field), {.keep = 12}, progress);
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/progress.h"
#include "edit/cancel.h"

namespace stormfield {

struct SimplifyOptions {
  /// Pairs up to this persistence are cancelled, and no vector may change by more; in mean speeds of the field.
  double epsilon = std::numeric_limits<double>::infinity();
  int keep = 0;  ///< fixed points and periodic orbits at which to stop
  /// Of a pair that needs several edits others are cancelled first.
  CancelOptions cancel = {.maxChecks = 6, .inSteps = false};
};

/// One pair that was tried.
struct SimplifyStep {
  std::string pair;          ///< names and places
  double persistence = 0.0;  ///< mean speeds
  bool applied = false;
  std::string reason;  ///< why not
};

struct SimplifyResult {
  VectorField field;
  Topology topology;
  std::vector<SimplifyStep> steps;
  std::vector<Index> vertices;  ///< whose vectors changed, ascending
  FieldChange change;           ///< from the given field
};

/// topology: of the field. The same for any number of threads. Throws InputError for an epsilon or keep below 0, and
/// Cancelled.
SimplifyResult simplifyField(const FlatFaces& faces, const VectorField& field, const Topology& topology,
                             const SimplifyOptions& options, Progress& progress);

}  // namespace stormfield
