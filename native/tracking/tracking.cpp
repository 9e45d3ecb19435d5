#include "tracking/tracking.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "base/message.h"
#include "tracking/detail/samples.h"

namespace stormfield {
namespace {

/// Steps of the search for the lambda where the trace is zero, inside one face.
constexpr int kMaxHopfSteps = 4;

void check(const TrackingOptions& options) {
  if (!(options.relativeTolerance >= 0.0 && options.relativeTolerance < 1.0)) {
    throw InputError(message("the relative tolerance is ", options.relativeTolerance, "; choose one from 0 up to 1"));
  }
  if (!(options.hopfDamping >= 0.0 && options.hopfDamping < 1.0)) {
    throw InputError(
        message("the damping of Hopf bifurcations is ", options.hopfDamping, "; choose one from 0 up to 1"));
  }
  if (!(options.chordTolerance > 0.0)) {
    throw InputError(message("the chord tolerance is ", options.chordTolerance, "; choose one above 0"));
  }
}

double rotationOf(const Eigen::Matrix2d& jacobian) {
  return jacobian(1, 0) - jacobian(0, 1);
}

/// Mean over lambda by the trapezoid rule.
template <typename Quantity>
double mean(const std::vector<JetSample>& jets, const Quantity& quantity) {
  double sum = 0.0, length = 0.0;
  for (std::size_t i = 0; i + 1 < jets.size(); ++i) {
    const double step = jets[i + 1].sample.lambda - jets[i].sample.lambda;
    sum += 0.5 * step * (quantity(jets[i].jacobian) + quantity(jets[i + 1].jacobian));
    length += step;
  }
  return length > 0.0 ? sum / length : quantity(jets.front().jacobian);
}

PathEnd endOf(Index crossing, Index other) {
  if (crossing == kNone) return PathEnd::Range;
  return other == kNone ? PathEnd::Boundary : PathEnd::Bifurcation;
}

TrackedPath summary(const ChargePath& charge, const std::vector<JetSample>& jets) {
  TrackedPath path;
  path.index = charge.charge;
  path.begin = endOf(charge.begin, charge.createdWith);
  path.end = endOf(charge.end, charge.annihilatedWith);
  path.strength = mean(jets, [](const Eigen::Matrix2d& j) { return std::sqrt(std::abs(j.determinant())); });
  path.rotation = mean(jets, rotationOf);
  for (const JetSample& jet : jets) {
    if (jet.listed) path.samples.push_back(jet.sample);
  }
  path.kind = prevailingKind(path.samples);
  return path;
}

// Hopf bifurcations -------------------------------------------------------------------------------------------------

/// Between two jets whose traces differ in sign: by false position within one face; where they lie on the two sides of
/// an edge, the nearer one to zero.
StabilityChange changeBetween(const PathSampler& sampler, const JetSample& a, const JetSample& b) {
  JetSample low = a, high = b;
  const bool inside = a.sample.point.face == b.sample.point.face && a.sample.lambda < b.sample.lambda;
  for (int step = 0; inside && step < kMaxHopfSteps; ++step) {
    const double from = low.jacobian.trace(), to = high.jacobian.trace();
    const double lambda = low.sample.lambda + from / (from - to) * (high.sample.lambda - low.sample.lambda);
    if (!(lambda > low.sample.lambda && lambda < high.sample.lambda)) break;
    const JetSample middle = sampler.inFace(a.sample.point.face, lambda, 1);
    (middle.jacobian.trace() > 0.0) == (from > 0.0) ? low = middle : high = middle;
  }
  const bool early = std::abs(low.jacobian.trace()) < std::abs(high.jacobian.trace());
  const PathSample& nearest = (early ? low : high).sample;
  return {nearest.lambda, nearest.point, nearest.position};
}

Bifurcation hopfAt(const StabilityChange& change, FixedPointKind node) {
  Bifurcation result;
  result.lambda = change.lambda;
  result.point = change.point;
  result.position = change.position;
  result.kind = BifurcationKind::Hopf;
  result.node = node;
  return result;
}

struct Stability {
  std::vector<Bifurcation> hopfs;
  StabilityMargins margins;
};

/// Sources that become sinks, or back (Hopf 1942): the trace changes its sign while the determinant is positive. A sign
/// is certain where the damping ratio exceeds the tolerance; of the changes between two certain signs (an odd number)
/// the middle one counts.
Stability stabilityOf(const PathSampler& sampler, const std::vector<JetSample>& jets, double damping) {
  Stability result;
  StabilityMargins& margins = result.margins;
  std::vector<std::pair<const JetSample*, const JetSample*>> changes;
  const auto located = [&] {
    std::vector<StabilityChange> places;
    for (const auto& [last, next] : changes) places.push_back(changeBetween(sampler, *last, *next));
    return places;
  };
  const JetSample* before = nullptr;
  for (const JetSample& jet : jets) {
    const double det = jet.jacobian.determinant(), trace = jet.jacobian.trace();
    if (det <= 0.0 || trace == 0.0) continue;
    const int sign = trace > 0.0 ? 1 : -1;
    if (margins.first == 0) margins.first = sign;
    margins.last = sign;
    if (before != nullptr && before->jacobian.trace() * trace < 0.0) changes.emplace_back(before, &jet);
    before = &jet;
    if (std::abs(trace) <= 2.0 * damping * std::sqrt(det)) continue;
    if (margins.firstCertain == 0) {
      margins.firstCertain = sign;
      margins.before = located();
    } else if (margins.lastCertain != sign) {
      const auto [last, next] = changes[changes.size() / 2];
      result.hopfs.push_back(
          hopfAt(changeBetween(sampler, *last, *next), sign > 0 ? FixedPointKind::Source : FixedPointKind::Sink));
    }
    margins.lastCertain = sign;
    changes.clear();
  }
  (margins.firstCertain == 0 ? margins.before : margins.after) = located();
  return result;
}

// Pairs ---------------------------------------------------------------------------------------------------------------

/// Source or sink, by the trace of the node next to where it meets the saddle.
FixedPointKind nodeKind(const JetSample& jet) {
  return jet.jacobian.trace() > 0.0 ? FixedPointKind::Source : FixedPointKind::Sink;
}

Bifurcation pairEvent(const ZeroCrossing& crossing, const TriangleMesh& mesh, const PathSampler& sampler,
                      BifurcationKind kind, FixedPointKind node, std::array<Index, 2> paths) {
  Bifurcation result;
  result.lambda = crossing.lambda;
  result.point = sampler.crossingPoint(crossing, TriangleMesh::face(mesh.edgeHalfedge(crossing.edge)));
  result.position = position(mesh, result.point);
  result.kind = kind;
  result.node = node;
  result.paths = paths;
  return result;
}

/// Creation, Hopf bifurcations and annihilation of a path of index +1, in this order.
std::vector<Bifurcation> eventsOf(const ChargePath& path, Index number, const std::vector<JetSample>& jets,
                                  const std::vector<Bifurcation>& hopfs, const PathSampler& sampler,
                                  const std::vector<ZeroCrossing>& crossings, const TriangleMesh& mesh) {
  std::vector<Bifurcation> events;
  if (path.createdWith != kNone) {
    events.push_back(pairEvent(crossings[path.begin], mesh, sampler, BifurcationKind::Creation, nodeKind(jets.front()),
                               {number, path.createdWith}));
  }
  for (const Bifurcation& hopf : hopfs) {
    events.push_back(hopf);
    events.back().paths = {number, kNone};
  }
  if (path.annihilatedWith != kNone) {
    events.push_back(pairEvent(crossings[path.end], mesh, sampler, BifurcationKind::Annihilation, nodeKind(jets.back()),
                               {number, path.annihilatedWith}));
  }
  return events;
}

}  // namespace

Tracking trackFixedPoints(const ParameterizedField& field, const TrackingOptions& options, Progress& progress) {
  check(options);
  const TriangleMesh& mesh = field.charts->mesh();
  progress.range(0.0, 0.5);
  const std::vector<ZeroCrossing> crossings = zeroCrossings(field, progress);
  const std::vector<ChargePath> paths = sweepCharges(mesh, firstIndices(field), crossings, progress);

  progress.range(0.5, 1.0);
  const PathSampler sampler(field, crossings, {options.relativeTolerance, options.chordTolerance});
  Tracking result;
  result.paths.resize(paths.size());
  std::vector<std::vector<Bifurcation>> events(paths.size());
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t{0}, paths.size(), [&](std::size_t i) {
    if (progress.cancelled()) return;
    const std::vector<JetSample> jets = sampler.sample(paths[i]);
    result.paths[i] = summary(paths[i], jets);
    progress.report(static_cast<double>(++done) / static_cast<double>(paths.size()));
    // A pair's events are listed once, with its node.
    if (paths[i].charge < 0) return;
    const Stability stability = stabilityOf(sampler, jets, options.hopfDamping);
    result.paths[i].margins = stability.margins;
    events[i] = eventsOf(paths[i], static_cast<Index>(i), jets, stability.hopfs, sampler, crossings, mesh);
  });
  progress.check();
  for (const auto& of : events) result.bifurcations.insert(result.bifurcations.end(), of.begin(), of.end());
  std::stable_sort(result.bifurcations.begin(), result.bifurcations.end(),
                   [](const Bifurcation& a, const Bifurcation& b) { return a.lambda < b.lambda; });
  progress.report(1.0);
  return result;
}

}  // namespace stormfield
