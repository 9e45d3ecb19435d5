// Surfaces and fields with known traces, shared by the tests and benchmarks of tracing and texture.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "field/parameterized_field.h"

namespace stormfield::surfaces {

using ChartsPointer = std::shared_ptr<const VertexCharts>;

inline ChartsPointer charts(Points points, Triangles triangles) {
  return std::make_shared<const VertexCharts>(
      std::make_shared<const TriangleMesh>(std::move(points), std::move(triangles)));
}

/// The square [-1, 1]^2 with n x n cells, its inner vertices moved by up to jitter of a cell.
inline ChartsPointer square(Index n, double jitter = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> move(-jitter * 2.0 / n, jitter * 2.0 / n);
  Points points((n + 1) * (n + 1), 3);
  Triangles triangles(2 * n * n, 3);
  for (Index j = 0; j <= n; ++j) {
    for (Index i = 0; i <= n; ++i) {
      const bool inner = i > 0 && j > 0 && i < n && j < n;
      const double dx = move(random), dy = move(random);
      points.row(j * (n + 1) + i) << -1.0 + 2.0 * i / n + inner * dx, -1.0 + 2.0 * j / n + inner * dy, 0.0;
    }
  }
  for (Index j = 0, f = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      triangles.row(f++) << a, b, d;
      triangles.row(f++) << a, d, c;
    }
  }
  return charts(points, triangles);
}

/// Unit sphere: an icosahedron whose faces are divided into n^2.
inline ChartsPointer sphere(Index n) {
  const double g = std::numbers::phi;
  const std::vector<Vec3> corners = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  const std::vector<std::array<int, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  std::map<std::array<long, 3>, Index> known;
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;
  const auto vertex = [&](const Vec3& p) {
    const Vec3 q = p.normalized();
    const std::array<long, 3> key = {std::lround(q.x() * 1e7), std::lround(q.y() * 1e7), std::lround(q.z() * 1e7)};
    const auto [it, isNew] = known.emplace(key, static_cast<Index>(points.size()));
    if (isNew) points.push_back(q);
    return it->second;
  };
  for (const auto& f : faces) {
    const auto at = [&](Index i, Index j) {
      return vertex((corners[f[0]] * (n - i - j) + corners[f[1]] * i + corners[f[2]] * j) / n);
    };
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; i + j < n; ++j) {
        triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < n) triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  Points p(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) p.row(i) = points[i];
  Triangles t(triangles.size(), 3);
  for (std::size_t i = 0; i < triangles.size(); ++i) t.row(i) << triangles[i][0], triangles[i][1], triangles[i][2];
  return charts(p, t);
}

/// Torus of radii 1 and r with n x m cells, displaced at random: curved, closed, genus 1, no two faces alike.
inline ChartsPointer torus(Index n, Index m, double r = 0.4, double jitter = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> move(-jitter, jitter);
  Points points(n * m, 3);
  Triangles triangles(2 * n * m, 3);
  for (Index i = 0, f = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      const double u = 2.0 * std::numbers::pi * (i + move(random)) / n,
                   v = 2.0 * std::numbers::pi * (j + move(random)) / m;
      const double rr = r * (1.0 + 0.3 * move(random));
      points.row(i * m + j) << (1.0 + rr * std::cos(v)) * std::cos(u), (1.0 + rr * std::cos(v)) * std::sin(u),
          rr * std::sin(v);
      const Index a = i * m + j, b = (i + 1) % n * m + j, c = i * m + (j + 1) % m, d = (i + 1) % n * m + (j + 1) % m;
      triangles.row(f++) << a, b, d;
      triangles.row(f++) << a, d, c;
    }
  }
  return charts(points, triangles);
}

/// A closed strip around a cube: corners with angle sums of 3/2 pi.
inline ChartsPointer cube() {
  Points p(8, 3);
  p << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  Triangles t(12, 3);
  t << 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7;
  return charts(p, t);
}

/// Samples a vector function of position at the vertices.
template <typename Function>
VectorField sampled(const ChartsPointer& c, const Function& function) {
  VectorField field{c, std::vector<Complex>(c->mesh().vertexCount())};
  for (Index v = 0; v < c->mesh().vertexCount(); ++v) {
    field.values[v] = c->toTangent(v, function(Vec3(c->mesh().point(v))));
  }
  return field;
}

inline VectorField randomField(const ChartsPointer& c, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  VectorField field{c, std::vector<Complex>(c->mesh().vertexCount())};
  for (Complex& v : field.values) v = Complex(normal(random), normal(random));
  return field;
}

/// A smooth field with vortices, saddles, sources and sinks, of speeds around 1.
inline VectorField swirlField(const ChartsPointer& c, double phase = 0.0) {
  return sampled(c, [phase](const Vec3& p) {
    return Vec3(std::sin(3.0 * p.y() + phase) + 0.3 * p.x(), std::cos(2.0 * p.z() - phase) - 0.2 * p.y(),
                std::sin(3.0 * p.x() + 1.0) + 0.5 * std::cos(phase) * p.z());
  });
}

inline std::vector<SurfacePoint> randomSeeds(const TriangleMesh& mesh, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<Index> face(0, mesh.faceCount() - 1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<SurfacePoint> seeds(count);
  for (SurfacePoint& p : seeds) {
    double a = unit(random), b = unit(random);
    if (a + b > 1.0) {
      a = 1.0 - a;
      b = 1.0 - b;
    }
    p.face = face(random);
    p.barycentric = {1.0 - a - b, a, b};
  }
  return seeds;
}

}  // namespace stormfield::surfaces
