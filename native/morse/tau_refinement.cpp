#include "morse/tau_refinement.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "base/memory_limit.h"
#include "base/message.h"
#include "field/poincare_index.h"
#include "maps/fixed_point_faces.h"
#include "maps/geometry_map.h"
#include "maps/tau_rows.h"
#include "morse/detail/deadline.h"
#include "morse/recurrence.h"

namespace stormfield {
namespace {

/// Sets whose priority is within this factor of the highest are refined in the same round.
constexpr double kRound = 16.0;
/// The next tau of a set is at least this fraction of the first tau by its own mean speed: flow in a component may be
/// much slower than in the set that it came from.
constexpr double kOfFirstTau = 0.5;

void checkTau(const std::optional<double>& tau, const char* name) {
  if (!tau || (*tau > 0.0 && std::isfinite(*tau))) return;
  throw InputError(message(name, " is ", *tau, "; it must be a positive number"));
}

/// The strongly connected components of the faces of some sets, by edges within each set.
struct SetComponents {
  std::vector<Index> faces;  ///< of all these sets, ascending
  Components components;     ///< of the places in faces
};

SetComponents componentsOf(const FaceSets& sets, const std::vector<Index>& chosen,
                           const std::vector<std::vector<Index>>& rows) {
  SetComponents result;
  for (const Index set : chosen) {
    result.faces.insert(result.faces.end(), sets.members(set).begin(), sets.members(set).end());
  }
  std::sort(result.faces.begin(), result.faces.end());
  std::vector<Index> place(sets.setOf().size(), kNone);
  for (std::size_t i = 0; i < result.faces.size(); ++i) place[result.faces[i]] = static_cast<Index>(i);
  DirectedGraph graph;
  for (const Index f : result.faces) {
    for (const Index target : rows[f]) {
      const bool inside = target < static_cast<Index>(place.size()) && sets.setOf(target) == sets.setOf(f);
      if (inside) graph.targets.push_back(place[target]);
    }
    graph.offsets.push_back(graph.targets.size());
  }
  result.components = stronglyConnectedComponents(graph);
  return result;
}

}  // namespace

double refinementPriority(const ConleyIndex& index, std::size_t faceCount) {
  constexpr ConleyIndex kSimple[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}};
  int distance = std::numeric_limits<int>::max();
  for (const ConleyIndex& simple : kSimple) {
    distance = std::min(
        distance, std::abs(index.b0 - simple.b0) + std::abs(index.b1 - simple.b1) + std::abs(index.b2 - simple.b2));
  }
  return (1.0 + distance) * static_cast<double>(faceCount);
}

TauRefinement::TauRefinement(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
                             const TauRefinementOptions& options)
    : faces_(std::move(faces)),
      field_(std::move(field)),
      options_(options),
      flow_(std::make_shared<const PreparedFlow>(*faces_, *field_, options.map.unit, options.map.tolerance)),
      poincare_(poincareIndices(*field_)),
      fixedPointFaces_(fixedPointFaces(*field_)) {
  checkTau(options.tauMin, "tauMin");
  checkTau(options.tauMax, "tauMax");
  const CombinatorialMap coarse = geometryMap(*field_);
  rows_.resize(coarse.outside());
  taus_.assign(coarse.outside(), 0.0);
  for (Index f = 0; f < coarse.outside(); ++f) rows_[f].assign(coarse.graph.begin(f), coarse.graph.end(f));
  order_ = stronglyConnectedComponents(coarse.graph).of;
  Progress silent;
  MorseOptions morseOptions;
  morseOptions.fixedPointFaces = fixedPointFaces_;
  MorseDecomposition start = morseDecomposition(*field_, coarse, morseOptions, silent);
  sets_ = std::move(start.faces);
  indices_ = std::move(start.sets);
  for (Index set = 0; set < sets_.count(); ++set) states_.push_back({0.0, edgeTau(sets_.members(set)), 0, false, {}});
}

CombinatorialMap TauRefinement::map() const {
  return mapFromRows(rows_);
}

/// The time, or length, to cross an edge of these faces; infinite where the field is zero.
double TauRefinement::edgeTau(const std::vector<Index>& faces) const {
  const TriangleMesh& mesh = faces_->mesh();
  double length = 0.0, speed = 0.0;
  for (const Index f : faces) {
    for (int i = 0; i < 3; ++i) {
      length += mesh.edgeLength(mesh.edge(TriangleMesh::halfedge(f, i)));
      speed += std::abs(field_->values[mesh.vertex(f, i)]);
    }
  }
  if (!(speed > 0.0)) return std::numeric_limits<double>::infinity();
  return options_.map.unit == TauUnit::Length ? length / (3.0 * static_cast<double>(faces.size())) : length / speed;
}

/// The last tau doubled, or doubled again: what is outside a set at a tau stays outside at its multiples.
double TauRefinement::nextTau(const SetState& state) const {
  const double least = options_.tauMin.value_or(options_.edgesMin * state.scale);
  if (state.tau == 0.0 || !std::isfinite(least)) return least;
  double tau = 2.0 * state.tau;
  while (tau < kOfFirstTau * least) tau *= 2.0;
  return tau;
}

double TauRefinement::lastTau(const SetState& state) const {
  return options_.tauMax.value_or(options_.edgesMax * state.scale);
}

bool TauRefinement::canBeRefined(Index set) const {
  const SetState& state = states_[set];
  const double tau = nextTau(state);
  return !state.done && std::isfinite(tau) && tau <= lastTau(state) && priority(set) > options_.minPriority;
}

double TauRefinement::priority(Index set) const {
  return refinementPriority(indices_[set].index, sets_.members(set).size());
}

/// The sets of the next round, ascending; none when all are done.
std::vector<Index> TauRefinement::chooseSets() const {
  std::vector<std::pair<double, Index>> open;
  for (Index s = 0; s < sets_.count(); ++s) {
    if (canBeRefined(s)) open.emplace_back(-priority(s), s);
  }
  std::sort(open.begin(), open.end());
  std::vector<Index> chosen;
  for (const auto& [p, s] : open) {
    const bool isHigh = -p * kRound >= -open.front().first;
    if (isHigh && steps_ + static_cast<Index>(chosen.size()) < options_.maxSteps) chosen.push_back(s);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

RefinementStop TauRefinement::refine(Progress* progress) {
  const Deadline deadline(options_.maxSeconds, progress);
  Progress* const watched = deadline.progress();
  while (true) {
    if (progress != nullptr && progress->cancelled()) return RefinementStop::Cancelled;
    if (steps_ >= options_.maxSteps) return RefinementStop::Steps;
    if (deadline.isOver()) return RefinementStop::Time;
    try {
      if (!round(watched)) return RefinementStop::Done;
    } catch (const Cancelled&) {
      const bool byCaller = progress != nullptr && progress->cancelled();
      return byCaller ? RefinementStop::Cancelled : RefinementStop::Time;
    } catch (const InputError&) {
      return RefinementStop::Memory;  // rows have no other fault than that they do not fit
    }
  }
}

bool TauRefinement::round(Progress* progress) {
  const std::vector<Index> chosen = chooseSets();
  if (chosen.empty()) return false;
  if (progress != nullptr) progress->range(fractionDone(), 1.0);
  refineAll(chosen, progress);
  return true;
}

bool TauRefinement::refineSet(Index set, Progress* progress) {
  if (set < 0 || set >= sets_.count()) {
    throw InputError(message("there is no Morse set ", set, "; choose one from 0 to ", sets_.count() - 1));
  }
  const TauRefinement before = *this;
  try {
    // As long as the set stays as it is, it keeps its number.
    while (std::isfinite(nextTau(states_[set])) && nextTau(states_[set]) <= lastTau(states_[set])) {
      if (refineAll({set}, progress).front() != 0) return true;
    }
  } catch (const Cancelled&) {
    *this = before;
    throw;
  }
  return false;
}

/// Mean over the faces of how far their tau has come from the first to the last, by doublings.
double TauRefinement::fractionDone() const {
  double done = 0.0, all = 1e-300;
  for (Index s = 0; s < sets_.count(); ++s) {
    const auto size = static_cast<double>(sets_.members(s).size());
    const SetState& state = states_[s];
    all += size;
    if (!canBeRefined(s)) {
      done += size;
    } else if (state.tau > 0.0) {
      const double first = 0.5 * nextTau({0.0, state.scale, 0, false, {}});
      done += size * std::clamp(std::log2(state.tau / first) / std::log2(lastTau(state) / first), 0.0, 1.0);
    }
  }
  return std::min(0.99, done / all);
}

/// The sets that images at the next tau are followed in: the ancestors of the set at the taus before.
SetWindows TauRefinement::windowsOf(Index set) const {
  const SetState& state = states_[set];
  const double tau = nextTau(state);
  SetWindows windows;
  windows.memoryLimit = options_.map.memoryLimit.value_or(halfOfMemory());
  windows.steps = flow_->stepCount(tau);
  for (int level = 1; level < windows.steps; level *= 2) {
    SharedFaces faces;
    for (const Ancestor& ancestor : state.ancestors) {
      if (ancestor.tau <= 1.001 * tau * level / windows.steps) faces = ancestor.faces;
    }
    windows.levels.push_back(faces);
  }
  return windows;
}

/// One step for each of the chosen sets; per set whether it changed. Where it throws, nothing has changed.
std::vector<char> TauRefinement::refineAll(const std::vector<Index>& chosen, Progress* progress) {
  std::vector<TauRows> computed(chosen.size());
  std::vector<TauWork> work(chosen.size());
  std::vector<std::size_t> bySize(chosen.size());
  std::iota(bySize.begin(), bySize.end(), std::size_t{0});
  std::sort(bySize.begin(), bySize.end(), [&](std::size_t a, std::size_t b) {
    return sets_.members(chosen[a]).size() > sets_.members(chosen[b]).size();
  });
  tbb::parallel_for(
      std::size_t{0}, chosen.size(),
      [&](std::size_t place) {
        const std::size_t i = bySize[place];
        const Index s = chosen[i];
        computed[i] = tauRowsWithinSet(*flow_, sets_.members(s), nextTau(states_[s]), windowsOf(s), progress, &work[i]);
      },
      tbb::simple_partitioner());

  std::vector<std::vector<Index>> newRows(rows_.size());  // without the edges of smaller tau
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::vector<Index>& members = sets_.members(chosen[i]);
    const auto& [offsets, targets] = computed[i];
    for (std::size_t k = 0; k < members.size(); ++k) {
      newRows[members[k]].assign(targets.data() + offsets[k], targets.data() + offsets[k + 1]);
      rows_[members[k]] = mergedRow(members[k], newRows[members[k]]);
      taus_[members[k]] = nextTau(states_[chosen[i]]);
    }
    work_.traces += work[i].traces;
  }
  for (const Index s : chosen) states_[s].tau = nextTau(states_[s]);
  steps_ += static_cast<Index>(chosen.size());
  return replaceByComponents(chosen, newRows);
}

/// The row of a face of a set after a step: the new edges within the set, and the old ones that lead out of it. At the
/// first tau these are the new ones to what comes after the set in the geometry-based map.
std::vector<Index> TauRefinement::mergedRow(Index face, const std::vector<Index>& newRow) const {
  const auto stays = [&](Index target) {
    return target != faces_->mesh().faceCount() && sets_.setOf(target) == sets_.setOf(face);
  };
  const bool first = taus_[face] == 0.0;
  std::vector<Index> row;
  for (const Index target : newRow) {
    if (stays(target) || (first && order_[target] < order_[face])) row.push_back(target);
  }
  if (first) return row;
  const auto middle = static_cast<std::ptrdiff_t>(row.size());
  std::copy_if(rows_[face].begin(), rows_[face].end(), std::back_inserter(row), [&](Index t) { return !stays(t); });
  std::inplace_merge(row.begin(), row.begin() + middle, row.end());
  return row;
}

/// Replaces the chosen sets by their components; per set whether it changed. newRows: of the step, from which
/// the exit sets of the components follow.
std::vector<char> TauRefinement::replaceByComponents(const std::vector<Index>& chosen,
                                                     const std::vector<std::vector<Index>>& newRows) {
  const auto faceCount = static_cast<std::size_t>(faces_->mesh().faceCount());
  const SetComponents split = componentsOf(sets_, chosen, rows_);
  std::vector<Index> number(split.components.count(), kNone), setOf(faceCount, kNone), parent;
  for (std::size_t i = 0; i < split.faces.size(); ++i) {
    const Index component = split.components.of[i];
    if (split.components.recurrent[component] == 0) continue;
    if (number[component] == kNone) {
      number[component] = static_cast<Index>(parent.size());
      parent.push_back(sets_.setOf(split.faces[i]));
    }
    setOf[split.faces[i]] = number[component];
  }
  const FaceSets fresh(std::move(setOf), static_cast<Index>(parent.size()));
  const std::vector<char> recurs = canRecur(faces_->mesh(), fresh, fixedPointFaces_);

  std::vector<char> mapped(faceCount, 0);
  for (const Index f : split.faces) mapped[f] = 1;
  const CombinatorialMap map = mapFromRows(newRows);

  struct Kept {
    const FaceSets* from;
    Index set;
    MorseSet index;
    SetState state;
  };
  std::vector<Kept> kept;
  for (Index s = 0; s < sets_.count(); ++s) {
    if (!std::binary_search(chosen.begin(), chosen.end(), s)) kept.push_back({&sets_, s, indices_[s], states_[s]});
  }
  std::vector<char> changed(chosen.size(), 1);
  for (Index s = 0; s < fresh.count(); ++s) {
    if (recurs[s] == 0) continue;
    SetState state = states_[parent[s]];
    const bool same = fresh.members(s).size() == sets_.members(parent[s]).size();
    state.scale = edgeTau(fresh.members(s));
    state.unchanged = same ? state.unchanged + 1 : 0;
    state.done = state.unchanged >= options_.patience;
    state.ancestors.push_back({state.tau, std::make_shared<const std::vector<Index>>(fresh.members(s))});
    if (same) changed[std::lower_bound(chosen.begin(), chosen.end(), parent[s]) - chosen.begin()] = 0;
    kept.push_back({&fresh, s, morseSet(*field_, map, poincare_, mapped, fresh, s), state});
  }
  std::sort(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) {
    return a.from->members(a.set).front() < b.from->members(b.set).front();
  });

  std::vector<Index> all(faceCount, kNone);
  std::vector<MorseSet> indices;
  std::vector<SetState> states;
  for (const Kept& k : kept) {
    for (const Index f : k.from->members(k.set)) all[f] = static_cast<Index>(indices.size());
    indices.push_back(k.index);
    states.push_back(k.state);
  }
  sets_ = FaceSets(std::move(all), static_cast<Index>(indices.size()));
  indices_ = std::move(indices);
  states_ = std::move(states);
  return changed;
}

}  // namespace stormfield
