#include "mesh/morton_order.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace stormfield {
namespace {

/// Bits of x spread to every third place.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

}  // namespace

std::vector<Index> mortonOrder(const TriangleMesh& mesh) {
  const Eigen::RowVector3d low = mesh.points().colwise().minCoeff();
  const double extent = (mesh.points().colwise().maxCoeff() - low).maxCoeff();
  const double scale = extent > 0.0 ? 2097151.0 / extent : 0.0;
  std::vector<std::pair<std::uint64_t, Index>> codes;
  codes.reserve(mesh.vertexCount());
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    if (mesh.outgoing(v) == kNone) continue;
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
      code |= spread(static_cast<std::uint64_t>((mesh.points()(v, k) - low[k]) * scale)) << k;
    }
    codes.emplace_back(code, v);
  }
  std::sort(codes.begin(), codes.end());
  std::vector<Index> order;
  order.reserve(codes.size());
  for (const auto& [code, v] : codes) order.push_back(v);
  return order;
}

}  // namespace stormfield
