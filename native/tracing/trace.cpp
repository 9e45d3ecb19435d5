#include "tracing/trace.h"

#include <cmath>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

void checkOptions(const TraceOptions& options) {
  const auto require = [](bool ok, const char* text) {
    if (!ok) throw InputError(text);
  };
  require(options.maxTime >= 0.0, "the time limit of a trace must be 0 s or more");
  require(options.maxLength >= 0.0, "the length limit of a trace must be 0 or more");
  require(options.tolerance > 0.0 && std::isfinite(options.tolerance),
          "the tolerance of a trace must be a positive fraction of the mean edge length, for example 1e-6");
  require(options.minSpeed >= 0.0, "the least speed of a trace must be 0 or more");
  require(options.maxSteps > 0, "a trace needs at least one step");
}

void checkSeeds(const TriangleMesh& mesh, const std::vector<SurfacePoint>& seeds) {
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const SurfacePoint& p = seeds[i];
    if (p.face < 0 || p.face >= mesh.faceCount()) {
      throw InputError(
          message("seed ", i, " is on face ", p.face, ", but the mesh has the faces 0 to ", mesh.faceCount() - 1));
    }
    const bool inside = p.barycentric.minCoeff() >= -1e-9 && std::abs(p.barycentric.sum() - 1.0) <= 1e-6;
    if (!inside) {
      throw InputError(message("seed ", i, " is outside face ", p.face,
                               "; barycentric coordinates must be 0 or more and add up to 1"));
    }
  }
}

}  // namespace stormfield
