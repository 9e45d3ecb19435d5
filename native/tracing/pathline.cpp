#include "tracing/pathline.h"

#include <cmath>

#include "base/error.h"
#include "base/message.h"
#include "tracing/detail/batch.h"
#include "tracing/integrator.h"

namespace stormfield {
namespace {

using Unsteady = Integrator<UnsteadyFlow>;

Unsteady makeIntegrator(const UnsteadyField& flow, const TraceOptions& options) {
  checkOptions(options);
  return Unsteady(*flow.faces, UnsteadyFlow(*flow.field, flow.segments, options.direction, flow.speed), options, 0.0);
}

void check(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds) {
  std::vector<SurfacePoint> points(seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    points[i] = seeds[i].point;
    if (!std::isfinite(seeds[i].time) || !(seeds[i].maxTime >= 0.0)) {
      throw InputError(message("seed ", i, " needs a finite time and a duration of 0 s or more"));
    }
  }
  checkSeeds(flow.faces->mesh(), points);
}

template <typename Visit>
TraceEnd run(Unsteady& integrator, const PathlineSeed& seed, const TraceOptions& options, const Visit& visit) {
  return integrator.run(seed.point, seed.time, std::min(seed.maxTime, options.maxTime), visit);
}

}  // namespace

UnsteadyField::UnsteadyField(const FlatFaces& flatFaces, const ParameterizedField& parameterizedField,
                             const LambdaTrack& track, double speedFactor)
    : faces(&flatFaces),
      field(&parameterizedField),
      segments(timeSegments(parameterizedField.lambdas, track)),
      speed(speedFactor) {
  if (parameterizedField.vertexCount() != flatFaces.mesh().vertexCount()) {
    throw InputError("the field to trace belongs to another mesh");
  }
  if (!std::isfinite(speedFactor)) throw InputError("the speed factor must be finite");
}

Traces tracePathlines(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds, const TraceOptions& options,
                      Progress* progress) {
  const Unsteady prototype = makeIntegrator(flow, options);
  check(flow, seeds);
  return recordEach(
      seeds.size(), [&] { return prototype; },
      [&](std::size_t i, Unsteady& integrator, const auto& visit) { return run(integrator, seeds[i], options, visit); },
      progress);
}

std::vector<TraceEnd> tracePathlineEnds(const UnsteadyField& flow, const std::vector<PathlineSeed>& seeds,
                                        const TraceOptions& options, Progress* progress) {
  const Unsteady prototype = makeIntegrator(flow, options);
  check(flow, seeds);
  const auto skip = [](const SurfacePoint&, double) {};
  return traceEach(
      seeds.size(), [&] { return prototype; },
      [&](std::size_t i, Unsteady& integrator) { return run(integrator, seeds[i], options, skip); }, progress);
}

}  // namespace stormfield
