// Basis fields of singular elements around a point of the surface (thesis 5.2, equation 11.5).
//
// In the logarithmic map z = distance exp(i angle) of the centre a source, sink, vortex or spiral is rot * z / |z| and
// a saddle exp(2 i axis) * conj(z) / |z|, times the speed: growing linearly at the centre, constant outside of the
// core.
#pragma once

#include "design/detail/region.h"
#include "design/element.h"
#include "design/log_map.h"

namespace stormfield {

/// A singular element at one lambda.
struct SingularState {
  SurfacePoint point;
  SingularKind kind = SingularKind::Source;
  double speed = 0.0;   ///< mesh units per second
  double radius = 0.0;  ///< mesh units
  double axis = 0.0;    ///< of a saddle's outflow, in the flat frame of the point's face
};

/// rho / sqrt(rho^2 + core^2): 0 at the centre, 1 far away.
double speedProfile(double distance, double core);

/// Value at a vertex of the map around state.point, in the vertex's chart.
Complex singularValue(const SingularState& state, const LogMapEntry& entry);

/// Angle, in the flat frame of face f, of the element's reference direction (the object's x axis by default, its y axis
/// where x is normal to the surface) rotated by its angle at lambda.
double axisAngle(const VertexCharts& charts, const DesignElement& element, Index f, double lambda);

}  // namespace stormfield
