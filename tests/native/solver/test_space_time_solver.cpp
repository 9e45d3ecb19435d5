#include "solver/space_time_solver.h"

#include <chrono>
#include <limits>
#include <map>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <Eigen/SparseCholesky>

#include "solver/connection_laplacian.h"
#include "solver/storm_constraints.h"
#include "tracing/surfaces.h"

namespace stormfield {
namespace {

using surfaces::ChartsPointer;

constexpr double kHard = std::numeric_limits<double>::infinity();

ChartsPointer annulus(Index n, Index m) {
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
  return surfaces::charts(points, triangles);
}

/// The meshes side by side as one, with a loose vertex at the end.
ChartsPointer together(const std::vector<ChartsPointer>& parts) {
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
  return surfaces::charts(p, t);
}

/// Some soft discs and some hard values, seeded.
ConstraintSet randomConstraints(const VertexCharts& charts, Index samples, bool soft, bool hard, unsigned seed,
                                Index vertices) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  ConstraintSet set;
  set.elementNames = {"soft", "hard"};
  const TriangleMesh& mesh = charts.mesh();
  for (int k = 0; soft && k < 3; ++k) {
    const Vec3 centre = mesh.point(static_cast<Index>(random() % vertices));
    const Complex value(normal(random), normal(random));
    for (Index v = 0; v < vertices; ++v) {
      if ((mesh.point(v) - centre).norm() > 0.2 * mesh.size()) continue;
      for (Index j = 0; j < samples; ++j) {
        if ((j + k) % 3) set.add(v, j, value, std::pow(10.0, 1 + k), 0);
      }
    }
  }
  for (int k = 0; hard && k < 20; ++k) {
    const Index v = static_cast<Index>(random() % vertices);
    const Index j = static_cast<Index>(random() % samples);
    const Complex value(static_cast<double>(v % 7) - 3.0, static_cast<double>(j % 5) - 2.0);
    set.add(v, j, value, kHard, 1);
  }
  return set;
}

/// The energy of the header, assembled from the mesh and factorised: shares nothing with the solver but its formula.
std::vector<Complex> directSolution(const VertexCharts& charts, const SpaceTimeOptions& options,
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

double difference(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  EXPECT_EQ(a.size(), b.size());
  double error = 0.0, length = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    error = std::max(error, std::abs(a[k] - b[k]));
    length = std::max(length, std::abs(b[k]));
  }
  return error / length;
}

struct OracleCase {
  const char* name;
  ChartsPointer charts;
  Index samples;
  Index constrainedVertices;
};

std::vector<OracleCase> oracleCases() {
  const auto sphere = surfaces::sphere(5);
  const auto torus = surfaces::torus(18, 9, 0.4, 0.25);
  const auto ring = annulus(24, 5);
  const auto several = together({surfaces::sphere(3), annulus(12, 3), surfaces::torus(10, 6)});
  const Index two = surfaces::sphere(3)->mesh().vertexCount() + annulus(12, 3)->mesh().vertexCount();
  return {{"sphere", sphere, 20, sphere->mesh().vertexCount()},
          {"torus", torus, 13, torus->mesh().vertexCount()},
          {"annulus", ring, 21, ring->mesh().vertexCount()},
          {"one sample", torus, 1, torus->mesh().vertexCount()},
          {"two samples", ring, 2, ring->mesh().vertexCount()},
          {"cube", surfaces::cube(), 7, 8},
          {"several components", several, 10, two}};
}

TEST(SpaceTimeSolver, AgreesWithADirectSolve) {
  for (const OracleCase& test : oracleCases()) {
    for (const auto& [soft, hard] : {std::pair{true, false}, std::pair{false, true}, std::pair{true, true}}) {
      SCOPED_TRACE(std::string(test.name) + (soft ? " soft" : "") + (hard ? " hard" : ""));
      const ConstraintSet constraints =
          randomConstraints(*test.charts, test.samples, soft, hard, 7, test.constrainedVertices);
      SpaceTimeOptions options;
      options.samples = test.samples;
      options.tolerance = 1e-11;
      Progress progress;
      const SpaceTimeResult result = SpaceTimeSolver(test.charts, options).solve(constraints, progress);
      const std::vector<Complex> expected = directSolution(*test.charts, options, constraints);
      EXPECT_LT(difference(result.field.values, expected), 1e-8);
      EXPECT_LE(result.residual, 1e-11);
      EXPECT_EQ(progress.fraction(), 1.0);
      for (std::size_t k = 0; k < constraints.size(); ++k) {
        if (!std::isinf(constraints.weight[k])) continue;
        EXPECT_EQ(result.field.sample(constraints.sample[k])[constraints.vertex[k]], constraints.value[k]);
      }
    }
  }
}

TEST(SpaceTimeSolver, MeetsThesisEquationOnItsOwnGrid) {
  // An interior row of the system on the thesis's planar setting is a multiple of eq. 11.3: neighbours in lambda weigh
  // omega = 10 against spatial weights that add up to 1.
  const ChartsPointer grid = surfaces::square(64);
  const SurfaceMatrix matrix = connectionLaplacian(*grid).matrix;
  ASSERT_EQ(matrix.rows(), 65 * 65);
  const double coupling = SpaceTimeSolver::lambdaCoupling({});
  Index interior = 0;
  for (Index i = 0; i < matrix.rows(); ++i) {
    if (matrix.start[i + 1] - matrix.start[i] != 4) continue;
    if (std::abs(matrix.mass[i] - 1.0 / 4096) > 1e-12) continue;
    ++interior;
    double spatial = 0.0;
    for (std::size_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) spatial += std::abs(matrix.value[k]);
    EXPECT_NEAR(matrix.diagonal[i], spatial, 1e-12);
    EXPECT_NEAR(coupling * matrix.mass[i] / spatial, 10.0, 1e-9);
  }
  EXPECT_EQ(interior, 63 * 63);
}

TEST(SpaceTimeSolver, SolutionIsTheMeanOfItsNeighbours) {
  // Eq. 11.3 itself, on the solved field: V = (sum of w V_neighbour + 10 (V_before + V_after)) / 21.
  const ChartsPointer grid = surfaces::square(64);
  ConstraintSet constraints;
  constraints.elementNames = {"corner", "middle"};
  constraints.add(0, 0, 1.0, kHard, 0);
  constraints.add(65 * 32 + 32, 50, Complex(0, 2), kHard, 1);
  SpaceTimeOptions options;
  options.tolerance = 1e-10;
  Progress progress;
  const ParameterizedField field = SpaceTimeSolver(grid, options).solve(constraints, progress).field;
  const auto space = [&](Index i, Index k, Index j) {
    const Index v = k * 65 + i;
    return grid->toSpace(v, field.sample(j)[v]);
  };
  for (const auto& [i, k, j] : {std::array<Index, 3>{20, 30, 50}, {33, 32, 49}, {5, 60, 2}, {40, 7, 97}}) {
    const Vec3 mean = (0.25 * (space(i - 1, k, j) + space(i + 1, k, j) + space(i, k - 1, j) + space(i, k + 1, j)) +
                       10.0 * (space(i, k, j - 1) + space(i, k, j + 1))) /
                      21.0;
    EXPECT_LT((mean - space(i, k, j)).norm(), 1e-7 * mean.norm());
  }
}

TEST(SpaceTimeSolver, WarmStartReachesTheSameFieldInFewerSteps) {
  const ChartsPointer sphere = surfaces::sphere(12);
  SpaceTimeOptions options;
  options.samples = 40;
  const SpaceTimeSolver solver(sphere, options);
  storms::StormOptions storm;
  storm.samples = 40;
  Progress progress;
  SpaceTimeState kept;
  const SpaceTimeResult before = solver.solve(storms::storms(*sphere, storm), progress, kept);
  SpaceTimeState fromField = solver.startFrom(before.field);
  for (SpaceTimeState* state : {&kept, &fromField}) {
    const SpaceTimeResult same = solver.solve(storms::storms(*sphere, storm), progress, *state);
    EXPECT_EQ(same.iterations, 0);
    EXPECT_EQ(same.field.values, before.field.values);
  }
  storm.shift = 0.05;
  const SpaceTimeResult cold = solver.solve(storms::storms(*sphere, storm), progress);
  for (SpaceTimeState* state : {&kept, &fromField}) {
    const SpaceTimeResult warm = solver.solve(storms::storms(*sphere, storm), progress, *state);
    EXPECT_LT(warm.iterations, cold.iterations);
    EXPECT_LE(warm.residual, options.tolerance);
    EXPECT_LT(difference(warm.field.values, cold.field.values), 2e-3);
  }
}

TEST(SpaceTimeSolver, EditsOfAnyKindAgreeWithADirectSolve) {
  // One state through edits that add, move and drop soft and hard constraints and whole components, at a tolerance
  // where the field must be right, and at one where single precision alone must tell the truth about its residual.
  const auto first = surfaces::sphere(3);
  const ChartsPointer charts = together({first, annulus(12, 3)});
  const Index all = charts->mesh().vertexCount() - 1, some = first->mesh().vertexCount();
  std::vector<ConstraintSet> edits;
  for (const auto& [soft, hard, seed, vertices] : {std::tuple{true, false, 1u, all},
                                                   {true, false, 2u, all},
                                                   {true, true, 2u, all},
                                                   {false, true, 3u, some},
                                                   {false, true, 3u, all},
                                                   {true, false, 4u, some},
                                                   {true, false, 4u, all}}) {
    edits.push_back(randomConstraints(*charts, 9, soft, hard, seed, vertices));
  }
  // The same again a thousand times longer, and then a thousandth.
  for (const double factor : {1e9, 1e-9}) {
    ConstraintSet scaled = edits.back();
    for (Complex& value : scaled.value) value *= factor;
    edits.push_back(scaled);
  }
  for (const double tolerance : {1e-11, 1e-4}) {
    const SpaceTimeOptions options{.samples = 9, .tolerance = tolerance};
    const SpaceTimeSolver solver(charts, options);
    SpaceTimeState state;
    Progress progress;
    for (std::size_t k = 0; k < edits.size(); ++k) {
      SCOPED_TRACE(k);
      const SpaceTimeResult result = solver.solve(edits[k], progress, state);
      EXPECT_LE(result.residual, tolerance);
      const std::vector<Complex> expected = directSolution(*charts, options, edits[k]);
      EXPECT_LT(difference(result.field.values, expected), 1000 * tolerance);
    }
  }
}

TEST(SpaceTimeSolver, StateOutlivesACancelledSolveAndKnowsItsSolver) {
  const ChartsPointer sphere = surfaces::sphere(8);
  const SpaceTimeSolver solver(sphere, {.samples = 20});
  const ConstraintSet before = storms::storms(*sphere, {.samples = 20});
  const ConstraintSet after = storms::storms(*sphere, {.samples = 20, .shift = 0.1});
  Progress progress, cancelled;
  cancelled.cancel();
  SpaceTimeState state;
  solver.solve(before, progress, state);
  EXPECT_THROW(solver.solve(after, cancelled, state), Cancelled);
  const SpaceTimeResult result = solver.solve(after, progress, state);
  EXPECT_LE(result.residual, 1e-4);
  EXPECT_LT(difference(result.field.values, solver.solve(after, progress).field.values), 2e-3);
  EXPECT_THROW(SpaceTimeSolver(sphere, {.samples = 20}).solve(after, progress, state), InputError);
}

TEST(SpaceTimeSolver, LeavesComponentsWithoutConstraintAtZero) {
  const auto sphere = surfaces::sphere(3);
  const ChartsPointer charts = together({sphere, annulus(12, 3), surfaces::torus(10, 6)});
  const Index first = sphere->mesh().vertexCount();
  ConstraintSet constraints;
  constraints.elementNames = {"ring"};
  constraints.add(first + 2, 3, Complex(1, 1), 50.0, 0);
  SpaceTimeOptions options;
  options.samples = 9;
  Progress progress;
  ParameterizedField start{charts, {}, std::vector<Complex>(9 * charts->mesh().vertexCount(), Complex(1, 2))};
  for (int j = 0; j < 9; ++j) start.lambdas.push_back(j / 8.0);
  const SpaceTimeSolver solver(charts, options);
  SpaceTimeState cold, warm = solver.startFrom(start);
  for (SpaceTimeState* state : {&cold, &warm}) {
    const SpaceTimeResult result = solver.solve(constraints, progress, *state);
    EXPECT_EQ(result.componentsWithoutConstraint, (std::vector<Index>{0, 2}));
    for (Index j = 0; j < 9; ++j) {
      for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
        const bool zero = result.field.sample(j)[v] == Complex{};
        EXPECT_EQ(zero, charts->mesh().component(v) != 1) << v;
      }
    }
  }
}

TEST(SpaceTimeSolver, GivesTheSameBitsForAnyThreadCount) {
  const ChartsPointer sphere = surfaces::sphere(16);
  const ConstraintSet constraints = storms::storms(*sphere, {.samples = 30});
  auto solve = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Progress progress;
    return SpaceTimeSolver(sphere, {.samples = 30}).solve(constraints, progress).field.values;
  };
  const std::vector<Complex> one = solve(1);
  EXPECT_EQ(one, solve(2));
  EXPECT_EQ(one, solve(3));
}

TEST(SpaceTimeSolver, StopsWithinATenthOfASecond) {
  const ChartsPointer sphere = surfaces::sphere(40);
  SpaceTimeOptions options;
  options.tolerance = 1e-12;
  const SpaceTimeSolver solver(sphere, options);
  const ConstraintSet constraints = storms::storms(*sphere, {});
  Progress progress;
  std::chrono::steady_clock::time_point asked;
  std::thread artist([&] {
    while (progress.fraction() == 0.0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    asked = std::chrono::steady_clock::now();
    progress.cancel();
  });
  EXPECT_THROW(solver.solve(constraints, progress), Cancelled);
  artist.join();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - asked).count();
  // Ten times the promise: this machine may be busy with other work.
  EXPECT_LT(seconds, 1.0);
  EXPECT_THROW(SpaceTimeSolver(sphere, options, progress), Cancelled);
}

TEST(SpaceTimeSolver, NamesWhatIsWrongWithConstraints) {
  const ChartsPointer cube = surfaces::cube();
  const SpaceTimeSolver solver(cube, {.samples = 5});
  auto messageOf = [&](const ConstraintSet& constraints) -> std::string {
    Progress progress;
    try {
      solver.solve(constraints, progress);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  auto one = [&](Index v, Index j, Complex value, double weight) {
    ConstraintSet set;
    set.elementNames = {"west storm", "east storm"};
    set.add(v, j, value, weight, 1);
    return set;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(messageOf({}).find("no constraint"), std::string::npos);
  for (const ConstraintSet& bad :
       {one(8, 0, 1.0, 1.0), one(-1, 0, 1.0, 1.0), one(0, 5, 1.0, 1.0), one(0, -1, 1.0, 1.0), one(0, 0, nan, 1.0),
        one(0, 0, 1.0, 0.0), one(0, 0, 1.0, -2.0), one(0, 0, 1.0, nan)}) {
    EXPECT_NE(messageOf(bad).find("east storm"), std::string::npos) << messageOf(bad);
  }
  ConstraintSet contradiction = one(3, 1, Complex(1, 0), kHard);
  contradiction.add(3, 1, Complex(1, 0), kHard, 0);
  EXPECT_EQ(messageOf(contradiction), "accepted");
  contradiction.add(3, 1, Complex(0, 1), kHard, 0);
  const std::string text = messageOf(contradiction);
  for (const char* part : {"west storm", "vertex 3", "lambda 0.25"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  ConstraintSet both = one(3, 1, Complex(0, 1), kHard);
  both.add(3, 2, Complex(1, 0), kHard, 0);
  both.add(3, 1, Complex(9, 9), 10.0, 0);  // a hard value beats a soft one
  EXPECT_EQ(messageOf(both), "accepted");
  ConstraintSet pair = one(3, 1, Complex(1, 0), kHard);
  pair.add(3, 1, Complex(-1, 0), kHard, 0);
  for (const char* part : {"west storm", "east storm"}) EXPECT_NE(messageOf(pair).find(part), std::string::npos);
}

TEST(SpaceTimeSolver, RefusesConstraintsOnLooseVerticesOnly) {
  const ChartsPointer charts = together({surfaces::sphere(3)});
  ConstraintSet constraints;
  constraints.add(charts->mesh().vertexCount() - 1, 0, 1.0, 10.0, 0);
  Progress progress;
  const SpaceTimeSolver solver(charts, {.samples = 4});
  EXPECT_THROW(solver.solve(constraints, progress), InputError);
  constraints.add(0, 0, 1.0, 10.0, 0);
  const SpaceTimeResult result = solver.solve(constraints, progress);
  EXPECT_EQ(result.field.sample(2)[charts->mesh().vertexCount() - 1], Complex{});
  EXPECT_NE(result.field.sample(2)[0], Complex{});
}

TEST(SpaceTimeSolver, RefusesOptionsAndStartsThatDoNotFit) {
  const ChartsPointer cube = surfaces::cube();
  EXPECT_THROW(SpaceTimeSolver(cube, {.samples = 0}), InputError);
  EXPECT_THROW(SpaceTimeSolver(cube, {.lambdaWeight = 0.0}), InputError);
  EXPECT_THROW(SpaceTimeSolver(cube, {.tolerance = 0.0}), InputError);
  EXPECT_THROW(SpaceTimeSolver(cube, {.maxIterations = 0}), InputError);
  ConstraintSet constraints;
  constraints.add(0, 0, 1.0, 1.0, 0);
  Progress progress;
  const ParameterizedField wrong{cube, {0.0, 1.0}, std::vector<Complex>(16)};
  EXPECT_THROW(SpaceTimeSolver(cube, {.samples = 3}).startFrom(wrong), InputError);
  ParameterizedField broken = SpaceTimeSolver(cube, {.samples = 3}).solve(constraints, progress).field;
  broken.values[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SpaceTimeSolver(cube, {.samples = 3}).startFrom(broken), InputError);
  SpaceTimeOptions hopeless{.samples = 100, .tolerance = 1e-17};
  EXPECT_THROW(SpaceTimeSolver(surfaces::sphere(5), hopeless).solve(constraints, progress), SolverError);
}

TEST(SpaceTimeSolver, ConvergesWithResolution) {
  // One design in space at 1, 4, 16 times the faces and 50, 100, 200 samples: vectors in space at shared vertices and
  // shared lambdas come closer to each other, by about the edge length that the rims of the discs are resolved with.
  std::vector<ParameterizedField> fields;
  Index samples = 51;
  for (const Index n : {10, 20, 40}) {
    const ChartsPointer sphere = surfaces::sphere(n);
    SpaceTimeOptions options;
    options.samples = samples;
    Progress progress;
    fields.push_back(
        SpaceTimeSolver(sphere, options).solve(storms::storms(*sphere, {.samples = samples}), progress).field);
    samples = 2 * samples - 1;
  }
  auto valueAt = [](const ParameterizedField& field, Index j, const Vec3& where) {
    const TriangleMesh& mesh = field.charts->mesh();
    Index nearest = 0;
    (mesh.points().rowwise() - where.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    EXPECT_LT((mesh.point(nearest) - where).norm(), 1e-9);
    return field.charts->toSpace(nearest, field.sample(j)[nearest]);
  };
  const TriangleMesh& coarse = fields[0].charts->mesh();
  std::array<double, 2> differences = {0.0, 0.0};
  double length = 0.0;
  for (Index v = 0; v < coarse.vertexCount(); v += 3) {
    for (const Index j : {0, 20, 50}) {
      const Vec3 a = valueAt(fields[0], j, coarse.point(v)), b = valueAt(fields[1], 2 * j, coarse.point(v)),
                 c = valueAt(fields[2], 4 * j, coarse.point(v));
      differences[0] += (a - b).squaredNorm();
      differences[1] += (b - c).squaredNorm();
      length += c.squaredNorm();
    }
  }
  const double first = std::sqrt(differences[0] / length), second = std::sqrt(differences[1] / length);
  RecordProperty("first", std::to_string(first));
  RecordProperty("second", std::to_string(second));
  EXPECT_LT(second, 0.75 * first);
  EXPECT_LT(first, 0.1);
}

}  // namespace
}  // namespace stormfield
