// The exceptions of the core. Messages name the element and the cure: users read them unchanged.
#pragma once

#include <stdexcept>

namespace stormfield {

/// The user's data cannot be used: names the element (vertex, edge, face, curve, sample) and the cure.
class InputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The mesh is not an oriented 2-manifold of proper triangles.
class MeshError : public InputError {
  using InputError::InputError;
};

/// The solver did not reach its tolerance.
class SolverError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The work was stopped through its Progress.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

}  // namespace stormfield
