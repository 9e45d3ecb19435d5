#include "maps/detail/cone_transit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "checks.h"
#include "fixtures.h"
#include "long_tests.h"
#include "maps/error_bound.h"
#include "morse/morse_analysis.h"
#include "morse/transit_persistence.h"
#include "morse/transit_refinement.h"

namespace stormfield::test {
namespace {

using FieldPointer = std::shared_ptr<const VectorField>;

std::shared_ptr<const FlatFaces> flatFaces(const VectorField& field) {
  return std::make_shared<const FlatFaces>(field.charts);
}

FieldPointer random(const Surface& s, std::uint64_t seed) {
  return std::make_shared<const VectorField>(randomField(makeCharts(s), seed));
}

/// A smooth field on the ball, torus or annulus with some saddles.
FieldPointer smooth(const Surface& s) {
  Points vectors(s.points.rows(), 3);
  for (Eigen::Index v = 0; v < vectors.rows(); ++v) {
    const Vec3 p = s.points.row(v);
    vectors.row(v) = Vec3(std::sin(3.0 * p.y()) + 0.2, std::cos(4.0 * p.x()) - p.z(), p.x() * p.y() - 0.3);
  }
  return std::make_shared<const VectorField>(fromSpace(makeCharts(s), vectors));
}

FieldPointer disturbed(const VectorField& field, double epsilon, Random& numbers, double least = 0.0) {
  VectorField result = field;
  for (Complex& value : result.values) {
    value += std::polar(epsilon * std::sqrt(numbers.uniform(least, 1.0)), numbers.uniform(-kPi, kPi));
  }
  return std::make_shared<const VectorField>(std::move(result));
}

double circleLength(double from, double to) {
  const double length = std::fmod(to - from, 3.0);
  return length < 0.0 ? length + 3.0 : length;
}

/// The exit of the trajectory from a position on a side, by many small steps; none while it is inside.
std::optional<double> fineExit(const FlatFace& face, const std::array<Complex, 3>& values, int side, double fraction) {
  const CarriedVectors vectors = face.carry(values[0], values[1], values[2]);
  Complex p = face.corner(side) + fraction * (face.corner((side + 1) % 3) - face.corner(side));
  const auto stepped = [&](double size) {
    const auto stage = [&](Complex at) {
      const Complex v = face.evaluate(vectors, at);
      return size * face.longestSide() * v / std::abs(v);
    };
    const Complex a = stage(p), b = stage(p + 0.5 * a), c = stage(p + 0.5 * b);
    return p + (a + 2.0 * b + 2.0 * c + stage(p + c)) / 6.0;
  };
  for (int i = 0; i < 4000; ++i) {
    double low = 0.0, high = 1e-3;
    if (face.barycentric(stepped(high)).minCoeff() >= 0.0) {
      p = stepped(high);
      continue;
    }
    if (i == 0) return std::nullopt;  // or over the side of entry, at once
    while (high - low > 1e-12) {
      const double middle = 0.5 * (low + high);
      (face.barycentric(stepped(middle)).minCoeff() >= 0.0 ? low : high) = middle;
    }
    const Eigen::Vector3d there = face.barycentric(stepped(high));
    int least = 0;
    there.minCoeff(&least);
    const int s = (least + 1) % 3;
    return s + there[(s + 1) % 3] / (there[s] + there[(s + 1) % 3]);
  }
  return std::nullopt;
}

TEST(ConeTransit, ArcsHoldWhereTrajectoriesOfAllFieldsLeave) {
  // Linear interpolation of the last of these steps; far less than what 1e-2 of the speed does.
  constexpr double kSteps = 1e-5;
  int compared = 0, narrow = 0;
  for (const Surface& s : {icosphere(1), torus(8, 6), grid(4, 0.2), bumpySphere(1)}) {
    for (const double epsilon : {0.01, 0.1}) {
      const FieldPointer field = random(s, 7);
      const auto faces = flatFaces(*field);
      const ConeTransit cones(faces, field, epsilon);
      Random numbers(3);
      for (int i = 0; i < (longTests() ? 20000 : 150); ++i) {
        const Index f = numbers.below(field->mesh().faceCount());
        const int side = numbers.below(3);
        if (cones.mayHoldFixedPoint(f)) continue;
        const double begin = numbers.uniform(0.0, 0.9), end = begin + 0.1 * numbers.uniform(0.0, 1.0);
        const ExitArcs arcs = cones.exitArcs(f, side, begin, end);
        // The same error at all corners rotates the field as far as the bound allows.
        const Complex error = std::polar(epsilon, numbers.uniform(-kPi, kPi));
        std::array<Complex, 3> values;
        for (int k = 0; k < 3; ++k) {
          const Complex own = std::polar(epsilon * numbers.uniform(0.0, 1.0), numbers.uniform(-kPi, kPi));
          const Index v = (*faces)[f].vertex(k);
          const Complex there = error / (*faces)[f].carry(k, 1.0);
          values[k] = field->values[v] + (i % 2 == 0 ? own : there);
        }
        const double from = numbers.uniform(begin, end);
        const auto to = fineExit((*faces)[f], values, side, from);
        if (!to || std::abs(*to - (side + from)) < 2e-3) continue;  // does not enter
        ++compared;
        double length = 0.0;
        for (const BoundaryArc& arc : arcs) length += arc.length;
        narrow += length < 0.5;
        const bool held = (*to >= side + begin - kSteps && *to <= side + end + kSteps) ||
                          std::any_of(arcs.begin(), arcs.end(), [&](const BoundaryArc& arc) {
                            return circleLength(arc.begin - kSteps, *to) <= arc.length + 2.0 * kSteps;
                          });
        EXPECT_TRUE(held) << "face " << f << ", from " << side + from << " to " << *to;
      }
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_GT(2 * narrow, compared);
}

TEST(TransitMap, HoldsWhereFineTrajectoriesLeave) {
  // Small pieces show whether images have enough to spare, also where trajectories graze the side they leave over.
  int compared = 0, outside = 0;
  for (const Surface& s : {icosphere(1), torus(8, 6), grid(4, 0.2), bumpySphere(1)}) {
    const FieldPointer field = random(s, 7);
    const auto faces = flatFaces(*field);
    TransitMap map(faces, field);
    for (int level = 0; level < (longTests() ? 6 : 3); ++level) {
      std::vector<Index> all;
      for (Index p = 0; p < map.pieceCount(); ++p) all.push_back(map.nodeOf(p));
      map.halve(all);
    }
    Random numbers(3);
    std::vector<Index> row;
    for (int i = 0; i < (longTests() ? 20000 : 150); ++i) {
      const Index node = map.nodeOf(numbers.below(map.pieceCount()));
      const EdgePiece& piece = map.piece(node);
      // Jumps in faces with a fixed point are found by bisection only (docs/performance.md).
      if (!piece.enters.isFace() || map.faceTransit().holdsFixedPoint(piece.enters.face())) continue;
      const Index f = piece.enters.face();
      const Index h = map.mesh().edgeHalfedge(piece.edge);
      const bool canonical = TriangleMesh::face(h) == f;
      const double fraction = piece.from + numbers.uniform(0.0, 1.0) * (piece.to - piece.from);
      const FlatFace& face = (*faces)[f];
      std::array<Complex, 3> values;
      for (int k = 0; k < 3; ++k) values[k] = field->values[face.vertex(k)];
      const int side = TriangleMesh::corner(canonical ? h : map.mesh().twin(h));
      const double from = canonical ? fraction : 1.0 - fraction;
      const auto to = fineExit(face, values, side, from);
      if (!to || std::abs(*to - (side + from)) < 2e-3) continue;
      map.row(node, row);
      const Index out = TriangleMesh::halfedge(f, std::min(2, static_cast<int>(*to)));
      const Index edge = map.mesh().edge(out);
      const double along = *to - std::floor(*to);
      const double at = map.mesh().edgeHalfedge(edge) == out ? along : 1.0 - along;
      ++compared;
      outside += std::none_of(row.begin(), row.end(), [&](Index target) {
        if (!map.isPiece(target)) return false;
        const EdgePiece& p = map.piece(target);
        return p.edge == edge && p.from <= at + 2e-6 && p.to >= at - 2e-6;
      });
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_EQ(outside, 0);
}

TEST(ConeTransit, EdgesAreCrossedBothWaysWhereTheErrorReachesTheComponentAcross) {
  const FieldPointer field = random(bumpySphere(1), 2);
  const ConeTransit cones(flatFaces(*field), field, 0.2);
  for (Index e = 0; e < field->mesh().edgeCount(); ++e) {
    std::vector<double> changes = cones.signChanges(e);
    changes.insert(changes.begin(), 0.0);
    changes.push_back(1.0);
    const EndVectors ends = endVectors(*field, field->mesh().edgeHalfedge(e));
    for (std::size_t i = 0; i + 1 < changes.size(); ++i) {
      const double middle = 0.5 * (changes[i] + changes[i + 1]);
      const double across = (1.0 - middle) * ends.tail.imag() + middle * ends.head.imag();
      const int wanted = std::abs(across) <= 0.2 ? 0 : (across > 0.0 ? 1 : -1);
      EXPECT_EQ(cones.crossingSign(e, changes[i], changes[i + 1]), wanted) << e;
    }
  }
}

TEST(ConeTransit, RefusesBadBounds) {
  const FieldPointer field = random(icosphere(0), 2);
  const auto faces = flatFaces(*field);
  expectFault<InputError>([&] { ConeTransit(faces, field, -1.0); }, {"eps", "-1"});
  expectFault<InputError>([&] { ConeTransit(faces, field, std::nan("")); }, {"eps"});
  expectFault<InputError>([&] { ConeTransit(faces, field, 0.1, {1.0}); }, {"1 weights", "12 vertices"});
}

// The map -------------------------------------------------------------------------------------------------------------

/// Targets of a node, and those of the interior nodes among them.
std::set<Index> reached(const TransitMap& map, Index node) {
  std::vector<Index> row, further;
  map.row(node, row);
  std::set<Index> result(row.begin(), row.end());
  for (const Index target : row) {
    if (target >= map.mesh().faceCount()) continue;
    map.row(target, further);
    result.insert(further.begin(), further.end());
  }
  return result;
}

TEST(TransitMapOfAllFields, GrowsWithTheBound) {
  for (const Surface& s : longTests() ? std::vector{icosphere(1), torus(8, 6), plateWithHoles(2, 1)}
                                      : std::vector{icosphere(0), torus(4, 3)}) {
    const FieldPointer field = random(s, 11);
    const auto faces = flatFaces(*field);
    TransitMap pieces(faces, field);
    std::vector<Index> all;
    for (Index p = 0; p < pieces.pieceCount(); ++p) all.push_back(pieces.nodeOf(p));
    pieces.halve(all);
    const ConeTransit cones(faces, field, 0.0);
    TransitMap before = pieces;
    for (const double epsilon : {1e-3, 1e-2, 0.03, 0.1, 0.3, 1.0}) {
      const TransitMap after = pieces.withinEpsilon(std::make_shared<const ConeTransit>(cones.withinEpsilon(epsilon)));
      int missing = 0;
      for (Index node = 0; node < before.outside(); ++node) {
        const std::set<Index> less = reached(before, node), more = reached(after, node);
        for (const Index target : less) missing += more.count(target) == 0;
      }
      EXPECT_EQ(missing, 0) << epsilon;
      before = after;
    }
  }
}

MorseDecomposition decomposed(const TransitRefinement& refinement, const KeptSets& kept = {}) {
  Progress progress;
  return refinement.decomposition(refinement.map().map(), kept, progress);
}

MorseDecomposition refined(const FieldPointer& field, double epsilon, int levels = 8) {
  TransitRefinement refinement(flatFaces(*field), field, {.maxLevel = levels, .epsilon = epsilon});
  EXPECT_EQ(refinement.refine(), RefinementStop::Done);
  return decomposed(refinement);
}

TEST(TransitRefinementOfAllFields, IsWhatTheMapOfAllPiecesAtOnceGives) {
  for (const Surface& s : {icosphere(0), torus(5, 4), annulus(9, 3)}) {
    const FieldPointer field = random(s, 4);
    TransitRefinement refinement(flatFaces(*field), field, {.maxLevel = 3, .epsilon = 0.05});
    refinement.refine();
    const MorseDecomposition whole = decomposed(refinement, {.empty = true});
    const NodeSets& sets = whole.withinFaces->nodes;
    std::set<std::vector<Index>> bySteps(refinement.sets().begin(), refinement.sets().end()), atOnce;
    for (Index set = 0; set < sets.count(); ++set) atOnce.insert(sets.members(set));
    EXPECT_EQ(bySteps, atOnce);
  }
}

TEST(TransitRefinementOfAllFields, IndicesSumToTheEulerCharacteristic) {
  for (const auto& [s, euler] : {std::pair{tetrahedron(), 2}, {icosphere(1), 2}, {torus(8, 6), 0}}) {
    for (const double epsilon : {1e-6, 0.01, 0.5}) {
      int sum = 0;
      for (const MorseSet& set : refined(random(s, 3), epsilon, 2).sets) {
        EXPECT_EQ(set.index.euler(), set.poincare);
        sum += set.poincare;
      }
      EXPECT_EQ(sum, euler) << epsilon;
    }
  }
}

TEST(TransitRefinementOfAllFields, BeyondAllSpeedsIsOneSet) {
  for (const auto& [s, euler] : {std::pair{icosphere(1), 2}, {torus(8, 6), 0}, {plateWithHoles(2, 1), -2}}) {
    const MorseDecomposition found = refined(random(s, 3), 100.0);
    ASSERT_EQ(found.sets.size(), 1U);
    EXPECT_EQ(found.sets[0].index, (ConleyIndex{1, 2 - euler, 1}));
    EXPECT_EQ(found.facesMet(0).size(), static_cast<std::size_t>(s.triangles.rows()));
  }
}

/// Whether the sets of a noisy field lie each in a set of the bound, and these keep the index of what is in them. That
/// of sets with a fixed point at the surface's boundary is not kept: fixed points may leave over it.
bool holds(const MorseDecomposition& noisy, const MorseDecomposition& bound) {
  std::vector<int> poincare(bound.sets.size(), 0);
  for (std::size_t s = 0; s < noisy.sets.size(); ++s) {
    const std::vector<Index>& faces = noisy.facesMet(static_cast<Index>(s));
    const auto& met = bound.withinFaces->facesMet;
    const auto in = std::find_if(met.begin(), met.end(), [&](const std::vector<Index>& around) {
      return std::includes(around.begin(), around.end(), faces.begin(), faces.end());
    });
    if (in == met.end()) return false;
    poincare[in - met.begin()] += noisy.sets[s].poincare;
  }
  for (std::size_t s = 0; s < poincare.size(); ++s) {
    if (!bound.sets[s].upperBound && poincare[s] != bound.sets[s].poincare) return false;
  }
  return true;
}

TEST(TransitRefinementOfAllFields, HoldsUnderNoiseWhileTheFieldsOwnGraphsChange) {
  const bool isLong = longTests();
  for (const Surface& s :
       {icosphere(isLong ? 3 : 0), torus(isLong ? 32 : 6, isLong ? 16 : 4), annulus(isLong ? 24 : 9, isLong ? 8 : 3)}) {
    const FieldPointer field = smooth(s);
    const int runs = isLong ? 100 : 2, levels = isLong ? 8 : 3;
    const double epsilon = 0.1 * meanSpeed(*field);
    const MorseDecomposition bound = refined(field, epsilon, levels), own = refined(field, 0.0, levels);
    Random numbers(12);
    int kept = 0, changed = 0;
    for (int run = 0; run < runs; ++run) {
      const MorseDecomposition noisy = refined(disturbed(*field, epsilon, numbers), 0.0, levels);
      kept += holds(noisy, bound);
      changed += noisy.sets.size() != own.sets.size();
    }
    EXPECT_EQ(kept, runs);
    EXPECT_GE(changed, isLong ? 1 : 0);
    RecordProperty("runs_with_another_number_of_own_sets", changed);
  }
}

TEST(TransitRefinementOfAllFields, AnalysisTakesEveryErrorBound) {
  const FieldPointer field = random(icosphere(0), 8);
  const auto faces = flatFaces(*field);
  Progress progress;
  MorseAnalysisOptions options;
  options.refine = true;
  options.epsilon = 0.05;
  const MorseAnalysis found = analyzeMorse(faces, *field, options, progress);
  EXPECT_EQ(found.model->epsilon(), 0.05);
  EXPECT_EQ(withSetRefined(faces, found, 0, progress).model->epsilon(), 0.05);
  const MorseAnalysis same = withinEpsilon(found, 0.05, {}, progress);
  const MorseAnalysis more = withinEpsilon(found, 100.0, {}, progress);
  EXPECT_EQ(same.decomposition.withinFaces->facesMet, found.decomposition.withinFaces->facesMet);
  EXPECT_EQ(more.decomposition.sets.size(), 1U);
  EXPECT_THROW(withinEpsilon(found, -1.0, {}, progress), InputError);
  options.epsilon = -1.0;
  EXPECT_THROW(analyzeMorse(faces, *field, options, progress), InputError);
  options.epsilon = 0.05;
  options.weights = {1.0, 2.0};
  EXPECT_THROW(analyzeMorse(faces, *field, options, progress), InputError);
}

TEST(TransitRefinementOfAllFields, PersistenceIsWhereSetsMerge) {
  const FieldPointer field = random(icosphere(0), 5);
  Progress progress;
  TransitRefinement refinement(flatFaces(*field), field, {.maxLevel = 3});
  refinement.refine();
  const MorseDecomposition found = decomposed(refinement);
  const NodeSets& nodes = found.withinFaces->nodes;
  const std::vector<double> persistence = transitPersistence(refinement, nodes, progress);
  ASSERT_GT(persistence.size(), 1U);
  const auto isMerged = [&](Index set, double epsilon) {
    const TransitRefinement bounded = refinement.withinEpsilon(epsilon);
    for (const std::vector<Index>& merged : bounded.sets()) {
      const auto holds = [&](Index s) {
        return std::binary_search(merged.begin(), merged.end(), nodes.members(s).front());
      };
      if (!holds(set)) continue;
      for (Index other = 0; other < nodes.count(); ++other) {
        if (other != set && holds(other)) return true;
      }
    }
    return false;
  };
  for (Index set = 0; set < nodes.count(); ++set) {
    ASSERT_TRUE(std::isfinite(persistence[set]));  // the surface is connected
    EXPECT_TRUE(isMerged(set, persistence[set]));
    constexpr double kFirstStep = 1e-5;  // smaller steps are not searched
    EXPECT_TRUE(persistence[set] < kFirstStep || !isMerged(set, persistence[set] / kPersistenceStep));
  }
  progress.cancel();
  EXPECT_THROW(transitPersistence(refinement, nodes, progress), Cancelled);
}

}  // namespace
}  // namespace stormfield::test
