// A periodic orbit: a closed streamline (thesis 2.2.1, 3.1).
#pragma once

#include <vector>

#include "mesh/surface_point.h"

namespace stormfield {

enum class OrbitKind {
  Attracting,
  Repelling,
  Center,      ///< one of a whole band of closed streamlines
  Degenerate,  ///< attracting on one side and repelling on the other
};

/// Lower-case word used in files and messages.
const char* name(OrbitKind kind);

struct PeriodicOrbit {
  OrbitKind kind = OrbitKind::Degenerate;
  /// Along the flow, one per edge crossing and integration step, the first repeated at the end.
  std::vector<SurfacePoint> points;
  std::vector<double> times;  ///< per point, seconds from the first
  double length = 0.0;        ///< mesh units
  double period = 0.0;        ///< seconds
  double multiplier = 1.0;    ///< derivative of the return map: < 1 attracting, > 1 repelling
};

}  // namespace stormfield
