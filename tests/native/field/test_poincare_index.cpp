#include "field/poincare_index.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "checks.h"
#include "field/interpolation.h"
#include "fixtures.h"

namespace stormfield::test {
namespace {

TEST(PoincareIndex, SumsToTheEulerCharacteristic) {
  for (const NamedSurface& s : closedSurfaces()) {
    const auto charts = makeCharts(s.surface);
    EXPECT_EQ(sum(poincareIndices(zeroField(charts))), s.euler) << s.name;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      EXPECT_EQ(sum(poincareIndices(randomField(charts, seed))), s.euler) << s.name << ", seed " << seed;
      EXPECT_EQ(sum(poincareIndices(randomIntegerField(charts, seed))), s.euler) << s.name << ", seed " << seed;
    }
  }
}

TEST(PoincareIndex, SumsPerComponent) {
  const auto charts = makeCharts(joined(plateWithHoles(2), icosphere(2), {0, 0, 9}));
  const std::vector<int> indices = poincareIndices(randomIntegerField(charts, 3));
  int sums[2] = {0, 0};
  for (Index f = 0; f < charts->mesh().faceCount(); ++f)
    sums[charts->mesh().component(charts->mesh().vertex(f, 0))] += indices[f];
  EXPECT_EQ(sums[0], -2);
  EXPECT_EQ(sums[1], 2);
}

/// The winding number seen by evaluating the field densely along the face's boundary, a hair inside.
int sampledWinding(const FaceInterpolant& local) {
  double turn = 0.0;
  Complex last;
  const int steps = 20000;
  for (int i = 0; i <= 3 * steps; ++i) {
    const int k = i / steps % 3;
    const double t = static_cast<double>(i % steps) / steps;
    Eigen::Vector3d b = Eigen::Vector3d::Constant(1e-7);
    b[k] += (1.0 - 3e-7) * (1.0 - t);
    b[(k + 1) % 3] += (1.0 - 3e-7) * t;
    const Complex value = local.evaluate(local.point(b));
    if (i > 0) turn += std::arg(value * std::conj(last));
    last = value;
  }
  return static_cast<int>(std::lround(turn / (2.0 * kPi)));
}

TEST(PoincareIndex, IsTheWindingOfTheInterpolatedField) {
  for (const Surface& s : {tetrahedron(), bumpySphere(1, 0.4), torus(7, 5)}) {
    const VectorField field = randomField(makeCharts(s), 12);
    const std::vector<int> indices = poincareIndices(field);
    for (Index f = 0; f < field.mesh().faceCount(); ++f)
      EXPECT_EQ(indices[f], sampledWinding(faceInterpolant(field, f)));
  }
}

TEST(PoincareIndex, DoesNotChangeWhenTheFieldIsReversedOrScaled) {
  const VectorField field = randomField(makeCharts(bumpySphere(2)), 2);
  const std::vector<int> indices = poincareIndices(field);
  for (const Complex factor : {Complex(-1.0), Complex(1e-200), Complex(1e200), Complex(3.0, 4.0)}) {
    VectorField changed = field;
    for (Complex& value : changed.values) value *= factor;
    EXPECT_EQ(poincareIndices(changed), indices) << factor;
  }
}

TEST(PoincareIndex, DoesNotDependOnTheSignOfZero) {
  const auto charts = makeCharts(icosphere(1));
  VectorField field = zeroField(charts);
  const std::vector<int> indices = poincareIndices(field);
  for (Complex& value : field.values) value = {-0.0, -0.0};
  EXPECT_EQ(poincareIndices(field), indices);
}

TEST(PoincareIndex, DoesNotDependOnLabelsOrThreads) {
  const Surface s = bumpySphere(2, 0.3);
  const VectorField field = randomIntegerField(makeCharts(s), 6);
  std::vector<Index> order(s.points.rows());
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = static_cast<Index>((v * 37 + 5) % order.size());
  Surface relabelled = s;
  std::vector<Complex> values(order.size());
  for (std::size_t v = 0; v < order.size(); ++v) {
    relabelled.points.row(order[v]) = s.points.row(v);
    values[order[v]] = field.values[v];
  }
  for (Eigen::Index i = 0; i < s.triangles.size(); ++i) relabelled.triangles.data()[i] = order[s.triangles.data()[i]];
  const std::vector<int> indices = poincareIndices(field);
  EXPECT_EQ(poincareIndices(makeVectorField(makeCharts(relabelled), values)), indices);

  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(edgeRotations(*field.charts, field.values.data()), edgeRotations(*makeCharts(s), field.values.data()));
  EXPECT_EQ(poincareIndices(field), indices);
}

TEST(EdgeTurns, StayWithinHalfATurn) {
  const auto charts = makeCharts(grid(4));
  VectorField field = zeroField(charts);
  for (std::size_t v = 0; v < field.values.size(); ++v) field.values[v] = v % 2 ? 1.0 : -1.0;
  for (const double turn : edgeRotations(*charts, field.values.data())) {
    EXPECT_GT(turn, -kPi);
    EXPECT_LE(turn, kPi);
  }
}

}  // namespace
}  // namespace stormfield::test
