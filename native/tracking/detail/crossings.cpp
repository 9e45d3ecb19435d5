#include "tracking/detail/crossings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "tracking/detail/step_quadratic.h"

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;
/// Signs of products are trusted beyond this fraction of their size.
constexpr double kTrusted = 1e-12;
/// Length of an infinitesimal vector: far below any real one, while products of two are still numbers.
constexpr double kInfinitesimal = 1e-120;
/// Edges in one piece of parallel work.
constexpr Index kBlock = 8192;

double cross(Complex a, Complex b) {
  return a.real() * b.imag() - a.imag() * b.real();
}
double dot(Complex a, Complex b) {
  return a.real() * b.real() + a.imag() * b.imag();
}
/// Plain product: the operator looks for infinities, which a field does not hold.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

Complex blend(Complex from, Complex to, const StepTime& at) {
  return at.u * from + at.t * to;
}

/// Rotation in (-pi, pi]. Adding zero makes 0 of -0, so that opposed vectors rotate by +pi.
double rotationOf(double crossed, double dotted) {
  return std::atan2(crossed + 0.0, dotted);
}

/// The end vectors of one edge over one step of lambda, both as the head sees them.
struct MovingEdge {
  Complex p0, p1, q0, q1;
  StepQuadratic crossed, dotted;

  MovingEdge(Complex tail0, Complex tail1, Complex head0, Complex head1, Complex transport)
      : p0(times(transport, tail0)), p1(times(transport, tail1)), q0(head0), q1(head1) {
    crossed = {{cross(p0, q0), cross(p0, q1) + cross(p1, q0), cross(p1, q1)}};
    dotted = {{dot(p0, q0), dot(p0, q1) + dot(p1, q0), dot(p1, q1)}};
  }

  /// Whether the ends are certainly never opposed.
  bool neverOpposed() const {
    const double bound = kTrusted * (crossed.size() + dotted.size());
    return dotted.above(bound) || crossed.above(bound) || crossed.below(-bound);
  }

  double rotationBefore() const { return rotationOf(crossed.c[0], dotted.c[0]); }
  double rotationAfter() const { return rotationOf(crossed.c[2], dotted.c[2]); }

  double along(const StepTime& at) const {
    const double p = std::abs(blend(p0, p1, at)), q = std::abs(blend(q0, q1, at));
    return p + q > 0.0 ? p / (p + q) : 0.5;
  }
};

enum class Ends { Opposed, Aligned, Unclear };

/// Length over the lengths it is blended from: round-off where the vector passes through zero.
double smallness(Complex from, Complex to, const StepTime& at) {
  return std::abs(blend(from, to, at)) / (at.u * std::abs(from) + at.t * std::abs(to));
}

/// At a root of the cross product: Unclear where one of the ends is zero up to round-off.
Ends endsAt(const MovingEdge& edge, const StepTime& at) {
  if (std::min(smallness(edge.p0, edge.p1, at), smallness(edge.q0, edge.q1, at)) <= kTrusted) return Ends::Unclear;
  return dot(blend(edge.p0, edge.p1, at), blend(edge.q0, edge.q1, at)) < 0.0 ? Ends::Opposed : Ends::Aligned;
}

/// When the vector is shortest on its straight line from one sample to the next.
StepTime shortest(Complex from, Complex to) {
  const double t = dot(from, from - to), u = dot(to, to - from);
  if (t <= 0.0 && u <= 0.0) return {};
  return StepTime::ratio(std::max(t, 0.0), std::max(u, 0.0));
}

/// When one crossing of this charge, which is known to happen, does. Without a root an end vector passes through zero,
/// where its direction reverses at once: the tail's to the side of the charge, or the head's to the other.
StepTime timeOfOne(const MovingEdge& edge, int charge, double tailRotation, double headRotation) {
  const StepQuadratic::Roots roots = edge.crossed.roots();
  // At a double root the slope is round-off.
  double steepest = -kTrusted * edge.crossed.size();
  std::optional<StepTime> fits;
  for (int k = 0; k < roots.count; ++k) {
    const double slope = edge.crossed.slope(roots.times[k]) * charge;
    if (slope < steepest || endsAt(edge, roots.times[k]) != Ends::Opposed) continue;
    steepest = slope;
    fits = roots.times[k];
  }
  if (fits) return *fits;
  return tailRotation * charge > -headRotation * charge ? shortest(edge.p0, edge.p1) : shortest(edge.q0, edge.q1);
}

/// Both roots are of ends that pass through zero: whether the first of them rotates the edge past pi. A rotation of the
/// tail's vector rotates the edge the other way.
bool rotatesPastPi(const MovingEdge& edge, const StepTime& first, double tailRotation, double headRotation) {
  const bool tail = smallness(edge.p0, edge.p1, first) < smallness(edge.q0, edge.q1, first);
  return (tail ? tailRotation < 0.0 : headRotation > 0.0) == (edge.crossed.c[0] >= 0.0);
}

/// When a charge crosses the edge and back, if it does at all: no index is left over.
std::optional<std::pair<StepTime, StepTime>> timesOfTwo(const MovingEdge& edge, double tailRotation,
                                                        double headRotation) {
  const StepQuadratic::Roots roots = edge.crossed.roots();
  if (roots.count < 2) return std::nullopt;
  const auto& [first, second] = roots.times;
  // A certain crossing makes an unclear one certain: charges cross in pairs here.
  const Ends before = endsAt(edge, first), after = endsAt(edge, second);
  if (before == Ends::Aligned || after == Ends::Aligned) return std::nullopt;
  const bool unclear = before == Ends::Unclear && after == Ends::Unclear;
  if (unclear && !rotatesPastPi(edge, first, tailRotation, headRotation)) return std::nullopt;
  // A rotation of exactly +pi at a sample counts as one that has not yet crossed, or has crossed already.
  if (first.t == 0.0 && !(edge.crossed.c[0] >= 0.0 && edge.crossed.slope(first) < 0.0)) return std::nullopt;
  if (second.u == 0.0 && !(edge.crossed.slope(second) > 0.0)) return std::nullopt;
  return std::pair(first, second);
}

/// The values of one sample with infinitesimal vectors in place of zero ones.
class SampleValues {
 public:
  explicit SampleValues(const Complex* values) : values_(values) {}
  Complex operator[](Index v) const { return values_[v] == 0.0 ? Complex(kInfinitesimal) : values_[v]; }

 private:
  const Complex* values_;
};

/// One step of lambda between two samples.
class LambdaStep {
 public:
  LambdaStep(const ParameterizedField& field, Index j)
      : charts_(*field.charts),
        mesh_(charts_.mesh()),
        from_(field.sample(j)),
        to_(field.sample(j + 1)),
        begin_(field.lambdas[j]),
        end_(field.lambdas[j + 1]) {}

  std::vector<ZeroCrossing> crossings(Index firstEdge, Index lastEdge) const {
    std::vector<ZeroCrossing> found;
    for (Index e = firstEdge; e < lastEdge; ++e) {
      const Index h = mesh_.edgeHalfedge(e);
      const Index tail = mesh_.tail(h), head = mesh_.head(h);
      const MovingEdge edge(from_[tail], to_[tail], from_[head], to_[head], charts_.transport(h));
      if (!edge.neverOpposed()) add(found, e, edge, vertexRotation(tail), vertexRotation(head));
    }
    return found;
  }

 private:
  double vertexRotation(Index v) const { return rotationOf(cross(from_[v], to_[v]), dot(from_[v], to_[v])); }

  void add(std::vector<ZeroCrossing>& found, Index e, const MovingEdge& edge, double tailRotation,
           double headRotation) const {
    const double excess = edge.rotationAfter() - edge.rotationBefore() - (headRotation - tailRotation);
    const int charge = static_cast<int>(std::lround(excess / (2.0 * kPi)));
    if (charge != 0) {
      found.push_back(at(e, edge, timeOfOne(edge, charge, tailRotation, headRotation), charge));
    } else if (const auto times = timesOfTwo(edge, tailRotation, headRotation)) {
      const int first = edge.crossed.c[0] >= 0.0 ? -1 : 1;
      found.push_back(at(e, edge, times->first, first));
      found.push_back(at(e, edge, times->second, -first));
    }
  }

  ZeroCrossing at(Index e, const MovingEdge& edge, const StepTime& time, int charge) const {
    return {time.t < 0.5 ? begin_ + time.t * (end_ - begin_) : end_ - time.u * (end_ - begin_), edge.along(time), e,
            charge};
  }

  const VertexCharts& charts_;
  const TriangleMesh& mesh_;
  SampleValues from_, to_;
  double begin_, end_;
};

}  // namespace

std::vector<ZeroCrossing> zeroCrossings(const ParameterizedField& field, Progress& progress) {
  const Index steps = field.sampleCount() - 1, edges = field.charts->mesh().edgeCount();
  if (steps < 1) return {};
  const Index blocks = (edges + kBlock - 1) / kBlock;
  std::vector<std::vector<ZeroCrossing>> pieces(static_cast<std::size_t>(steps) * blocks);
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
    if (progress.cancelled()) return;
    const Index block = static_cast<Index>(i % blocks);
    const LambdaStep step(field, static_cast<Index>(i / blocks));
    pieces[i] = step.crossings(block * kBlock, std::min(edges, (block + 1) * kBlock));
    progress.report(static_cast<double>(++done) / static_cast<double>(pieces.size()));
  });
  progress.check();

  // Steps follow each other in lambda: crossings that are sorted within each step are sorted as a whole.
  std::vector<std::vector<ZeroCrossing>> sorted(steps);
  tbb::parallel_for(Index{0}, steps, [&](Index j) {
    for (Index block = 0; block < blocks; ++block) {
      auto& piece = pieces[static_cast<std::size_t>(j) * blocks + block];
      sorted[j].insert(sorted[j].end(), piece.begin(), piece.end());
      piece = {};
    }
    std::stable_sort(sorted[j].begin(), sorted[j].end(), [](const ZeroCrossing& a, const ZeroCrossing& b) {
      return a.lambda != b.lambda ? a.lambda < b.lambda : a.edge < b.edge;
    });
  });
  progress.check();
  std::vector<ZeroCrossing> result;
  std::size_t count = 0;
  for (const auto& step : sorted) count += step.size();
  result.reserve(count);
  for (auto& step : sorted) {
    result.insert(result.end(), step.begin(), step.end());
    step = {};
  }
  return result;
}

std::vector<int> firstIndices(const ParameterizedField& field) {
  const VertexCharts& charts = *field.charts;
  const TriangleMesh& mesh = charts.mesh();
  const SampleValues values(field.sample(0));
  std::vector<int> indices(mesh.faceCount());
  tbb::parallel_for(Index{0}, mesh.faceCount(), [&](Index f) {
    double rotation = 0.0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index canonical = mesh.edgeHalfedge(mesh.edge(h));
      const Complex p = times(charts.transport(canonical), values[mesh.tail(canonical)]);
      const Complex q = values[mesh.head(canonical)];
      const double along = rotationOf(cross(p, q), dot(p, q));
      rotation += canonical == h ? along : -along;
      rotation -= (1.0 - charts.scale(mesh.tail(h))) * mesh.cornerAngle(h);
    }
    indices[f] = static_cast<int>(std::lround(rotation / (2.0 * kPi)));
  });
  return indices;
}

}  // namespace stormfield
