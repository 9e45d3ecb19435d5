// What an edit of one field gives: the changed field where it was verified, else the reason why nothing changed.
#pragma once

#include <string>
#include <vector>

#include "base/words.h"
#include "field/vector_field.h"
#include "morse/conley_index.h"
#include "topology/topology.h"

namespace stormfield {

/// How the vectors inside a block were made.
enum class Fill {
  None,
  Harmonic,
  Directions,
  Rotation,  ///< as they were, but turned
  Steps      ///< by several edits, each of which was verified
};
template <>
inline constexpr Words kWords<Fill>{"fill", {"none", "harmonic", "directions", "rotation", "steps"}};

/// How far the vectors were changed.
struct FieldChange {
  double largestAngle = 0.0;   ///< between a vector before and after, radians
  double largestLength = 0.0;  ///< |after| / |before| - 1, in absolute value, where both are not zero
  double largest = 0.0;        ///< |after - before|, mesh units per second
};

struct EditResult {
  bool applied = false;
  std::string reason;           ///< why it was refused: one sentence, with the entity and the cure
  VectorField field;            ///< as given, bit by bit, unless applied
  Topology topology;            ///< of the field above
  ConleyIndex index;            ///< of the block
  std::vector<EntityRef> left;  ///< entities of the topology that the edit left in its block
  std::vector<Index> faces;     ///< of the block, ascending
  std::vector<Index> vertices;  ///< whose vectors changed, ascending
  Fill fill = Fill::None;
  FieldChange change;
};

FieldChange changeBetween(const VectorField& before, const VectorField& after);
/// Ascending.
std::vector<Index> changedVertices(const VectorField& before, const VectorField& after);

/// Makes the result that of a verified edit: of the field after it, its topology, and what it left in its block.
void accept(EditResult& result, const VectorField& before, VectorField after, Topology topology,
            std::vector<EntityRef> left, std::vector<Index> faces, Fill fill);

}  // namespace stormfield
