// Design elements: what an artist places on the surface (thesis 5.2, 11.1.3, 11.1.4).
//
// An element is plain data in the object's own coordinates. Points are projected onto the surface; lambda says when it
// acts: one value per point for what moves (singularity paths, pathlines), or a start and an end, or one value for a
// single instant. Numbers of an element that stands still may change over lambda, with as many values as it has lambdas.
// Speeds are in mesh sizes (TriangleMesh::size) per second, lengths in mesh units, angles in radians, counter-clockwise
// seen from outside the surface.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/types.h"
#include "base/words.h"

namespace stormfield {

enum class ElementType { Singular, Regular, Streamline, Pathline, Attachment, Separation, Orbit, Bifurcation, Brush };
template <>
inline constexpr Words kWords<ElementType>{
    "type of element",
    {"singular", "regular", "streamline", "pathline", "attachment", "separation", "orbit", "bifurcation", "brush"}};

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

/// Whether flow beside a designed orbit nears it or leaves it.
enum class OrbitStability { Attracting, Repelling };
template <>
inline constexpr Words kWords<OrbitStability>{"kind of orbit element", {"attracting", "repelling"}};

/// What a bifurcation element makes happen as lambda grows: a saddle appears or vanishes together with a sink or source;
/// or a sink becomes a source and sheds a periodic orbit, or the reverse.
enum class BifurcationEvent { AppearSink, AppearSource, VanishSink, VanishSource, HopfBirth, HopfDeath };
template <>
inline constexpr Words kWords<BifurcationEvent>{
    "kind of bifurcation element",
    {"appear_sink", "appear_source", "vanish_sink", "vanish_source", "hopf_birth", "hopf_death"}};

/// What a brush stroke does (brush.h).
enum class BrushMode { Replace, Add, Strength, Smooth };
template <>
inline constexpr Words kWords<BrushMode>{"mode of a brush", {"replace", "add", "strength", "smooth"}};

/// A number that holds for all of an element's life, or one for each of its lambdas, linear in between and constant
/// outside of them.
class OverLambda {
 public:
  OverLambda(double value) : values_{value} {}
  OverLambda(std::vector<double> values) : values_(std::move(values)) {}

  double at(const std::vector<double>& lambdas, double lambda) const;
  double least() const;
  double largest() const;
  const std::vector<double>& values() const { return values_; }

 private:
  std::vector<double> values_;
};

struct DesignElement {
  std::string name;  ///< unique in the design; messages speak of it
  ElementType type = ElementType::Singular;
  SingularKind kind = SingularKind::Source;  ///< singular elements only
  std::vector<Vec3> points;                  ///< a singular element with several points moves along them
  std::vector<double> lambdas = {0.0, 1.0};  ///< one per point, or {start, end}, or {instant}
  OverLambda strength = 0.2;                 ///< speed away from the centre, mesh sizes per second (not for pathlines)
  OverLambda radius = 0.1;                   ///< of the region, or half width of a curve's strip; mesh units
  OverLambda angle = 0.0;         ///< of a saddle's outflow axis, or of an arrow, from the reference direction
  std::optional<Vec3> direction;  ///< reference direction of the angle, or of an arrow with one point
  bool hard = false;              ///< the inner third of the region is met exactly
  /// 1/s: flow at distance d from an attachment, separation or orbit nears or leaves it at the speed rate * d.
  OverLambda rate = 4.0;
  OrbitStability stability = OrbitStability::Attracting;  ///< orbits only
  /// An orbit turns against the order of its points; what a Hopf bifurcation sheds turns clockwise.
  bool reverse = false;
  BifurcationEvent event = BifurcationEvent::AppearSink;  ///< bifurcations only, which have one point and one lambda
  BrushMode mode = BrushMode::Replace;                    ///< brush strokes only
  double falloff = 0.5;  ///< of a brush: part of the radius over which it fades, 0 a hard edge
  double reach = 0.2;    ///< of a bifurcation: lambda from the event until its pair or orbit has its full size
  /// Lengths of lambda inside of the element's life over which its strength grows from 0, and falls to 0.
  double fadeIn = 0.0, fadeOut = 0.0;
};

/// Whether its points are a curve, an arrow's or a centre's place.
bool isCurve(const DesignElement& element);
/// Whether it is at different places at different lambda.
bool moves(const DesignElement& element);

inline double radiusAt(const DesignElement& element, double lambda) {
  return element.radius.at(element.lambdas, lambda);
}
inline double angleAt(const DesignElement& element, double lambda) {
  return element.angle.at(element.lambdas, lambda);
}
/// c of thesis eq. 5.2: minus the rate where flow nears the element's line, the rate where it leaves it, else 0.
double signedRateAt(const DesignElement& element, double lambda);
/// Strength at lambda with its fades, mesh sizes per second.
double strengthAt(const DesignElement& element, double lambda);
/// How firmly the element holds the field at lambda, 0 to 1: as the square of its strength, relative to the largest.
/// Where its strength falls to 0 it lets go, so that the field is free there instead of still.
double holdAt(const DesignElement& element, double lambda);

/// +1, or -1 for a saddle.
int poincareIndex(SingularKind kind);
/// Unit factor that rotates the direction away from the centre into the element's own direction (not for saddles).
Complex rotation(SingularKind kind);

/// Of a regular element: from its first point to its second, or its direction.
Vec3 arrowOf(const DesignElement& element);

/// Throws InputError on the first fault that needs no mesh: no element, duplicate names, values that are not finite,
/// a radius <= 0, a strength that is nowhere above 0 or somewhere below, too few points, lambda outside 0..1 or not
/// increasing or of the wrong number.
void checkElements(const std::vector<DesignElement>& elements);

/// How an element is called in messages: curve "X", singular element "Y".
std::string describe(const DesignElement& element);
/// A number as messages show it: four digits.
std::string shortNumber(double value);

}  // namespace stormfield
