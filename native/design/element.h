// Design elements: what an artist places on the surface (thesis 5.2, 11.1.3, 11.1.4).
//
// An element is plain data in the object's own coordinates. Points are projected onto the surface; lambda says when it
// acts: one value per point for what moves (singularity paths, pathlines), or a start and an end, or one value for a
// single instant. Speeds are in mesh sizes (TriangleMesh::size) per second, lengths in mesh units, angles in radians,
// counter-clockwise seen from outside the surface.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/types.h"
#include "base/words.h"

namespace stormfield {

enum class ElementType { Singular, Regular, Streamline, Pathline };
template <>
inline constexpr Words kWords<ElementType>{"type of element", {"singular", "regular", "streamline", "pathline"}};

enum class SingularKind {
  Source,
  Sink,
  Saddle,
  VortexCcw,
  VortexCw,
  SpiralInCcw,
  SpiralInCw,
  SpiralOutCcw,
  SpiralOutCw
};
template <>
inline constexpr Words kWords<SingularKind>{"kind of singular element",
                                            {"source", "sink", "saddle", "vortex_ccw", "vortex_cw", "spiral_in_ccw",
                                             "spiral_in_cw", "spiral_out_ccw", "spiral_out_cw"}};

struct DesignElement {
  std::string name;  ///< unique in the design; messages speak of it
  ElementType type = ElementType::Singular;
  SingularKind kind = SingularKind::Source;  ///< singular elements only
  std::vector<Vec3> points;                  ///< a singular element with several points moves along them
  std::vector<double> lambdas = {0.0, 1.0};  ///< one per point, or {start, end}, or {instant}
  double strength = 0.2;                     ///< speed away from the centre, mesh sizes per second (not for pathlines)
  double radius = 0.1;                       ///< of the region, or half width of a curve's strip; mesh units
  double angle = 0.0;                        ///< of a saddle's outflow axis from the reference direction, radians
  std::optional<Vec3> direction;  ///< reference direction of the angle, or of a regular element with one point
  bool hard = false;              ///< the inner third of the region is met exactly
};

/// +1, or -1 for a saddle.
int poincareIndex(SingularKind kind);
/// Unit factor that rotates the direction away from the centre into the element's own direction (not for saddles).
Complex rotation(SingularKind kind);

/// Of a regular element: from its first point to its second, or its direction.
Vec3 arrowOf(const DesignElement& element);

/// Throws InputError on the first fault that needs no mesh: no element, duplicate names, values that are not finite,
/// a radius <= 0, too few points, lambda outside 0..1 or not increasing or of the wrong number.
void checkElements(const std::vector<DesignElement>& elements);

/// How an element is called in messages: curve "X", singular element "Y".
std::string describe(const DesignElement& element);
/// A number as messages show it: four digits.
std::string shortNumber(double value);

}  // namespace stormfield
