#include "maps/detail/unit_speed_flow.h"

namespace stormfield {
namespace {

/// The slow speed, as a fraction of the mean speed around the vertex. Chosen small, so that nearly all of the surface
/// is crossed at unit speed, and large enough for the integrator to take its usual steps towards a fixed point.
constexpr double kSlow = 0.02;

}  // namespace

std::vector<double> slowSpeeds(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  std::vector<double> sum(field.values.size(), 0.0), weight(field.values.size(), 0.0);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    double mean = 0.0;
    for (int i = 0; i < 3; ++i) mean += std::abs(field.values[mesh.vertex(f, i)]) / 3.0;
    for (int i = 0; i < 3; ++i) {
      sum[mesh.vertex(f, i)] += mesh.faceArea(f) * mean;
      weight[mesh.vertex(f, i)] += mesh.faceArea(f);
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = weight[v] > 0.0 ? kSlow * sum[v] / weight[v] : 0.0;
  return sum;
}

}  // namespace stormfield
