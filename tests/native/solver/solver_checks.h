// What the tests of the solver share: surfaces with boundary and components, constraints at random, and the oracle, a
// direct solve of the energy that the solver's header states.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "fixtures.h"
#include "solver/space_time_solver.h"

namespace stormfield::solving {

using test::ChartsPointer;

inline constexpr double kHard = std::numeric_limits<double>::infinity();

inline ChartsPointer annulus(Index n, Index m) {
  Points points(n * (m + 1), 3);
  Triangles triangles(2 * n * m, 3);
  for (Index i = 0, f = 0; i < n; ++i) {
    for (Index j = 0; j <= m; ++j) {
      const double angle = 2.0 * std::numbers::pi * i / n;
      const double r = 0.5 + 0.5 * j / m;
      points.row(i * (m + 1) + j) << r * std::cos(angle), r * std::sin(angle), 0.2 * r * r;
      if (j == m) continue;
      const Index a = i * (m + 1) + j, b = (i + 1) % n * (m + 1) + j;
      triangles.row(f++) << a, a + 1, b + 1;
      triangles.row(f++) << a, b + 1, b;
    }
  }
  return test::makeCharts({points, triangles});
}

/// The meshes side by side as one, with a loose vertex at the end.
inline ChartsPointer together(const std::vector<ChartsPointer>& parts) {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> faces;
  for (const ChartsPointer& part : parts) {
    const TriangleMesh& mesh = part->mesh();
    const Index offset = static_cast<Index>(points.size());
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      points.push_back(mesh.point(v) + Vec3(3.0 * static_cast<double>(offset), 0, 0));
    }
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      faces.push_back({offset + mesh.vertex(f, 0), offset + mesh.vertex(f, 1), offset + mesh.vertex(f, 2)});
    }
  }
  points.push_back(Vec3(-9, -9, -9));
  Points p(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) p.row(i) = points[i];
  Triangles t(faces.size(), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) t.row(f) << faces[f][0], faces[f][1], faces[f][2];
  return test::makeCharts({p, t});
}

/// Some soft discs and some hard values, seeded.
inline ConstraintSet randomConstraints(const VertexCharts& charts, Index samples, bool soft, bool hard, unsigned seed,
                                       Index vertices) {
  test::Random random(seed);
  ConstraintSet set;
  set.elementNames = {"soft", "hard"};
  const TriangleMesh& mesh = charts.mesh();
  for (int k = 0; soft && k < 3; ++k) {
    const Vec3 centre = mesh.point(random.below(vertices));
    const Complex value(random.uniform(), random.uniform());
    for (Index v = 0; v < vertices; ++v) {
      if ((mesh.point(v) - centre).norm() > 0.2 * mesh.size()) continue;
      for (Index j = 0; j < samples; ++j) {
        if ((j + k) % 3) set.add(v, j, value, std::pow(10.0, 1 + k), 0);
      }
    }
  }
  for (int k = 0; hard && k < 20; ++k) {
    const Index v = random.below(vertices);
    const Index j = random.below(samples);
    const Complex value(static_cast<double>(v % 7) - 3.0, static_cast<double>(j % 5) - 2.0);
    set.add(v, j, value, kHard, 1);
  }
  return set;
}

/// The energy of the header, assembled from the mesh and factorised: shares nothing with the solver but its formula.
inline std::vector<Complex> directSolution(const VertexCharts& charts, const SpaceTimeOptions& options,
                                           const ConstraintSet& constraints) {
  const TriangleMesh& mesh = charts.mesh();
  const Index n = mesh.vertexCount();
  const Index samples = options.samples;
  const Index unknowns = n * samples;
  std::vector<Eigen::Triplet<Complex>> entries;
  Eigen::VectorXcd b = Eigen::VectorXcd::Zero(unknowns);
  auto couple = [&](Index i, Index k, double weight, Complex carryItoK) {
    entries.emplace_back(i, i, weight);
    entries.emplace_back(k, k, weight);
    entries.emplace_back(k, i, -weight * carryItoK);
    entries.emplace_back(i, k, -weight * std::conj(carryItoK));
  };
  for (Index e = 0; e < mesh.edgeCount(); ++e) {
    const Index h = mesh.edgeHalfedge(e);
    auto cotangent = [&](Index side) {
      const Vec3 apex = mesh.point(mesh.tail(TriangleMesh::prev(side)));
      const Vec3 a = mesh.point(mesh.tail(side)) - apex, c = mesh.point(mesh.head(side)) - apex;
      return a.dot(c) / a.cross(c).norm();
    };
    double weight = 0.5 * cotangent(h);
    if (mesh.twin(h) != kNone) weight += 0.5 * cotangent(mesh.twin(h));
    for (Index j = 0; j < samples && weight > 1e-12; ++j) {
      couple(mesh.tail(h) + n * j, mesh.head(h) + n * j, weight, charts.transport(h));
    }
  }
  for (Index v = 0; v < n; ++v) {
    const double grid = 64.0 * (samples - 1) / 99.0;
    const double weight = 4.0 * options.lambdaWeight * grid * grid * mesh.vertexArea(v) / mesh.totalArea();
    for (Index j = 0; j + 1 < samples; ++j) couple(v + n * j, v + n * (j + 1), weight, 1.0);
    if (mesh.outgoing(v) == kNone) {
      for (Index j = 0; j < samples; ++j) entries.emplace_back(v + n * j, v + n * j, 1.0);
    }
  }
  std::map<Index, Complex> fixed;
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    const Index v = constraints.vertex[k];
    const Index row = v + n * constraints.sample[k];
    if (std::isinf(constraints.weight[k])) {
      fixed[row] = constraints.value[k];
    } else {
      const double weight = constraints.weight[k] * mesh.vertexArea(v) / mesh.totalArea();
      entries.emplace_back(row, row, weight);
      b[row] += weight * constraints.value[k];
    }
  }
  std::vector<char> constrained(mesh.componentCount(), 0);
  for (const Index v : constraints.vertex) constrained[mesh.component(v)] = 1;
  for (Index v = 0; v < n; ++v) {
    if (mesh.component(v) == kNone || constrained[mesh.component(v)]) continue;
    for (Index j = 0; j < samples; ++j) fixed[v + n * j] = 0.0;
  }
  std::vector<Eigen::Triplet<Complex>> free;
  for (const auto& entry : entries) {
    const bool rowFixed = fixed.count(entry.row()), columnFixed = fixed.count(entry.col());
    if (!rowFixed && !columnFixed) free.push_back(entry);
    if (!rowFixed && columnFixed) b[entry.row()] -= entry.value() * fixed[entry.col()];
  }
  for (const auto& [row, value] : fixed) {
    free.emplace_back(row, row, 1.0);
    b[row] = value;
  }
  Eigen::SparseMatrix<Complex> matrix(unknowns, unknowns);
  matrix.setFromTriplets(free.begin(), free.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<Complex>> factors(matrix);
  EXPECT_EQ(factors.info(), Eigen::Success);
  const Eigen::VectorXcd x = factors.solve(b);
  return std::vector<Complex>(x.data(), x.data() + x.size());
}

inline double difference(std::span<const Complex> a, std::span<const Complex> b) {
  EXPECT_EQ(a.size(), b.size());
  double error = 0.0, length = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    error = std::max(error, std::abs(a[k] - b[k]));
    length = std::max(length, std::abs(b[k]));
  }
  return error / length;
}

}  // namespace stormfield::solving
