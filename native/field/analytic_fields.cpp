#include "field/analytic_fields.h"

#include <cmath>
#include <utility>

namespace stormfield {
namespace {

template <typename Field>
Points vectorsAtVertices(const TriangleMesh& mesh, const Field& field) {
  Points vectors(mesh.vertexCount(), 3);
  for (Index v = 0; v < mesh.vertexCount(); ++v) vectors.row(v) = field(mesh.point(v));
  return vectors;
}

}  // namespace

VectorField sampled(std::shared_ptr<const VertexCharts> charts, const SpaceField& field) {
  const Points vectors = vectorsAtVertices(charts->mesh(), field);
  return fromSpace(std::move(charts), vectors);
}

ParameterizedField sampled(std::shared_ptr<const VertexCharts> charts, std::vector<double> lambdas,
                           const SpaceFieldOverLambda& field) {
  std::vector<Complex> values;
  for (const double lambda : lambdas) {
    const Points vectors = vectorsAtVertices(charts->mesh(), [&](const Vec3& p) { return field(p, lambda); });
    const std::vector<Complex> sample = fromSpace(charts, vectors).values;
    values.insert(values.end(), sample.begin(), sample.end());
  }
  return makeParameterizedField(std::move(charts), std::move(lambdas), std::move(values));
}

namespace analytic {

SpaceField uniform(const Vec3& velocity) {
  return [velocity](const Vec3&) { return velocity; };
}

SpaceField rotation(const Vec3& angularVelocity) {
  return [angularVelocity](const Vec3& p) { return Vec3(angularVelocity.cross(p)); };
}

Vec3 equation31(const Vec3& p) {
  return {p.y(), -p.x() + p.y() * std::cos(p.x()), 0.0};
}

SpaceField hopf(double growth, double rotation) {
  return [=](const Vec3& p) {
    const double radial = growth - p.squaredNorm();
    return Vec3(radial * p.x() - rotation * p.y(), radial * p.y() + rotation * p.x(), 0.0);
  };
}

SpaceField swirl(double phase) {
  return [phase](const Vec3& p) {
    return Vec3(std::sin(3.0 * p.y() + phase) + 0.3 * p.x(), std::cos(2.0 * p.z() - phase) - 0.2 * p.y(),
                std::sin(3.0 * p.x() + 1.0) + 0.5 * std::cos(phase) * p.z());
  };
}

Eigen::Vector2d foldForm(double x, double y, double parameter) {
  return {parameter - x * x, -y};
}

Eigen::Vector2d hopfForm(double x, double y, double parameter) {
  const double radial = parameter - x * x - y * y;
  return {radial * x - y, x + radial * y};
}

SpaceFieldOverLambda Placement::field(const PlanarForm& form) const {
  return [*this, form](const Vec3& p, double l) -> Vec3 {
    const Eigen::Rotation2Dd rotated(angle);
    const Eigen::Vector2d local = rotated.inverse() * (p.head<2>() - place - (l - lambda) * drift) / size;
    const Eigen::Vector2d v = rotated * form(local.x(), local.y(), rate * (l - lambda));
    return {v.x(), v.y(), 0.0};
  };
}

}  // namespace analytic
}  // namespace stormfield
