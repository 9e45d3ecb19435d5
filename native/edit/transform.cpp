#include "edit/transform.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "base/error.h"
#include "base/message.h"
#include "edit/detail/local_laplacian.h"

namespace stormfield {
namespace {

/// How far the length of an axis may lie above 1 by rounding.
constexpr double kRounding = 1e-9;

void checkKeys(const std::vector<TransformKey>& keys) {
  if (keys.empty()) throw InputError("a transform needs a key; say its angle, scale or stretch");
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const TransformKey& key = keys[i];
    if (!std::isfinite(key.lambda) || !std::isfinite(key.angle)) {
      throw InputError(message("key ", i, " of the transform is not finite; give finite numbers"));
    }
    if (!(key.scale > 0.0 && key.stretch > 0.0 && std::isfinite(key.scale) && std::isfinite(key.stretch))) {
      throw InputError(message("key ", i, " of the transform scales by ", key.scale, " and stretches by ", key.stretch,
                               "; give factors above 0"));
    }
    if (i > 0 && !(keys[i - 1].lambda < key.lambda)) {
      throw InputError(message("key ", i, " of the transform is at lambda ", key.lambda, ", not after the one before"));
    }
  }
}

void checkSizes(const ParameterizedField& field, const TransformOptions& options) {
  const auto vertices = static_cast<std::size_t>(field.vertexCount());
  if (!options.weights.empty() && options.weights.size() != vertices) {
    throw InputError(message("there are ", options.weights.size(), " weights for ", vertices, " vertices"));
  }
  for (const double weight : options.weights) {
    if (!(weight >= 0.0 && weight <= 1.0)) throw InputError(message("a weight is ", weight, "; give 0 to 1"));
  }
  if (options.axes.size() != 0 && options.axes.size() != field.values.size()) {
    throw InputError(message("there are ", options.axes.size(), " axes for ", field.values.size(), " vectors"));
  }
  for (const Complex axis : options.axes) {
    if (!(std::abs(axis) <= 1.0 + kRounding)) {
      throw InputError(message("an axis has the length ", std::abs(axis), "; give 1 at most"));
    }
  }
  const bool stretches =
      std::any_of(options.keys.begin(), options.keys.end(), [](const TransformKey& key) { return key.stretch != 1.0; });
  if (stretches && options.axes.size() == 0) throw InputError("a stretch needs an axis; say along what");
}

double geometric(double a, double b, double t) {
  return t == 0.0 ? a : t == 1.0 ? b : a * std::pow(b / a, t);
}

TransformKey keyAt(const std::vector<TransformKey>& keys, double lambda) {
  const auto next = std::find_if(keys.begin(), keys.end(), [&](const TransformKey& k) { return k.lambda > lambda; });
  if (next == keys.begin()) return keys.front();
  const TransformKey& a = *std::prev(next);
  if (next == keys.end()) return a;
  const double t = (lambda - a.lambda) / (next->lambda - a.lambda);
  return {lambda, a.angle + t * (next->angle - a.angle), geometric(a.scale, next->scale, t),
          geometric(a.stretch, next->stretch, t)};
}

Complex transformed(Complex value, const TransformKey& key, double weight, Complex axis) {
  if (key.stretch != 1.0) {
    value += (std::pow(key.stretch, weight) - 1.0) * (std::conj(axis) * value).real() * axis;
  }
  return std::polar(std::pow(key.scale, weight), weight * key.angle) * value;
}

}  // namespace

ParameterizedField transformField(const ParameterizedField& field, const TransformOptions& options) {
  checkKeys(options.keys);
  checkSizes(field, options);
  ParameterizedField result = field;
  const double first = options.keys.front().lambda;
  const bool frozen = options.source == TransformOf::FieldAtFirstKey;
  const VectorField start = frozen ? at(field, first) : VectorField{};
  const auto vertices = static_cast<std::size_t>(field.vertexCount());
  tbb::parallel_for(Index{0}, field.sampleCount(), [&](Index j) {
    if (field.lambdas[j] < first) return;
    const TransformKey key = keyAt(options.keys, field.lambdas[j]);
    for (std::size_t v = 0; v < vertices; ++v) {
      const double weight = options.weights.empty() ? 1.0 : options.weights[v];
      if (weight == 0.0) continue;
      Complex& value = result.values[j * vertices + v];
      // What is frozen goes over into what is around it, as the transform does.
      if (frozen) value = weight == 1.0 ? start.values[v] : value + weight * (start.values[v] - value);
      const Complex axis = options.axes.size() == 0 ? Complex() : options.axes[j * vertices + v];
      value = transformed(value, key, weight, axis);
    }
  });
  return result;
}

std::vector<double> falloffWeights(const TriangleMesh& mesh, const std::vector<Index>& faces, double falloff) {
  if (!(falloff >= 0.0)) throw InputError(message("the falloff is ", falloff, "; give a length from 0 on"));
  std::vector<double> distance(mesh.vertexCount(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
  for (const Index f : faces) {
    if (f < 0 || f >= mesh.faceCount()) {
      throw InputError(message("there is no face ", f, "; the mesh has ", mesh.faceCount()));
    }
    for (int k = 0; k < 3; ++k) {
      const Index v = mesh.vertex(f, k);
      if (distance[v] == 0.0) continue;
      distance[v] = 0.0;
      next.emplace(0.0, v);
    }
  }
  while (!next.empty()) {
    const auto [away, v] = next.top();
    next.pop();
    if (away > distance[v]) continue;
    forEachNeighbour(mesh, v, [&, away = away, v = v](Index neighbour, Index, bool) {
      const double further = away + (mesh.point(neighbour) - mesh.point(v)).norm();
      if (further >= falloff || further >= distance[neighbour]) return;
      distance[neighbour] = further;
      next.emplace(further, neighbour);
    });
  }
  std::vector<double> weights(mesh.vertexCount(), 0.0);
  for (std::size_t v = 0; v < weights.size(); ++v) {
    if (distance[v] == 0.0) {
      weights[v] = 1.0;
    } else if (distance[v] < falloff) {
      const double c = std::cos(0.5 * std::numbers::pi * distance[v] / falloff);
      weights[v] = c * c;
    }
  }
  return weights;
}

}  // namespace stormfield
