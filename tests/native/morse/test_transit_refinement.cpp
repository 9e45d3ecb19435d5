#include "morse/transit_refinement.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "base/error.h"
#include "checks.h"
#include "data_sets.h"
#include "fixtures.h"
#include "long_tests.h"
#include "morse/morse_analysis.h"
#include "polls.h"

namespace stormfield::test {
namespace {

using FieldPointer = std::shared_ptr<const VectorField>;

std::shared_ptr<const FlatFaces> flatFaces(const VectorField& field) {
  return std::make_shared<const FlatFaces>(field.charts);
}

FieldPointer planar(const Surface& s, const std::function<Vec3(double, double)>& function) {
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = function(s.points(v, 0), s.points(v, 1));
  return std::make_shared<const VectorField>(fromSpace(makeCharts(s), vectors));
}

/// Periodic orbits on the circles of these radii, by turns attracting (the outermost) and repelling.
FieldPointer orbits(const std::vector<double>& radii) {
  return planar(grid(20, 0.2), [&](double x, double y) {
    const double r = std::hypot(x - 0.011, y + 0.007);
    double growth = 1.0;
    for (const double radius : radii) growth *= 3.0 * (radius - r);
    return Vec3(growth * (x - 0.011) - (y + 0.007), growth * (y + 0.007) + x - 0.011, 0.0);
  });
}

FieldPointer random(const Surface& s, std::uint64_t seed) {
  return std::make_shared<const VectorField>(randomField(makeCharts(s), seed));
}

std::map<std::string, int> kinds(const MorseDecomposition& morse) {
  std::map<std::string, int> result;
  for (const MorseSet& set : morse.sets) {
    if (set.kind != MorseKind::Trivial) ++result[name(set.kind)];
  }
  return result;
}

/// The Morse sets of a refinement, and its map.
struct Refined {
  CombinatorialMap map;
  MorseDecomposition morse;

  Refined(const TransitRefinement& refinement, const KeptSets& kept) : map(refinement.map().map()) {
    Progress progress;
    morse = refinement.decomposition(map, kept, progress);
  }
};

Refined refined(const FieldPointer& field, const TransitRefinementOptions& options = {}, const KeptSets& kept = {}) {
  TransitRefinement refinement(flatFaces(*field), field, options);
  EXPECT_EQ(refinement.refine(), RefinementStop::Done);
  return {refinement, kept};
}

TEST(TransitMap, HoldsWhereTrajectoriesLeaveFaces) {
  for (const Surface& s : {icosphere(1), torus(8, 6), annulus(9, 3), tetrahedron()}) {
    for (const std::uint64_t seed : {1, 2}) {
      if (seed > 1 && !longTests()) continue;
      const FieldPointer field = random(s, seed);
      TransitMap map(flatFaces(*field), field);
      Random numbers(seed);
      std::vector<Index> row;
      for (int level = 0; level < 3; ++level) {
        int outside = 0;
        for (int i = 0; i < 1000; ++i) {
          const Index node = map.nodeOf(numbers.below(map.pieceCount()));
          const EdgePiece& piece = map.piece(node);
          if (!piece.enters.isFace()) continue;
          const Index h = map.mesh().edgeHalfedge(piece.edge);
          const double fraction = piece.from + numbers.uniform(0.0, 1.0) * (piece.to - piece.from);
          const Index f = piece.enters.face();
          const bool canonical = TriangleMesh::face(h) == f;
          const Index entered = canonical ? h : map.mesh().twin(h);
          const ExitPosition exit =
              map.faceTransit().exitOf(f, TriangleMesh::corner(entered) + (canonical ? fraction : 1.0 - fraction));
          map.row(node, row);
          if (!exit.exists()) {
            outside += !std::binary_search(row.begin(), row.end(), f);
            continue;
          }
          const double to = *exit;
          // Some piece of the row lies over the edge there.
          const int side = std::min(2, static_cast<int>(to));
          const Index out = TriangleMesh::halfedge(f, side), edge = map.mesh().edge(out);
          const double along = map.mesh().edgeHalfedge(edge) == out ? to - side : 1.0 - (to - side);
          const bool found = std::any_of(row.begin(), row.end(), [&](Index target) {
            if (!map.isPiece(target)) return false;
            const EdgePiece& p = map.piece(target);
            return p.edge == edge && p.from <= along + 1e-5 && p.to >= along - 1e-5;
          });
          // At the ends of an edge the next one does as well.
          outside += !found && along > 1e-5 && along < 1.0 - 1e-5;
        }
        EXPECT_EQ(outside, 0) << s.triangles.rows() << " faces, level " << level;
        std::vector<Index> all;
        for (Index p = 0; p < map.pieceCount(); ++p) all.push_back(map.nodeOf(p));
        map.halve(all);
      }
    }
  }
}

TEST(TransitRefinement, IsWhatTheMapOfAllPiecesAtOnceGives) {
  for (const Surface& s : {icosphere(1), torus(8, 6), annulus(9, 3), severalComponents()}) {
    const FieldPointer field = random(s, 4);
    TransitRefinement refinement(flatFaces(*field), field, {.maxLevel = 4});
    refinement.refine();
    const Refined whole(refinement, {.empty = true});
    const NodeSets& sets = whole.morse.withinFaces->nodes;
    std::set<std::vector<Index>> bySteps(refinement.sets().begin(), refinement.sets().end()), atOnce;
    for (Index set = 0; set < sets.count(); ++set) atOnce.insert(sets.members(set));
    EXPECT_EQ(bySteps, atOnce);
  }
}

TEST(TransitRefinement, HoldsEveryFixedPointAndSumsToTheEulerCharacteristic) {
  const std::vector<NamedSurface> surfaces{{"tetrahedron", tetrahedron(), 2},
                                           {"icosphere", icosphere(1), 2},
                                           {"torus", torus(8, 6), 0},
                                           {"genus 2", plateWithHoles(2), -2}};
  for (const auto& [what, s, euler] : surfaces) {
    const FieldPointer field = random(s, 3);
    const Refined found = refined(field, {.maxLevel = 4});
    int sum = 0;
    std::set<Index> covered;
    for (std::size_t i = 0; i < found.morse.sets.size(); ++i) {
      EXPECT_EQ(found.morse.sets[i].index.euler(), found.morse.sets[i].poincare) << what;
      sum += found.morse.sets[i].poincare;
      const std::vector<Index>& faces = found.morse.facesMet(static_cast<Index>(i));
      covered.insert(faces.begin(), faces.end());
    }
    EXPECT_EQ(sum, euler) << what;
    const FaceTransit transit(flatFaces(*field), field);
    for (Index f = 0; f < field->mesh().faceCount(); ++f) {
      EXPECT_LE(transit.holdsFixedPoint(f), covered.count(f)) << what << ", face " << f;
    }
  }
}

TEST(TransitRefinement, FindsNestedOrbits) {
  const auto one = kinds(refined(orbits({0.61})).morse);
  EXPECT_EQ(one, (std::map<std::string, int>{{"attracting", 1}, {"source", 1}}));
  const auto three = kinds(refined(orbits({0.31, 0.53, 0.77})).morse);
  EXPECT_EQ(three, (std::map<std::string, int>{{"attracting", 2}, {"repelling", 1}, {"source", 1}}));
}

TEST(TransitRefinement, ReversingTheFieldTurnsKindsAround) {
  const FieldPointer field = orbits({0.31, 0.53, 0.77});
  VectorField turned = *field;
  for (Complex& value : turned.values) value = -value;
  const auto back = kinds(refined(std::make_shared<const VectorField>(turned)).morse);
  EXPECT_EQ(back, (std::map<std::string, int>{{"attracting", 1}, {"repelling", 2}, {"sink", 1}}));
}

TEST(TransitRefinement, PartsAPairInsideFaces) {
  // A saddle and a sink in faces beside each other, which no map of whole faces can part: the way from the saddle to
  // the sink and the ways that come to the saddle pass through the same faces.
  const double a = 0.075;
  const FieldPointer field = planar(grid(16, 0.15, 3), [&](double x, double y) {
    const double u = a * a - (x - 0.02) * (x - 0.02), v = -0.2 * (y + 0.01);
    return Vec3(u - 0.3 * v, v + 0.3 * u, 0.0);
  });
  const auto found = kinds(refined(field, {.maxLevel = 10}).morse);
  EXPECT_EQ(found.count("saddle"), 1U);
  EXPECT_EQ(found.count("sink"), 1U);
}

TEST(TransitRefinement, TakesFixedPointsOnEdgesWithBothFaces) {
  // Duffing's oscillator with friction; its sinks lie in the middle of edges, where the field is across them.
  const FieldPointer field =
      planar(grid(30), [](double x, double y) { return Vec3(y, 0.25 * x - x * x * x - 0.1 * y, 0.0); });
  EXPECT_EQ(kinds(refined(field).morse), (std::map<std::string, int>{{"saddle", 1}, {"sink", 2}}));
}

TEST(TransitMap, EdgesThatFlowRunsAlongAreCrossedByNone) {
  // Orbits that run along edges, one attracting and one repelling; all but them cross the edges beside them.
  const Surface s = torus(16, 12);
  const auto charts = makeCharts(s);
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) {
    const Vec3 p = s.points.row(v), around = Vec3(-p.y(), p.x(), 0.0).normalized();
    const Vec3 out = Vec3(p.x(), p.y(), 0.0).normalized();
    const double cosine = (std::hypot(p.x(), p.y()) - 1.0) / 0.4, sine = p.z() / 0.4;
    // Down the tube's circle to its inner side, along the mesh's rings.
    vectors.row(v) = around + 0.7 * sine * (-sine * out + cosine * Vec3::UnitZ());
  }
  VectorField exact = fromSpace(charts, vectors);
  const TriangleMesh& mesh = charts->mesh();
  for (Index h = 0; h < 3 * mesh.faceCount(); ++h) {
    const Index tail = mesh.tail(h), j = tail % 12;
    const bool onRing = j % 6 == 0 && mesh.head(h) == (tail + 12) % mesh.vertexCount();
    if (onRing) exact.values[tail] = std::polar(1.0, charts->tailAngle(h));
  }
  const auto field = std::make_shared<const VectorField>(exact);
  const TransitMap map(flatFaces(*field), field);
  int along = 0;
  for (Index e = 0; e < mesh.edgeCount(); ++e) along += map.faceTransit().edgeFlow(e).along != 0;
  EXPECT_EQ(along, 2 * 16);
  for (Index p = 0; p < map.pieceCount(); ++p) {
    const EdgePiece& piece = map.piece(map.nodeOf(p));
    EXPECT_EQ(piece.enters == EnteredRegion::none(), map.faceTransit().edgeFlow(piece.edge).along != 0);
    EXPECT_FALSE(piece.enters == EnteredRegion::bothFaces());
  }
  EXPECT_EQ(kinds(refined(field).morse), (std::map<std::string, int>{{"attracting", 1}, {"repelling", 1}}));
}

TEST(TransitRefinement, LeavesPiecesThatHalvingDoesNotHelp) {
  // A field along one family of edges, and lines of zeros: rows of halves of coarse pieces would each hold all halves.
  const auto pieces = [](const FieldPointer& field) {
    TransitRefinement refinement(flatFaces(*field), field);
    EXPECT_EQ(refinement.refine(), RefinementStop::Done);
    return refinement.map().pieceCount();
  };
  const Surface s = grid(12);
  const Index edges = makeCharts(s)->mesh().edgeCount();
  EXPECT_LE(pieces(planar(s, [](double, double) { return Vec3(1.0, 0.0, 0.0); })), edges);
  EXPECT_LE(pieces(planar(s, [](double x, double) { return Vec3(x, 0.0, 0.0); })), edges);
  EXPECT_LE(pieces(planar(s, [](double x, double) { return Vec3(std::max(x, 0.0), 0.0, 0.0); })), 2 * edges);
  EXPECT_LE(pieces(planar(s, [](double, double) { return Vec3(0.0, 0.0, 0.0); })), edges);
}

TEST(TransitRefinement, FindsTheCenterOfAWeakSpiral) {
  for (const double decay : {0.1, 0.04}) {
    const FieldPointer field =
        planar(grid(10, 0.2), [&](double x, double y) { return Vec3(-y - decay * x, x - decay * y, 0.0); });
    const Refined found = refined(field, {}, {.empty = true});
    ASSERT_EQ(found.morse.sets.size(), 1U) << decay;
    EXPECT_EQ(found.morse.sets[0].kind, MorseKind::Sink) << decay;
    EXPECT_LT(found.morse.facesMet(0).size(), 30U) << decay;
  }
}

TEST(TransitRefinement, DoesNotDependOnThreads) {
  const FieldPointer field = random(icosphere(1), 5);
  const Refined all = refined(field);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Refined alone = refined(field);
  EXPECT_EQ(all.map.graph.targets, alone.map.graph.targets);
  EXPECT_EQ(all.morse.withinFaces->facesMet, alone.morse.withinFaces->facesMet);
  EXPECT_EQ(all.morse.graph.edges, alone.morse.graph.edges);
}

TEST(TransitRefinement, CancelAndLimitsLeaveAValidDecomposition) {
  const FieldPointer field = random(icosphere(1), 2);
  const auto faces = flatFaces(*field);
  Progress progress;
  for (const int poll : {1, 5, 50}) {
    TransitRefinement refinement(faces, field);
    CancelledAt watched(poll);
    refinement.refine(&watched);
    int sum = 0;
    for (const MorseSet& set : Refined(refinement, {}).morse.sets) sum += set.poincare;
    EXPECT_EQ(sum, 2) << poll;
    // And it can go on.
    EXPECT_EQ(refinement.refine(), RefinementStop::Done);
  }
  TransitRefinement instant(faces, field, {.maxSeconds = 0.0});
  EXPECT_EQ(instant.refine(), RefinementStop::Time);
  TransitRefinement small(faces, field, {.memoryLimit = 1000});
  EXPECT_EQ(small.refine(), RefinementStop::Memory);
}

TEST(TransitRefinement, RefusesTheMapOfOtherPieces) {
  const FieldPointer field = random(icosphere(0), 2);
  TransitRefinement refinement(flatFaces(*field), field, {.maxLevel = 2});
  const CombinatorialMap before = refinement.map().map();
  refinement.refine();
  Progress progress;
  expectFault<InputError>([&] { refinement.decomposition(before, {}, progress); }, {"nodes", "its own map"});
}

TEST(TransitRefinement, ClosedOrbitsEverywhereEnd) {
  const Surface s = torus(16, 10);
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) vectors.row(v) = Vec3(-s.points(v, 1), s.points(v, 0), 0.0);
  const auto field = std::make_shared<const VectorField>(fromSpace(makeCharts(s), vectors));
  TransitRefinement refinement(flatFaces(*field), field, {.maxLevel = 20});
  EXPECT_EQ(refinement.refine(), RefinementStop::Done);
  EXPECT_LT(refinement.map().pieceCount(), 100000);
}

TEST(TransitRefinement, DegenerateFields) {
  for (const Surface& s : {surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), grid(3), severalComponents()}) {
    const auto zero = std::make_shared<const VectorField>(zeroField(makeCharts(s)));
    const Refined found = refined(zero, {.maxLevel = 3});
    std::set<Index> covered;
    for (const auto& faces : found.morse.withinFaces->facesMet) covered.insert(faces.begin(), faces.end());
    EXPECT_EQ(covered.size(), static_cast<std::size_t>(zero->mesh().faceCount()));
  }
  for (const auto& [s, euler] : {std::pair{tetrahedron(), 2}, {icosphere(1), 2}, {torus(8, 6), 0}}) {
    const auto field = std::make_shared<const VectorField>(randomIntegerField(makeCharts(s), 2));
    const Refined found = refined(field, {.maxLevel = 3});
    int sum = 0;
    for (const MorseSet& set : found.morse.sets) sum += set.poincare;
    EXPECT_EQ(sum, euler);
  }
}

/// The gradient of a sum of waves on the ball, turned by about 60 degrees: many saddles whose separatrices run close
/// to each other, but none leads to another.
FieldPointer waves() {
  const Surface s = icosphere(3);
  const std::vector<Vec3> directions{{3.1, 0.4, 1.2}, {-0.7, 2.9, 1.5}, {1.4, -1.6, 2.7}, {-2.2, -1.9, 1.1}};
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& d : directions) sum += std::cos(d.dot(s.points.row(v)) + 0.3 * d.x()) * d;
    vectors.row(v) = sum + 1.7 * Vec3(s.points.row(v)).cross(sum);
  }
  return std::make_shared<const VectorField>(fromSpace(makeCharts(s), vectors));
}

int linksBetweenSaddles(const MorseDecomposition& morse) {
  return static_cast<int>(std::count_if(morse.graph.edges.begin(), morse.graph.edges.end(), [&](const auto& edge) {
    return morse.sets[edge[0]].kind == MorseKind::Saddle && morse.sets[edge[1]].kind == MorseKind::Saddle;
  }));
}

TEST(TransitRefinement, LinksNoSaddlesThatNoFlowLinks) {
  const FieldPointer field = waves();
  const MorseDecomposition morse = refined(field).morse;
  EXPECT_GE(kinds(morse)["saddle"], 4);
  EXPECT_EQ(linksBetweenSaddles(morse), 0);
}

TEST(TransitRefinement, PartsAllFixedPointsAndOrbitsOfTheGasEngine) {
  if (!longTests()) GTEST_SKIP() << "long";
  const auto data = dataSet("gasEngineV.t");
  if (!data) GTEST_SKIP() << withoutDataSet("gasEngineV.t");
  const auto field = std::make_shared<const VectorField>(fromSpace(makeCharts(data->surface), data->vectors));
  // As the entity connection graph has them: 29, 18, 13, 3 and 1.
  const std::map<std::string, int> all{
      {"saddle", 29}, {"sink", 18}, {"source", 13}, {"attracting", 3}, {"repelling", 1}};
  const MorseDecomposition morse = refined(field).morse;
  EXPECT_EQ(kinds(morse), all);
  EXPECT_LE(linksBetweenSaddles(morse), 3);  // closer than the last level of pieces tells apart
}

TEST(TransitRefinement, AnalysisRefinesASetByHandAndFindsWhatLiesBetween) {
  const FieldPointer field = random(icosphere(1), 8);
  Progress progress;
  MorseAnalysisOptions options;
  options.refine = true;
  const auto faces = flatFaces(*field);
  const MorseAnalysis found = analyzeMorse(faces, *field, options, progress);
  EXPECT_EQ(found.model->stop(), RefinementStop::Done);
  ASSERT_FALSE(found.decomposition.graph.edges.empty());
  const auto [from, to] = found.decomposition.graph.edges.front();
  for (const Index f : facesBetween(found, from, to)) {
    const std::vector<Index>& met = found.decomposition.facesMet(from);
    EXPECT_FALSE(std::binary_search(met.begin(), met.end(), f));
  }
  for (Index set = 0; set < found.decomposition.faces.count(); ++set) {
    const MorseAnalysis finer = withSetRefined(faces, found, set, progress);
    EXPECT_GE(finer.decomposition.faces.count() + 1, found.decomposition.faces.count());
  }
}

}  // namespace
}  // namespace stormfield::test
