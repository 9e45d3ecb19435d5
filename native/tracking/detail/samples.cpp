#include "tracking/detail/samples.h"

#include <algorithm>
#include <array>
#include <optional>

#include "topology/fixed_points.h"
#include "topology/zero_search.h"

namespace stormfield {
namespace {

constexpr int kMaxHalvings = 6;
/// Steps of lambda so short need no samples in between: at a vertex they are round-off of one event.
constexpr double kInstant = 1e-9;
/// Ends of an edge are opposed when their cross product is below this fraction of the product of their lengths.
constexpr double kOpposed = 1e-12;

/// The zero on the face's boundary, if there is one: the rotation along that edge is +pi or -pi by convention alone, so
/// that the face may hold the index although the field winds around it only up to round-off.
std::optional<Eigen::Vector3d> zeroOnBoundary(const FaceInterpolant& local) {
  for (int i = 0; i < 3; ++i) {
    if (local.carried[i] == 0.0) return Eigen::Vector3d::Unit(i);
  }
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3;
    const Complex along = local.corners[k] - local.corners[i];
    const Complex rotation = local.towards(k, -along) * std::conj(local.towards(i, along));
    if (rotation.real() >= 0.0 || std::abs(rotation.imag()) > -kOpposed * rotation.real()) continue;
    const double tail = std::abs(local.carried[i]), head = std::abs(local.carried[k]);
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    point[i] = head / (tail + head);
    point[k] = tail / (tail + head);
    return point;
  }
  return std::nullopt;
}

}  // namespace

PathSampler::PathSampler(const ParameterizedField& field, const std::vector<ZeroCrossing>& crossings,
                         const SamplingOptions& options)
    : field_(field), mesh_(field.charts->mesh()), crossings_(crossings), options_(options) {}

std::vector<JetSample> PathSampler::sample(const ChargePath& path) const {
  std::vector<JetSample> result;
  for (std::size_t k = 0; k < path.faces.size(); ++k) addSegment(result, path, k);
  return result;
}

/// Samples of the path within faces[k]: where it enters, at every lambda of the field, where it leaves, and more in
/// between where it bends.
void PathSampler::addSegment(std::vector<JetSample>& result, const ChargePath& path, std::size_t k) const {
  const std::vector<double>& lambdas = field_.lambdas;
  const Index face = path.faces[k];
  const Index in = k == 0 ? path.begin : path.crossings[k - 1];
  const Index out = k + 1 == path.faces.size() ? path.end : path.crossings[k];
  JetSample first = segmentEnd(face, path.charge, in, lambdas.front());
  // Crossings of one event at a vertex may differ by round-off.
  if (!result.empty()) first.sample.lambda = std::max(first.sample.lambda, result.back().sample.lambda);
  if (k > 0) result.back().listed = false;
  result.push_back(first);
  if (in == kNone && out == kNone && lambdas.size() == 1) return;

  JetSample last = segmentEnd(face, path.charge, out, lambdas.back());
  last.sample.lambda = std::max(last.sample.lambda, first.sample.lambda);
  const auto begin = std::upper_bound(lambdas.begin(), lambdas.end(), first.sample.lambda);
  const auto end = std::lower_bound(lambdas.begin(), lambdas.end(), last.sample.lambda);
  for (auto lambda = begin; lambda < end; ++lambda) refine(result, inFace(face, *lambda, path.charge), path.charge, 0);
  refine(result, last, path.charge, 0);
}

/// At a crossing, or inside the face at lambdaWithout where there is none.
JetSample PathSampler::segmentEnd(Index face, int index, Index crossing, double lambdaWithout) const {
  if (crossing == kNone) return inFace(face, lambdaWithout, index);
  const double lambda = crossings_[crossing].lambda;
  return jetAt(lambda, crossingPoint(crossings_[crossing], face), interpolant(face, lambda), index);
}

JetSample PathSampler::inFace(Index face, double lambda, int index) const {
  const FaceInterpolant local = interpolant(face, lambda);
  const std::optional<Eigen::Vector3d> boundary = zeroOnBoundary(local);
  return jetAt(lambda, {face, boundary ? *boundary : findZero(local, index)}, local, index);
}

SurfacePoint PathSampler::crossingPoint(const ZeroCrossing& crossing, Index face) const {
  const Index h = mesh_.edgeHalfedge(crossing.edge);
  const bool left = TriangleMesh::face(h) == face;
  const Index own = left ? h : mesh_.twin(h);
  const int tail = TriangleMesh::corner(own), head = (tail + 1) % 3;
  SurfacePoint point;
  point.face = face;
  point.barycentric[left ? tail : head] = 1.0 - crossing.along;
  point.barycentric[left ? head : tail] = crossing.along;
  return point;
}

/// Appends last, and before it as many samples as keep the curve within the chord tolerance.
void PathSampler::refine(std::vector<JetSample>& result, const JetSample& last, int index, int depth) const {
  const PathSample from = result.back().sample;
  const double lambda = 0.5 * (from.lambda + last.sample.lambda);
  if (depth < kMaxHalvings && last.sample.lambda - from.lambda > kInstant) {
    const JetSample middle = inFace(last.sample.point.face, lambda, index);
    const double bend = (middle.sample.position - 0.5 * (from.position + last.sample.position)).norm();
    if (bend > options_.chordTolerance * mesh_.meanEdgeLength()) {
      refine(result, middle, index, depth + 1);
      refine(result, last, index, depth + 1);
      return;
    }
  }
  result.push_back(last);
}

JetSample PathSampler::jetAt(double lambda, const SurfacePoint& point, const FaceInterpolant& local, int index) const {
  JetSample result;
  result.jacobian = local.jacobian(local.point(point.barycentric));
  result.sample = {lambda, point, position(mesh_, point), classify(result.jacobian, index, options_.relativeTolerance)};
  return result;
}

FaceInterpolant PathSampler::interpolant(Index face, double lambda) const {
  const std::vector<double>& lambdas = field_.lambdas;
  const auto above = std::upper_bound(lambdas.begin(), lambdas.end(), lambda) - lambdas.begin();
  const Index j = std::clamp<Index>(static_cast<Index>(above) - 1, 0, std::max<Index>(0, field_.sampleCount() - 2));
  const Index k = std::min(j + 1, field_.sampleCount() - 1);
  const double t = k > j ? (lambda - lambdas[j]) / (lambdas[k] - lambdas[j]) : 0.0;
  const Complex *from = field_.sample(j), *to = field_.sample(k);
  std::array<Complex, 3> values;
  for (int i = 0; i < 3; ++i) {
    const Index v = mesh_.vertex(face, i);
    values[i] = (1.0 - t) * from[v] + t * to[v];
  }
  return FaceInterpolant(*field_.charts, face, values);
}

}  // namespace stormfield
