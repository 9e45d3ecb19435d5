#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <numeric>
#include <thread>

#include "base/error.h"
#include "data_sets.h"
#include "field/poincare_index.h"
#include "fixtures.h"
#include "long_tests.h"
#include "maps/fixed_point_faces.h"
#include "maps/geometry_map.h"
#include "maps/tau_rows.h"
#include "morse/detail/deadline.h"
#include "morse/recurrence.h"
#include "morse/tau_refinement.h"
#include "morse/transit_refinement.h"
#include "polls.h"

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

/// What tau_refinement.h says the result is: from the taus alone, which are tauMin doubled, with all sets of a tau at
/// once.
class Recomputation {
 public:
  Recomputation(const VectorField& field, const TauRefinementOptions& options, const std::vector<double>& taus)
      : field_(field),
        taus_(taus),
        fixedPointFaces_(fixedPointFaces(field)),
        flat_(field.charts),
        flow_(flat_, field, options.map.unit, options.map.tolerance) {
    const CombinatorialMap geometry = geometryMap(field);
    order_ = stronglyConnectedComponents(geometry.graph).of;
    for (Index f = 0; f < geometry.outside(); ++f) rows_.emplace_back(geometry.graph.begin(f), geometry.graph.end(f));
    sets_ = setsOf(field, geometry, {});
    chains_.resize(sets_.count());
    const double last = *std::max_element(taus.begin(), taus.end());
    for (double tau = *options.tauMin; tau <= last; tau *= 2.0) step(tau);
  }
  const FaceSets& sets() const { return sets_; }
  const std::vector<std::vector<Index>>& rows() const { return rows_; }

 private:
  /// The sets that a set was part of after each of its taus.
  using Chain = std::vector<SharedFaces>;

  /// Every set whose faces all went so far.
  void step(double tau) {
    std::vector<std::vector<Index>> inside(rows_.size());
    for (Index s = 0; s < sets_.count(); ++s) {
      const auto& members = sets_.members(s);
      if (std::all_of(members.begin(), members.end(), [&](Index f) { return taus_[f] >= tau; })) makeRows(s, tau);
      for (const Index f : members) {
        std::copy_if(rows_[f].begin(), rows_[f].end(), std::back_inserter(inside[f]),
                     [&](Index t) { return isIn(s, t); });
      }
    }
    const CombinatorialMap map = mapFromRows(inside);
    const FaceSets parts = recurrentSets(map, stronglyConnectedComponents(map.graph));
    const std::vector<char> recurs = canRecur(field_.mesh(), parts, fixedPointFaces_);
    std::vector<Index> setOf(rows_.size(), kNone);
    std::vector<Chain> chains;
    for (Index s = 0; s < parts.count(); ++s) {
      if (recurs[s] == 0) continue;
      for (const Index f : parts.members(s)) setOf[f] = static_cast<Index>(chains.size());
      chains.push_back(chains_[sets_.setOf(parts.members(s).front())]);
      chains.back().push_back(std::make_shared<const std::vector<Index>>(parts.members(s)));
    }
    sets_ = {std::move(setOf), static_cast<Index>(chains.size())};
    chains_ = std::move(chains);
  }

  bool isIn(Index set, Index target) const { return target < field_.mesh().faceCount() && sets_.setOf(target) == set; }

  void makeRows(Index set, double tau) {
    // After 2^k steps each, back to the first tau: images are followed in the set of that tau, and of none before.
    const Chain& chain = chains_[set];
    SetWindows windows;
    windows.steps = flow_.stepCount(tau);
    const int doublings = std::countr_zero(static_cast<unsigned>(windows.steps));
    for (int k = 0; k < doublings; ++k) {
      const int age = doublings - k, place = static_cast<int>(chain.size()) - age;
      windows.levels.push_back(place < 0 ? nullptr : chain[place]);
    }
    const auto& members = sets_.members(set);
    const TauRows made = tauRowsWithinSet(flow_, members, tau, windows);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Index f = members[i];
      std::vector<Index> row;
      for (const Index t : rows_[f]) {
        if (!chain.empty() && !isIn(set, t)) row.push_back(t);
      }
      for (std::size_t k = made.offsets[i]; k < made.offsets[i + 1]; ++k) {
        const Index t = made.targets[k];
        if (isIn(set, t) || (chain.empty() && order_[t] < order_[f])) row.push_back(t);
      }
      std::sort(row.begin(), row.end());
      rows_[f] = row;
    }
  }

  const VectorField& field_;
  const std::vector<double>& taus_;
  std::vector<char> fixedPointFaces_;
  FlatFaces flat_;
  PreparedFlow flow_;
  std::vector<Index> order_;
  std::vector<std::vector<Index>> rows_;
  FaceSets sets_;
  std::vector<Chain> chains_;
};

void expectRecomputation(const VectorField& field, const TauRefinementOptions& options,
                         const TauRefinement& refinement) {
  const Recomputation again(field, options, refinement.taus());
  const CombinatorialMap map = refinement.map(), expected = mapFromRows(again.rows());
  EXPECT_EQ(refinement.sets().setOf(), again.sets().setOf());
  EXPECT_EQ(map.graph.offsets, expected.graph.offsets);
  EXPECT_EQ(map.graph.targets, expected.graph.targets);
  EXPECT_EQ(refinement.sets().setOf(), setsOf(field, map, refinement.taus()).setOf());
}

class RefinementOnSurfaces : public testing::TestWithParam<NamedSurface> {};

TEST_P(RefinementOnSurfaces, IsWhatARecomputationAtItsTausGives) {
  for (int seed = 1; seed <= shortOrLong(1, 20); ++seed) {
    const auto field = std::make_shared<const VectorField>(randomField(makeCharts(GetParam().surface), seed));
    const auto faces = flatFaces(*field);
    for (const TauUnit unit : {TauUnit::Time, TauUnit::Length}) {
      TauRefinementOptions options;
      options.map.unit = unit;
      options.tauMin = startingTau(*field, unit, 0.3);
      options.tauMax = 4.5 * *options.tauMin;
      TauRefinement whole(faces, field, options);
      EXPECT_EQ(whole.refine(), RefinementStop::Done);
      expectRecomputation(*field, options, whole);

      options.maxSteps = 3;
      TauRefinement limited(faces, field, options);
      limited.refine();
      expectRecomputation(*field, options, limited);

      TauRefinement byHand(faces, field, options);
      for (int i = 0; i < 6 && byHand.sets().count() > 0; ++i) byHand.refineSet((5 * i + 3) % byHand.sets().count());
      expectRecomputation(*field, options, byHand);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, RefinementOnSurfaces,
                         testing::Values(NamedSurface{"sphere", icosphere(1), 2}, NamedSurface{"torus", torus(6, 4), 0},
                                         NamedSurface{"annulus", annulus(9, 3), 0}),
                         [](const auto& shown) { return std::string(shown.param.name); });

TEST(Refinement, PartsOfTheGasEngineDoNotDependOnTheOrder) {
  const auto data = dataSet("gasEngineV.t");
  if (!data) GTEST_SKIP() << withoutDataSet("gasEngineV.t");
  const auto field = std::make_shared<const VectorField>(fieldOn(*data));
  const auto faces = flatFaces(*field);
  const TauRefinement start(faces, field);
  std::vector<Index> small;  // first faces of sets
  for (Index s = 0; s < start.sets().count() && small.size() < 6; ++s) {
    const auto& members = start.sets().members(s);
    if (members.size() > 20 && members.size() < 100) small.push_back(members.front());
  }
  ASSERT_GT(small.size(), 2u);
  const auto refined = [&](const std::vector<Index>& order) {
    TauRefinement refinement = start;
    for (const Index f : order) refinement.refineSet(refinement.sets().setOf(f));
    return refinement;
  };
  const TauRefinement one = refined(small), other = refined({small.rbegin(), small.rend()});
  EXPECT_EQ(one.taus(), other.taus());
  EXPECT_EQ(one.sets().setOf(), other.sets().setOf());
  EXPECT_EQ(one.map().graph.targets, other.map().graph.targets);
  EXPECT_EQ(setsOf(*field, one.map(), one.taus()).setOf(), one.sets().setOf());
}

TEST(Refinement, SetsStayWithinThoseTheyComeFrom) {
  const auto field = std::make_shared<const VectorField>(randomField(makeCharts(icosphere(2)), 8));
  TauRefinement refinement(flatFaces(*field), field, {.edgesMin = 1.0});
  for (int i = 0; i < 3; ++i) {
    const FaceSets before = refinement.sets();
    if (!refinement.round()) break;
    for (Index s = 0; s < refinement.sets().count(); ++s) {
      const auto& faces = refinement.sets().members(s);
      EXPECT_NE(before.setOf(faces.front()), kNone);
      for (const Index f : faces) EXPECT_EQ(before.setOf(f), before.setOf(faces.front()));
    }
  }
}

TEST(Refinement, SeparatesASaddleFromItsSinks) {
  const auto field = twoSinks(24);
  TauRefinement refinement(flatFaces(*field), field);
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
    TauRefinement refinement(flatFaces(*field), field, {.edgesMax = edgesMax});
    refinement.refine();
    for (const MorseSet& set : refinement.indices()) EXPECT_EQ(set.index.euler(), set.poincare) << edgesMax;
  }
}

TEST(Refinement, KeepsLimits) {
  const auto field = twoSinks(14);
  TauRefinement none(flatFaces(*field), field, {.maxSteps = 0});
  EXPECT_EQ(none.refine(), RefinementStop::Steps);
  EXPECT_EQ(none.steps(), 0);
  TauRefinement instant(flatFaces(*field), field, {.maxSeconds = 0.0});
  EXPECT_EQ(instant.refine(), RefinementStop::Time);
  TauRefinement bounded(flatFaces(*field), field, {.tauMin = 0.1, .tauMax = 0.5});
  bounded.refine();
  for (const double tau : bounded.taus()) EXPECT_LE(tau, 0.5);
}

TEST(Refinement, KeepsTheMemoryLimit) {
  const auto field = twoSinks(14);
  TauRefinementOptions options;
  options.map.memoryLimit = 1000;
  TauRefinement refinement(flatFaces(*field), field, options);
  const auto before = refinement.sets().setOf();
  EXPECT_EQ(refinement.refine(), RefinementStop::Memory);
  EXPECT_EQ(refinement.steps(), 0);
  EXPECT_EQ(refinement.sets().setOf(), before);
  EXPECT_THROW(refinement.refineSet(0), InputError);
}

TEST(Refinement, HoldsEveryFixedPointAtEveryTau) {
  for (const double edgesMax : {4.0, 16.0}) {
    const auto field = std::make_shared<const VectorField>(randomField(makeCharts(icosphere(1)), 3));
    TauRefinement refinement(flatFaces(*field), field, {.edgesMax = edgesMax});
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
  // A round asks often: the fiftieth poll comes before the end of the first, in which nodes at most double.
  const auto field = turn();
  const auto faces = flatFaces(*field);
  CancelledAt fiftieth(50), again(50);
  TauRefinement refinement(faces, field);
  EXPECT_EQ(refinement.refine(&fiftieth), RefinementStop::Cancelled);
  EXPECT_EQ(refinement.steps(), 0);
  TransitRefinement transits(faces, field, {.maxLevel = 30, .patience = 30});
  const auto nodes = [&] { return transits.map().map().graph.nodeCount(); };
  const Index before = nodes();
  EXPECT_EQ(transits.refine(&again), RefinementStop::Cancelled);
  EXPECT_LE(nodes(), 2 * before);
}

TEST(Refinement, ADeadlineCancelsWhenItsTimeIsOverOrTheCallerCancels) {
  const Deadline over(0.0, nullptr);
  while (!over.progress()->cancelled()) std::this_thread::yield();
  EXPECT_TRUE(over.isOver());
  Progress caller;
  const Deadline far(1e9, &caller);
  EXPECT_FALSE(far.progress()->cancelled());
  caller.cancel();
  while (!far.progress()->cancelled()) std::this_thread::yield();
  EXPECT_FALSE(far.isOver());
}

TEST(Refinement, CancelLeavesCompleteRounds) {
  const auto field = twoSinks(20);
  const auto faces = flatFaces(*field);
  for (const int poll : {1, 2, 5, 20, 100, 500}) {
    TauRefinement refinement(faces, field);
    CancelledAt progress(poll);
    refinement.refine(&progress);
    TauRefinement rounds(faces, field);
    while (rounds.steps() < refinement.steps()) rounds.round();
    EXPECT_EQ(rounds.sets().setOf(), refinement.sets().setOf()) << poll;
    EXPECT_EQ(rounds.taus(), refinement.taus()) << poll;
    EXPECT_EQ(rounds.map().graph.targets, refinement.map().graph.targets) << poll;
  }
}

TEST(Refinement, StopsInTheMiddleOfARoundWhenTheTimeIsOver) {
  const auto field = turn();
  TauRefinement refinement(flatFaces(*field), field, {.maxSeconds = 0.05});
  EXPECT_EQ(refinement.refine(), RefinementStop::Time);
  EXPECT_EQ(refinement.sets().count(), 1);
}

TEST(Refinement, RefinesOneSetByHand) {
  const auto field = twoSinks(24);
  TauRefinement refinement(flatFaces(*field), field);
  ASSERT_GT(refinement.sets().count(), 0);
  const TauRefinement copy = refinement;
  Index largest = 0;
  for (Index s = 0; s < refinement.sets().count(); ++s) {
    if (refinement.sets().members(s).size() > refinement.sets().members(largest).size()) largest = s;
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
  TauRefinement again = copy;
  EXPECT_THROW(again.refineSet(largest, &cancelled), Cancelled);
  EXPECT_EQ(again.sets().setOf(), before);
}

TEST(Refinement, ZeroFieldsAndSingleTrianglesAreLeftAsTheyAre) {
  for (const Surface& s : {surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), grid(3), severalComponents()}) {
    const auto field = std::make_shared<const VectorField>(zeroField(makeCharts(s)));
    TauRefinement refinement(flatFaces(*field), field);
    EXPECT_EQ(refinement.refine(), RefinementStop::Done);
    EXPECT_EQ(refinement.steps(), 0);
  }
  const auto field = twoSinks(6);
  EXPECT_THROW(TauRefinement(flatFaces(*field), field, {.tauMin = -1.0}), InputError);
  EXPECT_THROW(TauRefinement(flatFaces(*field), field, {.tauMax = 0.0}), InputError);
}

TEST(Refinement, PriorityIsTheFacesTimesTheDistanceFromTheBasicIndices) {
  EXPECT_EQ(refinementPriority({0, 1, 0}, 7), 7.0);
  EXPECT_EQ(refinementPriority({0, 0, 0}, 7), 14.0);
  EXPECT_EQ(refinementPriority({0, 2, 1}, 7), 14.0);
}

}  // namespace
}  // namespace stormfield::test
