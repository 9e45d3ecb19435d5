#include "morse/transit_persistence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "maps/error_bound.h"

namespace stormfield {
namespace {

/// The ladder begins at this part of the largest speed, or at the refinement's own epsilon.
constexpr double kLeast = 1e-6, kBeyond = 1.1;

/// Per set a number that those in one strongly connected set have in common.
using Joined = std::vector<Index>;

class Ladder {
 public:
  Ladder(const TransitRefinement& refinement, const NodeSets& nodes, double least, int steps, Progress& progress)
      : refinement_(refinement), nodes_(nodes), least_(least), steps_(steps), progress_(progress) {}

  double epsilon(int step) const { return least_ * std::pow(kPersistenceStep, step); }

  /// Per set the first step at which it is joined with another, or one beyond the last.
  std::vector<int> firstJoined() {
    Joined alone(nodes_.count());
    for (Index s = 0; s < nodes_.count(); ++s) alone[s] = s;
    std::vector<int> first(nodes_.count(), steps_);
    between(-1, alone, steps_ - 1, at(steps_ - 1), first);
    return first;
  }

 private:
  Joined at(int step) {
    progress_.report(static_cast<double>(looks_++) / steps_);
    progress_.check();
    const TransitRefinement within = refinement_.within(epsilon(step), &progress_);
    std::vector<Index> setOf(within.map().outside(), kNone);
    for (std::size_t s = 0; s < within.sets().size(); ++s) {
      for (const Index node : within.sets()[s]) setOf[node] = static_cast<Index>(s);
    }
    Joined result(nodes_.count());
    for (Index s = 0; s < nodes_.count(); ++s) result[s] = setOf[nodes_.members(s).front()];
    return result;
  }

  static std::vector<char> isJoined(const Joined& joined) {
    std::map<Index, int> sizes;
    for (const Index set : joined) ++sizes[set];
    std::vector<char> result(joined.size());
    std::transform(joined.begin(), joined.end(), result.begin(), [&](Index set) { return sizes[set] > 1 ? 1 : 0; });
    return result;
  }

  /// Sets that are joined at the step `high` but not at `low`.
  void between(int low, const Joined& atLow, int high, const Joined& atHigh, std::vector<int>& first) {
    const std::vector<char> before = isJoined(atLow), after = isJoined(atHigh);
    if (before == after) return;
    if (high == low + 1) {
      for (std::size_t s = 0; s < first.size(); ++s) {
        if (after[s] != 0 && before[s] == 0) first[s] = high;
      }
      return;
    }
    const int middle = low + (high - low) / 2;
    const Joined there = at(middle);
    between(low, atLow, middle, there, first);
    between(middle, there, high, atHigh, first);
  }

  const TransitRefinement& refinement_;
  const NodeSets& nodes_;
  double least_;
  int steps_, looks_ = 0;
  Progress& progress_;
};

/// An epsilon at which some field within the bound rests in every face that has an error.
double mostEpsilon(const VectorField& field, const std::vector<double>& weights) {
  double most = 0.0;
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    const double weight = weights.empty() ? 1.0 : weights[v];
    if (weight > 0.0) most = std::max(most, std::abs(field.values[v]) / weight);
  }
  return kBeyond * most;
}

}  // namespace

std::vector<double> transitPersistence(const TransitRefinement& refinement, const NodeSets& nodes, Progress& progress) {
  std::vector<double> result(nodes.count(), std::numeric_limits<double>::infinity());
  const double most = mostEpsilon(refinement.field(), refinement.options().weights);
  if (nodes.count() < 2 || !(most > 0.0) || !std::isfinite(most)) return result;
  const double least = std::max(kLeast * most, kPersistenceStep * refinement.options().epsilon);
  const int steps = 1 + std::max(0, static_cast<int>(std::ceil(std::log(most / least) / std::log(kPersistenceStep))));
  Ladder ladder(refinement, nodes, least, steps, progress);
  const std::vector<int> first = ladder.firstJoined();
  for (Index s = 0; s < nodes.count(); ++s) {
    if (first[s] < steps) result[s] = ladder.epsilon(first[s]);
  }
  return result;
}

}  // namespace stormfield
