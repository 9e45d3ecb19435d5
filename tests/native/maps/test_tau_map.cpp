#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/error.h"
#include "data_sets.h"
#include "fixtures.h"
#include "long_tests.h"
#include "maps/detail/edge_image.h"
#include "maps/error_bound.h"
#include "maps/geometry_map.h"
#include "maps/prepared_flow.h"
#include "maps/tau_map.h"
#include "polls.h"

namespace stormfield::test {
namespace {

bool leadsTo(const CombinatorialMap& map, Index from, Index to) {
  return std::binary_search(map.graph.begin(from), map.graph.end(from), to);
}

/// Advects random points of random faces (of the chosen ones, or of all) and counts those whose image is not in F of
/// their face.
class Escapes final : public AdvectionQueue {
 public:
  Escapes(const CombinatorialMap& map, double tau, int tries, const std::vector<Index>& asked)
      : map_(map), tau_(tau), left_(tries), asked_(asked) {}

  bool next(int lane, AdvectedPoint& from, double& tau) override {
    if (left_-- <= 0) return false;
    const Index face =
        asked_.empty() ? random_.below(map_.outside()) : asked_[random_.below(static_cast<Index>(asked_.size()))];
    from = {.point = {face, random_.barycentric()}};
    from_[lane] = face;
    tau = tau_;
    return true;
  }
  void arrive(int lane, const AdvectedPoint& end) override {
    count_ += !leadsTo(map_, from_[lane], end.leftSurface ? map_.outside() : end.point.face);
  }
  int count() const { return count_; }

 private:
  const CombinatorialMap& map_;
  double tau_;
  int left_, count_ = 0;
  const std::vector<Index>& asked_;
  Random random_{11};
  std::array<Index, kMaxLanes> from_{};
};

/// How many of `tries` points escape, by fine traces.
int escapes(const FlatFaces& faces, const VectorField& field, const CombinatorialMap& map, TauUnit unit, double tau,
            int tries, const std::vector<Index>& asked = {}) {
  Escapes escaping(map, tau, tries, asked);
  const PreparedFlow flow(faces, field, unit, 1e-8);
  flow.advector(Direction::Forward, nullptr)->advectAll(escaping);
  return escaping.count();
}

/// Of as many tries as a short test makes, those of a long one.
constexpr int kLongFactor = 50;
int tries(int brief) {
  return brief * shortOrLong(1, kLongFactor);
}

/// Smooth on the surface: the tangent part of a vector that changes slowly in space.
VectorField smoothField(const std::shared_ptr<const VertexCharts>& charts) {
  Points vectors(charts->mesh().vertexCount(), 3);
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const Vec3 p = charts->mesh().point(v);
    vectors.row(v) = Vec3(std::sin(2.0 * p.y()) + 0.3, std::cos(1.7 * p.z()) - p.x(), std::sin(p.x() + p.y()));
  }
  return fromSpace(charts, vectors);
}

class TauMapOnSurfaces : public testing::TestWithParam<NamedSurface> {};

TEST_P(TauMapOnSurfaces, EnclosesTheImagesOfSmoothAndRandomFields) {
  const auto charts = makeCharts(GetParam().surface);
  const FlatFaces faces(charts);
  const bool all = longTests();
  for (const VectorField& field : {smoothField(charts), randomField(charts, 3)}) {
    for (const double edges : {0.3, 2.0, 6.0}) {
      for (const TauUnit unit : {TauUnit::Time, TauUnit::Length}) {
        TauMapOptions options;
        options.unit = unit;
        if (!all && unit == TauUnit::Length && edges > 2.0) continue;
        const double tau = startingTau(field, unit, edges);
        std::vector<Index> asked;
        for (Index f = 0; f < charts->mesh().faceCount(); f += all ? 1 : 1 + charts->mesh().faceCount() / 4) {
          asked.push_back(f);
        }
        std::vector<double> taus(charts->mesh().faceCount(), 0.0);
        for (const Index f : asked) taus[f] = tau;
        const CombinatorialMap map = tauMap(faces, field, taus, options);
        EXPECT_EQ(escapes(faces, field, map, unit, tau, tries(50), asked), 0)
            << edges << " edges, unit " << static_cast<int>(unit);
      }
    }
  }
}

std::vector<NamedSurface> allSurfaces() {
  auto all = closedSurfaces();
  for (auto& s : boundedSurfaces()) all.push_back(std::move(s));
  return all;
}
INSTANTIATE_TEST_SUITE_P(Surfaces, TauMapOnSurfaces, testing::ValuesIn(allSurfaces()), [](const auto& shown) {
  std::string name = shown.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

TEST(TauMap, EnclosesTheImagesOfTheGasEngine) {
  const auto data = dataSet("gasEngineV.t");
  if (!data) GTEST_SKIP() << withoutDataSet("gasEngineV.t");
  const VectorField field = fieldOn(*data);
  const FlatFaces faces(field.charts);
  const double tau = 3e-4;
  std::vector<double> taus(field.mesh().faceCount(), 0.0);
  std::vector<Index> asked(taus.size());
  std::iota(asked.begin(), asked.end(), 0);
  if (!longTests()) {  // a few of the faces
    for (Index f = 0; f < 100; ++f) asked[f] = 263 * f;
    asked.resize(100);
  }
  for (const Index f : asked) taus[f] = tau;
  const CombinatorialMap map = tauMap(faces, field, taus);
  EXPECT_EQ(escapes(faces, field, map, TauUnit::Time, tau, tries(2000), asked), 0);
}

// The images of the ends and the middle of an edge come together, but a saddle that they pass draws out what lies between.
TEST(TauMap, SeesWhatLeavesBetweenSamplesThatComeTogether) {
  const auto charts = makeCharts(icosphere(2));
  const FlatFaces faces(charts);
  const VectorField field = randomField(charts, 3);
  const double tau = startingTau(field, TauUnit::Time, 6.0);
  std::vector<double> taus(charts->mesh().faceCount(), 0.0);
  taus[162] = taus[163] = tau;
  const CombinatorialMap map = tauMap(faces, field, taus);
  EXPECT_EQ(escapes(faces, field, map, TauUnit::Time, tau, tries(500), {162, 163}), 0);
}

// Edges that need more samples than the limit are sampled again in the end, one at a time.
TEST(TauMap, BridgesGapsOfEdgesThatNeedTooManySamples) {
  const auto charts = makeCharts(icosphere(2));
  const TriangleMesh& mesh = charts->mesh();
  const FlatFaces faces(charts);
  const VectorField field = randomField(charts, 3);
  const double tau = startingTau(field, TauUnit::Time, 6.0);
  constexpr int kSteps = 16;
  const PreparedFlow flow(faces, field, TauUnit::Time, 1e-5);
  const auto advector = flow.advector(Direction::Forward, nullptr);
  std::vector<std::vector<AdvectedPoint>> arrivals(mesh.vertexCount());
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    AdvectedPoint at{.point = vertexPoint(mesh, v)};
    for (int i = 0; i < kSteps; ++i) arrivals[v].push_back(at = advector->advect(at, tau / kSteps));
  }
  std::vector<EdgeToSample> edges;
  for (Index e = 0; e < 160; ++e) {
    const Index h = mesh.edgeHalfedge(e);
    edges.push_back({e, arrivals[mesh.tail(h)], arrivals[mesh.head(h)]});
  }
  const auto images = [&](std::size_t maxSamples, std::size_t pieces) {
    std::vector<std::vector<Index>> made(edges.size());
    for (std::size_t first = 0; first < edges.size(); first += edges.size() / pieces) {
      EdgeImageSampler sampler(flow, tau, kSteps, nullptr, nullptr, maxSamples);
      sampler.sample(std::span(edges).subspan(first, edges.size() / pieces),
                     [&](std::size_t i, const EdgeImage& image) { made[first + i] = image.faces; });
    }
    return made;
  };
  const auto whole = images(EdgeImageSampler::kMaxSamples, 1), bridged = images(20, 1);
  EXPECT_NE(bridged, whole);
  EXPECT_EQ(bridged, images(20, edges.size()));
  for (const auto& image : bridged) EXPECT_FALSE(image.empty());
}

// Around a spiral the flow lengthens vectors during half of each turn, while the image shrinks.
TEST(TauMap, FollowsImagesIntoSpiralsWithFewTraces) {
  const auto charts = makeCharts(grid(12));
  Points vectors = charts->mesh().points();
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const double x = vectors(v, 0) - 0.013, y = vectors(v, 1) + 0.017;
    vectors.row(v) = Vec3(-0.3 * x - 4.0 * y, x - 0.3 * y, 0.0);
  }
  const VectorField field = fromSpace(charts, vectors);
  const FlatFaces faces(charts);
  TauWork work;
  std::vector<double> taus(charts->mesh().faceCount(), 0.0);
  for (Index f = 120; f < 140; ++f) taus[f] = 20.0;
  tauMap(faces, field, taus, {}, nullptr, &work);
  EXPECT_LT(work.traces, 400u);
}

TEST(TauMap, MovesAGridByAConstantField) {
  const auto charts = makeCharts(grid(10));
  const FlatFaces faces(charts);
  const VectorField field = fromSpace(charts, Vec3(1, 0, 0).transpose().replicate(charts->mesh().vertexCount(), 1));
  const CombinatorialMap map = tauMap(faces, field, 0.4);  // two cells of 0.2
  for (Index f = 0; f < map.outside(); ++f) {
    const Vec3 middle = position(charts->mesh(), {f, Eigen::Vector3d::Constant(1.0 / 3.0)});
    if (middle.x() < 0.5) {
      EXPECT_TRUE(leadsTo(map, f, f + 4)) << f;
      EXPECT_FALSE(leadsTo(map, f, f)) << f;
      EXPECT_LE(map.graph.end(f) - map.graph.begin(f), 14) << f;
    } else if (middle.x() > 0.65) {
      EXPECT_TRUE(leadsTo(map, f, map.outside())) << f;
    }
  }
  EXPECT_EQ(map.graph.begin(map.outside()), map.graph.end(map.outside()));
}

TEST(TauMap, ASinkDrawsEverythingTogetherAndASourceSpreadsIt) {
  const auto charts = makeCharts(grid(12, 0.2));
  const FlatFaces faces(charts);
  for (const double sign : {-1.0, 1.0}) {
    const VectorField field = fromSpace(charts, sign * charts->mesh().points());
    const CombinatorialMap map = tauMap(faces, field, 1.5);
    std::size_t largest = 0;
    for (Index f = 0; f < map.outside(); ++f) {
      largest = std::max<std::size_t>(largest, map.graph.end(f) - map.graph.begin(f));
    }
    // exp(1.5)^2 = 20 times the area, filled
    if (sign < 0.0) {
      EXPECT_LE(largest, 12U);
    } else {
      EXPECT_GE(largest, 20U);
    }
    EXPECT_EQ(escapes(faces, field, map, TauUnit::Time, 1.5, 3000), 0);
  }
}

TEST(TauMap, ASourceThatFillsTheSurfaceLeavesNoEdgeOnIt) {
  const auto charts = makeCharts(grid(7, 0.2));
  const FlatFaces faces(charts);
  const VectorField field = fromSpace(charts, charts->mesh().points());
  const CombinatorialMap map = tauMap(faces, field, 12.0);
  Index fills = 0;
  for (Index f = 0; f < map.outside(); ++f) fills += map.graph.end(f) - map.graph.begin(f) == map.outside() + 1;
  EXPECT_EQ(fills, 1);
  EXPECT_EQ(escapes(faces, field, map, TauUnit::Time, 12.0, 1000), 0);
}

TEST(TauMap, EnclosesWhatPassesTheBoundaryWhereAllEdgesLeave) {
  // Near vertex 2 the flow touches the boundary: all edges of face 4 leave, but points inside pass.
  const auto charts = makeCharts(annulus(13, 3));
  const FlatFaces faces(charts);
  const VectorField field = smoothField(charts);
  const double tau = startingTau(field, TauUnit::Length, 0.3);
  const CombinatorialMap map = tauMap(faces, field, tau, {.unit = TauUnit::Length});
  const PreparedFlow flow(faces, field, TauUnit::Length, 1e-8);
  const SurfacePoint passing{4, {0.8777, 0.0992, 0.0231}};
  const AdvectedPoint end = flow.advector(Direction::Forward, nullptr)->advect(passing, tau);
  ASSERT_FALSE(end.leftSurface);
  EXPECT_TRUE(leadsTo(map, passing.face, end.point.face));
  EXPECT_EQ(escapes(faces, field, map, TauUnit::Length, tau, 2000, {2, 3, 4, 5}), 0);
}

/// A field within the error, whose error points along a vector in space, across the field, or at random.
VectorField disturbed(const VectorField& field, double epsilon, int kind) {
  VectorField result = field;
  Random random(100 + kind);
  const Vec3 direction = random.vector();
  const VectorField along = fromSpace(field.charts, direction.transpose().replicate(field.mesh().vertexCount(), 1));
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    const Complex error = kind % 3 == 0   ? along.values[v]
                          : kind % 3 == 1 ? Complex(0.0, 1.0) * field.values[v]
                                          : std::polar(1.0, random.uniform(0.0, 6.28));
    if (std::abs(error) > 0.0) result.values[v] += 0.999 * epsilon * error / std::abs(error);
  }
  return result;
}

void expectHolds(const Surface& surface, bool rough, TauUnit unit, int kinds) {
  const auto charts = makeCharts(surface);
  const FlatFaces faces(charts);
  // A random field draws everything apart: it is followed not as far.
  const VectorField field = rough ? randomField(charts, 3) : smoothField(charts);
  const double epsilon = 0.2 * meanSpeed(field), tau = startingTau(field, unit, rough ? 0.3 : 1.5);
  const CombinatorialMap exact = tauMap(faces, field, tau, {.unit = unit});
  const CombinatorialMap map = tauMap(faces, field, tau, {.unit = unit, .error = {epsilon, {}}});
  for (Index f = 0; f < map.outside(); ++f) {
    EXPECT_TRUE(std::includes(map.graph.begin(f), map.graph.end(f), exact.graph.begin(f), exact.graph.end(f)));
  }
  int without = 0;
  for (int kind = 0; kind < kinds; ++kind) {
    const VectorField other = disturbed(field, epsilon, kind);
    EXPECT_EQ(escapes(faces, other, map, unit, tau, tries(500)), 0) << rough << static_cast<int>(unit) << kind;
    without += escapes(faces, other, exact, unit, tau, tries(500));
  }
  EXPECT_GT(without, 0) << "the map without the error holds as well";
}

TEST(TauMap, HoldsForAllFieldsWithinTheError) {
  expectHolds(torus(14, 9), false, TauUnit::Time, 3);
  expectHolds(torus(14, 9), true, TauUnit::Length, 3);
  if (tries(1) == 1) return;
  for (const Surface& surface : {bumpySphere(2), torus(14, 9), icosphere(3)}) {
    for (const bool rough : {false, true}) {
      for (const TauUnit unit : {TauUnit::Time, TauUnit::Length}) expectHolds(surface, rough, unit, 12);
    }
  }
}

TEST(TauMap, RefusesErrorsItCannotBound) {
  const auto charts = makeCharts(icosphere(2));
  const FlatFaces faces(charts);
  const VectorField field = smoothField(charts);
  EXPECT_THROW(tauMap(faces, field, 0.1, {.error = {-1.0, {}}}), InputError);
  EXPECT_THROW(tauMap(faces, field, 0.1, {.error = {std::nan(""), {}}}), InputError);
  EXPECT_THROW(tauMap(faces, field, 0.1, {.error = {0.1, {1.0}}}), InputError);
  EXPECT_THROW(tauMap(faces, field, 50.0, {.error = {3.0 * meanSpeed(field), {}}}), InputError);
  const auto bounded = makeCharts(grid(4));
  EXPECT_THROW(tauMap(FlatFaces(bounded), randomField(bounded, 1), 0.1, {.error = {0.1, {}}}), InputError);
}

TEST(TauMap, IsTheSameForAnyNumberOfThreads) {
  const auto charts = makeCharts(bumpySphere(2));
  const FlatFaces faces(charts);
  const VectorField field = smoothField(charts);
  const CombinatorialMap many = tauMap(faces, field, 0.3);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const CombinatorialMap single = tauMap(faces, field, 0.3);
  EXPECT_EQ(many.graph.offsets, single.graph.offsets);
  EXPECT_EQ(many.graph.targets, single.graph.targets);
}

TEST(TauMap, RowsDependOnTheirOwnTauOnly) {
  const auto charts = makeCharts(icosphere(3));
  const FlatFaces faces(charts);
  const VectorField field = smoothField(charts);
  std::vector<double> taus(charts->mesh().faceCount());
  for (std::size_t f = 0; f < taus.size(); ++f) taus[f] = 0.1 * static_cast<double>(f % 3);
  const CombinatorialMap mixed = tauMap(faces, field, taus);
  const CombinatorialMap rows[] = {geometryMap(field), tauMap(faces, field, 0.1), tauMap(faces, field, 0.2)};
  for (Index f = 0; f < mixed.outside(); ++f) {
    const DirectedGraph& other = rows[f % 3].graph;
    EXPECT_TRUE(std::equal(mixed.graph.begin(f), mixed.graph.end(f), other.begin(f), other.end(f))) << f;
  }
}

TEST(TauMap, TakesAtMost64BytesForAnEdge) {
  const auto charts = makeCharts(icosphere(3));
  const FlatFaces faces(charts);
  const VectorField field = smoothField(charts);
  TauWork work;
  const CombinatorialMap map = tauMap(faces, field, startingTau(field), {}, nullptr, &work);
  EXPECT_LE(static_cast<double>(work.peakBytes), 64.0 * static_cast<double>(map.graph.edgeCount()));
}

TEST(TauMap, SpatialTauIsTheTauMapByLength) {
  const auto charts = makeCharts(icosphere(3));
  const FlatFaces faces(charts);
  VectorField field = smoothField(charts);
  const CombinatorialMap map = tauMap(faces, field, 0.2, {.unit = TauUnit::Length});
  for (Complex& v : field.values) v *= 8.0;  // a power of two: the same bits
  const CombinatorialMap faster = tauMap(faces, field, 0.2, {.unit = TauUnit::Length});
  EXPECT_EQ(map.graph.targets, faster.graph.targets);
}

TEST(TauMap, RefusesWhatItCannotUse) {
  const auto charts = makeCharts(grid(4));
  const FlatFaces faces(charts);
  const VectorField field = randomField(charts, 1);
  for (const double tau : {0.0, -1.0, std::nan(""), HUGE_VAL}) EXPECT_THROW(tauMap(faces, field, tau), InputError);
  EXPECT_THROW(tauMap(faces, field, std::vector<double>(3, 1.0)), InputError);
  EXPECT_THROW(startingTau(zeroField(charts)), InputError);
  EXPECT_THROW(startingTau(field, TauUnit::Time, 0.0), InputError);
  VectorField broken = field;
  broken.values[5] = {std::nan(""), 0.0};
  EXPECT_THROW(tauMap(faces, broken, 1.0), InputError);
  broken.values.resize(3);
  EXPECT_THROW(tauMap(faces, broken, 1.0), InputError);
}

TEST(TauMap, NamesTheLargestTauThatFitsIntoMemory) {
  // Shear around a torus draws images out, the longer the farther.
  const auto charts = makeCharts(torus(8, 5));
  const FlatFaces faces(charts);
  Points vectors(charts->mesh().vertexCount(), 3);
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const Vec3 p = charts->mesh().point(v);
    vectors.row(v) = (1.0 + 3.0 * p.z()) * Vec3(-p.y(), p.x(), 0.0);
  }
  const VectorField shear = fromSpace(charts, vectors);
  TauMapOptions options;
  options.memoryLimit = 18500;
  EXPECT_NO_THROW(tauMap(faces, shear, 0.01, options));
  try {
    tauMap(faces, shear, 2.5, options);
    FAIL() << "it fits";
  } catch (const InputError& e) {
    const std::string text = e.what(), before = "the largest tau that fits is about ";
    ASSERT_NE(text.find(before), std::string::npos) << text;
    const double largest = std::stod(text.substr(text.find(before) + before.size()));
    EXPECT_GT(largest, 0.01);
    EXPECT_LT(largest, 2.5);
    EXPECT_NO_THROW(tauMap(faces, shear, 0.9 * largest, options)) << largest;
  }
}

TEST(TauMap, AZeroFieldMovesNothing) {
  for (const Surface& s : {grid(3), icosphere(1)}) {
    const auto charts = makeCharts(s);
    const FlatFaces faces(charts);
    for (const TauUnit unit : {TauUnit::Time, TauUnit::Length}) {
      TauMapOptions options;
      options.unit = unit;
      const CombinatorialMap map = tauMap(faces, zeroField(charts), 1.0, options);
      for (Index f = 0; f < map.outside(); ++f) EXPECT_TRUE(leadsTo(map, f, f));
    }
  }
}

TEST(TauMap, FieldsWithZeroVectorsAreEnclosed) {
  for (const Surface& s : {grid(5), icosphere(1), severalComponents()}) {
    const auto charts = makeCharts(s);
    const FlatFaces faces(charts);
    const VectorField field = randomIntegerField(charts, 4);
    const double tau = startingTau(field, TauUnit::Time, 0.5);
    const CombinatorialMap map = tauMap(faces, field, tau);
    EXPECT_EQ(escapes(faces, field, map, TauUnit::Time, tau, 2000), 0);
  }
}

TEST(TauMap, WorksOnASingleTriangle) {
  const auto charts = makeCharts(surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  const FlatFaces faces(charts);
  const VectorField field = fromSpace(charts, Vec3(1, 0, 0).transpose().replicate(3, 1));
  const CombinatorialMap near = tauMap(faces, field, 0.1), far = tauMap(faces, field, 5.0);
  EXPECT_TRUE(leadsTo(near, 0, 0));
  EXPECT_TRUE(leadsTo(near, 0, 1));
  EXPECT_TRUE(leadsTo(far, 0, 1));
}

TEST(TauMap, StopsWhenCancelled) {
  const auto charts = makeCharts(icosphere(4));
  const FlatFaces faces(charts);
  const VectorField field = smoothField(charts);
  expectStopsSoon([&](Progress& progress) { tauMap(faces, field, 1.5, {}, &progress); }, 1000, 0.05);
}

}  // namespace
}  // namespace stormfield::test
