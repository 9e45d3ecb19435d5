#include "maps/error_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "checks.h"
#include "field/interpolation.h"
#include "field/poincare_index.h"
#include "fixtures.h"
#include "maps/fixed_point_faces.h"
#include "maps/geometry_map.h"
#include "morse/morse_decomposition.h"
#include "morse/persistence.h"

namespace stormfield::test {
namespace {

VectorField swirl(int level) {
  const Surface s = icosphere(level);
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) {
    const Vec3 p = s.points.row(v);
    vectors.row(v) = Vec3(std::sin(3.0 * p.y()) + 0.2, std::cos(4.0 * p.x()) - p.z(), p.x() * p.y() - 0.3);
  }
  return fromSpace(makeCharts(s), vectors);
}

/// The field with errors of the given part of epsilon * weight, in random directions.
VectorField disturbed(const VectorField& field, double epsilon, const std::vector<double>& weights, Random& random,
                      double least = 0.0) {
  VectorField result = field;
  for (std::size_t v = 0; v < result.values.size(); ++v) {
    const double weight = weights.empty() ? 1.0 : weights[v];
    const double length = epsilon * weight * std::sqrt(random.uniform(least, 1.0));
    result.values[v] += std::polar(length, random.uniform(-kPi, kPi));
  }
  return result;
}

std::vector<double> randomWeights(Index count, Random& random) {
  std::vector<double> weights(count);
  for (double& weight : weights) weight = random.below(5) == 0 ? 0.0 : random.uniform(0.0, 2.0);
  return weights;
}

bool leads(const CombinatorialMap& map, Index a, Index b) {
  return std::binary_search(map.graph.begin(a), map.graph.end(a), b);
}

MorseDecomposition decomposed(const VectorField& field, const ErrorBoundedMap& bounded, double epsilon) {
  Progress progress;
  return morseDecomposition(field, mapWithinEpsilon(bounded, epsilon),
                            {{}, fixedPointFacesWithinEpsilon(bounded, epsilon)}, progress);
}

MorseDecomposition decomposed(const VectorField& field) {
  return decomposed(field, errorBoundedMap(field, {}), 0.0);
}

// The map -------------------------------------------------------------------------------------------------------------

TEST(ErrorBoundedMap, WithoutErrorIsTheGeometryMap) {
  for (const NamedSurface& s : closedSurfaces()) {
    const VectorField field = randomField(makeCharts(s.surface), 3);
    const CombinatorialMap wanted = geometryMap(field), map = mapWithinEpsilon(errorBoundedMap(field, {}), 0.0);
    EXPECT_EQ(map.graph.offsets, wanted.graph.offsets) << s.name;
    EXPECT_EQ(map.graph.targets, wanted.graph.targets) << s.name;
  }
}

TEST(ErrorBoundedMap, HoldsTheMapOfEveryFieldWithinTheBound) {
  Random random(5);
  std::vector<NamedSurface> surfaces = closedSurfaces();
  for (NamedSurface& s : boundedSurfaces()) surfaces.push_back(std::move(s));
  for (const NamedSurface& s : surfaces) {
    for (int round = 0; round < 30; ++round) {
      const auto charts = makeCharts(s.surface);
      const VectorField field = randomField(charts, 100 + round);
      const double epsilon = random.uniform(0.01, 0.5);
      const auto weights = round % 2 == 0 ? std::vector<double>{} : randomWeights(charts->mesh().vertexCount(), random);
      const ErrorBoundedMap bounded = errorBoundedMap(field, weights);
      const CombinatorialMap map = mapWithinEpsilon(bounded, epsilon);
      const std::vector<char> resting = fixedPointFacesWithinEpsilon(bounded, epsilon);
      // Errors of the full size as well: the bound itself is within the bound.
      const VectorField other = disturbed(field, epsilon, weights, random, round % 3 == 0 ? 1.0 : 0.0);
      const CombinatorialMap otherMap = geometryMap(other);
      for (Index f = 0; f < otherMap.graph.nodeCount(); ++f) {
        for (const Index* t = otherMap.graph.begin(f); t != otherMap.graph.end(f); ++t) {
          EXPECT_TRUE(leads(map, f, *t)) << s.name << ": " << f << " -> " << *t;
        }
      }
      const std::vector<char> otherResting = fixedPointFaces(other);
      for (std::size_t f = 0; f < resting.size(); ++f) EXPECT_GE(resting[f], otherResting[f]) << s.name;
    }
  }
}

TEST(ErrorBoundedMap, EdgesComeAtTheLeastEpsilon) {
  // Just below the epsilon of an edge no field crosses there: the vectors turned outwards as far as possible do not.
  const VectorField field = randomField(makeCharts(bumpySphere(2)), 9);
  const ErrorBoundedMap bounded = errorBoundedMap(field, {});
  const TriangleMesh& mesh = field.mesh();
  for (Index e = 0; e < mesh.edgeCount(); ++e) {
    for (const Index h : {mesh.edgeHalfedge(e), mesh.twin(mesh.edgeHalfedge(e))}) {
      const Index f = TriangleMesh::face(h), g = TriangleMesh::face(mesh.twin(h));
      const auto at = std::lower_bound(bounded.map.graph.begin(f), bounded.map.graph.end(f), g);
      const double from = bounded.edgeEpsilon[at - bounded.map.graph.targets.data()];
      const auto [tail, head] = endVectors(field, h);
      const double wanted = std::max(0.0, std::min(tail.imag(), head.imag()));
      EXPECT_NEAR(from, wanted, 1e-12);
    }
  }
}

TEST(ErrorBoundedMap, FlatFacesRestAtTheirLeastSpeed) {
  const VectorField field = randomField(makeCharts(grid(6, 0.3)), 2);
  const ErrorBoundedMap bounded = errorBoundedMap(field, {});
  Random random(1);
  for (Index f = 0; f < field.mesh().faceCount(); ++f) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3000; ++i) {
      // Towards the boundary, where most least speeds are.
      Eigen::Vector3d b = random.barycentric();
      if (i % 2 == 0) {
        b[random.below(3)] = 0.0;
        b /= b.sum();
      }
      least = std::min(least, evaluate(field, {f, b}).norm());
    }
    EXPECT_LE(bounded.faceEpsilon[f], least);
    EXPECT_GE(bounded.faceEpsilon[f], least - 0.05);
  }
}

TEST(ErrorBoundedMap, RefusesBadWeights) {
  const VectorField field = randomField(makeCharts(grid(3)), 1);
  expectFault<InputError>([&] { errorBoundedMap(field, {1.0, 2.0}); }, {"2 weights", "16 vertices"});
  std::vector<double> weights(16, 1.0);
  weights[7] = -1.0;
  expectFault<InputError>([&] { errorBoundedMap(field, weights); }, {"vertex 7", "-1"});
  weights[7] = std::numeric_limits<double>::quiet_NaN();
  expectFault<InputError>([&] { errorBoundedMap(field, weights); }, {"vertex 7"});
}

TEST(MeanSpeed, IsAnAreaMean) {
  const auto charts = makeCharts(grid(8, 0.3));
  const VectorField field =
      makeVectorField(charts, std::vector<Complex>(charts->mesh().vertexCount(), Complex(3.0, 4.0)));
  EXPECT_NEAR(meanSpeed(field), 5.0, 1e-12);
  EXPECT_EQ(meanSpeed(zeroField(charts)), 0.0);
}

// The decomposition under noise ---------------------------------------------------------------------------------------

/// Whether each set of the noisy field lies in one of the sets of the bound, and flow between them goes their way.
void expectWithin(const MorseDecomposition& noisy, const MorseDecomposition& bound) {
  std::vector<Index> inside(noisy.sets.size());
  for (Index s = 0; s < noisy.faces.count(); ++s) {
    inside[s] = bound.faces.setOf(noisy.faces.members(s)[0]);
    ASSERT_NE(inside[s], kNone);
    for (const Index f : noisy.faces.members(s)) ASSERT_EQ(bound.faces.setOf(f), inside[s]);
  }
  const Index n = bound.faces.count();
  std::vector<std::vector<char>> reach(n, std::vector<char>(n, 0));
  for (const auto& [a, b] : bound.graph.edges) reach[a][b] = 1;
  for (Index k = 0; k < n; ++k) {
    reach[k][k] = 1;
    for (Index a = 0; a < n; ++a) {
      for (Index b = 0; b < n; ++b) reach[a][b] = reach[a][b] || (reach[a][k] && reach[k][b]);
    }
  }
  for (const auto& [a, b] : noisy.graph.edges) EXPECT_TRUE(reach[inside[a]][inside[b]]);
}

TEST(ErrorBoundedDecomposition, HoldsUnderNoiseInEveryRunWhileFixedPointsChange) {
  const VectorField field = swirl(4);
  const auto fixedPoints = [](const VectorField& f) {
    const std::vector<int> indices = poincareIndices(f);
    return indices.size() - std::count(indices.begin(), indices.end(), 0);
  };
  const ErrorBoundedMap bounded = errorBoundedMap(field, {});
  const double epsilon = 0.05 * meanSpeed(field);
  const MorseDecomposition bound = decomposed(field, bounded, epsilon);
  const auto before = fixedPoints(field);
  Random random(12);
  int kept = 0, changed = 0;
  for (int run = 0; run < 100; ++run) {
    const VectorField noisy = disturbed(field, epsilon, {}, random);
    const MorseDecomposition morse = decomposed(noisy);
    expectWithin(morse, bound);
    kept += !HasFailure();
    changed += fixedPoints(noisy) != before;
    // Sets of a nonzero index are there in every field of the bound (continuation).
    for (Index s = 0; s < bound.faces.count(); ++s) {
      if (bound.sets[s].index == ConleyIndex{}) continue;
      int inside = 0;
      for (Index t = 0; t < morse.faces.count(); ++t) inside += bound.faces.setOf(morse.faces.members(t)[0]) == s;
      EXPECT_GT(inside, 0);
    }
  }
  EXPECT_EQ(kept, 100);
  EXPECT_GT(changed, 0);
  RecordProperty("kept_of_100", kept);
  RecordProperty("other_number_of_fixed_points_of_100", changed);
}

// Persistence ---------------------------------------------------------------------------------------------------------

/// The least epsilon at which the set's faces are connected with those of another, among all at which F changes.
std::vector<double> byTrying(const ErrorBoundedMap& bounded, const IndexSets& sets, double epsilon) {
  std::vector<double> result(sets.count(), std::numeric_limits<double>::infinity());
  std::vector<double> levels = bounded.edgeEpsilon;
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  for (const double level : levels) {
    if (!(level > epsilon) || !std::isfinite(level)) continue;
    const Components parts = stronglyConnectedComponents(mapWithinEpsilon(bounded, level).graph);
    for (Index a = 0; a < sets.count(); ++a) {
      for (Index b = 0; b < sets.count(); ++b) {
        if (a == b || parts.of[sets.members(a)[0]] != parts.of[sets.members(b)[0]]) continue;
        result[a] = std::min(result[a], level);
      }
    }
  }
  return result;
}

TEST(Persistence, IsWhereSetsMerge) {
  Random random(6);
  for (int round = 0; round < 12; ++round) {
    const VectorField field = disturbed(swirl(1 + round % 2), 0.5, {}, random);
    const auto weights = round % 3 == 0 ? randomWeights(field.mesh().vertexCount(), random) : std::vector<double>{};
    const ErrorBoundedMap bounded = errorBoundedMap(field, weights);
    Progress progress;
    const MergeLevels levels = mergeLevels(bounded, progress);
    for (const double epsilon : {0.0, 0.1}) {
      const MorseDecomposition morse = decomposed(field, bounded, epsilon);
      EXPECT_EQ(persistenceOf(levels, morse.faces, epsilon), byTrying(bounded, morse.faces, epsilon));
    }
  }
}

TEST(Persistence, LevelsAreTheComponentsOfEveryEpsilon) {
  const VectorField field = swirl(2);
  const ErrorBoundedMap bounded = errorBoundedMap(field, {});
  Progress progress;
  const MergeLevels levels = mergeLevels(bounded, progress);
  EXPECT_TRUE(std::is_sorted(levels.epsilon.begin(), levels.epsilon.end()));
  for (const double epsilon : {0.0, 0.01, 0.1, 0.3, 1.0, 10.0}) {
    const auto parts = stronglyConnectedComponents(mapWithinEpsilon(bounded, epsilon).graph);
    const auto joins = std::upper_bound(levels.epsilon.begin(), levels.epsilon.end(), epsilon) - levels.epsilon.begin();
    EXPECT_EQ(parts.count(), bounded.map.graph.nodeCount() - joins);
    for (std::ptrdiff_t i = 0; i < joins; ++i) EXPECT_EQ(parts.of[levels.first[i]], parts.of[levels.second[i]]);
  }
}

TEST(Persistence, OfALoneSetIsInfinite) {
  const VectorField field = zeroField(makeCharts(icosphere(1)));
  const ErrorBoundedMap bounded = errorBoundedMap(field, {});
  Progress progress;
  const MorseDecomposition morse = decomposed(field, bounded, 0.0);
  EXPECT_EQ(persistenceOf(mergeLevels(bounded, progress), morse.faces, 0.0),
            std::vector<double>{std::numeric_limits<double>::infinity()});
}

}  // namespace
}  // namespace stormfield::test
