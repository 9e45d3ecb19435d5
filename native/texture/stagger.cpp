#include "texture/stagger.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "texture/detail/random.h"

namespace stormfield {
namespace {

/// Random values on the integer lattice, joined by a polynomial with two continuous derivatives; in [0, 1).
double latticeNoise(const Vec3& p, std::uint64_t seed) {
  const Vec3 cell(std::floor(p.x()), std::floor(p.y()), std::floor(p.z()));
  const Vec3 s = p - cell;
  const Vec3 ease = (s.array().cube() * (s.array() * (s.array() * 6.0 - 15.0) + 10.0)).matrix();
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::int64_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (corner >> axis & 1) != 0;
      weight *= upper ? ease[axis] : 1.0 - ease[axis];
      at[axis] = static_cast<std::int64_t>(cell[axis]) + (upper ? 1 : 0);
    }
    sum += weight * uniform(seed, at[0], at[1], at[2]);
  }
  return sum;
}

}  // namespace

StaggerStep largestStaggerStep(const TriangleMesh& mesh, const std::vector<double>& offsets) {
  StaggerStep worst;
  for (Index e = 0; e < mesh.edgeCount(); ++e) {
    const Index h = mesh.edgeHalfedge(e);
    const double difference = std::abs(offsets[mesh.head(h)] - offsets[mesh.tail(h)]);
    if (difference >= worst.difference) worst = {difference, e};
  }
  return worst;
}

std::vector<double> stagger(const TriangleMesh& mesh, const StaggerOptions& options, double largestStep) {
  std::vector<double> offsets(mesh.vertexCount());
  const double perUnit = options.frequency / mesh.size();
  // Relative to the object, so that moving or scaling its vertices together changes nothing.
  const Vec3 origin = mesh.points().colwise().minCoeff();
  tbb::parallel_for(Index{0}, mesh.vertexCount(), [&](Index v) {
    offsets[v] = options.cycles * latticeNoise((mesh.point(v) - origin) * perUnit, options.seed);
  });
  const double steepest = largestStaggerStep(mesh, offsets).difference;
  if (steepest > largestStep) {
    for (double& offset : offsets) offset *= 0.999 * largestStep / steepest;
  }
  return offsets;
}

}  // namespace stormfield
