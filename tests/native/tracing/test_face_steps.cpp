#include "tracing/detail/face_steps.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "fixtures.h"

namespace stormfield {
namespace {

/// Where a step from a point inside a face goes; duration 0 where it is not plain.
struct Gone {
  FaceStep step;
  bool plain = false;
};

bool same(const Gone& a, const Gone& b) {
  if (a.plain != b.plain || !a.plain) return a.plain == b.plain;
  const bool place =
      a.step.exit.side < 0 ? a.step.barycentric == b.step.barycentric : a.step.exit.fraction == b.step.exit.fraction;
  return place && a.step.exit.side == b.step.exit.side && a.step.duration == b.step.duration &&
         a.step.length == b.step.length;
}

TEST(FaceSteps, ManyParticlesGoWhereEachGoesAlone) {
  // Of faces all alike in size and curvature, the correction is near the tolerance: it is left out in some.
  const auto charts = test::makeCharts(test::dividedIcosahedron(12));
  const VectorField field = sampled(charts, analytic::swirl());
  const TriangleMesh& mesh = charts->mesh();
  const FlatFaces faces(charts);
  std::vector<double> bends;
  std::vector<FaceFlow> flows;
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const auto value = [&](int corner) { return field.values[mesh.vertex(f, corner)]; };
    flows.emplace_back(faces[f], std::array<Complex, 3>{value(0), value(1), value(2)});
    bends.push_back(static_cast<double>(flows.back().bend) * flows.back().base);
  }
  std::nth_element(bends.begin(), bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2), bends.end());
  const StepLimits limits{10.0 * bends[bends.size() / 2], 1e-1, 0.0};

  const auto seeds = test::randomSeeds(mesh, 1000, 3);
  std::vector<Gone> alone(seeds.size()), together(seeds.size());
  std::size_t flat = 0;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const FaceFlow& flow = flows[seeds[i].face];
    flat += isFlatEnough(flow, limits);
    alone[i].plain = stepThroughFace(flow, {}, seeds[i].barycentric, limits, alone[i].step);
  }
  EXPECT_GT(flat, seeds.size() / 4);
  EXPECT_LT(flat, seeds.size() * 3 / 4);

  FaceSteps steps(limits);
  std::array<std::size_t, FaceSteps::kCount> particle{};
  std::size_t next = 0, ended = 0;
  const auto set = [&](int i) {
    if (next == seeds.size()) return;
    const SurfacePoint& seed = seeds[particle[i] = next++];
    steps.set(i, flows[seed.face], {}, seed.barycentric, limits.maxDuration);
  };
  for (int i = 0; i < FaceSteps::kCount; ++i) set(i);
  while (true) {
    const auto advanced = steps.advance();
    if (advanced.empty()) break;
    for (const int i : advanced) {
      Gone& gone = together[particle[i]];
      const FaceSteps::Outcome outcome = steps.take(i, gone.step);
      if (outcome == FaceSteps::Outcome::Again) continue;
      gone.plain = outcome == FaceSteps::Outcome::Done;
      ++ended;
      set(i);
    }
  }
  EXPECT_EQ(ended, seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) EXPECT_TRUE(same(alone[i], together[i])) << "particle " << i;
}

TEST(FaceSteps, NothingSetIsNothingToAdvance) {
  FaceSteps steps({1e-6, 1e-4, 0.0});
  EXPECT_TRUE(steps.advance().empty());
}

}  // namespace
}  // namespace stormfield
