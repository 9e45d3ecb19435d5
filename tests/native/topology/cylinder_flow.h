// A flow whose periodic orbit is known exactly: on a cylinder, which is flat, the interpolation of vectors that are
// linear in the height is exact. In the unrolled cylinder
//     s' = speed,  z' = -rate (z - height):
// one orbit, at z = height, with the period P / speed (P: the perimeter of the polygon), the length P and the
// multiplier exp(-rate P / speed).
#pragma once

#include <functional>

#include "fixtures.h"

namespace stormfield::test {

struct CylinderFlow {
  int around = 24, rows = 15;
  double speed = 1.0, rate = 0.2, height = 0.03;

  double width() const { return 2.0 * std::sin(kPi / around); }
  double perimeter() const { return around * width(); }
  double period() const { return perimeter() / std::abs(speed); }
  /// Distance from the orbit after one return over the distance before it, in the direction of the flow.
  double multiplier() const { return std::exp(-rate * period()); }

  /// Length along the polygon up to a point of the cylinder.
  double along(const Vec3& p) const {
    const double angle = std::atan2(p.y(), p.x()), opening = 2.0 * kPi / around;
    const double facet = std::floor((angle < 0.0 ? angle + 2.0 * kPi : angle) / opening);
    const Complex a = std::polar(1.0, facet * opening), b = std::polar(1.0, (facet + 1.0) * opening);
    const double fraction = ((Complex(p.x(), p.y()) - a) / (b - a)).real();
    return (facet + fraction) * width();
  }

  VectorField field() const {
    const auto charts = makeCharts(cylinder(around, rows));
    const TriangleMesh& mesh = charts->mesh();
    VectorField result = zeroField(charts);
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      // Any edge along the ring of v tells where the chart's directions along and up are.
      double ringAngle = 0.0;
      for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
        const Index ring = v / around, to = mesh.head(h);
        if (to == ring * around + (v + 1) % around) ringAngle = charts->tailAngle(h);
        if (to == ring * around + (v + around - 1) % around) ringAngle = charts->tailAngle(h) + kPi;
      }
      result.values[v] = Complex(speed, -rate * (mesh.point(v).z() - height)) * std::polar(1.0, ringAngle);
    }
    return result;
  }

  /// The inner halfedge through which the flow passes at a height, with the fraction there; the first in the order of
  /// halfedges that is not along a ring.
  std::pair<Index, double> crossedAt(const TriangleMesh& mesh, double z) const {
    for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
      const Vec3 tail = mesh.point(mesh.tail(h)), head = mesh.point(mesh.head(h));
      // The flow with a positive speed crosses halfedges that go down.
      const bool down = speed > 0.0 ? head.z() < tail.z() - 1e-9 : head.z() > tail.z() + 1e-9;
      if (!down || (z - tail.z()) * (z - head.z()) > 0.0) continue;
      return {h, (z - tail.z()) / (head.z() - tail.z())};
    }
    return {kNone, 0.0};
  }
};

}  // namespace stormfield::test
