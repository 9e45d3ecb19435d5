// Fields given by formulas, whose topology is known: for tests, demonstrations and debugging, as OpenVDB's
// VelocityFields.h.
//
// A space field gives a vector for every point of space, in mesh units per second; sampled() takes its tangential
// component at the vertices of a mesh. Planar forms live in the plane z = 0.
//
//   const VectorField field = sampled(charts, analytic::hopf(0.25, 1.0));
//   const auto merging = sampled(charts, evenLambdas(21), analytic::Placement{}.field(analytic::foldForm));
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "field/parameterized_field.h"

namespace stormfield {

using SpaceField = std::function<Vec3(const Vec3& point)>;
using SpaceFieldOverLambda = std::function<Vec3(const Vec3& point, double lambda)>;

/// Both throw InputError where a vector is not finite (names the vertex).
VectorField sampled(std::shared_ptr<const VertexCharts> charts, const SpaceField& field);
ParameterizedField sampled(std::shared_ptr<const VertexCharts> charts, std::vector<double> lambdas,
                           const SpaceFieldOverLambda& field);

namespace analytic {

/// The same vector everywhere: no fixed points in the plane.
SpaceField uniform(const Vec3& velocity);
/// Rigid rotation, angularVelocity x point (radians per second): on a sphere two centers at the ends of the axis, all
/// other streamlines closed.
SpaceField rotation(const Vec3& angularVelocity);
/// Thesis equation 3.1: exactly n periodic orbits inside the radius (n + 1) pi, attracting and repelling alternately.
Vec3 equation31(const Vec3& point);
/// Normal form of the Hopf bifurcation: r' = r (growth - r^2), angle' = rotation. For growth > 0 a source inside an
/// attracting orbit of radius sqrt(growth), period 2 pi / |rotation| and multiplier exp(-2 growth period); else a sink.
SpaceField hopf(double growth, double rotation);
/// Vortices, saddles, sources and sinks on any surface near the origin, at speeds around 1; smooth in phase.
SpaceField swirl(double phase = 0.0);

/// A vector of the plane from its coordinates and the parameter of a bifurcation.
using PlanarForm = std::function<Eigen::Vector2d(double x, double y, double parameter)>;

/// Normal form of the saddle-node bifurcation: x' = parameter - x^2, y' = -y. A sink at x = sqrt(parameter) and a
/// saddle at x = -sqrt(parameter), which meet at 0; none below.
Eigen::Vector2d foldForm(double x, double y, double parameter);
/// Normal form of the Hopf bifurcation that rotates by one radian per second.
Eigen::Vector2d hopfForm(double x, double y, double parameter);

/// Where a planar form stands on the plane z = 0, and how lambda changes it.
struct Placement {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double angle = 0.0;                               ///< radians, counter-clockwise
  double size = 1.0;                                ///< mesh units per unit of the form
  double lambda = 0.5;                              ///< at which the form's parameter is 0
  double rate = 1.0;                                ///< of the parameter per lambda
  Eigen::Vector2d drift = Eigen::Vector2d::Zero();  ///< of the whole pattern per lambda

  SpaceFieldOverLambda field(const PlanarForm& form) const;
};

}  // namespace analytic
}  // namespace stormfield
