#include "maps/error_bound.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "field/interpolation.h"
#include "maps/detail/error_checks.h"
#include "maps/fixed_point_faces.h"
#include "maps/geometry_map.h"

namespace stormfield {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
/// The least epsilon that is not 0.
constexpr double kSmallestEpsilon = std::numeric_limits<double>::denorm_min();
/// Bound on the round-off of components and lengths, as a fraction of their vector: ten times that of a rotation into
/// the frame of an edge (geometry_map.cpp). Bounds on epsilon are lowered by it.
constexpr double kRoundOff = 1e-13;

/// The least epsilon at which a vector can have a component > 0 in a direction where it has `component`.
double epsilonToTurn(double component, double length, double weight) {
  if (component > 0.0) return 0.0;
  if (!(weight > 0.0)) return kNever;
  return std::max((-component - kRoundOff * length) / weight, kSmallestEpsilon);
}

/// The least epsilon at which flow can leave a face over its halfedge h.
double crossingEpsilon(const VectorField& field, const std::vector<double>& weights, Index h) {
  const TriangleMesh& mesh = field.mesh();
  const EndVectors ends = endVectors(field, h);
  const auto [tail, head] = ends;
  const bool runsAlong = tail.imag() == 0.0 && head.imag() == 0.0;
  if (holdsFixedPointOnEdge(ends) || (runsAlong && mesh.twin(h) != kNone)) return 0.0;
  return std::min(epsilonToTurn(-tail.imag(), std::abs(tail), weights[mesh.tail(h)]),
                  epsilonToTurn(-head.imag(), std::abs(head), weights[mesh.head(h)]));
}

double distanceFromOrigin(Complex a, Complex b) {
  const Complex side = b - a;
  const double square = std::norm(side);
  const double t = square > 0.0 ? std::clamp(-(a * std::conj(side)).real() / square, 0.0, 1.0) : 0.0;
  return std::abs(a + t * side);
}

/// Distance of the origin from a triangle.
double distanceFromOrigin(const std::array<Complex, 3>& corners) {
  const auto areaWithOrigin = [&](int i) { return (std::conj(corners[i]) * corners[(i + 1) % 3]).imag(); };
  const std::array<double, 3> areas{areaWithOrigin(0), areaWithOrigin(1), areaWithOrigin(2)};
  const bool inside = std::all_of(areas.begin(), areas.end(), [](double area) { return area > 0.0; }) ||
                      std::all_of(areas.begin(), areas.end(), [](double area) { return area < 0.0; });
  if (inside) return 0.0;
  double least = kNever;
  for (int i = 0; i < 3; ++i) least = std::min(least, distanceFromOrigin(corners[i], corners[(i + 1) % 3]));
  return least;
}

/// A lower bound of |V| on a face. Twist rotates a carried vector by up to |twist| times half the corner's angle.
double leastSpeed(const VectorField& field, Index f) {
  const FaceInterpolant local = faceInterpolant(field, f);
  double longest = 0.0, largestChange = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double half = 0.5 * field.mesh().cornerAngle(TriangleMesh::halfedge(f, k));
    const double angle = std::min(std::abs(local.twist[k]) * half, 3.14);
    longest = std::max(longest, std::abs(local.carried[k]));
    largestChange = std::max(largestChange, 2.0 * std::abs(local.carried[k]) * std::sin(0.5 * angle));
  }
  return std::max(0.0, distanceFromOrigin(local.carried) - largestChange - kRoundOff * longest);
}

double fixedPointEpsilon(const VectorField& field, const std::vector<double>& weights, Index f) {
  double weight = 0.0;
  for (int k = 0; k < 3; ++k) weight = std::max(weight, weights[field.mesh().vertex(f, k)]);
  return weight > 0.0 ? std::max(leastSpeed(field, f) / weight, kSmallestEpsilon) : kNever;
}

/// The targets of a face, at most itself and three others, each with its least epsilon.
struct EpsilonRow {
  std::array<std::pair<Index, double>, 4> edges{};
  int count = 0;

  void add(Index target, double from) {
    for (int i = 0; i < count; ++i) {
      if (edges[i].first != target) continue;
      edges[i].second = std::min(edges[i].second, from);
      return;
    }
    edges[count++] = {target, from};
  }
};

}  // namespace

std::vector<double> checkedWeights(const VectorField& field, const std::vector<double>& weights) {
  checkWeights(field.mesh(), weights);
  return weights.empty() ? std::vector<double>(field.mesh().vertexCount(), 1.0) : weights;
}

std::vector<double> fixedPointEpsilons(const VectorField& field, const std::vector<double>& givenWeights) {
  const std::vector<double> weights = checkedWeights(field, givenWeights);
  const std::vector<char> holds = fixedPointFaces(field);
  std::vector<double> result(holds.size());
  tbb::parallel_for(Index{0}, field.mesh().faceCount(),
                    [&](Index f) { result[f] = holds[f] != 0 ? 0.0 : fixedPointEpsilon(field, weights, f); });
  return result;
}

ErrorBoundedMap errorBoundedMap(const VectorField& field, const std::vector<double>& weights) {
  Progress progress;
  return errorBoundedMap(field, weights, progress);
}

ErrorBoundedMap errorBoundedMap(const VectorField& field, const std::vector<double>& givenWeights, Progress& progress) {
  const TriangleMesh& mesh = field.mesh();
  const std::vector<double> weights = checkedWeights(field, givenWeights);
  ErrorBoundedMap result;
  result.faceEpsilon = fixedPointEpsilons(field, weights);
  std::vector<EpsilonRow> rows(mesh.faceCount());
  progress.check();
  tbb::parallel_for(Index{0}, mesh.faceCount(), [&](Index f) {
    if (progress.cancelled()) return;
    rows[f].add(f, result.faceEpsilon[f]);
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index twin = mesh.twin(h);
      rows[f].add(twin == kNone ? mesh.faceCount() : TriangleMesh::face(twin), crossingEpsilon(field, weights, h));
    }
    std::sort(rows[f].edges.begin(), rows[f].edges.begin() + rows[f].count);
  });
  progress.check();
  DirectedGraph& graph = result.map.graph;
  for (const EpsilonRow& row : rows) {
    for (int i = 0; i < row.count; ++i) {
      graph.targets.push_back(row.edges[i].first);
      result.edgeEpsilon.push_back(row.edges[i].second);
    }
    graph.offsets.push_back(graph.targets.size());
  }
  graph.offsets.push_back(graph.targets.size());  // outside leads nowhere
  return result;
}

CombinatorialMap mapWithinEpsilon(const ErrorBoundedMap& bounded, double epsilon) {
  const DirectedGraph& all = bounded.map.graph;
  CombinatorialMap result;
  result.graph.offsets.reserve(all.offsets.size());
  for (Index node = 0; node < all.nodeCount(); ++node) {
    for (std::size_t e = all.offsets[node]; e < all.offsets[node + 1]; ++e) {
      if (bounded.edgeEpsilon[e] <= epsilon) result.graph.targets.push_back(all.targets[e]);
    }
    result.graph.offsets.push_back(result.graph.targets.size());
  }
  return result;
}

std::vector<char> fixedPointFacesWithinEpsilon(const ErrorBoundedMap& bounded, double epsilon) {
  std::vector<char> result(bounded.faceEpsilon.size());
  std::transform(bounded.faceEpsilon.begin(), bounded.faceEpsilon.end(), result.begin(),
                 [=](double from) { return from <= epsilon ? 1 : 0; });
  return result;
}

double meanSpeed(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  double sum = 0.0;
  for (Index v = 0; v < mesh.vertexCount(); ++v) sum += mesh.vertexArea(v) * std::abs(field.values[v]);
  return sum / mesh.totalArea();
}

}  // namespace stormfield
