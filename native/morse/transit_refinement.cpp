#include "morse/transit_refinement.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "base/memory_limit.h"
#include "base/message.h"
#include "morse/detail/deadline.h"
#include "morse/recurrence.h"

namespace stormfield {
namespace {

/// A set of nodes that keeps this fraction of them or more after its pieces were halved has lost hardly any.
constexpr double kHardlyAny = 0.9;
/// Sets of at most so many nodes (rings around weak spirals) cost little and go so many levels beyond the last.
constexpr int kSmallSet = 500, kLevelsOfSmall = 6;
/// Sets that are refined by hand go so many levels beyond the last.
constexpr int kLevelsByHand = 4;
/// Estimated bytes per node, of the map and the graph.
constexpr std::size_t kBytesPerNode = 200;

bool hardlyLess(std::size_t after, std::size_t before) {
  return static_cast<double>(after) >= kHardlyAny * static_cast<double>(before);
}

/// Per node, of so many, the set that it is in, or kNone.
std::vector<Index> setOfNodes(const std::vector<std::vector<Index>>& sets, Index count) {
  std::vector<Index> result(count, kNone);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    for (const Index node : sets[s]) result[node] = static_cast<Index>(s);
  }
  return result;
}

/// The nodes of the recurrent components, ascending; components by their first nodes. components: of the places in
/// nodes.
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

/// The faces that each set meets: those of its fixed points, and those that a piece of it enters and leads on from.
std::vector<std::vector<Index>> facesMet(const TransitMap& map, const CombinatorialMap& graph, const NodeSets& nodes) {
  std::vector<std::vector<Index>> result(nodes.count());
  for (Index s = 0; s < nodes.count(); ++s) {
    std::vector<Index>& faces = result[s];
    for (const Index node : nodes.members(s)) {
      const bool leadsOn = std::any_of(graph.graph.begin(node), graph.graph.end(node), [&](Index target) {
        return target < static_cast<Index>(nodes.setOf().size()) && nodes.setOf(target) == s;
      });
      if (leadsOn) map.appendFaces(node, faces);
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  }
  return result;
}

/// Gives each face to one of the sets that meet it: to that with its interior node, else to the smallest.
FaceSets assignFaces(const TransitMap& map, const NodeSets& nodes, const std::vector<std::vector<Index>>& facesMet) {
  const Index faceCount = map.mesh().faceCount();
  std::vector<Index> setOf(faceCount, kNone), bySize(facesMet.size());
  std::iota(bySize.begin(), bySize.end(), 0);
  std::stable_sort(bySize.begin(), bySize.end(),
                   [&](Index a, Index b) { return facesMet[a].size() < facesMet[b].size(); });
  for (Index f = 0; f < faceCount; ++f) setOf[f] = nodes.setOf(f);
  for (const Index s : bySize) {
    for (const Index f : facesMet[s]) {
      if (setOf[f] == kNone) setOf[f] = s;
    }
  }
  return {std::move(setOf), nodes.count()};
}

/// Per set whether it can hold recurrence (recurrence.h): with a fixed point, or with essential curves in the faces
/// that it meets. Sets may meet the same faces, so that as many as do not are looked at together.
std::vector<char> setsThatRecur(const TransitMap& map, const std::vector<std::vector<Index>>& members,
                                const std::vector<std::vector<Index>>& facesMet) {
  std::vector<char> result(members.size(), 0);
  std::vector<Index> left;
  for (std::size_t s = 0; s < members.size(); ++s) {
    result[s] = map.isPiece(members[s].front()) ? 0 : 1;  // interior nodes, of fixed points, have the lowest numbers
    if (result[s] == 0) left.push_back(static_cast<Index>(s));
  }
  while (!left.empty()) {
    std::vector<Index> setOf(map.mesh().faceCount(), kNone), now, later;
    for (const Index s : left) {
      const bool isApart =
          std::all_of(facesMet[s].begin(), facesMet[s].end(), [&](Index f) { return setOf[f] == kNone; });
      if (!isApart) {
        later.push_back(s);
        continue;
      }
      for (const Index f : facesMet[s]) setOf[f] = static_cast<Index>(now.size());
      now.push_back(s);
    }
    const FaceSets sets(std::move(setOf), static_cast<Index>(now.size()));
    const std::vector<char> recurs = canRecur(map.mesh(), sets, map.fixedPointFaces());
    for (std::size_t i = 0; i < now.size(); ++i) result[now[i]] = recurs[i];
    left = std::move(later);
  }
  return result;
}

/// Per component whether edges lead from it to others, and from others to it.
struct ComponentOrder {
  std::vector<char> hasSuccessor, hasPredecessor;

  ComponentOrder(const DirectedGraph& graph, const Components& components)
      : hasSuccessor(components.count(), 0), hasPredecessor(hasSuccessor) {
    for (Index node = 0; node < graph.nodeCount(); ++node) {
      const Index from = components.of[node];
      for (const Index* t = graph.begin(node); t != graph.end(node); ++t) {
        const Index to = components.of[*t];
        if (from != to) hasSuccessor[from] = hasPredecessor[to] = 1;
      }
    }
  }
};

bool hasBoundaryEdge(const TriangleMesh& mesh, Index f) {
  return mesh.twin(3 * f) == kNone || mesh.twin(3 * f + 1) == kNone || mesh.twin(3 * f + 2) == kNone;
}

std::shared_ptr<const ConeTransit> conesOf(const std::shared_ptr<const FlatFaces>& faces,
                                           const std::shared_ptr<const VectorField>& field,
                                           const TransitRefinementOptions& options) {
  if (options.epsilon == 0.0) return nullptr;
  return std::make_shared<const ConeTransit>(faces, field, options.epsilon, options.weights);
}

}  // namespace

TransitRefinement::TransitRefinement(const std::shared_ptr<const FlatFaces>& faces,
                                     const std::shared_ptr<const VectorField>& field,
                                     const TransitRefinementOptions& options, Progress* progress)
    : faces_(faces),
      field_(field),
      options_(options),
      cones_(conesOf(faces, field, options)),
      map_(faces, field, progress, cones_) {
  findSets(progress);
}

TransitRefinement TransitRefinement::withinEpsilon(double epsilon, Progress* progress) const {
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
  states_.assign(nodes_.size(), {});
  connecting_.reset();
  level_ = 0;
}

int TransitRefinement::maxLevelOf(Index set) const {
  return options_.maxLevel + (nodes_[set].size() <= kSmallSet ? kLevelsOfSmall : 0);
}

bool TransitRefinement::canBeRefined(Index set, int maxLevel) const {
  if (states_[set].done) return false;
  return std::any_of(nodes_[set].begin(), nodes_[set].end(), [&](Index node) { return canBeHalved(node, maxLevel); });
}

bool TransitRefinement::canBeHalved(Index node, int maxLevel) const {
  return !map_.isSettled(node) && map_.piece(node).level < maxLevel;
}

bool TransitRefinement::fitsIntoMemory() const {
  return kBytesPerNode * static_cast<std::size_t>(map_.outside()) < options_.memoryLimit.value_or(halfOfMemory()) / 2;
}

RefinementStop TransitRefinement::refine(Progress* progress) {
  const Deadline deadline(options_.maxSeconds, progress);
  Progress* const watched = deadline.progress();
  while (true) {
    if (progress != nullptr && progress->cancelled()) return RefinementStop::Cancelled;
    if (deadline.isOver()) return RefinementStop::Time;
    if (!fitsIntoMemory()) return RefinementStop::Memory;
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
    if (states_[s].halved || canBeRefined(s, maxLevelOf(s))) chosen.push_back(s);
  }
  if (chosen.empty()) return refineConnections(progress);
  if (progress != nullptr) progress->report(std::min(1.0, static_cast<double>(level_) / options_.maxLevel));
  refineSets(chosen, 0, progress);
  ++level_;
  return true;
}

bool TransitRefinement::refineNodes(const std::vector<Index>& nodes, Progress* progress) {
  const auto holdsSome = [&](const std::vector<Index>& set) {
    return std::any_of(nodes.begin(), nodes.end(),
                       [&](Index node) { return std::binary_search(set.begin(), set.end(), node); });
  };
  while (true) {
    std::vector<Index> chosen;
    for (Index s = 0; s < static_cast<Index>(nodes_.size()); ++s) {
      if (!holdsSome(nodes_[s])) continue;
      states_[s].done = false;
      if (canBeRefined(s, maxLevelOf(s) + kLevelsByHand)) chosen.push_back(s);
    }
    if (chosen.empty() || !fitsIntoMemory()) return false;
    if (refineSets(chosen, kLevelsByHand, progress)) return true;
  }
}

/// Halves the pieces of some sets and replaces these by their components; whether one lost more pieces than halving
/// explains, or all are gone.
bool TransitRefinement::refineSets(const std::vector<Index>& chosen, int furtherLevels, Progress* progress) {
  connecting_.reset();
  halvePiecesOf(chosen, furtherLevels, progress);
  return replaceByComponents(chosen, progress);
}

void TransitRefinement::halvePiecesOf(const std::vector<Index>& chosen, int furtherLevels, Progress* progress) {
  std::vector<Index> pieces, owner;
  for (const Index s : chosen) {
    if (states_[s].halved) continue;
    const int maxLevel = maxLevelOf(s) + furtherLevels;
    for (const Index node : nodes_[s]) {
      if (!canBeHalved(node, maxLevel)) continue;
      pieces.push_back(node);
      owner.push_back(s);
    }
  }
  // The number of the outside node grows; no set has it.
  const Index before = map_.outside();
  const std::vector<std::size_t> halved = map_.halve(pieces, progress);
  for (std::size_t i = 0; i < halved.size(); ++i) {
    nodes_[owner[halved[i]]].push_back(before + static_cast<Index>(i));
  }
  for (const Index s : chosen) states_[s].halved = true;
}

bool TransitRefinement::replaceByComponents(const std::vector<Index>& chosen, Progress* progress) {
  std::vector<Index> nodes, setOf(map_.outside(), kNone);
  for (const Index s : chosen) {
    for (const Index node : nodes_[s]) setOf[node] = s;
  }
  map_.eachNode([&](Index node) {
    if (setOf[node] != kNone) nodes.push_back(node);
  });
  std::vector<std::vector<Index>> components =
      recurrentMembers(stronglyConnectedComponents(map_.graphAmong(nodes, progress)), nodes);

  bool changed = components.empty();
  std::vector<std::vector<Index>> sets;
  std::vector<SetState> states;
  for (Index s = 0; s < static_cast<Index>(nodes_.size()); ++s) {
    if (std::binary_search(chosen.begin(), chosen.end(), s)) continue;
    sets.push_back(std::move(nodes_[s]));
    states.push_back(states_[s]);
  }
  for (std::vector<Index>& component : components) {
    const Index parent = setOf[component.front()];
    const bool unchanged = hardlyLess(component.size(), nodes_[parent].size());
    changed = changed || !unchanged;
    SetState state;
    state.unchanged = unchanged ? states_[parent].unchanged + 1 : 0;
    state.done = state.unchanged >= options_.patience;
    sets.push_back(std::move(component));
    states.push_back(state);
  }
  nodes_ = std::move(sets);
  states_ = std::move(states);
  return changed;
}

/// Halves the pieces on connections through intermediate sets; false when none is left to halve. Sources and sinks are
/// not intermediate: their connections fill the surface.
bool TransitRefinement::refineConnections(Progress* progress) {
  const std::vector<Index> nodes = nodesOfConnections();
  std::vector<Index> through = nodesThroughIntermediateSets(nodes, progress);
  // An error bound widens connections, and smaller pieces then do not narrow them.
  const bool narrows = !connecting_ || !hardlyLess(through.size(), nodes.size());
  if (options_.epsilon > 0.0 && !narrows) return false;

  const std::vector<Index> setOf = setOfNodes(nodes_, map_.outside());
  std::vector<Index> pieces;
  for (const Index node : through) {
    if (setOf[node] == kNone && canBeHalved(node, options_.maxLevel)) pieces.push_back(node);
  }
  const Index halves = map_.outside();
  map_.halve(pieces, progress);
  for (Index node = halves; node < map_.outside(); ++node) through.push_back(node);
  connecting_ = std::move(through);
  return !pieces.empty();
}

/// The nodes that may be on connections, in the order of eachNode: those known from the last round, or all.
std::vector<Index> TransitRefinement::nodesOfConnections() const {
  std::vector<char> isConnecting(map_.outside(), connecting_ ? 0 : 1);
  if (connecting_) {
    for (const Index node : *connecting_) isConnecting[node] = 1;
  }
  std::vector<Index> nodes;
  map_.eachNode([&](Index node) {
    if (isConnecting[node] != 0) nodes.push_back(node);
  });
  return nodes;
}

/// Of these nodes those that an intermediate set leads to, and that lead to one; with the nodes of such sets.
std::vector<Index> TransitRefinement::nodesThroughIntermediateSets(const std::vector<Index>& nodes,
                                                                   Progress* progress) const {
  const std::vector<Index> setOf = setOfNodes(nodes_, map_.outside());
  const DirectedGraph graph = map_.graphAmong(nodes, progress);
  // Of known connections, which lack the nodes before and after them, all sets are intermediate.
  std::vector<char> hasSuccessor(nodes_.size(), connecting_ ? 1 : 0), hasPredecessor = hasSuccessor;
  for (Index i = 0; i < graph.nodeCount(); ++i) {
    const Index from = setOf[nodes[i]];
    for (const Index* t = graph.begin(i); t != graph.end(i); ++t) {
      const Index to = setOf[nodes[*t]];
      if (from == to) continue;
      if (from != kNone) hasSuccessor[from] = 1;
      if (to != kNone) hasPredecessor[to] = 1;
    }
  }
  std::vector<Index> intermediate;
  for (Index i = 0; i < graph.nodeCount(); ++i) {
    const Index s = setOf[nodes[i]];
    if (s != kNone && hasSuccessor[s] != 0 && hasPredecessor[s] != 0) intermediate.push_back(i);
  }
  const std::vector<char> after = reachable(graph, intermediate), before = reachable(reversed(graph), intermediate);
  std::vector<Index> result;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (after[i] != 0 && before[i] != 0) result.push_back(nodes[i]);
  }
  return result;
}

/// Index and kind of a recurrent component with these nodes.
MorseSet TransitRefinement::morseSetOf(const std::vector<Index>& nodes, bool hasPredecessor, bool hasSuccessor) const {
  MorseSet set;
  for (const Index node : nodes) {
    if (map_.isPiece(node)) continue;
    set.poincare += map_.faceTransit().poincare()[node];
    set.upperBound = set.upperBound || (options_.epsilon > 0.0 && hasBoundaryEdge(map_.mesh(), node));
  }
  const int b0 = hasSuccessor ? 0 : 1, b2 = hasPredecessor ? 0 : 1;
  set.index = matchPoincareSum({b0, std::max(0, b0 + b2 - set.poincare), b2}, set.poincare);
  set.kind = kindOf(set.index);
  return set;
}

MorseDecomposition TransitRefinement::decomposition(const CombinatorialMap& map, const KeptSets& kept,
                                                    Progress& progress) const {
  if (map.outside() != map_.outside()) {
    throw InputError(message("the combinatorial map has ", map.outside(), " nodes, but the refinement has ",
                             map_.outside(), "; take its own map"));
  }
  const DirectedGraph& graph = map.graph;
  const Components components = stronglyConnectedComponents(graph);
  progress.check();
  const ComponentOrder order(graph, components);
  std::vector<Index> nodes(map_.outside());
  std::iota(nodes.begin(), nodes.end(), 0);
  std::vector<std::vector<Index>> members = recurrentMembers(components, nodes);
  const auto nodeSets = [&] {
    return NodeSets(setOfNodes(members, graph.nodeCount()), static_cast<Index>(members.size()));
  };
  std::vector<std::vector<Index>> met = facesMet(map_, map, nodeSets());
  progress.check();

  // The sets that are kept, with their indices, by their first faces.
  const std::vector<char> recurs =
      kept.empty ? std::vector<char>(members.size(), 1) : setsThatRecur(map_, members, met);
  std::vector<MorseSet> found;
  std::vector<Index> chosen;
  for (std::size_t s = 0; s < members.size(); ++s) {
    const Index component = components.of[members[s].front()];
    found.push_back(morseSetOf(members[s], order.hasPredecessor[component] != 0, order.hasSuccessor[component] != 0));
    const bool isKept = recurs[s] != 0 && (kept.trivial || found[s].kind != MorseKind::Trivial);
    if (isKept) chosen.push_back(static_cast<Index>(s));
  }
  std::stable_sort(chosen.begin(), chosen.end(), [&](Index a, Index b) { return met[a].front() < met[b].front(); });

  MorseDecomposition result;
  std::vector<std::vector<Index>> keptMembers, keptMet;
  for (const Index s : chosen) {
    keptMembers.push_back(std::move(members[s]));
    keptMet.push_back(std::move(met[s]));
    result.sets.push_back(found[s]);
  }
  members = std::move(keptMembers);
  result.withinFaces = SetsWithinFaces{nodeSets(), std::move(keptMet)};
  result.faces = assignFaces(map_, result.withinFaces->nodes, result.withinFaces->facesMet);
  result.mapEdges = graph.edgeCount();
  result.graph = morseConnectionGraph(map, components, result.withinFaces->nodes);
  progress.report(1.0);
  return result;
}

}  // namespace stormfield
