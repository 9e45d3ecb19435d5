#include "long_tests.h"
#include "solver/solver_checks.h"
#include "solver/storm_constraints.h"

namespace stormfield {
namespace {

using namespace solving;

TEST(SpaceTimeSolver, ConvergesWithResolution) {
  // One design in space at 1, 4, 16 times the faces and 50, 100, 200 samples: vectors in space at shared vertices and
  // shared lambdas come closer to each other, by about the edge length that the rims of the discs are resolved with.
  std::vector<ParameterizedField> fields;
  Index samples = test::shortOrLong(26, 51);
  const Index coarsest = test::shortOrLong(6, 10);
  for (const Index n : {coarsest, 2 * coarsest, 4 * coarsest}) {
    const ChartsPointer sphere = test::makeCharts(test::dividedIcosahedron(n));
    SpaceTimeOptions options;
    options.samples = samples;
    Progress progress;
    fields.push_back(
        SpaceTimeSolver(sphere, options).solve(storms::storms(*sphere, {.samples = samples}), progress).field);
    samples = 2 * samples - 1;
  }
  auto valueAt = [](const ParameterizedField& field, Index j, const Vec3& where) {
    const TriangleMesh& mesh = field.charts->mesh();
    Index nearest = 0;
    (mesh.points().rowwise() - where.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    EXPECT_LT((mesh.point(nearest) - where).norm(), 1e-9);
    return field.charts->toSpace(nearest, field.sample(j)[nearest]);
  };
  const TriangleMesh& coarse = fields[0].charts->mesh();
  std::array<double, 2> differences = {0.0, 0.0};
  double length = 0.0;
  for (Index v = 0; v < coarse.vertexCount(); v += 3) {
    const Index last = fields[0].sampleCount() - 1;
    for (const Index j : {0, 2 * last / 5, last}) {
      const Vec3 a = valueAt(fields[0], j, coarse.point(v)), b = valueAt(fields[1], 2 * j, coarse.point(v)),
                 c = valueAt(fields[2], 4 * j, coarse.point(v));
      differences[0] += (a - b).squaredNorm();
      differences[1] += (b - c).squaredNorm();
      length += c.squaredNorm();
    }
  }
  const double first = std::sqrt(differences[0] / length), second = std::sqrt(differences[1] / length);
  RecordProperty("first", std::to_string(first));
  RecordProperty("second", std::to_string(second));
  EXPECT_LT(second, 0.75 * first);
  EXPECT_LT(first, 0.1);
}

}  // namespace
}  // namespace stormfield
