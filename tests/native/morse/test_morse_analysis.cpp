#include "morse/morse_analysis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <thread>

#include "base/error.h"
#include "checks.h"
#include "fixtures.h"
#include "maps/geometry_map.h"
#include "morse/detail/deadline.h"

namespace stormfield::test {
namespace {

struct Sphere {
  VectorField field = randomField(makeCharts(icosphere(1)), 8);
  std::shared_ptr<const FlatFaces> faces = std::make_shared<const FlatFaces>(field.charts);
  Progress progress;

  MorseAnalysis analyzed(const MorseAnalysisOptions& options) { return analyzeMorse(faces, field, options, progress); }
};

MorseAnalysisOptions by(MorseMethod method, bool refine = false) {
  MorseAnalysisOptions options;
  options.method = method;
  options.refine = refine;
  return options;
}

TEST(MorseAnalysis, MethodsAndStopsHaveNames) {
  for (const MorseMethod method : {MorseMethod::Geometry, MorseMethod::Tau, MorseMethod::Spatial}) {
    EXPECT_EQ(fromName<MorseMethod>(name(method)), method);
  }
  expectFault<InputError>([] { fromName<MorseMethod>("magic"); }, {"magic", "geometry", "tau", "spatial"});
  EXPECT_STREQ(name(RefinementStop::Done), "done");
  EXPECT_STREQ(name(RefinementStop::Steps), "steps");
  EXPECT_STREQ(name(RefinementStop::Time), "time");
  EXPECT_STREQ(name(RefinementStop::Memory), "memory");
  EXPECT_STREQ(name(RefinementStop::Cancelled), "cancelled");
}

TEST(MorseAnalysis, ModelsSayWhatTheyAre) {
  Sphere sphere;
  const Index faceCount = sphere.field.mesh().faceCount();
  const MorseAnalysis plain = sphere.analyzed({});
  EXPECT_EQ(plain.model->method(), MorseMethod::Geometry);
  EXPECT_EQ(plain.model->tau(), 0.0);
  EXPECT_EQ(plain.model->stop(), std::nullopt);
  EXPECT_EQ(plain.model->map().graph.targets, geometryMap(sphere.field).graph.targets);
  EXPECT_FALSE(plain.decomposition.withinFaces);

  MorseAnalysisOptions options = by(MorseMethod::Spatial);
  options.tau = 0.2;
  const MorseAnalysis spatial = sphere.analyzed(options);
  EXPECT_EQ(spatial.model->method(), MorseMethod::Spatial);
  EXPECT_EQ(spatial.model->taus(), std::vector<double>(faceCount, 0.2));
  EXPECT_EQ(spatial.model->stop(), std::nullopt);

  const MorseAnalysis refined = sphere.analyzed(by(MorseMethod::Tau, true));
  const std::vector<double> taus = refined.model->taus();
  EXPECT_EQ(refined.model->method(), MorseMethod::Tau);
  EXPECT_EQ(refined.model->tau(), *std::max_element(taus.begin(), taus.end()));
  EXPECT_EQ(refined.model->stop(), RefinementStop::Done);

  const MorseAnalysis transits = sphere.analyzed(by(MorseMethod::Geometry, true));
  EXPECT_EQ(transits.model->method(), MorseMethod::Geometry);
  EXPECT_EQ(transits.model->taus(), std::vector<double>(faceCount, 0.0));
  EXPECT_EQ(transits.model->stop(), RefinementStop::Done);
  ASSERT_TRUE(transits.decomposition.withinFaces);
  EXPECT_GT(transits.model->map().outside(), faceCount);
}

TEST(MorseAnalysis, WithinEpsilonIsTheAnalysisWithThatEpsilon) {
  Sphere sphere;
  const MorseAnalysis start = sphere.analyzed({});
  for (const double epsilon : {0.0, 0.05, 0.3}) {
    MorseAnalysisOptions options;
    options.epsilon = epsilon;
    const MorseAnalysis wanted = sphere.analyzed(options), found = withinEpsilon(start, epsilon, {}, sphere.progress);
    EXPECT_EQ(found.model->epsilon(), epsilon);
    EXPECT_EQ(found.model->map().graph.targets, wanted.model->map().graph.targets);
    EXPECT_EQ(found.decomposition.faces.setOf(), wanted.decomposition.faces.setOf());
    EXPECT_EQ(found.decomposition.graph.edges, wanted.decomposition.graph.edges);
    for (std::size_t s = 0; s < wanted.decomposition.sets.size(); ++s) {
      EXPECT_EQ(found.decomposition.sets[s].persistence, wanted.decomposition.sets[s].persistence);
    }
  }
}

VectorField fieldOf(const Surface& s, const std::function<Vec3(const Vec3&)>& flow) {
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = flow(s.points.row(v));
  return fromSpace(makeCharts(s), vectors);
}

Index countOf(const VectorField& field, double epsilon, const KeptSets& kept) {
  Progress progress;
  const MorseAnalysis start = analyzeMorse(nullptr, field, {}, progress);
  return withinEpsilon(start, epsilon, kept, progress).decomposition.faces.count();
}

TEST(MorseAnalysis, KeepsTheSetsThatAreAskedFor) {
  // Flow that only passes, known up to 0.3: faces lead back and forth, and nothing recurs.
  const VectorField uniform = fieldOf(grid(20, 0.3), [](const Vec3&) { return Vec3(1.0, 0.123, 0.0); });
  EXPECT_EQ(countOf(uniform, 0.3, {}), 0);
  EXPECT_GT(countOf(uniform, 0.3, {.empty = true}), 0);
  // A repelling orbit inside the ring and an attracting one outside; rows of faces go around too, with trivial index.
  const VectorField around = fieldOf(torus(80, 40), [](const Vec3& p) {
    const Vec3 ring = Vec3(p.x(), p.y(), 0.0).normalized();
    return Vec3(ring + 0.3 * Vec3::UnitZ().cross(ring));
  });
  EXPECT_EQ(countOf(around, 0.0, {.trivial = false}), 2);
  EXPECT_GT(countOf(around, 0.0, {}), 2);
}

TEST(MorseAnalysis, APlainOneIsRefinedSetBySetByTau) {
  Sphere sphere;
  const MorseAnalysis start = sphere.analyzed({});
  Index largest = 0;
  for (Index s = 0; s < start.decomposition.faces.count(); ++s) {
    if (start.decomposition.facesMet(s).size() > start.decomposition.facesMet(largest).size()) largest = s;
  }
  const MorseAnalysis finer = withSetRefined(sphere.faces, start, largest, sphere.progress);
  EXPECT_EQ(finer.model->method(), MorseMethod::Tau);
  const std::vector<double> taus = finer.model->taus();
  for (Index f = 0; f < static_cast<Index>(taus.size()); ++f) {
    EXPECT_EQ(taus[f] > 0.0, start.decomposition.faces.setOf(f) == largest) << f;
  }
  // And so on, by the same refinement.
  EXPECT_EQ(withSetRefined(sphere.faces, finer, 0, sphere.progress).model->method(), MorseMethod::Tau);
}

TEST(MorseAnalysis, RefusesWhatTheMethodHasNot) {
  Sphere sphere;
  const MorseAnalysis plain = sphere.analyzed({}), tau = sphere.analyzed(by(MorseMethod::Tau));
  expectFault<InputError>([&] { withinEpsilon(tau, 0.1, {}, sphere.progress); }, {"'tau'", "error bound", "geometry"});
  expectFault<InputError>([&] { withinEpsilon(plain, std::nan(""), {}, sphere.progress); }, {"eps", "nan"});
  expectFault<InputError>([&] { withSetRefined(sphere.faces, tau, 0, sphere.progress); }, {"refined", "set by set"});
  const MorseAnalysis bounded = withinEpsilon(plain, 0.01, {}, sphere.progress);
  expectFault<InputError>([&] { withSetRefined(sphere.faces, bounded, 0, sphere.progress); }, {"eps 0"});
}

TEST(MorseAnalysis, RefusesSetsThatDoNotExist) {
  Sphere sphere;
  const MorseAnalysis found = sphere.analyzed({});
  const Index count = found.decomposition.faces.count();
  for (const Index set : {-1, count}) {
    expectFault<InputError>([&] { withSetRefined(sphere.faces, found, set, sphere.progress); }, {"no Morse set"});
    expectFault<InputError>([&] { facesBetween(found, set, 0); }, {"no Morse set", std::to_string(set)});
    expectFault<InputError>([&] { facesBetween(found, 0, set); }, {"no Morse set", std::to_string(set)});
  }
}

TEST(MorseAnalysis, RefusesOptionsThatDoNotGoTogether) {
  Sphere sphere;
  const auto refuses = [&](const MorseAnalysisOptions& options, const std::string& part) {
    expectFault<InputError>([&] { sphere.analyzed(options); }, {part});
  };
  refuses({.tau = 0.1}, "has no tau");
  refuses({.method = MorseMethod::Tau, .tau = 0.0}, "positive number");
  refuses({.method = MorseMethod::Tau, .tauMax = 0.1}, "tau_max is for refinement");
  refuses({.method = MorseMethod::Tau, .epsilon = 0.1}, "error bound");
  refuses({.refine = true, .maxSeconds = 0.0}, "limit of time");
  refuses({.epsilon = -1.0}, "eps");
  expectFault<InputError>([&] { analyzeMorse(nullptr, sphere.field, {.refine = true}, sphere.progress); },
                          {"laid out for tracing"});
}

TEST(Deadline, IsOverAfterItsSecondsOrWhenTheCallerCancels) {
  Progress caller;
  const Deadline none(std::numeric_limits<double>::infinity(), &caller);
  EXPECT_EQ(none.progress(), &caller);
  EXPECT_FALSE(none.isOver());
  const Deadline now(0.0, nullptr);
  EXPECT_TRUE(now.isOver());
  while (!now.progress()->cancelled()) std::this_thread::yield();
  const Deadline late(1e300, &caller);
  EXPECT_FALSE(late.isOver());
  EXPECT_FALSE(late.progress()->cancelled());
  caller.cancel();
  while (!late.progress()->cancelled()) std::this_thread::yield();
  EXPECT_FALSE(late.isOver());
}

}  // namespace
}  // namespace stormfield::test
