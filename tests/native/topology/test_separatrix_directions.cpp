#include "topology/detail/separatrix_directions.h"

#include <gtest/gtest.h>

#include "base/message.h"
#include "checks.h"
#include "flows.h"
#include "topology/detail/sectors.h"
#include "topology/fixed_points.h"

namespace stormfield::test {
namespace {

Vec3 unit(double angle) {
  return {std::cos(angle), std::sin(angle), 0.0};
}

/// A linear saddle with these angles of the directions that leave and enter it.
VectorField saddle(const Vec3& centre, double leaves, double enters) {
  Eigen::Matrix2d vectors;
  vectors.col(0) = unit(leaves).head<2>();
  vectors.col(1) = unit(enters).head<2>();
  const Eigen::Matrix2d a = vectors * Eigen::Vector2d(0.7, -2.0).asDiagonal() * vectors.inverse();
  return sampledOn(grid(8), [&](const Vec3& p) {
    const Eigen::Vector2d v = a * (p - centre).head<2>();
    return Vec3(v.x(), v.y(), 0.0);
  });
}

TEST(SeparatrixDirections, OfALinearSaddleAreItsEigenvectors) {
  // Inside a face, on edges (one axis, the diagonal), at a vertex.
  for (const Vec3& centre : {Vec3(0.11, 0.03, 0), Vec3(0.25, 0.1, 0), Vec3(0.1, 0.1, 0), Vec3(0.25, -0.5, 0)}) {
    for (const auto& [leaves, enters] : {std::pair(0.3, 1.3), std::pair(-1.0, 0.1), std::pair(2.0, 1.8)}) {
      const std::string what = message("at ", centre.transpose(), ", directions ", leaves, " and ", enters);
      const VectorField field = saddle(centre, leaves, enters);
      const FixedPoint p = findFixedPoints(field).at(0);
      const auto directions = separatrixDirections(field, p.point);
      ASSERT_EQ(directions.size(), 4u) << what;
      double before = 0.0, rotation = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        const SeparatrixDirection& d = directions[i];
        EXPECT_NE(d.outgoing, directions[(i + 1) % 4].outgoing) << what;
        const Vec3 eigenvector = unit(d.outgoing ? leaves : enters);
        EXPECT_NEAR(std::abs(d.inSpace.dot(eigenvector)), 1.0, 1e-9) << what;
        EXPECT_NEAR(std::abs(d.direction), 1.0, 1e-12) << what;
        expectNear(d.inSpace, field.charts->faceToSpace(d.face, d.direction), 1e-12, what);
        // Counter-clockwise, once around.
        const double angle = std::atan2(d.inSpace.y(), d.inSpace.x());
        if (i > 0) {
          const double step = std::remainder(angle - before, 2.0 * kPi);
          EXPECT_GT(step < 0.0 ? step + 2.0 * kPi : step, 0.0) << what;
          rotation += step < 0.0 ? step + 2.0 * kPi : step;
        }
        before = angle;
      }
      EXPECT_LT(rotation, 2.0 * kPi) << what;
    }
  }
}

TEST(SeparatrixDirections, OfAMonkeySaddleAreEvenlySpaced) {
  // conj(z^2), rotated, on a fan of 12 faces: radial where 3 angle is a multiple of pi after the rotation.
  static constexpr double kRotation = 0.2;
  std::vector<Vec3> points{{0, 0, 0}};
  std::vector<std::array<Index, 3>> faces;
  for (Index i = 0; i < 12; ++i) {
    points.push_back(unit(kPi * i / 6.0));
    faces.push_back({0, 1 + i, 1 + (i + 1) % 12});
  }
  const VectorField field = sampledOn(surface(points, faces), [](const Vec3& p) {
    const Complex z(p.x(), p.y()), v = std::conj(z * z) * std::polar(1.0, kRotation);
    return Vec3(v.real(), v.imag(), 0.0);
  });
  const auto directions = separatrixDirections(field, vertexPoint(field.mesh(), 0));
  ASSERT_EQ(directions.size(), 6u);
  // The interpolated field is a blend of the samples: its directions are near those of conj(z^2).
  for (const SeparatrixDirection& d : directions) {
    const double angle = std::atan2(d.inSpace.y(), d.inSpace.x());
    EXPECT_NEAR(std::cos(3.0 * angle - kRotation), d.outgoing ? 1.0 : -1.0, 0.05);
  }
}

TEST(SeparatrixDirections, OfASourceAreNone) {
  const VectorField field = sampledOn(grid(8), [](const Vec3& p) { return Vec3(p.x() - 0.11, 2.0 * p.y(), 0.0); });
  EXPECT_TRUE(separatrixDirections(field, findFixedPoints(field).at(0).point).empty());
}

TEST(SeparatrixStart, LiesOnTheDirectionInsideItsFace) {
  for (const Vec3& centre : {Vec3(0.11, 0.03, 0), Vec3(0.25, 0.1, 0), Vec3(0.25, -0.5, 0)}) {
    const VectorField field = saddle(centre, 0.3, 1.3);
    const FlatFaces faces(field.charts);
    const FixedPoint p = findFixedPoints(field).at(0);
    for (const SeparatrixDirection& d : p.separatrices) {
      const SurfacePoint start = separatrixStart(faces, p.point, d);
      EXPECT_EQ(start.face, d.face);
      EXPECT_GE(start.barycentric.minCoeff(), 0.0);
      const Vec3 away = position(field.mesh(), start) - centre;
      EXPECT_NEAR(away.norm(), 1e-3 * 0.25, 1e-9);
      EXPECT_NEAR(away.normalized().dot(d.inSpace), 1.0, 1e-9);
    }
  }
}

TEST(Sectors, SurroundThePoint) {
  struct Case {
    Vec3 place;
    std::size_t sectors;
    double opening;
    bool surrounded;
  };
  const VectorField field = sampledOn(grid(8), [](const Vec3&) { return Vec3(1, 0, 0); });
  const FlatFaces faces(field.charts);
  const TriangleMesh& mesh = field.mesh();
  for (const Case& c : {Case{{0.11, 0.03, 0}, 1, 2.0 * kPi, true}, Case{{0.25, 0.1, 0}, 2, 2.0 * kPi, true},
                        Case{{0.25, -0.5, 0}, 6, 2.0 * kPi, true}, Case{{1.0, 0.1, 0}, 1, kPi, false},
                        Case{{1.0, 0.25, 0}, 3, kPi, false}}) {
    SurfacePoint p;
    for (Index f = 0; f < mesh.faceCount() && p.face == kNone; ++f) {
      const Eigen::Vector3d b =
          faces[f].barycentric(field.charts->spaceToFace(f, c.place - mesh.point(mesh.vertex(f, 0))));
      if (b.minCoeff() > -1e-12) p = {f, b};
    }
    const auto sectors = sectorsAround(*field.charts, p);
    EXPECT_EQ(sectors.size(), c.sectors) << c.place.transpose();
    double opening = 0.0;
    for (const Sector& sector : sectors) {
      opening += sector.opening;
      const Eigen::Vector3d b = faces[sector.face].barycentric(sector.apex);
      expectNear(position(mesh, {sector.face, b}), c.place, 1e-12);
    }
    EXPECT_NEAR(opening, c.opening, 1e-12) << c.place.transpose();
    EXPECT_EQ(surroundsPoint(*field.charts, p, sectors), c.surrounded) << c.place.transpose();
  }
}

}  // namespace
}  // namespace stormfield::test
