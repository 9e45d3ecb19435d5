#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/error.h"
#include "field/poincare_index.h"
#include "fixtures.h"
#include "morse/refinement.h"
#include "morse/transit_refinement.h"

namespace stormfield::test {
namespace {

/// On a square: two sinks on the x axis and the saddle between them.
std::shared_ptr<const VectorField> twoSinks(int n) {
  const auto charts = makeCharts(grid(n, 0.2));
  Points vectors = charts->mesh().points();
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const Vec3 p = charts->mesh().point(v);
    const double x = p.x() - 0.013, y = p.y() + 0.017;
    // The rotation makes the geometry-based map coarse.
    const double u = x - 4.0 * x * x * x, w = -y;
    vectors.row(v) = Vec3(u - 0.6 * w, w + 0.6 * u, 0.0);
  }
  return std::make_shared<const VectorField>(fromSpace(charts, vectors));
}

std::shared_ptr<const FlatFaces> flatFaces(const VectorField& field) {
  return std::make_shared<const FlatFaces>(field.charts);
}

FaceSets setsOf(const VectorField& field, const CombinatorialMap& map, const std::vector<double>& taus) {
  MorseOptions options;
  for (const double tau : taus) options.mapped.push_back(tau > 0.0);
  Progress progress;
  return morseDecomposition(field, map, options, progress).faces;
}

/// A turn about the axis: closed orbits in every face, which every round follows all of.
std::shared_ptr<const VectorField> turn() {
  const auto charts = makeCharts(torus(40, 20));
  Points vectors(charts->mesh().vertexCount(), 3);
  for (Index v = 0; v < charts->mesh().vertexCount(); ++v) {
    const Vec3 p = charts->mesh().point(v);
    vectors.row(v) = Vec3(-p.y(), p.x(), 0.0);
  }
  return std::make_shared<const VectorField>(fromSpace(charts, vectors));
}

TEST(Refinement, EnclosesWhatARecomputationAtItsTausEncloses) {
  std::vector<std::shared_ptr<const VectorField>> fields{twoSinks(12)};
  for (const Surface& s : {icosphere(1), annulus(9, 3)}) {
    fields.push_back(std::make_shared<const VectorField>(randomField(makeCharts(s), 6)));
  }
  for (const auto& field : fields) {
    MorseRefinement refinement(flatFaces(*field), field, {.edgesMin = 2.0, .edgesMax = 4.0});
    EXPECT_EQ(refinement.refine(), RefinementStop::Done);
    EXPECT_GT(refinement.steps(), 0);
    // Both enclose what recurs, by images that are padded in different steps, so that the faces may differ by some.
    const CombinatorialMap full = tauMap(*flatFaces(*field), *field, refinement.taus());
    const FaceSets whole = setsOf(*field, full, refinement.taus());
    const std::vector<int> poincare = poincareIndices(*field);
    const auto meets = [](const FaceSets& sets, const std::vector<Index>& faces) {
      return std::any_of(faces.begin(), faces.end(), [&](Index f) { return sets.setOf(f) != kNone; });
    };
    for (Index s = 0; s < refinement.sets().count(); ++s) EXPECT_TRUE(meets(whole, refinement.sets().faces(s)));
    for (Index s = 0; s < whole.count(); ++s) {
      int sum = 0;
      for (const Index f : whole.faces(s)) sum += poincare[f];
      if (sum != 0) {
        EXPECT_TRUE(meets(refinement.sets(), whole.faces(s)));
      }
    }
    for (std::size_t f = 0; f < poincare.size(); ++f) {
      if (poincare[f] != 0) {
        EXPECT_NE(refinement.sets().setOf(static_cast<Index>(f)), kNone) << f;
      }
    }
    // Its own map may join what padding reaches across a set's border, never split.
    const FaceSets own = setsOf(*field, refinement.map(), refinement.taus());
    for (Index s = 0; s < refinement.sets().count(); ++s) {
      for (const Index f : refinement.sets().faces(s)) {
        EXPECT_EQ(own.setOf(f), own.setOf(refinement.sets().faces(s).front()));
      }
    }
  }
}

TEST(Refinement, SetsStayWithinThoseTheyComeFrom) {
  const auto field = std::make_shared<const VectorField>(randomField(makeCharts(icosphere(2)), 8));
  MorseRefinement refinement(flatFaces(*field), field, {.edgesMin = 1.0});
  for (int i = 0; i < 3; ++i) {
    const FaceSets before = refinement.sets();
    if (!refinement.round()) break;
    for (Index s = 0; s < refinement.sets().count(); ++s) {
      const auto& faces = refinement.sets().faces(s);
      EXPECT_NE(before.setOf(faces.front()), kNone);
      for (const Index f : faces) EXPECT_EQ(before.setOf(f), before.setOf(faces.front()));
    }
  }
}

TEST(Refinement, SeparatesASaddleFromItsSinks) {
  const auto field = twoSinks(24);
  MorseRefinement refinement(flatFaces(*field), field);
  refinement.refine();
  int sinks = 0, saddles = 0;
  for (const MorseSet& set : refinement.indices()) {
    sinks += set.kind == MorseKind::Sink;
    saddles += set.kind == MorseKind::Saddle;
  }
  EXPECT_EQ(sinks, 2);
  EXPECT_EQ(saddles, 1);
}

TEST(Refinement, IndicesAgreeWithThePoincareSumsUpToVeryLargeTau) {
  for (const double edgesMax : {64.0, 512.0}) {
    const auto field = twoSinks(16);
    MorseRefinement refinement(flatFaces(*field), field, {.edgesMax = edgesMax});
    refinement.refine();
    for (const MorseSet& set : refinement.indices()) EXPECT_EQ(set.index.euler(), set.poincare) << edgesMax;
  }
}

TEST(Refinement, KeepsLimits) {
  const auto field = twoSinks(14);
  MorseRefinement none(flatFaces(*field), field, {.maximalSteps = 0});
  EXPECT_EQ(none.refine(), RefinementStop::Steps);
  EXPECT_EQ(none.steps(), 0);
  MorseRefinement instant(flatFaces(*field), field, {.maximalSeconds = 0.0});
  EXPECT_EQ(instant.refine(), RefinementStop::Time);
  MorseRefinement bounded(flatFaces(*field), field, {.tauMin = 0.1, .tauMax = 0.5});
  bounded.refine();
  for (const double tau : bounded.taus()) EXPECT_LE(tau, 0.5);
}

TEST(Refinement, KeepsTheMemoryLimit) {
  const auto field = twoSinks(14);
  RefinementOptions options;
  options.map.memoryLimit = 1000;
  MorseRefinement refinement(flatFaces(*field), field, options);
  const auto before = refinement.sets().setOf();
  EXPECT_EQ(refinement.refine(), RefinementStop::Memory);
  EXPECT_EQ(refinement.steps(), 0);
  EXPECT_EQ(refinement.sets().setOf(), before);
  EXPECT_THROW(refinement.refineSet(0), InputError);
}

TEST(Refinement, HoldsEveryFixedPointAtEveryTau) {
  for (const double edgesMax : {4.0, 16.0}) {
    const auto field = std::make_shared<const VectorField>(randomField(makeCharts(icosphere(1)), 3));
    MorseRefinement refinement(flatFaces(*field), field, {.edgesMax = edgesMax});
    refinement.refine();
    const std::vector<int> poincare = poincareIndices(*field);
    for (std::size_t f = 0; f < poincare.size(); ++f) {
      if (poincare[f] != 0) {
        EXPECT_NE(refinement.sets().setOf(static_cast<Index>(f)), kNone) << f;
      }
    }
  }
}

TEST(Refinement, StopsSoonAfterCancel) {
  const auto field = turn();
  MorseRefinement refinement(flatFaces(*field), field);
  TransitRefinement transits(flatFaces(*field), field, {.levels = 30, .patience = 30});
  const auto latency = [](auto& work) {
    using Clock = std::chrono::steady_clock;
    Progress progress;
    Clock::time_point cancelled;
    std::thread watcher([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      cancelled = Clock::now();
      progress.cancel();
    });
    EXPECT_EQ(work.refine(&progress), RefinementStop::Cancelled);
    const auto end = Clock::now();
    watcher.join();
    return std::chrono::duration<double>(end - cancelled).count();
  };
  // Asked is 0.1 s; sanitizers and other work on the machine take their part.
  EXPECT_LT(latency(refinement), 1.0);
  EXPECT_LT(latency(transits), 1.0);
}

TEST(Refinement, CancelLeavesCompleteRounds) {
  const auto field = twoSinks(20);
  const auto faces = flatFaces(*field);
  for (const int microseconds : {0, 300, 1000, 3000, 10000}) {
    MorseRefinement refinement(faces, field);
    Progress progress;
    std::thread watcher([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
      progress.cancel();
    });
    refinement.refine(&progress);
    watcher.join();
    MorseRefinement rounds(faces, field);
    while (rounds.steps() < refinement.steps()) rounds.round();
    EXPECT_EQ(rounds.sets().setOf(), refinement.sets().setOf()) << microseconds;
    EXPECT_EQ(rounds.taus(), refinement.taus()) << microseconds;
    EXPECT_EQ(rounds.map().graph.targets, refinement.map().graph.targets) << microseconds;
  }
}

TEST(Refinement, StopsInTheMiddleOfARoundWhenTheTimeIsOver) {
  const auto field = turn();
  MorseRefinement refinement(flatFaces(*field), field, {.maximalSeconds = 0.05});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(refinement.refine(), RefinementStop::Time);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 2.0);
  EXPECT_EQ(refinement.sets().count(), 1);
}

TEST(Refinement, RefinesOneSetByHand) {
  const auto field = twoSinks(24);
  MorseRefinement refinement(flatFaces(*field), field);
  ASSERT_GT(refinement.sets().count(), 0);
  const MorseRefinement copy = refinement;
  Index largest = 0;
  for (Index s = 0; s < refinement.sets().count(); ++s) {
    if (refinement.sets().faces(s).size() > refinement.sets().faces(largest).size()) largest = s;
  }
  EXPECT_TRUE(refinement.refineSet(largest));
  for (std::size_t f = 0; f < refinement.taus().size(); ++f) {
    EXPECT_EQ(refinement.taus()[f] > 0.0, copy.sets().setOf(static_cast<Index>(f)) == largest);
  }
  EXPECT_THROW(refinement.refineSet(-1), InputError);
  EXPECT_THROW(refinement.refineSet(100000), InputError);
  Progress cancelled;
  cancelled.cancel();
  const auto before = copy.sets().setOf();
  MorseRefinement again = copy;
  EXPECT_THROW(again.refineSet(largest, &cancelled), Cancelled);
  EXPECT_EQ(again.sets().setOf(), before);
}

TEST(Refinement, ZeroFieldsAndSingleTrianglesAreLeftAsTheyAre) {
  for (const Surface& s : {surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), grid(3), severalComponents()}) {
    const auto field = std::make_shared<const VectorField>(zeroField(makeCharts(s)));
    MorseRefinement refinement(flatFaces(*field), field);
    EXPECT_EQ(refinement.refine(), RefinementStop::Done);
    EXPECT_EQ(refinement.steps(), 0);
  }
  const auto field = twoSinks(6);
  EXPECT_THROW(MorseRefinement(flatFaces(*field), field, {.tauMin = -1.0}), InputError);
  EXPECT_THROW(MorseRefinement(flatFaces(*field), field, {.tauMax = 0.0}), InputError);
}

TEST(Refinement, PriorityIsTheFacesTimesTheDistanceFromTheBasicIndices) {
  EXPECT_EQ(refinementPriority({0, 1, 0}, 7), 7.0);
  EXPECT_EQ(refinementPriority({0, 0, 0}, 7), 14.0);
  EXPECT_EQ(refinementPriority({0, 2, 1}, 7), 14.0);
}

}  // namespace
}  // namespace stormfield::test
