// A topology that was updated after a change equals the one that is found anew.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "data_sets.h"
#include "long_tests.h"
#include "topology/flows.h"

namespace stormfield::test {
namespace {

/// Turned and scaled within some edge lengths of a random vertex, or, where it is 0, not at all.
VectorField changedSomewhere(const VectorField& field, Random& random) {
  const TriangleMesh& mesh = field.mesh();
  const auto middle = static_cast<Index>(std::abs(random.uniform()) * (mesh.vertexCount() - 1));
  const double radius = (3.0 + 9.0 * std::abs(random.uniform())) * mesh.meanEdgeLength();
  const double angle = 2.0 * random.uniform(), growth = 0.5 * random.uniform();
  VectorField changed = field;
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    const double distance = (mesh.point(v) - mesh.point(middle)).norm() / radius;
    if (distance >= 1.0) continue;
    const double part = (1.0 - distance * distance) * (1.0 - distance * distance);
    changed.values[v] *= std::polar(1.0 + part * growth, part * angle);
  }
  return changed;
}

void expectSame(const Topology& updated, const Topology& whole) {
  ASSERT_EQ(updated.fixedPoints.size(), whole.fixedPoints.size());
  for (std::size_t i = 0; i < whole.fixedPoints.size(); ++i) {
    EXPECT_EQ(updated.fixedPoints[i].position, whole.fixedPoints[i].position);
    EXPECT_EQ(updated.fixedPoints[i].kind, whole.fixedPoints[i].kind);
  }
  ASSERT_EQ(updated.periodicOrbits.size(), whole.periodicOrbits.size());
  for (std::size_t i = 0; i < whole.periodicOrbits.size(); ++i) {
    EXPECT_EQ(updated.periodicOrbits[i].kind, whole.periodicOrbits[i].kind);
    EXPECT_NEAR(updated.periodicOrbits[i].length, whole.periodicOrbits[i].length,
                1e-6 * whole.periodicOrbits[i].length);
  }
  ASSERT_EQ(updated.separatrices.size(), whole.separatrices.size());
  for (std::size_t i = 0; i < whole.separatrices.size(); ++i) {
    EXPECT_EQ(updated.separatrices[i].saddle, whole.separatrices[i].saddle);
    EXPECT_EQ(updated.separatrices[i].outgoing, whole.separatrices[i].outgoing);
    EXPECT_EQ(updated.separatrices[i].end, whole.separatrices[i].end);
  }
  ASSERT_EQ(updated.links.size(), whole.links.size());
  for (std::size_t i = 0; i < whole.links.size(); ++i) {
    EXPECT_EQ(updated.links[i].source, whole.links[i].source);
    EXPECT_EQ(updated.links[i].target, whole.links[i].target);
    EXPECT_EQ(updated.links[i].separatrices, whole.links[i].separatrices);
  }
}

/// Each change is one of the field before, whose topology was updated itself.
void expectSameAfterChanges(VectorField field, int changes, std::uint64_t seed) {
  const FlatFaces faces(field.charts);
  Topology known = findTopology(faces, field);
  Random random(seed);
  for (int i = 0; i < changes; ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", change " + std::to_string(i));
    VectorField changed = changedSomewhere(field, random);
    Topology updated = updatedTopology(faces, changed, field, known);
    expectSame(updated, findTopology(faces, changed));
    known = std::move(updated);
    field = std::move(changed);
  }
}

TEST(UpdatedTopology, EqualsTheWholeAfterRandomChanges) {
  for (std::uint64_t seed = 1; seed <= shortOrLong<std::uint64_t>(3, 40); ++seed) {
    expectSameAfterChanges(smoothField(icosphere(4), seed), 6, seed);
    expectSameAfterChanges(smoothField(torus(48, 24), seed), 6, seed);
    expectSameAfterChanges(smoothField(scaled(plateWithHoles(2, 6), 0.08), seed), 6, seed);
  }
}

TEST(UpdatedTopology, EqualsTheWholeOnGasEngine) {
  const auto engine = dataSet("gasEngineV.t");
  if (!engine) GTEST_SKIP() << withoutDataSet("gasEngineV.t");
  expectSameAfterChanges(fieldOn(*engine), shortOrLong(3, 40), 1);
}

/// Orbits that vanish, appear and move under a change that crosses them.
TEST(UpdatedTopology, EqualsTheWholeWithOrbits) {
  const VectorField field = sampledOn(scaled(grid(48, 0.2), 12.0), equation31);
  expectSameAfterChanges(field, shortOrLong(6, 40), 7);
}

TEST(UpdatedTopology, NothingChanged) {
  const VectorField field = smoothField(torus(48, 24), 1);
  const FlatFaces faces(field.charts);
  const Topology whole = findTopology(faces, field);
  expectSame(updatedTopology(faces, field, field, whole), whole);
}

TEST(UpdatedTopology, RefusesValuesThatAreNotFinite) {
  const VectorField field = smoothField(icosphere(2), 1);
  const FlatFaces faces(field.charts);
  const Topology whole = findTopology(faces, field);
  VectorField changed = field;
  changed.values[3] = Complex(std::nan(""), 0.0);
  EXPECT_THROW(updatedTopology(faces, changed, field, whole), InputError);
}

}  // namespace
}  // namespace stormfield::test
