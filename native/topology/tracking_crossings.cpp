#include "topology/tracking_crossings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;
/// Signs of products are trusted beyond this part of their size.
constexpr double kTrusted = 1e-12;
/// Length of an infinitesimal vector, as part of the largest: its products with others of its kind are still numbers.
constexpr double kInfinitesimal = 1e-100;
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

/// Turn in (-pi, pi]. Adding zero turns -0 into 0, so that opposed vectors turn by +pi.
double turnOf(double crossed, double dotted) {
  return std::atan2(crossed + 0.0, dotted);
}

/// c[0] u^2 + c[1] u t + c[2] t^2 with u = 1 - t: the values at both samples and what is between them.
struct Quadratic {
  std::array<double, 3> c;

  double at(double t) const { return (1.0 - t) * ((1.0 - t) * c[0] + t * c[1]) + t * t * c[2]; }
  double slope(double t) const { return (1.0 - t) * (c[1] - 2.0 * c[0]) + t * (2.0 * c[2] - c[1]); }
  bool above(double bound) const { return c[0] > bound && c[1] > bound && c[2] > bound; }
  bool below(double bound) const { return c[0] < bound && c[1] < bound && c[2] < bound; }
  double size() const { return std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]); }

  struct Roots {
    int count = 0;
    std::array<double, 2> t{};
  };

  /// Its roots in [0, 1] in order.
  Roots roots() const {
    const double discriminant = c[1] * c[1] - 4.0 * c[0] * c[2];
    Roots found;
    if (!(discriminant >= 0.0)) return found;
    const double half = -0.5 * (c[1] + std::copysign(std::sqrt(discriminant), c[1]));
    // t : u is a ratio of numbers of the same sign; exchanging the samples exchanges t and u.
    const auto add = [&](double t, double u) {
      if ((t > 0.0 && u < 0.0) || (t < 0.0 && u > 0.0) || t + u == 0.0) return;
      found.t[found.count++] = t / (t + u);
    };
    add(half, c[2]);
    add(c[0], half);
    if (found.count == 2 && found.t[0] > found.t[1]) std::swap(found.t[0], found.t[1]);
    return found;
  }
};

/// The end vectors of one edge over one step of lambda, both as the head sees them.
struct MovingEdge {
  Complex p0, p1, q0, q1;
  Quadratic crossed, dotted;

  MovingEdge(Complex tail0, Complex tail1, Complex head0, Complex head1, Complex transport)
      : p0(times(transport, tail0)), p1(times(transport, tail1)), q0(head0), q1(head1) {
    crossed = {{cross(p0, q0), cross(p0, q1) + cross(p1, q0), cross(p1, q1)}};
    dotted = {{dot(p0, q0), dot(p0, q1) + dot(p1, q0), dot(p1, q1)}};
  }

  /// Whether the ends are surely never opposed.
  bool calm() const {
    const double bound = kTrusted * (crossed.size() + dotted.size());
    return dotted.above(bound) || crossed.above(bound) || crossed.below(-bound);
  }

  double turnBefore() const { return turnOf(crossed.c[0], dotted.c[0]); }
  double turnAfter() const { return turnOf(crossed.c[2], dotted.c[2]); }

  double along(double t) const {
    const double p = std::abs((1.0 - t) * p0 + t * p1), q = std::abs((1.0 - t) * q0 + t * q1);
    return p + q > 0.0 ? p / (p + q) : 0.5;
  }
};

/// When the vector is shortest on its straight way.
double shortest(Complex from, Complex to) {
  const double squared = std::norm(to - from);
  return squared > 0.0 ? std::clamp(dot(from, from - to) / squared, 0.0, 1.0) : 0.5;
}

/// One crossing that carries this charge is known to happen: the time that fits best. Where an end vector passes
/// through zero, or both stay on one line, round-off decides what the roots are, and the time is where a vector is
/// shortest.
double timeOfOne(const MovingEdge& edge, int charge) {
  const Quadratic::Roots roots = edge.crossed.roots();
  for (int k = 0; k < roots.count; ++k) {
    const double t = roots.t[k];
    if (edge.crossed.slope(t) * charge > 0.0 && edge.dotted.at(t) < -kTrusted * edge.dotted.size()) return t;
  }
  const auto misfit = [&](double t) { return std::abs(edge.crossed.at(t)) + std::max(0.0, edge.dotted.at(t)); };
  double best = shortest(edge.p0, edge.p1);
  for (const double t : {shortest(edge.q0, edge.q1), roots.t[0], roots.t[1]}) {
    if (misfit(t) < misfit(best)) best = t;
  }
  return best;
}

/// No index is left over: either nothing happens, or one charge comes and goes.
std::optional<std::pair<double, double>> timesOfTwo(const MovingEdge& edge) {
  const auto [count, t] = edge.crossed.roots();
  if (count < 2) return std::nullopt;
  const double first = edge.dotted.at(t[0]), second = edge.dotted.at(t[1]);
  // With one of them certain, the other is as well: round-off near a zero end vector decides nothing.
  const double bound = kTrusted * edge.dotted.size();
  if (std::min(first, second) >= -bound || std::max(first, second) > bound) return std::nullopt;
  // A turn of exactly +pi at a sample counts as one that has not yet crossed, or has crossed already.
  const bool positive = edge.crossed.c[0] >= 0.0;
  if (t[0] == 0.0 && !(positive && edge.crossed.slope(0.0) < 0.0)) return std::nullopt;
  if (t[1] == 1.0 && !(edge.crossed.slope(1.0) > 0.0)) return std::nullopt;
  return std::pair(t[0], t[1]);
}

/// The values of one sample with infinitesimal vectors in place of zero ones.
class Sample {
 public:
  Sample(const Complex* values, double infinitesimal) : values_(values), infinitesimal_(infinitesimal) {}
  Complex operator[](Index v) const { return values_[v] == 0.0 ? Complex(infinitesimal_) : values_[v]; }

 private:
  const Complex* values_;
  double infinitesimal_;
};

double infinitesimalOf(const ParameterizedField& field) {
  double largest = 0.0;
  for (const Complex& value : field.values) {
    largest = std::max({largest, std::abs(value.real()), std::abs(value.imag())});
  }
  return largest > 0.0 ? kInfinitesimal * largest : 1.0;
}

/// One step of lambda on some of the edges.
class Step {
 public:
  Step(const ParameterizedField& field, Index j, double infinitesimal)
      : charts_(*field.charts),
        mesh_(charts_.mesh()),
        from_(field.sample(j), infinitesimal),
        to_(field.sample(j + 1), infinitesimal),
        begin_(field.lambdas[j]),
        length_(field.lambdas[j + 1] - field.lambdas[j]) {}

  std::vector<EdgeCrossing> crossings(Index firstEdge, Index lastEdge) const {
    std::vector<EdgeCrossing> found;
    for (Index e = firstEdge; e < lastEdge; ++e) {
      const Index h = mesh_.edgeHalfedge(e);
      const Index tail = mesh_.tail(h), head = mesh_.head(h);
      const MovingEdge edge(from_[tail], to_[tail], from_[head], to_[head], charts_.transport(h));
      if (!edge.calm()) add(found, e, edge, turnOfVertex(head) - turnOfVertex(tail));
    }
    return found;
  }

 private:
  double turnOfVertex(Index v) const { return turnOf(cross(from_[v], to_[v]), dot(from_[v], to_[v])); }

  /// vertexTurn: how much more the vector at the head turns over the step than the one at the tail.
  void add(std::vector<EdgeCrossing>& found, Index e, const MovingEdge& edge, double vertexTurn) const {
    const double excess = edge.turnAfter() - edge.turnBefore() - vertexTurn;
    const int charge = static_cast<int>(std::lround(excess / (2.0 * kPi)));
    if (charge != 0) {
      found.push_back(at(e, edge, timeOfOne(edge, charge), charge));
    } else if (const auto times = timesOfTwo(edge)) {
      const int first = edge.crossed.c[0] >= 0.0 ? -1 : 1;
      found.push_back(at(e, edge, times->first, first));
      found.push_back(at(e, edge, times->second, -first));
    }
  }

  EdgeCrossing at(Index e, const MovingEdge& edge, double t, int charge) const {
    return {std::min(begin_ + t * length_, begin_ + length_), edge.along(t), e, charge};
  }

  const VertexCharts& charts_;
  const TriangleMesh& mesh_;
  Sample from_, to_;
  double begin_, length_;
};

}  // namespace

std::vector<EdgeCrossing> edgeCrossings(const ParameterizedField& field, Progress& progress) {
  const Index steps = field.sampleCount() - 1, edges = field.charts->mesh().edgeCount();
  if (steps < 1) return {};
  const double infinitesimal = infinitesimalOf(field);
  const Index blocks = (edges + kBlock - 1) / kBlock;
  std::vector<std::vector<EdgeCrossing>> pieces(static_cast<std::size_t>(steps) * blocks);
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
    if (progress.cancelled()) return;
    const Index block = static_cast<Index>(i % blocks);
    const Step step(field, static_cast<Index>(i / blocks), infinitesimal);
    pieces[i] = step.crossings(block * kBlock, std::min(edges, (block + 1) * kBlock));
  });
  progress.check();

  // Pieces of one step lie side by side; what is sorted inside each step stays sorted as a whole.
  std::vector<std::vector<EdgeCrossing>> sorted(steps);
  tbb::parallel_for(Index{0}, steps, [&](Index j) {
    for (Index block = 0; block < blocks; ++block) {
      auto& piece = pieces[static_cast<std::size_t>(j) * blocks + block];
      sorted[j].insert(sorted[j].end(), piece.begin(), piece.end());
      piece = {};
    }
    std::stable_sort(sorted[j].begin(), sorted[j].end(), [](const EdgeCrossing& a, const EdgeCrossing& b) {
      return a.lambda != b.lambda ? a.lambda < b.lambda : a.edge < b.edge;
    });
  });
  progress.check();
  std::vector<EdgeCrossing> result;
  std::size_t count = 0;
  for (const auto& step : sorted) count += step.size();
  result.reserve(count);
  for (const auto& step : sorted) result.insert(result.end(), step.begin(), step.end());
  return result;
}

std::vector<int> firstIndices(const ParameterizedField& field) {
  const VertexCharts& charts = *field.charts;
  const TriangleMesh& mesh = charts.mesh();
  const Sample values(field.sample(0), infinitesimalOf(field));
  std::vector<int> indices(mesh.faceCount());
  tbb::parallel_for(Index{0}, mesh.faceCount(), [&](Index f) {
    double turn = 0.0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index canonical = mesh.edgeHalfedge(mesh.edge(h));
      const Complex p = times(charts.transport(canonical), values[mesh.tail(canonical)]);
      const Complex q = values[mesh.head(canonical)];
      const double along = turnOf(cross(p, q), dot(p, q));
      turn += canonical == h ? along : -along;
      turn -= (1.0 - charts.scale(mesh.tail(h))) * mesh.cornerAngle(h);
    }
    indices[f] = static_cast<int>(std::lround(turn / (2.0 * kPi)));
  });
  return indices;
}

}  // namespace stormfield
