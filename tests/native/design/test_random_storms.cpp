#include <cstdlib>

#include "fixtures.h"
#include "long_tests.h"
#include "storm_checks.h"

namespace stormfield {
namespace {

using namespace storms;
using test::Random;

// Storms at random on random surfaces: whatever the mesh, the sampling, the kind and the angle at which they meet,
// there are two storms before lambda_c and one after it (the reverse for a split), each within an edge of its path.
// STORMFIELD_RANDOM_STORMS sets the number of designs for a longer run.

struct RandomDesign {
  ChartsPointer charts;
  std::vector<DesignElement> elements;
  Index samples = 0;
  bool merge = true;
  double lambdaC = 0.6;
};

/// An icosphere with vertices moved by up to a quarter of an edge, hills and hollows.
ChartsPointer roughSphere(Random& random) {
  const ChartsPointer round = test::makeCharts(test::dividedIcosahedron(10 + random.below(12)));
  Points points = round->mesh().points();
  const double jitter = random.uniform(0.0, 0.25) * round->mesh().meanEdgeLength();
  const double hills = random.uniform(0.0, 0.12);
  for (Index v = 0; v < points.rows(); ++v) {
    const Vec3 p = (Vec3(points.row(v)) + jitter * random.vector()).normalized();
    points.row(v) =
        p * (1.0 + hills * std::sin(4.0 * p.x() + 1.0) * std::cos(5.0 * p.y()) + 0.5 * hills * std::sin(6.0 * p.z()));
  }
  return test::makeCharts({points, round->mesh().triangles()});
}

RandomDesign randomDesign(Random& random) {
  constexpr std::array kKinds = {SingularKind::VortexCcw,   SingularKind::VortexCw, SingularKind::SpiralInCcw,
                                 SingularKind::SpiralOutCw, SingularKind::Source,   SingularKind::Sink};
  RandomDesign design;
  design.charts = roughSphere(random);
  design.samples = 20 + random.below(60);
  const Vec3 centre = random.vector().normalized();
  const Vec3 across = centre.cross(random.vector()).normalized(), along = centre.cross(across);
  const auto around = [&](double angle, double distance) -> Vec3 {
    return std::cos(distance) * centre + std::sin(distance) * (std::cos(angle) * across + std::sin(angle) * along);
  };
  const double first = random.uniform(0.0, 2.0 * test::kPi), second = first + random.uniform(1.2, 5.0);
  design.elements = merge(kKinds[static_cast<std::size_t>(random.below(kKinds.size()))],
                          around(first, random.uniform(0.5, 1.0)), around(second, random.uniform(0.4, 1.0)), centre,
                          around(random.uniform(0.0, 6.2), random.uniform(0.1, 0.5)), random.uniform(0.25, 0.5));
  design.merge = random.below(2) == 0;
  if (!design.merge) {
    design.elements = reversed(design.elements);
    design.lambdaC = 0.4;
  }
  return design;
}

TEST(Storms, AreTwoBeforeAndOneAfterInRandomDesigns) {
  const char* wanted = std::getenv("STORMFIELD_RANDOM_STORMS");
  const int count = wanted != nullptr ? std::atoi(wanted) : test::shortOrLong(2, 6);
  Random dice(20091);
  for (int i = 0; i < count; ++i) {
    const RandomDesign design = randomDesign(dice);
    SCOPED_TRACE(testing::Message() << "design " << i << ", " << design.charts->mesh().vertexCount() << " vertices, "
                                    << design.samples << " samples, " << name(design.elements.front().kind));
    const SpaceTimeResult result = solved(design.charts, design.elements, design.samples);
    for (Index j = 0; j < design.samples; ++j) checkSample(result, design.elements, j, design.lambdaC, design.merge);
  }
}

}  // namespace
}  // namespace stormfield
