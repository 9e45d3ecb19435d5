#include "morse/transit_persistence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "maps/error_bound.h"

namespace stormfield {
namespace {

/// The first step, in largest epsilons, unless the refinement's own epsilon is larger.
constexpr double kFirstStep = 1e-6;
/// The last step exceeds the largest epsilon at which anything changes by this factor.
constexpr double kMargin = 1.1;

/// Per set the component that holds it.
using ComponentOf = std::vector<Index>;

/// Tries epsilons, numbered as steps by a factor of kPersistenceStep.
class EpsilonSteps {
 public:
  EpsilonSteps(const TransitRefinement& refinement, const NodeSets& nodes, double first, int count, Progress& progress)
      : refinement_(refinement), nodes_(nodes), first_(first), count_(count), progress_(progress) {}

  double epsilon(int step) const { return first_ * std::pow(kPersistenceStep, step); }

  /// Per set the first step at which it has merged with another, or count where it never does.
  std::vector<int> firstMerged() {
    ComponentOf apart(nodes_.count());
    for (Index s = 0; s < nodes_.count(); ++s) apart[s] = s;
    std::vector<int> first(nodes_.count(), count_);
    bisect(-1, apart, count_ - 1, at(count_ - 1), first);
    return first;
  }

 private:
  ComponentOf at(int step) {
    progress_.report(static_cast<double>(tried_++) / count_);
    progress_.check();
    const TransitRefinement bounded = refinement_.withinEpsilon(epsilon(step), &progress_);
    std::vector<Index> setOf(bounded.map().outside(), kNone);
    for (std::size_t s = 0; s < bounded.sets().size(); ++s) {
      for (const Index node : bounded.sets()[s]) setOf[node] = static_cast<Index>(s);
    }
    ComponentOf result(nodes_.count());
    for (Index s = 0; s < nodes_.count(); ++s) result[s] = setOf[nodes_.members(s).front()];
    return result;
  }

  /// Per set whether it shares its component.
  static std::vector<char> isMerged(const ComponentOf& componentOf) {
    std::map<Index, int> sizes;
    for (const Index component : componentOf) ++sizes[component];
    std::vector<char> result(componentOf.size());
    std::transform(componentOf.begin(), componentOf.end(), result.begin(),
                   [&](Index component) { return sizes[component] > 1 ? 1 : 0; });
    return result;
  }

  /// Finds the first step of the sets that have merged at the step `high` but not at `low`.
  void bisect(int low, const ComponentOf& atLow, int high, const ComponentOf& atHigh, std::vector<int>& first) {
    const std::vector<char> before = isMerged(atLow), after = isMerged(atHigh);
    if (before == after) return;
    if (high == low + 1) {
      for (std::size_t s = 0; s < first.size(); ++s) {
        if (after[s] != 0 && before[s] == 0) first[s] = high;
      }
      return;
    }
    const int middle = low + (high - low) / 2;
    const ComponentOf atMiddle = at(middle);
    bisect(low, atLow, middle, atMiddle, first);
    bisect(middle, atMiddle, high, atHigh, first);
  }

  const TransitRefinement& refinement_;
  const NodeSets& nodes_;
  double first_;
  int count_, tried_ = 0;
  Progress& progress_;
};

/// An epsilon at which every face with an error holds a fixed point of some field within it.
double maxEpsilon(const VectorField& field, const std::vector<double>& weights) {
  double result = 0.0;
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    const double weight = weights.empty() ? 1.0 : weights[v];
    if (weight > 0.0) result = std::max(result, std::abs(field.values[v]) / weight);
  }
  return kMargin * result;
}

}  // namespace

std::vector<double> transitPersistence(const TransitRefinement& refinement, const NodeSets& nodes, Progress& progress) {
  std::vector<double> result(nodes.count(), std::numeric_limits<double>::infinity());
  const double last = maxEpsilon(refinement.field(), refinement.options().weights);
  if (nodes.count() < 2 || !(last > 0.0) || !std::isfinite(last)) return result;
  const double first = std::max(kFirstStep * last, kPersistenceStep * refinement.options().epsilon);
  const int count = 1 + std::max(0, static_cast<int>(std::ceil(std::log(last / first) / std::log(kPersistenceStep))));
  EpsilonSteps steps(refinement, nodes, first, count, progress);
  const std::vector<int> merged = steps.firstMerged();
  for (Index s = 0; s < nodes.count(); ++s) {
    if (merged[s] < count) result[s] = steps.epsilon(merged[s]);
  }
  return result;
}

}  // namespace stormfield
