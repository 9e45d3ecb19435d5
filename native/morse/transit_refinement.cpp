#include "morse/transit_refinement.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/memory_limit.h"
#include "base/message.h"
#include "morse/detail/deadline.h"
#include "morse/recurrence.h"

namespace stormfield {
namespace {

/// A set that keeps this part of its pieces and more after all of them were halved has lost hardly any.
constexpr double kHardlyAny = 0.9;
/// Levels beyond the last: for sets of so few nodes, which cost little (rings around weak spirals), and by hand.
constexpr int kSmallSet = 500, kLevelsOfSmall = 6, kLevelsByHand = 4;
/// Memory per node, of the map and the graph.
constexpr std::size_t kBytesPerNode = 200;

/// Of each of so many nodes the set that it is in, or kNone.
std::vector<Index> setOfNodes(const std::vector<std::vector<Index>>& sets, Index count) {
  std::vector<Index> result(count, kNone);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    for (const Index node : sets[s]) result[node] = static_cast<Index>(s);
  }
  return result;
}

/// The members of the recurrent components, ascending; components by their first members.
std::vector<std::vector<Index>> recurrentMembers(const Components& components, const std::vector<Index>& nodes) {
  std::vector<Index> number(components.count(), kNone);
  std::vector<std::vector<Index>> result;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Index component = components.of[i];
    if (components.recurrent[component] == 0) continue;
    if (number[component] == kNone) {
      number[component] = static_cast<Index>(result.size());
      result.emplace_back();
    }
    result[number[component]].push_back(nodes[i]);
  }
  for (std::vector<Index>& members : result) std::sort(members.begin(), members.end());
  std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.front() < b.front(); });
  return result;
}

/// The faces that each set meets: those of its fixed points, and those that it flows through from piece to piece.
std::vector<std::vector<Index>> facesMet(const TransitMap& map, const CombinatorialMap& graph, const NodeSets& nodes) {
  std::vector<std::vector<Index>> result(nodes.count());
  for (Index s = 0; s < nodes.count(); ++s) {
    std::vector<Index>& faces = result[s];
    for (const Index node : nodes.members(s)) {
      const bool goesOn = std::any_of(graph.graph.begin(node), graph.graph.end(node), [&](Index target) {
        return target < static_cast<Index>(nodes.setOf().size()) && nodes.setOf(target) == s;
      });
      if (goesOn) map.appendFaces(node, faces);
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  }
  return result;
}

/// Parts the faces among the sets that meet them.
FaceSets partFaces(const TransitMap& map, const NodeSets& nodes, const std::vector<std::vector<Index>>& covers) {
  const Index faceCount = map.mesh().faceCount();
  std::vector<Index> setOf(faceCount, kNone), bySize(covers.size());
  std::iota(bySize.begin(), bySize.end(), 0);
  std::stable_sort(bySize.begin(), bySize.end(), [&](Index a, Index b) { return covers[a].size() < covers[b].size(); });
  for (Index f = 0; f < faceCount; ++f) setOf[f] = nodes.setOf(f);  // whose node of rest it holds
  for (const Index s : bySize) {
    for (const Index f : covers[s]) {
      if (setOf[f] == kNone) setOf[f] = s;
    }
  }
  return {std::move(setOf), nodes.count()};
}

/// Whether sets can hold recurrence (recurrence.h): those with a fixed point, and those whose faces go around
/// something.
std::vector<char> canRecur(const TransitMap& map, const std::vector<std::vector<Index>>& members,
                           const std::vector<std::vector<Index>>& covers) {
  std::vector<char> result(members.size(), 0);
  std::vector<Index> left;
  for (std::size_t s = 0; s < members.size(); ++s) {
    result[s] = map.isPiece(members[s].front()) ? 0 : 1;  // nodes of rest come first
    if (result[s] == 0) left.push_back(static_cast<Index>(s));
  }
  // All that are apart from each other at a time.
  while (!left.empty()) {
    std::vector<Index> setOf(map.mesh().faceCount(), kNone), now, later;
    for (const Index s : left) {
      const bool apart = std::all_of(covers[s].begin(), covers[s].end(), [&](Index f) { return setOf[f] == kNone; });
      if (!apart) {
        later.push_back(s);
        continue;
      }
      for (const Index f : covers[s]) setOf[f] = static_cast<Index>(now.size());
      now.push_back(s);
    }
    const FaceSets sets(std::move(setOf), static_cast<Index>(now.size()));
    const std::vector<char> recurs = canRecur(map.mesh(), sets, map.fixedPointFaces());
    for (std::size_t i = 0; i < now.size(); ++i) result[now[i]] = recurs[i];
    left = std::move(later);
  }
  return result;
}

bool isAtBoundary(const TriangleMesh& mesh, Index f) {
  return mesh.twin(3 * f) == kNone || mesh.twin(3 * f + 1) == kNone || mesh.twin(3 * f + 2) == kNone;
}

std::shared_ptr<const ConeTransit> conesOf(const std::shared_ptr<const FlatFaces>& faces,
                                           const std::shared_ptr<const VectorField>& field,
                                           const TransitOptions& options) {
  if (options.epsilon == 0.0) return nullptr;
  return std::make_shared<const ConeTransit>(faces, field, options.epsilon, options.weights);
}

}  // namespace

TransitRefinement::TransitRefinement(const std::shared_ptr<const FlatFaces>& faces,
                                     const std::shared_ptr<const VectorField>& field, const TransitOptions& options,
                                     Progress* progress)
    : faces_(faces),
      field_(field),
      options_(options),
      cones_(conesOf(faces, field, options)),
      map_(faces, field, progress, cones_) {
  findSets(progress);
}

TransitRefinement TransitRefinement::within(double epsilon, Progress* progress) const {
  TransitRefinement result = *this;
  if (epsilon == options_.epsilon) return result;
  result.options_.epsilon = epsilon;
  result.cones_ = cones_ ? std::make_shared<const ConeTransit>(cones_->withinEpsilon(epsilon))
                         : std::make_shared<const ConeTransit>(faces_, field_, epsilon, options_.weights);
  result.map_ = map_.withinEpsilon(result.cones_);
  result.findSets(progress);
  return result;
}

void TransitRefinement::findSets(Progress* progress) {
  std::vector<Index> nodes(map_.outside());
  std::iota(nodes.begin(), nodes.end(), 0);
  nodes_ = recurrentMembers(stronglyConnectedComponents(map_.graphAmong(nodes, progress)), nodes);
  trials_.assign(nodes_.size(), {});
  ways_.clear();
  level_ = 0;
}

int TransitRefinement::levelsOf(Index set) const {
  return options_.levels + (nodes_[set].size() <= kSmallSet ? kLevelsOfSmall : 0);
}

bool TransitRefinement::isOpen(Index set, int levels) const {
  if (trials_[set].done) return false;
  return std::any_of(nodes_[set].begin(), nodes_[set].end(), [&](Index node) { return isOpenPiece(node, levels); });
}

bool TransitRefinement::isOpenPiece(Index node, int levels) const {
  return !map_.isSettled(node) && map_.piece(node).level < levels;
}

bool TransitRefinement::fits() const {
  return kBytesPerNode * static_cast<std::size_t>(map_.outside()) < options_.memoryLimit.value_or(halfOfMemory()) / 2;
}

RefinementStop TransitRefinement::refine(Progress* progress) {
  const Deadline deadline(options_.maximalSeconds, progress);
  Progress* const watched = deadline.progress();
  while (true) {
    if (progress != nullptr && progress->cancelled()) return RefinementStop::Cancelled;
    if (deadline.isOver()) return RefinementStop::Time;
    if (!fits()) return RefinementStop::Memory;
    try {
      if (!round(watched)) return RefinementStop::Done;
    } catch (const Cancelled&) {
      const bool byCaller = progress != nullptr && progress->cancelled();
      return byCaller ? RefinementStop::Cancelled : RefinementStop::Time;
    }
  }
}

bool TransitRefinement::round(Progress* progress) {
  std::vector<Index> chosen;
  for (Index s = 0; s < static_cast<Index>(nodes_.size()); ++s) {
    if (trials_[s].halved || isOpen(s, levelsOf(s))) chosen.push_back(s);
  }
  if (chosen.empty()) return refineWays(progress);
  if (progress != nullptr) progress->report(std::min(1.0, static_cast<double>(level_) / options_.levels));
  refineSets(chosen, 0, progress);
  ++level_;
  return true;
}

bool TransitRefinement::refineNodes(const std::vector<Index>& nodes, Progress* progress) {
  const auto setsOf = [&] {
    std::vector<Index> chosen;
    for (Index s = 0; s < static_cast<Index>(nodes_.size()); ++s) {
      const bool holds = std::any_of(nodes.begin(), nodes.end(), [&](Index node) {
        return std::binary_search(nodes_[s].begin(), nodes_[s].end(), node);
      });
      if (holds) chosen.push_back(s);
    }
    return chosen;
  };
  while (true) {
    std::vector<Index> chosen;
    for (const Index s : setsOf()) {
      trials_[s].done = false;
      if (isOpen(s, levelsOf(s) + kLevelsByHand)) chosen.push_back(s);
    }
    if (chosen.empty() || !fits()) return false;
    if (refineSets(chosen, kLevelsByHand, progress)) return true;
  }
}

/// Halves the pieces of some sets and finds what they split into; whether one lost more pieces than halving explains,
/// or came apart.
bool TransitRefinement::refineSets(const std::vector<Index>& chosen, int more, Progress* progress) {
  std::vector<Index> pieces, owner;
  for (const Index s : chosen) {
    if (trials_[s].halved) continue;
    const int levels = levelsOf(s) + more;
    for (const Index node : nodes_[s]) {
      if (!isOpenPiece(node, levels)) continue;
      pieces.push_back(node);
      owner.push_back(s);
    }
  }
  ways_.clear();
  // The outside node moves on; nothing keeps it.
  const Index before = map_.outside();
  const std::vector<std::size_t> halved = map_.halve(pieces, progress);
  for (std::size_t i = 0; i < halved.size(); ++i) {
    nodes_[owner[halved[i]]].push_back(before + static_cast<Index>(i));
  }
  for (const Index s : chosen) trials_[s].halved = true;

  std::vector<Index> members, setOf(map_.outside(), kNone);
  for (const Index s : chosen) {
    for (const Index node : nodes_[s]) setOf[node] = s;
  }
  map_.eachNode([&](Index node) {
    if (setOf[node] != kNone) members.push_back(node);
  });
  std::vector<std::vector<Index>> parts =
      recurrentMembers(stronglyConnectedComponents(map_.graphAmong(members, progress)), members);

  bool changed = false;
  std::vector<std::vector<Index>> kept;
  std::vector<Trial> trials;
  for (Index s = 0; s < static_cast<Index>(nodes_.size()); ++s) {
    if (std::binary_search(chosen.begin(), chosen.end(), s)) continue;
    kept.push_back(std::move(nodes_[s]));
    trials.push_back(trials_[s]);
  }
  for (std::vector<Index>& part : parts) {
    const Index parent = setOf[part.front()];
    const bool hardlyAny = static_cast<double>(part.size()) >= kHardlyAny * static_cast<double>(nodes_[parent].size());
    changed = changed || !hardlyAny;
    Trial trial;
    trial.kept = hardlyAny ? trials_[parent].kept + 1 : 0;
    trial.done = trial.kept >= options_.patience;
    kept.push_back(std::move(part));
    trials.push_back(trial);
  }
  nodes_ = std::move(kept);
  trials_ = std::move(trials);
  return changed || parts.empty();
}

/// Halves the pieces on ways from one set that flow passes through to another; false when nothing is left. Sources and
/// sinks do not matter here: their ways fill the surface.
bool TransitRefinement::refineWays(Progress* progress) {
  const std::vector<Index> setOf = setOfNodes(nodes_, map_.outside());
  std::vector<Index> nodes;
  std::vector<char> isOnWay(map_.outside(), ways_.empty() ? 1 : 0);
  for (const Index node : ways_) isOnWay[node] = 1;
  map_.eachNode([&](Index node) {
    if (isOnWay[node] != 0) nodes.push_back(node);
  });
  const DirectedGraph graph = map_.graphAmong(nodes, progress);

  std::vector<char> leads(nodes_.size(), ways_.empty() ? 0 : 1), isLedTo = leads;
  for (Index i = 0; i < graph.nodeCount(); ++i) {
    const Index from = setOf[nodes[i]];
    for (const Index* t = graph.begin(i); t != graph.end(i); ++t) {
      const Index to = setOf[nodes[*t]];
      if (from == to) continue;
      if (from != kNone) leads[from] = 1;
      if (to != kNone) isLedTo[to] = 1;
    }
  }
  const auto isPassed = [&](Index node) {
    const Index s = setOf[node];
    return s != kNone && leads[s] != 0 && isLedTo[s] != 0;
  };
  std::vector<Index> passed;
  for (Index i = 0; i < graph.nodeCount(); ++i) {
    if (isPassed(nodes[i])) passed.push_back(i);
  }
  const std::vector<char> after = reachable(graph, passed), before = reachable(reversed(graph), passed);

  std::vector<Index> between, pieces;
  const std::size_t all = nodes.size();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Index node = nodes[i];
    if (after[i] == 0 || before[i] == 0) continue;
    between.push_back(node);
    if (setOf[node] == kNone && isOpenPiece(node, options_.levels)) pieces.push_back(node);
  }
  // An error bound widens the ways, which smaller pieces then do not narrow.
  const bool narrows = ways_.empty() || static_cast<double>(between.size()) < kHardlyAny * static_cast<double>(all);
  if (options_.epsilon > 0.0 && !narrows) return false;
  const Index halves = map_.outside();
  map_.halve(pieces, progress);
  for (Index node = halves; node < map_.outside(); ++node) between.push_back(node);
  ways_ = std::move(between);
  return !pieces.empty();
}

TransitDecomposition TransitRefinement::decomposition(bool keepEmpty, bool keepTrivial, Progress& progress) const {
  TransitDecomposition result;
  result.map = map_.map(&progress);
  const DirectedGraph& graph = result.map.graph;
  const Components components = stronglyConnectedComponents(graph);
  progress.check();
  std::vector<char> leads(components.count(), 0), isLedTo(components.count(), 0);
  for (Index node = 0; node < graph.nodeCount(); ++node) {
    const Index from = components.of[node];
    for (const Index* t = graph.begin(node); t != graph.end(node); ++t) {
      const Index to = components.of[*t];
      if (from != to) leads[from] = isLedTo[to] = 1;
    }
  }
  std::vector<Index> nodes(map_.outside());
  std::iota(nodes.begin(), nodes.end(), 0);
  std::vector<std::vector<Index>> members = recurrentMembers(components, nodes);
  const auto setsOf = [&] {
    return NodeSets(setOfNodes(members, graph.nodeCount()), static_cast<Index>(members.size()));
  };
  std::vector<std::vector<Index>> covers = facesMet(map_, result.map, setsOf());
  progress.check();

  // Sets that count, with their indices, by their first faces.
  const std::vector<char> recurs = keepEmpty ? std::vector<char>(members.size(), 1) : canRecur(map_, members, covers);
  std::vector<MorseSet> found(members.size());
  std::vector<Index> order;
  for (std::size_t s = 0; s < members.size(); ++s) {
    const Index component = components.of[members[s].front()];
    MorseSet& set = found[s];
    for (const Index node : members[s]) {
      if (map_.isPiece(node)) continue;
      set.poincare += map_.faceTransit().poincare()[node];
      set.upperBound = set.upperBound || (options_.epsilon > 0.0 && isAtBoundary(map_.mesh(), node));
    }
    const int b0 = leads[component] == 0 ? 1 : 0, b2 = isLedTo[component] == 0 ? 1 : 0;
    set.index = agreeing({b0, std::max(0, b0 + b2 - set.poincare), b2}, set.poincare);
    set.kind = kindOf(set.index);
    if (recurs[s] != 0 && (keepTrivial || set.kind != MorseKind::Trivial)) order.push_back(static_cast<Index>(s));
  }
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return covers[a].front() < covers[b].front(); });
  std::vector<std::vector<Index>> chosenMembers;
  for (const Index s : order) {
    chosenMembers.push_back(std::move(members[s]));
    result.morse.covers.push_back(std::move(covers[s]));
    result.morse.sets.push_back(found[s]);
  }
  members = std::move(chosenMembers);
  result.nodes = setsOf();
  result.morse.faces = partFaces(map_, result.nodes, result.morse.covers);
  result.morse.mapEdges = graph.edgeCount();
  result.morse.graph = morseConnectionGraph(result.map, components, result.nodes);
  progress.report(1.0);
  return result;
}

}  // namespace stormfield
