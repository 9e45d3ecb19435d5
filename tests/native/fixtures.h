// Test surfaces by property, as plain arrays, and random fields on them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "field/analytic_fields.h"
#include "field/parameterized_field.h"

namespace stormfield::test {

inline constexpr double kPi = std::numbers::pi;

struct Surface {
  Points points;
  Triangles triangles;
};

/// The same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low = -1.0, double high = 1.0) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Index below(Index bound) { return static_cast<Index>(engine_() % static_cast<std::uint64_t>(bound)); }
  Vec3 vector() { return {uniform(), uniform(), uniform()}; }
  /// A point inside a face, away from its boundary by margin (barycentric).
  Eigen::Vector3d barycentric(double margin = 0.0) {
    const double a = uniform(0.0, 1.0), b = uniform(0.0, 1.0);
    const Eigen::Vector3d inside =
        a + b < 1.0 ? Eigen::Vector3d(a, b, 1.0 - a - b) : Eigen::Vector3d(1.0 - a, 1.0 - b, a + b - 1.0);
    return (1.0 - 3.0 * margin) * inside + Eigen::Vector3d::Constant(margin);
  }

 private:
  std::mt19937_64 engine_;
};

inline Surface surface(const std::vector<Vec3>& points, const std::vector<std::array<Index, 3>>& triangles) {
  Surface s{Points(points.size(), 3), Triangles(triangles.size(), 3)};
  for (std::size_t i = 0; i < points.size(); ++i) s.points.row(static_cast<Eigen::Index>(i)) = points[i];
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    for (int k = 0; k < 3; ++k) s.triangles(static_cast<Eigen::Index>(f), k) = triangles[f][k];
  }
  return s;
}

/// The quads of a rows x columns lattice; a periodic direction closes on itself.
inline std::vector<std::array<Index, 3>> latticeTriangles(int rows, int columns, bool closedRows, bool closedColumns) {
  std::vector<std::array<Index, 3>> result;
  for (int i = 0; i + (closedRows ? 0 : 1) < rows; ++i) {
    for (int j = 0; j + (closedColumns ? 0 : 1) < columns; ++j) {
      const Index a = i * columns + j, b = i * columns + (j + 1) % columns;
      const Index c = (i + 1) % rows * columns + (j + 1) % columns, d = (i + 1) % rows * columns + j;
      result.push_back({a, b, c});
      result.push_back({a, c, d});
    }
  }
  return result;
}

/// Flat square [-1, 1]^2 with n x n cells; jitter (fraction of a cell) moves the inner vertices.
inline Surface grid(int n, double jitter = 0.0, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<Vec3> points;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const bool inner = i > 0 && i < n && j > 0 && j < n;
      const double dx = random.uniform(), dy = random.uniform();
      points.emplace_back(-1.0 + 2.0 * (j + (inner ? jitter * dx : 0.0)) / n,
                          -1.0 + 2.0 * (i + (inner ? jitter * dy : 0.0)) / n, 0.0);
    }
  }
  return surface(points, latticeTriangles(n + 1, n + 1, false, false));
}

inline Surface tetrahedron() {
  return surface({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
}

struct Polyhedron {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> faces;
};

/// Vertices on the unit sphere.
inline Polyhedron icosahedron() {
  const double t = std::numbers::phi;
  Polyhedron p{{{-1, t, 0},
                {1, t, 0},
                {-1, -t, 0},
                {1, -t, 0},
                {0, -1, t},
                {0, 1, t},
                {0, -1, -t},
                {0, 1, -t},
                {t, 0, -1},
                {t, 0, 1},
                {-t, 0, -1},
                {-t, 0, 1}},
               {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (Vec3& point : p.points) point.normalize();
  return p;
}

/// Unit sphere: an icosahedron whose faces are cut in four level times.
inline Surface icosphere(int level) {
  auto [points, faces] = icosahedron();
  for (int round = 0; round < level; ++round) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [at, added] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(points.size()));
      if (added) points.push_back((points[a] + points[b]).normalized());
      return at->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const Index x = middle(a, b), y = middle(b, c), z = middle(c, a);
      finer.insert(finer.end(), {{a, x, z}, {b, y, x}, {c, z, y}, {x, y, z}});
    }
    faces = std::move(finer);
  }
  return surface(points, faces);
}

/// Unit sphere: an icosahedron whose edges are cut in n pieces and its faces in n^2.
inline Surface dividedIcosahedron(int n) {
  const auto [corners, faces] = icosahedron();
  std::map<std::array<long, 3>, Index> known;
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> finer;
  const auto vertex = [&](const Vec3& p) {
    const Vec3 q = p.normalized();
    const std::array<long, 3> key = {std::lround(q.x() * 1e7), std::lround(q.y() * 1e7), std::lround(q.z() * 1e7)};
    const auto [it, added] = known.try_emplace(key, static_cast<Index>(points.size()));
    if (added) points.push_back(q);
    return it->second;
  };
  for (const auto& face : faces) {
    const Vec3 &a = corners[face[0]], &b = corners[face[1]], &c = corners[face[2]];
    const auto at = [&](int i, int j) { return vertex((a * (n - i - j) + b * i + c * j) / n); };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        finer.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < n) finer.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  return surface(points, finer);
}

/// Unit sphere by parallels and meridians: needles at its two poles.
inline Surface uvSphere(int rings, int segments) {
  std::vector<Vec3> points{{0, 0, 1}};
  std::vector<std::array<Index, 3>> faces;
  for (int i = 1; i < rings; ++i) {
    for (int j = 0; j < segments; ++j) {
      const double theta = kPi * i / rings, phi = 2.0 * kPi * j / segments;
      points.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    }
  }
  const Index south = static_cast<Index>(points.size());
  points.emplace_back(0, 0, -1);
  const auto at = [&](int i, int j) { return static_cast<Index>(1 + (i - 1) * segments + j % segments); };
  for (int j = 0; j < segments; ++j) {
    faces.push_back({0, at(1, j), at(1, j + 1)});
    for (int i = 1; i + 1 < rings; ++i) {
      faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    faces.push_back({south, at(rings - 1, j + 1), at(rings - 1, j)});
  }
  return surface(points, faces);
}

/// The icosphere with radii changed at random by up to amplitude.
inline Surface bumpySphere(int level, double amplitude = 0.15, std::uint64_t seed = 7) {
  Surface s = icosphere(level);
  Random random(seed);
  for (Eigen::Index v = 0; v < s.points.rows(); ++v) s.points.row(v) *= 1.0 + amplitude * random.uniform();
  return s;
}

/// Radii large and small; jitter (fraction of a cell) moves the vertices and bends the tube.
inline Surface torus(int around, int across, double large = 1.0, double small = 0.4, double jitter = 0.0,
                     std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<Vec3> points;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * kPi * (i + jitter * random.uniform()) / around;
      const double v = 2.0 * kPi * (j + jitter * random.uniform()) / across;
      const double tube = small * (1.0 + 0.3 * jitter * random.uniform());
      points.emplace_back((large + tube * std::cos(v)) * std::cos(u), (large + tube * std::cos(v)) * std::sin(u),
                          -tube * std::sin(v));
    }
  }
  return surface(points, latticeTriangles(around, across, true, true));
}

/// Corners with angle sums of 3/2 pi.
inline Surface cube() {
  return surface({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {{0, 2, 1},
                                                                                                            {0, 3, 2},
                                                                                                            {4, 5, 6},
                                                                                                            {4, 6, 7},
                                                                                                            {0, 1, 5},
                                                                                                            {0, 5, 4},
                                                                                                            {1, 2, 6},
                                                                                                            {1, 6, 5},
                                                                                                            {2, 3, 7},
                                                                                                            {2, 7, 6},
                                                                                                            {3, 0, 4},
                                                                                                            {3, 4, 7}});
}

/// Genus g: the skin of a plate of cubes with g holes, cells x cells x cells small cubes each, bent a little so that no
/// vertex is flat.
inline Surface plateWithHoles(int g, int cells = 2) {
  const auto solid = [&](int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0) return false;
    const int i = x / cells, j = y / cells, k = z / cells;
    return i < 2 * g + 1 && j < 3 && k < 1 && !(j == 1 && i % 2 == 1);
  };
  std::map<std::array<int, 3>, Index> numbers;
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> faces;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, added] = numbers.try_emplace(at, static_cast<Index>(points.size()));
    if (added) {
      const Vec3 p(at[0], at[1], at[2]);
      points.push_back(p + 0.1 * Vec3(std::sin(1.3 * p.y() + p.z()), std::sin(0.9 * p.x()), std::sin(p.x() + p.y())));
    }
    return found->second;
  };
  for (int x = 0; x < (2 * g + 1) * cells; ++x) {
    for (int y = 0; y < 3 * cells; ++y) {
      for (int z = 0; z < cells; ++z) {
        if (!solid(x, y, z)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          for (int side = 0; side < 2; ++side) {
            std::array<int, 3> neighbour{x, y, z};
            neighbour[axis] += side == 0 ? -1 : 1;
            if (solid(neighbour[0], neighbour[1], neighbour[2])) continue;
            const int p = (axis + 1) % 3, q = (axis + 2) % 3;
            std::array<std::array<int, 3>, 4> corner;
            for (int c = 0; c < 4; ++c) {
              corner[c] = {x, y, z};
              corner[c][axis] += side;
              corner[c][p] += c == 1 || c == 2;
              corner[c][q] += c >= 2;
            }
            if (side == 0) std::swap(corner[1], corner[3]);
            const Index a = vertex(corner[0]), b = vertex(corner[1]), c = vertex(corner[2]), d = vertex(corner[3]);
            faces.push_back({a, b, c});
            faces.push_back({a, c, d});
          }
        }
      }
    }
  }
  return surface(points, faces);
}

/// Open tube around the z axis, radius 1, height 2: two boundary loops.
inline Surface cylinder(int around, int rows) {
  std::vector<Vec3> points;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j < around; ++j) {
      const double u = 2.0 * kPi * j / around;
      points.emplace_back(std::cos(u), std::sin(u), -1.0 + 2.0 * i / rows);
    }
  }
  return surface(points, latticeTriangles(rows + 1, around, false, true));
}

/// Flat ring between the radii 1 and 2: two boundary loops.
inline Surface annulus(int around, int rows) {
  std::vector<Vec3> points;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j < around; ++j) {
      const double u = 2.0 * kPi * j / around, r = 2.0 - static_cast<double>(i) / rows;
      points.emplace_back(r * std::cos(u), r * std::sin(u), 0.0);
    }
  }
  return surface(points, latticeTriangles(rows + 1, around, false, true));
}

/// Both surfaces side by side, the second moved by offset.
inline Surface joined(const Surface& a, const Surface& b, const Vec3& offset) {
  Surface s{Points(a.points.rows() + b.points.rows(), 3), Triangles(a.triangles.rows() + b.triangles.rows(), 3)};
  s.points << a.points, b.points.rowwise() + offset.transpose();
  s.triangles << a.triangles, (b.triangles.array() + static_cast<Index>(a.points.rows())).matrix();
  return s;
}

/// A sphere, a torus and a square that do not touch.
inline Surface severalComponents() {
  return joined(joined(icosphere(1), torus(8, 6), {4, 0, 0}), grid(3), {0, 4, 0});
}

struct NamedSurface {
  std::string name;
  Surface surface;
  int euler;
};

inline std::vector<NamedSurface> closedSurfaces() {
  return {{"tetrahedron", tetrahedron(), 2},
          {"icosphere", icosphere(2), 2},
          {"bumpy sphere", bumpySphere(2, 0.4), 2},
          {"uv sphere", uvSphere(9, 14), 2},
          {"torus", torus(14, 9), 0},
          {"genus 2", plateWithHoles(2), -2},
          {"genus 3", plateWithHoles(3), -4},
          {"sphere and torus", joined(icosphere(1), torus(8, 6), {4, 0, 0}), 2}};
}

inline std::vector<NamedSurface> boundedSurfaces() {
  return {{"square", grid(6, 0.3), 1}, {"cylinder", cylinder(11, 4), 0}, {"annulus", annulus(13, 3), 0}};
}

using ChartsPointer = std::shared_ptr<const VertexCharts>;

inline std::shared_ptr<const TriangleMesh> makeMesh(const Surface& s) {
  return std::make_shared<const TriangleMesh>(s.points, s.triangles);
}
inline ChartsPointer makeCharts(const Surface& s) {
  return std::make_shared<const VertexCharts>(makeMesh(s));
}

inline VectorField randomField(ChartsPointer charts, std::uint64_t seed) {
  Random random(seed);
  std::vector<Complex> values(charts->mesh().vertexCount());
  for (Complex& value : values) value = {random.uniform(), random.uniform()};
  return makeVectorField(std::move(charts), std::move(values));
}

/// Components -1, 0 or 1: zero vectors, equal and opposed neighbours in plenty.
inline VectorField randomIntegerField(ChartsPointer charts, std::uint64_t seed) {
  Random random(seed);
  std::vector<Complex> values(charts->mesh().vertexCount());
  for (Complex& value : values) value = {random.below(3) - 1.0, random.below(3) - 1.0};
  return makeVectorField(std::move(charts), std::move(values));
}

/// Points anywhere in faces picked at random.
inline std::vector<SurfacePoint> randomSeeds(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<SurfacePoint> seeds(count);
  for (SurfacePoint& p : seeds) {
    p.face = random.below(mesh.faceCount());
    p.barycentric = random.barycentric();
  }
  return seeds;
}

inline VectorField zeroField(ChartsPointer charts) {
  std::vector<Complex> values(charts->mesh().vertexCount(), 0.0);
  return makeVectorField(std::move(charts), std::move(values));
}

/// Samples evenly spaced over lambda.
inline ParameterizedField blend(const std::vector<VectorField>& samples) {
  ParameterizedField field{samples.front().charts, {}, {}};
  std::vector<Complex> values;
  for (std::size_t j = 0; j < samples.size(); ++j) {
    field.lambdas.push_back(static_cast<double>(j) / static_cast<double>(std::max(std::size_t{1}, samples.size() - 1)));
    values.insert(values.end(), samples[j].values.begin(), samples[j].values.end());
  }
  field.values = values;
  return field;
}

}  // namespace stormfield::test
