// A drawn loop becomes one periodic orbit, of its kind, near where it was drawn (thesis 5.2): the analysis says so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "storm_checks.h"
#include "topology/topology.h"

namespace stormfield {
namespace {

DesignElement orbit(const std::string& name, std::vector<Vec3> loop, OrbitStability stability, double radius) {
  DesignElement element;
  element.name = name;
  element.type = ElementType::Orbit;
  element.points = std::move(loop);
  element.stability = stability;
  element.radius = radius;
  return element;
}

std::vector<Vec3> loop(const std::function<Vec3(double)>& at, int count = 60) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back(at(2.0 * test::kPi * i / count));
  return points;
}

double distanceTo(const std::vector<Vec3>& curve, const Vec3& p) {
  double least = 1e9;
  for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
    const Vec3 along = curve[k + 1] - curve[k];
    const double squared = along.squaredNorm();
    const double t = squared > 0.0 ? std::clamp((p - curve[k]).dot(along) / squared, 0.0, 1.0) : 0.0;
    least = std::min(least, (curve[k] + t * along - p).norm());
  }
  return least;
}

/// Exactly one orbit lies in each strip: a quarter of its width or nearer, of the right kind and turning, at any sample.
void checkOrbits(const test::ChartsPointer& charts, const std::vector<DesignElement>& elements, Index samples = 2) {
  const TriangleMesh& mesh = charts->mesh();
  const auto result = storms::solved(charts, elements, samples);
  const ClosestPointQuery query(charts->meshPointer());
  const FlatFaces faces(charts);
  for (Index j = 0; j < samples; j += std::max<Index>(1, samples - 1)) {
    const Topology topology = findTopology(faces, sampleField(result.field, j));
    for (const DesignElement& element : elements) {
      if (element.type != ElementType::Orbit) continue;
      const SurfacePath path(mesh, query, element);
      int inStrip = 0;
      for (const PeriodicOrbit& found : topology.periodicOrbits) {
        double farthest = 0.0, nearest = 1e9;
        for (const SurfacePoint& p : found.points) {
          const double distance = distanceTo(path.positions(), position(mesh, p));
          farthest = std::max(farthest, distance);
          nearest = std::min(nearest, distance);
        }
        if (nearest > 0.5 * element.radius.largest()) continue;
        ++inStrip;
        EXPECT_LT(farthest, 0.5 * element.radius.largest()) << element.name;
        EXPECT_NEAR(found.length, path.length(), 0.1 * path.length()) << element.name;
        const bool attracting = element.stability == OrbitStability::Attracting;
        EXPECT_EQ(found.kind, attracting ? OrbitKind::Attracting : OrbitKind::Repelling) << element.name;
        EXPECT_EQ(found.multiplier < 1.0, attracting) << element.name;
        const Vec3 here = position(mesh, found.points[0]), ahead = position(mesh, found.points[1]);
        std::size_t k = 0;
        for (std::size_t i = 0; i + 1 < path.positions().size(); ++i)
          if ((path.positions()[i] - here).norm() < (path.positions()[k] - here).norm()) k = i;
        const double along = (ahead - here).dot(path.positions()[k + 1] - path.positions()[k]);
        EXPECT_EQ(along > 0.0, !element.reverse) << element.name;
      }
      EXPECT_EQ(inStrip, 1) << element.name << " at sample " << j;
    }
  }
}

Vec3 onSphere(double longitude, double latitude) {
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

constexpr OrbitStability kBoth[] = {OrbitStability::Attracting, OrbitStability::Repelling};

TEST(OrbitElements, CirclesOnASphere) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(14));
  for (const OrbitStability stability : kBoth)
    for (const double latitude : {0.0, 0.5, 1.0}) {
      DesignElement element = orbit("circle", loop([&](double t) { return onSphere(t, latitude); }), stability, 0.2);
      checkOrbits(charts, {element});
      element.reverse = true;
      checkOrbits(charts, {element});
    }
}

TEST(OrbitElements, WavyLoops) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(20));
  for (const OrbitStability stability : kBoth) {
    checkOrbits(charts, {orbit("waves", loop([](double t) { return onSphere(t, 0.25 * std::sin(3.0 * t)); }, 120),
                               stability, 0.15)});
    checkOrbits(charts,
                {orbit("flower", loop([](double t) { return onSphere(t, 0.8 + 0.15 * std::sin(5.0 * t)); }, 160),
                       stability, 0.15)});
  }
}

TEST(OrbitElements, LoopsOfATorusThatCannotBeDrawnTogether) {
  const auto charts = test::makeCharts(test::torus(60, 28, 1.0, 0.4, 0.15, 2));
  const auto on = [](double u, double v) {
    return Vec3((1.0 + 0.4 * std::cos(v)) * std::cos(u), (1.0 + 0.4 * std::cos(v)) * std::sin(u), 0.4 * std::sin(v));
  };
  for (const OrbitStability stability : kBoth) {
    checkOrbits(charts, {orbit("along", loop([&](double t) { return on(t, 0.7); }, 120), stability, 0.15)});
    checkOrbits(charts, {orbit("around", loop([&](double t) { return on(0.4, t); }), stability, 0.15)});
    checkOrbits(charts, {orbit("both ways", loop([&](double t) { return on(t, t); }, 160), stability, 0.15)});
  }
}

TEST(OrbitElements, LoopsAroundTheHolesOfGenusTwo) {
  const auto charts = test::makeCharts(test::plateWithHoles(2, 5));
  for (const OrbitStability stability : kBoth) {
    // Around the left hole, on the upper side; and around the bridge between the holes.
    const auto hole = loop([](double t) { return Vec3(7.5 + 4.0 * std::cos(t), 7.5 + 4.0 * std::sin(t), 5.0); }, 80);
    checkOrbits(charts, {orbit("hole", hole, stability, 1.2)});
    std::vector<Vec3> bridge;
    const auto side = [&](const Vec3& a, const Vec3& b) {
      for (int i = 0; i < 10; ++i) bridge.push_back(a + 0.1 * i * (b - a));
    };
    side({10, 7.5, 0}, {10, 7.5, 5}), side({10, 7.5, 5}, {15, 7.5, 5});
    side({15, 7.5, 5}, {15, 7.5, 0}), side({15, 7.5, 0}, {10, 7.5, 0});
    checkOrbits(charts, {orbit("bridge", bridge, stability, 1.5)});
  }
}

TEST(OrbitElements, TwoNestedOfOppositeKindKeepApart) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(20));
  const auto circle = [](double latitude) { return loop([=](double t) { return onSphere(t, latitude); }); };
  for (const double apart : {0.5, 0.3}) {
    DesignElement inner = orbit("inner", circle(0.3 + apart), OrbitStability::Attracting, 0.25);
    const DesignElement outer = orbit("outer", circle(0.3), OrbitStability::Repelling, 0.25);
    checkOrbits(charts, {inner, outer});
    inner.reverse = true;
    checkOrbits(charts, {inner, outer});
  }
}

TEST(OrbitElements, ActForPartOfLambda) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  DesignElement element = orbit("c", loop([](double t) { return onSphere(t, 0.0); }), OrbitStability::Repelling, 0.2);
  element.lambdas = {0.0, 0.4};
  ElementOptions options;
  options.samples = 11;
  for (const Index j : elementConstraints(charts, {element}, options).sample) EXPECT_LE(j, 4);
}

std::string fault(const test::ChartsPointer& charts, const std::vector<DesignElement>& elements) {
  ElementOptions options;
  options.samples = 2;
  try {
    elementConstraints(charts, elements, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OrbitElements, BadLoopsAreRefused) {
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  const auto attracting = [](std::vector<Vec3> points) {
    return orbit("o", std::move(points), OrbitStability::Attracting, 0.2);
  };
  const auto eight = loop([](double t) { return onSphere(0.5 * std::sin(2.0 * t), 0.5 * std::sin(t)); });
  EXPECT_NE(fault(charts, {attracting(eight)}).find("orbit \"o\" crosses itself near ("), std::string::npos);
  const auto twice = loop([](double t) { return onSphere(2.0 * t, 0.0); });
  EXPECT_NE(fault(charts, {attracting(twice)}).find("itself near ("), std::string::npos);
  const auto spiral = loop([](double t) { return onSphere(2.0 * t, 0.3 + 0.1 * t); }, 120);
  EXPECT_NE(fault(charts, {attracting(spiral)}).find("itself near ("), std::string::npos);
  test::Surface disc = test::dividedIcosahedron(12);
  disc.points.col(2) *= 0.1;
  const auto sides = loop([](double t) {
    const double above = std::sin(t) > 0.0 ? 0.095 : -0.095;
    return Vec3(0.3 * std::cos(t), 0.3 * std::sin(t), above);
  });
  EXPECT_NE(fault(test::makeCharts(disc), {attracting(sides)}).find("orbit \"o\" jumps from ("), std::string::npos);
  const auto tiny = loop([](double t) { return onSphere(0.01 * std::cos(t), 0.01 * std::sin(t)); });
  EXPECT_NE(fault(charts, {attracting(tiny)}).find("across, smaller than an edge of the mesh"), std::string::npos);
  const auto off = loop([](double t) { return Vec3(1.5 * onSphere(t, 0.0)); });
  EXPECT_NE(fault(charts, {attracting(off)}).find("orbit \"o\" point 0 lies 0.5"), std::string::npos);
  EXPECT_EQ(fault(charts, {attracting({{1, 0, 0}, {0, 1, 0}})}), "orbit \"o\" has 2 points: it needs at least 3");
  const auto close = [](double latitude) { return loop([=](double t) { return onSphere(t, latitude); }); };
  DesignElement other = attracting(close(0.05));
  other.name = "p";
  EXPECT_EQ(fault(charts, {attracting(close(0.0)), other}),
            "orbit \"o\" and orbit \"p\" come closer to each other than the mesh resolves: move one away, or refine "
            "the mesh");
  DesignElement still = attracting(close(0.0));
  still.rate = 0.0;
  EXPECT_EQ(fault(charts, {still}),
            "orbit \"o\" has pull 0: give a number above 0, and choose attracting or repelling");
}

}  // namespace
}  // namespace stormfield
