#include <gtest/gtest.h>

#include "checks.h"
#include "fixtures.h"
#include "streamlines/detail/given_curves.h"
#include "streamlines/detail/straightest_path.h"
#include "streamlines/detail/taper.h"

namespace stormfield {
namespace {

using test::kPi;

SurfacePoint pointAt(const FlatFaces& faces, const Vec3& place) {
  const TriangleMesh& mesh = faces.mesh();
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const Eigen::Vector3d b =
        faces[f].barycentric(faces.charts().spaceToFace(f, place - mesh.point(mesh.vertex(f, 0))));
    const SurfacePoint p{f, b};
    if (b.minCoeff() > -1e-12 && (position(mesh, p) - place).norm() < 1e-9) return p;
  }
  return {};
}

TEST(StraightestPath, InThePlaneIsAStraightLine) {
  const FlatFaces faces(test::makeCharts(test::grid(12, 0.3)));
  const SurfacePoint from = pointAt(faces, Vec3(0.013, -0.027, 0.0));
  for (int i = 0; i < 24; ++i) {
    const Vec3 direction(std::cos(0.27 * i), std::sin(0.27 * i), 0.0);
    const Complex local = faces.charts().spaceToFace(from.face, direction);
    const StraightestPath path = straightestPath(faces, from, 3.0 * local, 0.9);
    test::expectNear(position(faces.mesh(), path.point), position(faces.mesh(), from) + 0.9 * direction, 1e-7);
    EXPECT_NEAR(path.length, 0.9, 1e-12);
    test::expectNear(faces.charts().faceToSpace(path.point.face, path.direction), direction, 1e-9);
  }
}

TEST(StraightestPath, EndsAtTheBoundary) {
  const FlatFaces faces(test::makeCharts(test::grid(12, 0.3)));
  const SurfacePoint from = pointAt(faces, Vec3(0.5, -0.027, 0.0));
  const Complex right = faces.charts().spaceToFace(from.face, Vec3::UnitX());
  const StraightestPath path = straightestPath(faces, from, right, 2.0);
  EXPECT_NEAR(path.length, 0.5, 1e-9);
  test::expectNear(position(faces.mesh(), path.point), Vec3(1.0, -0.027, 0.0), 1e-7);
}

TEST(StraightestPath, OnACylinderIsAHelix) {
  // In the unrolled polygon: along by length cos a, up by length sin a.
  constexpr int kAround = 24;
  const FlatFaces faces(test::makeCharts(test::cylinder(kAround, 10)));
  const double width = 2.0 * std::sin(kPi / kAround);
  const SurfacePoint from{0, Eigen::Vector3d(0.6, 0.3, 0.1)};  // corners: ring 0 at 0 and 1 widths, ring 1 at 1 width
  const Vec3 start = position(faces.mesh(), from);
  const double angle = 0.2, length = 4.0;
  const StraightestPath path = straightestPath(faces, from, std::polar(1.0, angle), length);
  const Vec3 end = position(faces.mesh(), path.point);
  EXPECT_NEAR(end.z(), start.z() + length * std::sin(angle), 1e-7);
  const double along = (0.3 + 0.1) * width + length * std::cos(angle);
  const double facets = along / width, t = facets - std::floor(facets), u = 2.0 * kPi * std::floor(facets) / kAround;
  const Vec3 a(std::cos(u), std::sin(u), 0.0),
      b(std::cos(u + 2.0 * kPi / kAround), std::sin(u + 2.0 * kPi / kAround), 0.0);
  test::expectNear(Vec3(end.x(), end.y(), 0.0), Vec3((1.0 - t) * a + t * b), 1e-7);
}

/// A straight line along x with points every step, all of one number.
Line straightLine(const FlatFaces& faces, double y, double from, double to, double step) {
  Line line;
  for (double x = from; x <= to + 1e-9; x += step) {
    const SurfacePoint p = pointAt(faces, Vec3(x, y, 0.0));
    line.points.push_back({p, position(faces.mesh(), p)});
  }
  return line;
}

void addTo(NearLines& samples, const FlatFaces& faces, const Line& line, Index number) {
  double arc = 0.0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const LinePoint& p = line.points[i];
    if (i > 0) arc += (p.position - line.points[i - 1].position).norm();
    samples.add({p.position, faces.mesh().faceNormal(p.point.face), p.point.face, number, arc});
  }
}

TEST(Taper, FallsLinearlyAtEndsInside) {
  const FlatFaces faces(test::makeCharts(test::grid(8)));
  const LineRules rules{.distance = 0.2, .testDistance = 0.105, .step = 0.05};
  NearLines samples(faces.mesh(), 0.2);
  std::vector<Line> lines(4, straightLine(faces, 0.03, -0.8, 0.8, 0.05));
  lines[1].fullStart = true;
  lines[2].fullStart = lines[2].fullEnd = true;
  lines[3].closed = true;
  const auto tapers = taperLines(faces.mesh(), lines, samples, rules, nullptr);
  for (std::size_t k = 0; k < lines[0].points.size(); ++k) {
    const double fromStart = 0.05 * static_cast<double>(k), fromEnd = 1.6 - fromStart;
    const double start = std::min(1.0, fromStart / 0.3), end = std::min(1.0, fromEnd / 0.3);  // over 1.5 distances
    EXPECT_NEAR(tapers[0][k], start * end, 1e-12);
    EXPECT_NEAR(tapers[1][k], end, 1e-12);
    EXPECT_EQ(tapers[2][k], 1.0);
    EXPECT_EQ(tapers[3][k], 1.0);
  }
  // A short line falls over a third of its length.
  const auto brief = taperLines(faces.mesh(), {straightLine(faces, 0.03, 0.0, 0.3, 0.05)}, samples, rules, nullptr);
  EXPECT_NEAR(brief[0][1], 0.5, 1e-12);
  EXPECT_NEAR(brief[0][2], 1.0, 1e-12);
}

TEST(Taper, FallsWhereAnEarlierLineIsNear) {
  const FlatFaces faces(test::makeCharts(test::grid(8)));
  const LineRules rules{.distance = 0.2, .testDistance = 0.105, .step = 0.05};
  for (const auto& [apart, factor] : {std::pair(0.25, 1.0), std::pair(0.1525, 0.675), std::pair(0.105, 0.35)}) {
    NearLines samples(faces.mesh(), 0.2);
    std::vector<Line> lines{straightLine(faces, 0.03, -0.8, 0.8, 0.05),
                            straightLine(faces, 0.03 + apart, -0.8, 0.8, 0.05)};
    for (Line& line : lines) line.fullStart = line.fullEnd = true;
    for (const Index i : {0, 1}) addTo(samples, faces, lines[i], i);
    auto tapers = taperLines(faces.mesh(), lines, samples, rules, nullptr);
    for (std::size_t k = 0; k < tapers[0].size(); ++k) {
      EXPECT_EQ(tapers[0][k], 1.0) << "the earlier line does not give way";
      EXPECT_NEAR(tapers[1][k], factor, 1e-6) << apart;
    }
    // Nor does a given curve.
    lines[1].given = 0;
    tapers = taperLines(faces.mesh(), lines, samples, rules, nullptr);
    for (const double width : tapers[1]) EXPECT_EQ(width, 1.0);
  }
}

TEST(GivenCurves, HaveEvenPoints) {
  const FlatFaces faces(test::makeCharts(test::grid(8)));
  GivenCurve curve;
  for (const LinePoint& p : straightLine(faces, 0.03, -0.8, 0.8, 0.02).points) curve.points.push_back(p.point);
  const auto points = evenPoints(faces.mesh(), curve, 0.1);
  test::expectNear(points.front().position, Vec3(-0.8, 0.03, 0.0), 1e-12);
  test::expectNear(points.back().position, Vec3(0.8, 0.03, 0.0), 1e-9);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double apart = (points[i].position - points[i - 1].position).norm();
    EXPECT_LE(apart, 0.1 + 1e-9);
    EXPECT_GE(apart, 0.075 - 1e-9);
  }
}

TEST(GivenCurves, EndWhereTheyComeNearAnotherLine) {
  const FlatFaces faces(test::makeCharts(test::grid(8)));
  const LineRules rules{.distance = 0.2, .testDistance = 0.105, .step = 0.05};
  NearLines samples(faces.mesh(), 0.2);
  // The first line crosses the second one's way at x = 0.4.
  Line across;
  for (int i = -10; i <= 10; ++i) {
    const SurfacePoint p = pointAt(faces, Vec3(0.4, 0.03 + 0.05 * i, 0.0));
    across.points.push_back({p, position(faces.mesh(), p)});
  }
  addTo(samples, faces, across, 0);
  auto open = straightLine(faces, 0.03, -0.8, 0.8, 0.05).points, closed = open;
  const std::vector<Vec3> starts{across.points.front().position, open.front().position};
  const std::size_t before = samples.size();
  addGivenCurve(open, false, 1, rules, starts, faces.mesh(), samples);
  EXPECT_NEAR(open.back().position.x(), 0.25, 1e-9);  // 0.3 is nearer than 0.105
  EXPECT_EQ(samples.size(), before + open.size());
  addGivenCurve(closed, true, 1, rules, starts, faces.mesh(), samples);
  EXPECT_NEAR(closed.back().position.x(), 0.8, 1e-9);
}

}  // namespace
}  // namespace stormfield
