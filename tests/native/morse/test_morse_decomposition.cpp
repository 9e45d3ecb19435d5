#include "morse/morse_decomposition.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include "checks.h"
#include "field/poincare_index.h"
#include "fixtures.h"
#include "maps/error_bound.h"
#include "maps/geometry_map.h"

namespace stormfield::test {
namespace {

MorseDecomposition decomposed(const VectorField& field, double epsilon = 0.0, bool keepEmpty = false) {
  const ErrorBoundedMap bounded = errorBoundedMap(field, {});
  Progress progress;
  return morseDecomposition(field, mapWithinEpsilon(bounded, epsilon),
                            {{}, fixedPointFacesWithinEpsilon(bounded, epsilon), {.empty = keepEmpty}}, progress);
}

VectorField spaceField(const Surface& s, const std::function<Vec3(const Vec3&)>& function) {
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = function(s.points.row(v));
  return fromSpace(makeCharts(s), vectors);
}

VectorField scaled(VectorField field, double factor) {
  for (Complex& value : field.values) value *= factor;
  return field;
}

/// Kinds of all sets, or of those with a nonzero index, as sorted words.
std::string kinds(const MorseDecomposition& morse, bool trivial = true) {
  std::vector<std::string> words;
  for (const MorseSet& set : morse.sets) {
    if (trivial || set.kind != MorseKind::Trivial) words.emplace_back(name(set.kind));
  }
  std::sort(words.begin(), words.end());
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

int eulerSum(const MorseDecomposition& morse) {
  int sum = 0;
  for (const MorseSet& set : morse.sets) sum += set.index.euler();
  return sum;
}

/// b0 - b1 + b2 is the Poincare sum inside each set.
void expectPoincare(const MorseDecomposition& morse, const std::string& what) {
  for (const MorseSet& set : morse.sets) {
    EXPECT_EQ(set.index.euler(), set.poincare - set.internalTangencies) << what;
    EXPECT_GE(set.index.b1, 0) << what;
  }
}

// Sums ----------------------------------------------------------------------------------------------------------------

TEST(MorseDecomposition, IndicesAddUpToEulerCharacteristic) {
  for (const NamedSurface& s : closedSurfaces()) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      for (const bool integers : {false, true}) {
        const auto charts = makeCharts(s.surface);
        const VectorField field = integers ? randomIntegerField(charts, seed) : randomField(charts, seed);
        const MorseDecomposition morse = decomposed(field);
        EXPECT_EQ(eulerSum(morse), s.euler) << s.name << " seed " << seed << (integers ? " integers" : "");
        expectPoincare(morse, s.name);
      }
    }
  }
}

TEST(MorseDecomposition, IndicesAreThePoincareSumsAlsoAtBoundaries) {
  int seen = 0;
  for (const NamedSurface& s : boundedSurfaces()) {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const auto charts = makeCharts(s.surface);
      expectPoincare(decomposed(randomField(charts, seed)), s.name + " seed " + std::to_string(seed));
      const MorseDecomposition all = decomposed(randomField(charts, seed), 0.0, true);
      expectPoincare(all, s.name + " all, seed " + std::to_string(seed));
      for (const MorseSet& set : all.sets) seen += set.internalTangencies;
    }
  }
  EXPECT_GT(seen, 100) << "the boundary was hardly grazed";
}

TEST(MorseDecomposition, IndicesAreThePoincareSumsForEveryErrorBound) {
  for (const double epsilon : {0.05, 0.2, 0.5}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const auto charts = makeCharts(bumpySphere(2, 0.2));
      const MorseDecomposition morse = decomposed(randomField(charts, seed), epsilon);
      EXPECT_EQ(eulerSum(morse), 2);
      expectPoincare(morse, "bumpy sphere");
    }
  }
}

// Known flows ---------------------------------------------------------------------------------------------------------

/// Around the z axis, on the unit sphere: rate(z) upwards, with some rotation.
VectorField overSphere(int level, const std::function<double(double)>& rate) {
  return spaceField(icosphere(level), [&](const Vec3& p) {
    const Vec3 up = Vec3(0, 0, 1) - p.z() * p;
    return Vec3(rate(p.z()) * up + 0.1 * Vec3(0, 0, 1).cross(p));
  });
}

TEST(MorseDecomposition, OfTwoPoles) {
  const MorseDecomposition morse = decomposed(overSphere(3, [](double) { return 1.0; }));
  EXPECT_EQ(kinds(morse), "sink source");
  ASSERT_EQ(morse.graph.edges.size(), 1U);
  const auto [from, to] = morse.graph.edges[0];
  EXPECT_EQ(morse.sets[from].kind, MorseKind::Source);
  EXPECT_EQ(morse.sets[to].kind, MorseKind::Sink);
}

TEST(MorseDecomposition, OfNestedOrbitsOnTheSphere) {
  // Upwards below z = -0.4 and between 0.1 and 0.5: orbits at -0.4 (attracting), 0.1 (repelling) and 0.5 (attracting).
  const auto rate = [](double z) { return -(z + 0.4) * (z - 0.1) * (z - 0.5) * 4.0; };
  const MorseDecomposition morse = decomposed(overSphere(5, rate));
  EXPECT_EQ(kinds(morse), "attracting attracting repelling source source");
  EXPECT_EQ(morse.graph.edges.size(), 4U);
}

TEST(MorseDecomposition, OfOrbitsOnTheTorus) {
  // Around the tube towards its outside, along the ring always: a repelling orbit inside, an attracting one outside.
  const VectorField field = spaceField(torus(80, 40), [](const Vec3& p) {
    const Vec3 ring = Vec3(p.x(), p.y(), 0.0).normalized();
    return Vec3(ring + 0.3 * Vec3(0, 0, 1).cross(ring));
  });
  const MorseDecomposition morse = decomposed(field);
  // Rows of the mesh lead around the ring too, so that they stay possible orbits, of index 0.
  EXPECT_EQ(kinds(morse, false), "attracting repelling");
}

TEST(MorseDecomposition, OfHopfNormalForm) {
  // r' = r (mu - r^2) with some rotation: a sink for mu < 0; a source and an attracting orbit at sqrt(mu) for mu > 0.
  for (const double mu : {-0.3, 0.25}) {
    const VectorField field = spaceField(grid(80, 0.2), [&](const Vec3& p) {
      return Vec3((mu - p.squaredNorm()) * 5.0 * p + 0.2 * Vec3(-p.y(), p.x(), 0.0));
    });
    EXPECT_EQ(kinds(decomposed(field)), mu < 0.0 ? "sink" : "attracting source");
  }
}

TEST(MorseDecomposition, OfSaddleNodeNormalForm) {
  for (const double mu : {-0.1, 0.2}) {
    const VectorField field =
        spaceField(grid(41, 0.2), [&](const Vec3& p) { return Vec3(mu - p.x() * p.x(), -p.y() + 0.013, 0.0); });
    EXPECT_EQ(kinds(decomposed(field)), mu < 0.0 ? "" : "saddle sink");
  }
}

TEST(MorseDecomposition, OfNothingButPassage) {
  // Uniform flow, and flow once around a fixed point that is not there: many faces lead back and forth, none recurs.
  const VectorField uniform = spaceField(grid(20, 0.3), [](const Vec3&) { return Vec3(1.0, 0.123, 0.0); });
  EXPECT_TRUE(decomposed(uniform).sets.empty());
  EXPECT_FALSE(decomposed(uniform, 0.3, true).sets.empty());
  EXPECT_TRUE(decomposed(uniform, 0.3).sets.empty());
}

TEST(MorseDecomposition, OfOrbitsAroundAHole) {
  const VectorField around = spaceField(annulus(40, 10), [](const Vec3& p) {
    const double r = p.norm();
    return Vec3((1.5 - r) * p / r + 0.2 * Vec3(-p.y(), p.x(), 0.0));
  });
  EXPECT_EQ(kinds(decomposed(around), false), "attracting");
}

TEST(MorseDecomposition, SaysWhatFlowsOut) {
  const VectorField source = spaceField(grid(20, 0.2), [](const Vec3& p) { return Vec3(p + Vec3(0.01, 0.02, 0)); });
  const MorseDecomposition outwards = decomposed(source), inwards = decomposed(scaled(source, -1.0));
  ASSERT_EQ(kinds(outwards), "source");
  ASSERT_EQ(kinds(inwards), "sink");
  EXPECT_EQ(outwards.graph.outflow, std::vector<char>{1});
  EXPECT_EQ(inwards.graph.outflow, std::vector<char>{0});
}

// Symmetries ----------------------------------------------------------------------------------------------------------

TEST(MorseDecomposition, ReversedFieldSwapsKindsAndEdges) {
  const auto charts = makeCharts(bumpySphere(3, 0.1));
  VectorField field = overSphere(3, [](double z) { return z - 0.2; });
  Random random(4);
  for (Complex& value : field.values) value += 0.4 * Complex(random.uniform(), random.uniform());
  const MorseDecomposition forth = decomposed(field), back = decomposed(scaled(field, -1.0));
  EXPECT_GT(forth.sets.size(), 6U);
  ASSERT_EQ(forth.faces.setOf(), back.faces.setOf());
  for (std::size_t s = 0; s < forth.sets.size(); ++s) {
    EXPECT_EQ(forth.sets[s].index.b0, back.sets[s].index.b2);
    EXPECT_EQ(forth.sets[s].index.b1, back.sets[s].index.b1);
    EXPECT_EQ(forth.sets[s].index.b2, back.sets[s].index.b0);
  }
  auto turned = back.graph.edges;
  for (auto& [a, b] : turned) std::swap(a, b);
  std::sort(turned.begin(), turned.end());
  EXPECT_EQ(forth.graph.edges, turned);
}

TEST(MorseDecomposition, RelabelledFacesAndVerticesHaveTheSameSets) {
  const Surface s = bumpySphere(3, 0.1);
  const auto flow = [](const Vec3& p) { return Vec3(std::sin(3 * p.y()), std::cos(4 * p.x()) - p.z(), p.x() * p.y()); };
  Random random(8);
  std::vector<Index> vertex(s.points.rows()), face(s.triangles.rows());
  for (auto* numbers : {&vertex, &face}) {
    std::iota(numbers->begin(), numbers->end(), 0);
    for (std::size_t i = numbers->size() - 1; i > 0; --i) {
      std::swap((*numbers)[i], (*numbers)[random.below(static_cast<Index>(i) + 1)]);
    }
  }
  Surface other = s;
  for (std::size_t v = 0; v < vertex.size(); ++v) other.points.row(vertex[v]) = s.points.row(static_cast<Index>(v));
  for (std::size_t f = 0; f < face.size(); ++f) {
    for (int k = 0; k < 3; ++k) other.triangles(face[f], (k + 1) % 3) = vertex[s.triangles(static_cast<Index>(f), k)];
  }
  const MorseDecomposition one = decomposed(spaceField(s, flow)), two = decomposed(spaceField(other, flow));
  ASSERT_GT(one.sets.size(), 3U);
  ASSERT_EQ(one.sets.size(), two.sets.size());
  std::vector<Index> same(one.sets.size());
  for (std::size_t s1 = 0; s1 < one.sets.size(); ++s1) {
    const auto& faces = one.faces.members(static_cast<Index>(s1));
    same[s1] = two.faces.setOf(face[faces[0]]);
    ASSERT_NE(same[s1], kNone);
    ASSERT_EQ(faces.size(), two.faces.members(same[s1]).size());
    for (const Index f : faces) EXPECT_EQ(two.faces.setOf(face[f]), same[s1]);
    EXPECT_EQ(one.sets[s1].index, two.sets[same[s1]].index);
  }
  std::vector<std::array<Index, 2>> edges;
  for (const auto& [a, b] : one.graph.edges) edges.push_back({same[a], same[b]});
  std::sort(edges.begin(), edges.end());
  EXPECT_EQ(edges, two.graph.edges);
}

TEST(MorseDecomposition, IsTheSameForAnyNumberOfThreads) {
  const VectorField field = randomField(makeCharts(torus(60, 40)), 2);
  const MorseDecomposition many = decomposed(field, 0.01);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const MorseDecomposition single = decomposed(field, 0.01);
  EXPECT_EQ(many.faces.setOf(), single.faces.setOf());
  EXPECT_EQ(many.graph.edges, single.graph.edges);
  for (std::size_t s = 0; s < many.sets.size(); ++s) EXPECT_EQ(many.sets[s].index, single.sets[s].index);
}

// The graph -----------------------------------------------------------------------------------------------------------

TEST(MorseConnectionGraph, HasTheReachabilityOfTheMapAndNoEdgeTooMany) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    VectorField field = overSphere(2, [](double z) { return z - 0.2; });
    Random random(seed);
    for (Complex& value : field.values) value += 0.6 * Complex(random.uniform(), random.uniform());
    const CombinatorialMap map = mapWithinEpsilon(errorBoundedMap(field, {}), 0.0);
    Progress progress;
    const MorseDecomposition morse = morseDecomposition(field, map, {}, progress);
    const Index n = morse.faces.count();
    std::vector<std::vector<char>> reach(n, std::vector<char>(n, 0)), byEdges = reach;
    for (Index a = 0; a < n; ++a) {
      std::vector<char> seen(map.graph.nodeCount(), 0);
      std::vector<Index> open = morse.faces.members(a);
      while (!open.empty()) {
        const Index f = open.back();
        open.pop_back();
        for (const Index* t = map.graph.begin(f); t != map.graph.end(f); ++t) {
          if (seen[*t] != 0) continue;
          seen[*t] = 1;
          open.push_back(*t);
        }
      }
      for (Index b = 0; b < n; ++b) reach[a][b] = a != b && seen[morse.faces.members(b)[0]] != 0;
    }
    const auto closure = [&](std::size_t without) {
      std::vector<std::vector<char>> result(n, std::vector<char>(n, 0));
      for (std::size_t e = 0; e < morse.graph.edges.size(); ++e) {
        if (e != without) result[morse.graph.edges[e][0]][morse.graph.edges[e][1]] = 1;
      }
      for (Index k = 0; k < n; ++k) {
        for (Index a = 0; a < n; ++a) {
          for (Index b = 0; b < n; ++b) result[a][b] = result[a][b] || (result[a][k] && result[k][b]);
        }
      }
      return result;
    };
    const std::size_t edges = morse.graph.edges.size();
    EXPECT_EQ(closure(edges), reach);
    for (std::size_t e = 0; e < edges; ++e) EXPECT_NE(closure(e), reach) << "edge " << e << " is not needed";
  }
}

TEST(MorseConnectionGraph, ConnectionRegionsLieBetween) {
  const VectorField field = overSphere(3, [](double) { return 1.0; });
  const CombinatorialMap map = geometryMap(field);
  Progress progress;
  const MorseDecomposition morse = morseDecomposition(field, map, {}, progress);
  const auto [from, to] = morse.graph.edges.at(0);
  const auto forth = connectionRegion(map, morse.faces, from, to), back = connectionRegion(map, morse.faces, to, from);
  std::size_t inSets = 0;
  for (const Index set : {from, to}) inSets += morse.faces.members(set).size();
  EXPECT_EQ(forth.size() + inSets, static_cast<std::size_t>(field.mesh().faceCount()));
  EXPECT_TRUE(back.empty());
}

// Degenerate and bad input --------------------------------------------------------------------------------------------

TEST(MorseDecomposition, OfZeroFieldsIsTheSurface) {
  for (const NamedSurface& s : closedSurfaces()) {
    const auto charts = makeCharts(s.surface);
    const MorseDecomposition morse = decomposed(zeroField(charts));
    ASSERT_EQ(static_cast<Index>(morse.sets.size()), charts->mesh().componentCount()) << s.name;
    EXPECT_EQ(eulerSum(morse), s.euler);
    EXPECT_TRUE(morse.graph.edges.empty());
  }
}

TEST(MorseDecomposition, OfARegionOfZerosIsOneSet) {
  const VectorField field = spaceField(grid(30, 0.2), [](const Vec3& p) {
    const double r = p.norm();
    return r < 0.4 ? Vec3(Vec3::Zero()) : Vec3((0.4 - r) * p);
  });
  const MorseDecomposition morse = decomposed(field);
  EXPECT_EQ(kinds(morse), "sink");
  EXPECT_GT(morse.faces.members(0).size(), 100U);
}

TEST(MorseDecomposition, OfOneTriangle) {
  const Surface triangle = surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const Vec3 middle(0.3, 0.3, 0.0);
  EXPECT_EQ(kinds(decomposed(spaceField(triangle, [&](const Vec3& p) { return Vec3(p - middle); }))), "source");
  EXPECT_EQ(kinds(decomposed(spaceField(triangle, [&](const Vec3& p) { return Vec3(middle - p); }))), "sink");
  EXPECT_EQ(kinds(decomposed(spaceField(triangle, [&](const Vec3&) { return Vec3(1, 0.2, 0); }))), "");
  for (std::uint64_t seed = 1; seed < 200; ++seed) {
    expectPoincare(decomposed(randomField(makeCharts(triangle), seed), 0.0, true), "triangle");
  }
}

TEST(MorseDecomposition, OfSeveralComponents) {
  const auto charts = makeCharts(severalComponents());
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const MorseDecomposition morse = decomposed(randomField(charts, seed));
    expectPoincare(morse, "several components");
    for (const auto& [a, b] : morse.graph.edges) {
      const auto componentOf = [&](Index set) {
        return charts->mesh().component(charts->mesh().vertex(morse.faces.members(set)[0], 0));
      };
      EXPECT_EQ(componentOf(a), componentOf(b));
    }
  }
}

TEST(MorseDecomposition, BoundsOfMapsThatMissEdgesStillAgreeWithThePoincareSum) {
  for (const double sign : {-1.0, 1.0}) {
    const auto charts = makeCharts(grid(6));
    const TriangleMesh& mesh = charts->mesh();
    Points vectors = mesh.points();
    for (Index v = 0; v < mesh.vertexCount(); ++v) {
      vectors.row(v) = Vec3(mesh.point(v).x() - 0.03, sign * (mesh.point(v).y() + 0.05), 0.0);
    }
    const VectorField field = fromSpace(charts, vectors);
    const std::vector<int> poincare = poincareIndices(field);
    const auto saddle = static_cast<Index>(
        std::find_if(poincare.begin(), poincare.end(), [](int i) { return i != 0; }) - poincare.begin());
    for (Index other = 0; other < mesh.faceCount(); ++other) {
      // The face of the fixed point leads to itself and to one other face alone.
      CombinatorialMap map;
      auto& [offsets, targets] = map.graph;
      targets = {std::min(saddle, other), std::max(saddle, other)};
      if (other == saddle) targets.pop_back();
      for (Index f = 0; f <= mesh.faceCount(); ++f) offsets.push_back(f < saddle ? 0 : targets.size());
      Progress progress;
      const MorseDecomposition morse =
          morseDecomposition(field, map, {.mapped = std::vector<char>(mesh.faceCount(), 1)}, progress);
      ASSERT_EQ(morse.sets.size(), 1U);
      EXPECT_TRUE(morse.sets[0].upperBound);
      EXPECT_EQ(morse.sets[0].poincare, static_cast<int>(sign));
      EXPECT_EQ(morse.sets[0].index.euler(), morse.sets[0].poincare) << "face " << other;
    }
  }
}

TEST(MorseDecomposition, RefusesWhatDoesNotFit) {
  const VectorField field = randomField(makeCharts(grid(3)), 1);
  const CombinatorialMap other = geometryMap(randomField(makeCharts(grid(4)), 1));
  Progress progress;
  expectFault<InputError>([&] { morseDecomposition(field, other, {}, progress); }, {"32 faces", "18", "same mesh"});
  const std::vector<char> few(4, 1);
  expectFault<InputError>([&] { morseDecomposition(field, geometryMap(field), {.mapped = few}, progress); },
                          {"mapped", "4 faces"});
  progress.cancel();
  EXPECT_THROW(morseDecomposition(field, geometryMap(field), {}, progress), Cancelled);
}

}  // namespace
}  // namespace stormfield::test
