#include "tracking/tracking.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <thread>

#include "base/message.h"
#include "checks.h"
#include "field/interpolation.h"
#include "field/poincare_index.h"
#include "long_tests.h"
#include "topology/fixed_points.h"
#include "tracked_fields.h"

namespace stormfield::test {
namespace {

Tracking track(const ParameterizedField& field, const TrackingOptions& options = {}) {
  Progress progress;
  return trackFixedPoints(field, options, progress);
}

int count(const Tracking& tracking, BifurcationKind kind) {
  return static_cast<int>(std::count_if(tracking.bifurcations.begin(), tracking.bifurcations.end(),
                                        [&](const Bifurcation& b) { return b.kind == kind; }));
}

/// Index held by each face at a lambda that is no crossing's.
std::map<Index, int> heldAt(const Tracking& tracking, double lambda) {
  std::map<Index, int> held;
  for (const TrackedPath& path : tracking.paths) {
    const auto& samples = path.samples;
    if (lambda < samples.front().lambda || lambda > samples.back().lambda) continue;
    std::size_t i = 0;
    while (i + 1 < samples.size() && samples[i + 1].lambda <= lambda) ++i;
    held[samples[i].point.face] += path.index;
  }
  std::erase_if(held, [](const auto& entry) { return entry.second == 0; });
  return held;
}

void expectIndicesHeld(const ParameterizedField& field, const Tracking& tracking, double lambda,
                       const std::string& what) {
  const std::vector<int> indices = poincareIndices(at(field, lambda));
  std::map<Index, int> wanted;
  for (Index f = 0; f < static_cast<Index>(indices.size()); ++f) {
    if (indices[f] != 0) wanted[f] = indices[f];
  }
  EXPECT_EQ(heldAt(tracking, lambda), wanted) << what << " at lambda " << lambda;
}

void expectPathSound(const ParameterizedField& field, const TrackedPath& path, const std::string& what) {
  ASSERT_FALSE(path.samples.empty()) << what;
  EXPECT_EQ(std::abs(path.index), 1) << what;
  const TriangleMesh& mesh = field.charts->mesh();
  double largest = 0.0;
  for (const Complex& value : field.values) largest = std::max(largest, std::abs(value));
  for (std::size_t i = 0; i < path.samples.size(); ++i) {
    const PathSample& sample = path.samples[i];
    if (i > 0) {
      EXPECT_GE(sample.lambda, path.samples[i - 1].lambda) << what;
    }
    EXPECT_GE(sample.point.barycentric.minCoeff(), 0.0) << what;
    EXPECT_NEAR(sample.point.barycentric.sum(), 1.0, 1e-14) << what;
    expectNear(sample.position, position(mesh, sample.point), 0.0, what);
    if (sample.point.barycentric.maxCoeff() < 1.0) {
      EXPECT_LE(evaluate(at(field, sample.lambda), sample.point).norm(), 1e-11 * largest)
          << what << " at lambda " << sample.lambda << ", sample " << i << " of " << path.samples.size();
    }
  }
  if (path.begin == PathEnd::Range) {
    EXPECT_EQ(path.samples.front().lambda, field.lambdas.front()) << what;
  }
  if (path.end == PathEnd::Range) {
    EXPECT_EQ(path.samples.back().lambda, field.lambdas.back()) << what;
  }
}

/// Every inner end is one bifurcation of the right kind, and every bifurcation is the end of the paths it names.
void expectEndsClassified(const Tracking& tracking, const std::string& what) {
  std::vector<std::array<int, 2>> ends(tracking.paths.size(), {0, 0});
  double before = 0.0;
  for (const Bifurcation& event : tracking.bifurcations) {
    EXPECT_GE(event.lambda, before) << what;
    before = event.lambda;
    EXPECT_TRUE(event.node == FixedPointKind::Source || event.node == FixedPointKind::Sink) << what;
    if (event.kind == BifurcationKind::Hopf) {
      EXPECT_EQ(tracking.paths[event.paths[0]].index, 1) << what;
      continue;
    }
    EXPECT_EQ(tracking.paths[event.paths[0]].index, 1) << what;
    EXPECT_EQ(tracking.paths[event.paths[1]].index, -1) << what;
    const bool creation = event.kind == BifurcationKind::Creation;
    for (const Index i : event.paths) {
      const PathSample& end = creation ? tracking.paths[i].samples.front() : tracking.paths[i].samples.back();
      EXPECT_NEAR(end.lambda, event.lambda, 1e-12) << what;
      expectNear(end.position, event.position, 1e-12, what);
      ++ends[i][creation ? 0 : 1];
    }
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    EXPECT_EQ(ends[i][0], tracking.paths[i].begin == PathEnd::Bifurcation) << what;
    EXPECT_EQ(ends[i][1], tracking.paths[i].end == PathEnd::Bifurcation) << what;
  }
}

Tracking expectSound(const ParameterizedField& field, const std::string& what, bool generic = true) {
  const Tracking tracking = track(field);
  for (const TrackedPath& path : tracking.paths) expectPathSound(field, path, what);
  expectEndsClassified(tracking, what);
  Random random(17);
  for (int k = 0; generic && k < 12; ++k) expectIndicesHeld(field, tracking, random.uniform(0.0, 1.0), what);
  return tracking;
}

// Properties ---------------------------------------------------------------------------------------------------------

TEST(Tracking, HoldsTheIndicesAtEveryLambda) {
  auto surfaces = closedSurfaces();
  for (const NamedSurface& s : boundedSurfaces()) surfaces.push_back(s);
  surfaces.push_back({"several components", severalComponents(), 3});
  for (const NamedSurface& s : surfaces) {
    const auto charts = makeCharts(s.surface);
    for (std::uint64_t seed = 0; seed < shortOrLong(1u, 4u); ++seed) {
      const int samples = shortOrLong(3, 6);
      expectSound(randomHistory(charts, samples, seed), message(s.name, ", random ", seed));
      expectSound(smoothBlend(charts, 8, seed), message(s.name, ", smooth ", seed));
      // Zeros on edges belong to either face.
      expectSound(randomIntegerHistory(charts, samples, seed), message(s.name, ", integers ", seed), false);
    }
  }
}

TEST(Tracking, IndicesAddUpToTheEulerCharacteristic) {
  for (const NamedSurface& s : closedSurfaces()) {
    const auto charts = makeCharts(s.surface);
    const ParameterizedField field = randomIntegerHistory(charts, 5, 3);
    const Tracking tracking = track(field);
    Random random(3);
    for (int k = 0; k < 50; ++k) {
      int sum = 0;
      for (const auto& [face, index] : heldAt(tracking, random.uniform(0.0, 1.0))) sum += index;
      EXPECT_EQ(sum, s.euler) << s.name;
    }
  }
}

TEST(Tracking, BoundedSurfacesLoseAndGainPathsAtTheirBoundary) {
  const auto charts = makeCharts(grid(12, 0.2));
  // A source drifts in from the left and out to the right.
  const ParameterizedField field = sampled(
      charts, evenLambdas(9), [](const Vec3& p, double l) -> Vec3 { return p - Vec3(-1.6 + 3.2 * l, 0.123, 0.0); });
  const Tracking tracking = expectSound(field, "drifting source");
  ASSERT_EQ(tracking.paths.size(), 1u);
  EXPECT_EQ(tracking.paths[0].begin, PathEnd::Boundary);
  EXPECT_EQ(tracking.paths[0].end, PathEnd::Boundary);
  EXPECT_NEAR(tracking.paths[0].samples.front().lambda, 0.6 / 3.2, 1e-12);
  EXPECT_NEAR(tracking.paths[0].samples.back().lambda, 2.6 / 3.2, 1e-12);
  EXPECT_TRUE(tracking.bifurcations.empty());
}

TEST(Tracking, PathsThroughVerticesAndAlongEdgesStayWhole) {
  const auto charts = makeCharts(grid(8));
  for (const int index : {1, -1}) {
    for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(1, -1, 0), Vec3(1, 0.5, 0)}) {
      for (const int samples : {2, 3, 6, 9}) {
        const ParameterizedField field = sampled(charts, evenLambdas(samples), [&](const Vec3& p, double l) {
          const Vec3 from = p - (1.5 * l - 0.75) * way;
          return Vec3(from.x(), index * from.y(), 0.0);
        });
        const std::string what = message("index ", index, " along ", way.transpose(), ", samples ", samples);
        const Tracking tracking = expectSound(field, what, false);
        ASSERT_EQ(tracking.paths.size(), 1u) << what;
        EXPECT_TRUE(tracking.bifurcations.empty()) << what;
        EXPECT_EQ(tracking.paths[0].kind, index > 0 ? FixedPointKind::Source : FixedPointKind::Saddle) << what;
        for (const PathSample& sample : tracking.paths[0].samples) {
          expectNear(sample.position, (1.5 * sample.lambda - 0.75) * way, 1e-12, what);
        }
      }
    }
  }
}

TEST(Tracking, ReversingLambdaSwapsCreationAndAnnihilation) {
  const auto charts = makeCharts(bumpySphere(3, 0.1));
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const ParameterizedField field = smoothBlend(charts, 12, seed);
    const Tracking there = track(field), back = track(reversedInLambda(field));
    ASSERT_EQ(there.paths.size(), back.paths.size());
    ASSERT_EQ(there.bifurcations.size(), back.bifurcations.size());
    for (std::size_t i = 0; i < there.bifurcations.size(); ++i) {
      const Bifurcation &a = there.bifurcations[i], &b = back.bifurcations[back.bifurcations.size() - 1 - i];
      EXPECT_NEAR(a.lambda, 1.0 - b.lambda, 1e-12);
      expectNear(a.position, b.position, 1e-9);
      if (a.kind == BifurcationKind::Hopf) {
        EXPECT_EQ(b.kind, BifurcationKind::Hopf);
        EXPECT_NE(a.node, b.node);
      } else {
        EXPECT_EQ(b.kind,
                  a.kind == BifurcationKind::Creation ? BifurcationKind::Annihilation : BifurcationKind::Creation);
        EXPECT_EQ(a.node, b.node);
      }
    }
  }
}

void expectSame(const Tracking& a, const Tracking& b) {
  ASSERT_EQ(a.paths.size(), b.paths.size());
  ASSERT_EQ(a.bifurcations.size(), b.bifurcations.size());
  for (std::size_t i = 0; i < a.paths.size(); ++i) {
    ASSERT_EQ(a.paths[i].samples.size(), b.paths[i].samples.size());
    EXPECT_EQ(a.paths[i].kind, b.paths[i].kind);
    EXPECT_EQ(a.paths[i].strength, b.paths[i].strength);
    for (std::size_t k = 0; k < a.paths[i].samples.size(); ++k) {
      EXPECT_EQ(a.paths[i].samples[k].lambda, b.paths[i].samples[k].lambda);
      EXPECT_EQ(a.paths[i].samples[k].position, b.paths[i].samples[k].position);
      EXPECT_EQ(a.paths[i].samples[k].kind, b.paths[i].samples[k].kind);
    }
  }
  for (std::size_t i = 0; i < a.bifurcations.size(); ++i) {
    EXPECT_EQ(a.bifurcations[i].lambda, b.bifurcations[i].lambda);
    EXPECT_EQ(a.bifurcations[i].position, b.bifurcations[i].position);
    EXPECT_EQ(a.bifurcations[i].paths, b.bifurcations[i].paths);
  }
}

TEST(Tracking, DoesNotDependOnLabelsOrThreads) {
  const Surface s = bumpySphere(shortOrLong(2, 3), 0.2);
  const ParameterizedField field = randomIntegerHistory(makeCharts(s), 7, 4);
  const Tracking tracking = track(field);
  Surface reversedLabels = s;
  const Index last = static_cast<Index>(s.points.rows()) - 1;
  reversedLabels.points = s.points.colwise().reverse();
  reversedLabels.triangles = (last - s.triangles.array()).matrix();
  FieldValues values = field.values;
  for (Index j = 0; j < field.sampleCount(); ++j) {
    Complex* const from = values.begin() + static_cast<std::ptrdiff_t>(j) * (last + 1);
    std::reverse(from, from + last + 1);
  }
  expectSame(tracking, track(makeParameterizedField(makeCharts(reversedLabels), field.lambdas, values)));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  expectSame(tracking, track(field));
}

TEST(Tracking, DoesNotDependOnTheOrderOfFaces) {
  const Surface s = bumpySphere(shortOrLong(2, 3), 0.2);
  const auto charts = makeCharts(s);
  const ParameterizedField field = randomHistory(charts, 5, 9);
  Surface other = s;
  // Faces from last to first, each from its next corner on: every canonical halfedge changes, and every chart.
  for (Eigen::Index f = 0; f < s.triangles.rows(); ++f) {
    const auto from = s.triangles.row(s.triangles.rows() - 1 - f);
    other.triangles.row(f) << from[1], from[2], from[0];
  }
  const auto otherCharts = makeCharts(other);
  std::vector<Complex> values;
  for (Index j = 0; j < field.sampleCount(); ++j) {
    for (Index v = 0; v < field.vertexCount(); ++v) {
      const Index h = charts->mesh().outgoing(v), head = charts->mesh().head(h);
      Index same = otherCharts->mesh().outgoing(v);
      while (otherCharts->mesh().head(same) != head) same = otherCharts->mesh().nextOutgoing(same);
      values.push_back(field.sample(j)[v] * std::polar(1.0, otherCharts->tailAngle(same) - charts->tailAngle(h)));
    }
  }
  const Tracking a = track(field), b = track(makeParameterizedField(otherCharts, field.lambdas, values));
  ASSERT_EQ(a.paths.size(), b.paths.size());
  ASSERT_EQ(a.bifurcations.size(), b.bifurcations.size());
  for (std::size_t i = 0; i < a.bifurcations.size(); ++i) {
    EXPECT_NEAR(a.bifurcations[i].lambda, b.bifurcations[i].lambda, 1e-12);
    EXPECT_EQ(a.bifurcations[i].kind, b.bifurcations[i].kind);
    expectNear(a.bifurcations[i].position, b.bifurcations[i].position, 1e-9);
  }
}

TEST(Tracking, KindsAndPlacesAreThoseOfFixedPoints) {
  const ParameterizedField field = smoothBlend(makeCharts(bumpySphere(3, 0.05)), 6, 2);
  const Tracking tracking = track(field);
  for (const double lambda : field.lambdas) {
    for (const FixedPoint& point : findFixedPoints(at(field, lambda))) {
      int met = 0;
      for (const TrackedPath& path : tracking.paths) {
        for (const PathSample& sample : path.samples) {
          if (sample.lambda != lambda || (sample.position - point.position).norm() > 1e-10) continue;
          ++met;
          EXPECT_EQ(path.index, point.index);
          EXPECT_EQ(sample.kind, point.kind);
        }
      }
      EXPECT_EQ(met, 1) << "lambda " << lambda << ", face " << point.point.face;
    }
  }
}

// Normal forms -------------------------------------------------------------------------------------------------------

constexpr int kCells = 64;
constexpr double kCell = 2.0 / kCells;

std::vector<analytic::Placement> placements() {
  analytic::Placement moved, turned, small, drifting;
  moved.place = {0.237, -0.181};
  moved.lambda = 0.37;
  turned = moved;
  turned.angle = 0.8;
  small = turned;
  small.size = 0.4;
  small.rate = 2.0;
  drifting = turned;
  drifting.drift = {0.3, 0.21};
  return {{}, moved, turned, small, drifting};
}

TEST(Tracking, SaddleNodesAppearAndVanishWhereTheyShould) {
  const auto charts = makeCharts(grid(kCells, 0.2));
  for (const analytic::Placement& placement : placements()) {
    for (const int sign : {1, -1}) {
      // x' = sign * parameter - x^2, y' = -y: a sink and a saddle at x = +-sqrt(sign * parameter).
      const ParameterizedField field =
          sampled(charts, evenLambdas(21),
                  placement.field([&](double x, double y, double mu) { return analytic::foldForm(x, y, sign * mu); }));
      const std::string what = message("sign ", sign, ", angle ", placement.angle, ", size ", placement.size);
      const Tracking tracking = expectSound(field, what);
      const auto kind = sign > 0 ? BifurcationKind::Creation : BifurcationKind::Annihilation;
      // Linear interpolation lifts x^2 by up to a quarter of the squared cell, jitter and diagonal included by one;
      // the blend between two samples of a drifting pattern lifts it by its way in one step in the same manner.
      const double cell = (std::sqrt(2.0) * 1.4 * kCell + placement.drift.norm() / 20.0) / placement.size;
      const double lambdaTolerance = 0.25 * cell * cell / placement.rate;
      const double placeTolerance = cell * placement.size;
      ASSERT_GE(count(tracking, kind), 1) << what;
      int close = 0;
      for (const Bifurcation& event : tracking.bifurcations) {
        if (event.kind != kind || std::abs(event.lambda - placement.lambda) > lambdaTolerance) continue;
        ++close;
        EXPECT_EQ(event.node, FixedPointKind::Sink) << what;
        expectNear(event.position, Vec3(placement.place.x(), placement.place.y(), 0.0), placeTolerance, what);
      }
      EXPECT_EQ(close, 1) << what << ", " << tracking.bifurcations.size() << " bifurcations";
      EXPECT_EQ(tracking.bifurcations.size(), 1u) << what;
      EXPECT_EQ(tracking.paths.size(), 2u) << what;
    }
  }
}

TEST(Tracking, HopfBifurcationsAreListed) {
  const auto charts = makeCharts(grid(kCells, 0.2));
  for (const analytic::Placement& placement : placements()) {
    for (const int sign : {1, -1}) {
      const ParameterizedField field =
          sampled(charts, evenLambdas(21),
                  placement.field([&](double x, double y, double mu) { return analytic::hopfForm(x, y, sign * mu); }));
      const std::string what = message("sign ", sign, ", angle ", placement.angle, ", size ", placement.size);
      const Tracking tracking = expectSound(field, what);
      ASSERT_EQ(tracking.paths.size(), 1u) << what;
      ASSERT_EQ(tracking.bifurcations.size(), 1u) << what;
      const Bifurcation& event = tracking.bifurcations[0];
      EXPECT_EQ(event.kind, BifurcationKind::Hopf) << what;
      EXPECT_EQ(event.node, sign > 0 ? FixedPointKind::Source : FixedPointKind::Sink) << what;
      // The interpolant's divergence at the center is off by that of 4 r^2 over one cell.
      const double cell = (1.4 * kCell + placement.drift.norm() / 20.0) / placement.size;
      EXPECT_NEAR(event.lambda, placement.lambda, 4.0 * cell * cell / placement.rate) << what;
      const Eigen::Vector2d there = placement.place + (event.lambda - placement.lambda) * placement.drift;
      expectNear(event.position, Vec3(there.x(), there.y(), 0.0), 0.5 * kCell, what);
    }
  }
}

TEST(Tracking, AClosedCurveInLambdaIsTwoPaths) {
  const auto charts = makeCharts(grid(32, 0.1));
  // A pair lives while (lambda - 0.5)^2 < 0.04.
  const ParameterizedField field = sampled(charts, evenLambdas(41), [](const Vec3& p, double l) -> Vec3 {
    return {0.04 - (l - 0.5) * (l - 0.5) - p.x() * p.x(), -(p.y() - 0.03), 0.0};
  });
  const Tracking tracking = expectSound(field, "loop");
  ASSERT_EQ(tracking.paths.size(), 2u);
  ASSERT_EQ(tracking.bifurcations.size(), 2u);
  EXPECT_EQ(tracking.bifurcations[0].kind, BifurcationKind::Creation);
  EXPECT_EQ(tracking.bifurcations[1].kind, BifurcationKind::Annihilation);
  EXPECT_EQ(tracking.bifurcations[0].paths, tracking.bifurcations[1].paths);
  // d lambda of the vertex is the error of x^2 over twice the distance to the turning point.
  EXPECT_NEAR(tracking.bifurcations[0].lambda, 0.3, 0.25 * 0.01 / 0.4);
  EXPECT_NEAR(tracking.bifurcations[1].lambda, 0.7, 0.25 * 0.01 / 0.4);
}

TEST(Tracking, CurvesAreSmooth) {
  const auto charts = makeCharts(grid(16, 0.2));
  const ParameterizedField field = sampled(charts, {0.0, 1.0}, [](const Vec3& p, double l) -> Vec3 {
    return l == 0.0 ? Vec3(p.x() + 0.7, p.y() + 0.31, 0.0) : Vec3(-p.y() + 0.2, p.x() - 0.7, 0.0);
  });
  TrackingOptions options;
  options.chordTolerance = 1e-3;
  const Tracking tracking = track(field, options);
  ASSERT_EQ(tracking.paths.size(), 1u);
  for (const PathSample& sample : tracking.paths[0].samples) {
    const double a = 1.0 - sample.lambda, b = sample.lambda;
    const Eigen::Matrix2d m = (Eigen::Matrix2d() << a, -b, b, a).finished();
    const Eigen::Vector2d exact = m.inverse() * Eigen::Vector2d(-0.7 * a - 0.2 * b, -0.31 * a + 0.7 * b);
    expectNear(sample.position, Vec3(exact.x(), exact.y(), 0.0), 1e-12);
  }
}

// Degenerate input ---------------------------------------------------------------------------------------------------

TEST(Tracking, OneSampleGivesPathsOfOneSample) {
  const auto charts = makeCharts(bumpySphere(2));
  const Tracking tracking = track(randomHistory(charts, 1, 5));
  const auto points = findFixedPoints(randomField(charts, 5));
  ASSERT_EQ(tracking.paths.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(tracking.paths[i].samples.size(), 1u);
    EXPECT_EQ(tracking.paths[i].samples[0].position, points[i].position);
    EXPECT_EQ(tracking.paths[i].kind, points[i].kind);
    EXPECT_EQ(tracking.paths[i].begin, PathEnd::Range);
    EXPECT_EQ(tracking.paths[i].end, PathEnd::Range);
  }
  EXPECT_TRUE(tracking.bifurcations.empty());
}

TEST(Tracking, ZeroFieldsAndZeroRegionsAreTracked) {
  for (const NamedSurface& s : closedSurfaces()) {
    const auto charts = makeCharts(s.surface);
    std::vector<Complex> zeros(3 * static_cast<std::size_t>(charts->mesh().vertexCount()), 0.0);
    const ParameterizedField zero = makeParameterizedField(charts, evenLambdas(3), zeros);
    const Tracking tracking = expectSound(zero, s.name + ", zero", false);
    int sum = 0;
    for (const TrackedPath& path : tracking.paths) {
      sum += path.index;
      EXPECT_EQ(path.kind, FixedPointKind::Degenerate);
      EXPECT_EQ(path.strength, 0.0);
    }
    EXPECT_EQ(sum, s.euler) << s.name;

    ParameterizedField half = randomHistory(charts, 4, 8);
    for (std::size_t i = 0; i < half.values.size(); i += 2) half.values[i] = 0.0;
    expectSound(half, s.name + ", half zero");
  }
}

TEST(Tracking, ConstantFieldsKeepTheirPoints) {
  const auto charts = makeCharts(bumpySphere(3, 0.2));
  const std::vector<Complex> once = randomField(charts, 2).values;
  std::vector<Complex> values = once;
  values.insert(values.end(), once.begin(), once.end());
  const Tracking tracking = track(makeParameterizedField(charts, {0.25, 0.5}, values));
  EXPECT_TRUE(tracking.bifurcations.empty());
  for (const TrackedPath& path : tracking.paths) {
    EXPECT_EQ(path.life(), 0.25);
    for (const PathSample& sample : path.samples) {
      expectNear(sample.position, path.samples.front().position, 1e-12);
    }
  }
}

TEST(Tracking, ALoneTriangleWorks) {
  const auto charts = makeCharts(surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  const ParameterizedField field = sampled(
      charts, evenLambdas(3), [](const Vec3& p, double l) -> Vec3 { return p - Vec3(0.2 + 0.1 * l, 0.3, 0.0); });
  EXPECT_EQ(expectSound(field, "triangle").paths.size(), 1u);
}

TEST(Tracking, RefusesOptionsOutOfRange) {
  const ParameterizedField field = randomHistory(makeCharts(tetrahedron()), 2, 1);
  expectFault<InputError>([&] { track(field, {.relativeTolerance = 1.0}); }, {"relative tolerance", "1"});
  expectFault<InputError>([&] { track(field, {.hopfDamping = -0.5}); }, {"Hopf", "-0.5"});
  expectFault<InputError>([&] { track(field, {.chordTolerance = 0.0}); }, {"chord tolerance"});
}

TEST(Tracking, StopsWhenCancelled) {
  const ParameterizedField field = randomHistory(makeCharts(bumpySphere(3)), 3, 1);
  Progress progress;
  progress.cancel();
  EXPECT_THROW(trackFixedPoints(field, {}, progress), Cancelled);
}

}  // namespace
}  // namespace stormfield::test
