#include "tracing/streamline.h"

#include "base/error.h"
#include "tracing/batch.h"
#include "tracing/integrator.h"

namespace stormfield {
namespace {

using Steady = Integrator<SteadyFlow>;

struct Skip {
  void operator()(const SurfacePoint&, double) const {}
};

double fastest(const VectorField& field) {
  double squared = 0.0;
  for (const Complex& v : field.values) squared = std::max(squared, std::norm(v));
  return std::sqrt(squared);
}

Steady makeIntegrator(const FlatFaces& faces, const VectorField& field, const TraceOptions& options) {
  if (field.values.size() != static_cast<std::size_t>(faces.mesh().vertexCount())) {
    throw InputError("the field to trace belongs to another mesh");
  }
  checkOptions(options);
  const double rate = options.direction == Direction::Backward ? -1.0 : 1.0;
  return Steady(faces, SteadyFlow(field.values.data(), rate), options, options.minimalSpeed * fastest(field));
}

}  // namespace

Traces traceStreamlines(const FlatFaces& faces, const VectorField& field, const std::vector<SurfacePoint>& seeds,
                        const TraceOptions& options, Progress* progress) {
  const Steady prototype = makeIntegrator(faces, field, options);
  checkSeeds(faces.mesh(), seeds);
  return recordEach(
      seeds.size(), [&] { return prototype; },
      [&](std::size_t i, Steady& integrator, const auto& visit) {
        return integrator.run(seeds[i], 0.0, options.maximalTime, visit);
      },
      progress);
}

std::vector<TraceEnd> traceStreamlineEnds(const FlatFaces& faces, const VectorField& field,
                                          const std::vector<SurfacePoint>& seeds, const TraceOptions& options,
                                          Progress* progress) {
  const Steady prototype = makeIntegrator(faces, field, options);
  checkSeeds(faces.mesh(), seeds);
  return traceEach(
      seeds.size(), [&] { return prototype; },
      [&](std::size_t i, Steady& integrator) { return integrator.run(seeds[i], 0.0, options.maximalTime, Skip()); },
      progress);
}

TraceEnd traceStreamline(const FlatFaces& faces, const VectorField& field, const SurfacePoint& seed,
                         const TraceOptions& options) {
  return traceStreamlineEnds(faces, field, {seed}, options).front();
}

}  // namespace stormfield
