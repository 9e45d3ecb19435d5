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
/// A part of a set that is slower than the whole by more than this factor goes on with a tau of its own.
constexpr double kSlower = 0.5;

void checkTau(const std::optional<double>& tau, const char* name) {
  if (!tau || (*tau > 0.0 && std::isfinite(*tau))) return;
  throw InputError(message(name, " is ", *tau, "; it must be a positive number"));
}

/// The strongly connected components of the faces of some sets, by edges within each set.
struct LocalParts {
  std::vector<Index> faces;  ///< ascending
  Components components;     ///< of the places in faces
};

LocalParts splitSets(const FaceSets& sets, const std::vector<Index>& chosen,
                     const std::vector<std::vector<Index>>& rows) {
  LocalParts parts;
  for (const Index set : chosen)
    parts.faces.insert(parts.faces.end(), sets.members(set).begin(), sets.members(set).end());
  std::sort(parts.faces.begin(), parts.faces.end());
  std::vector<Index> place(sets.setOf().size(), kNone);
  for (std::size_t i = 0; i < parts.faces.size(); ++i) place[parts.faces[i]] = static_cast<Index>(i);
  DirectedGraph graph;
  for (const Index f : parts.faces) {
    for (const Index target : rows[f]) {
      const bool inside = target < static_cast<Index>(place.size()) && sets.setOf(target) == sets.setOf(f);
      if (inside) graph.targets.push_back(place[target]);
    }
    graph.offsets.push_back(graph.targets.size());
  }
  parts.components = stronglyConnectedComponents(graph);
  return parts;
}

}  // namespace

double refinementPriority(const ConleyIndex& index, std::size_t faceCount) {
  constexpr ConleyIndex kBasic[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}};
  int distance = std::numeric_limits<int>::max();
  for (const ConleyIndex& basic : kBasic) {
    distance = std::min(distance,
                        std::abs(index.b0 - basic.b0) + std::abs(index.b1 - basic.b1) + std::abs(index.b2 - basic.b2));
  }
  return (1.0 + distance) * static_cast<double>(faceCount);
}

MorseRefinement::MorseRefinement(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field,
                                 const RefinementOptions& options)
    : faces_(std::move(faces)),
      field_(std::move(field)),
      options_(options),
      flow_(std::make_shared<const PreparedFlow>(*faces_, *field_, options.map.unit, options.map.tolerance)),
      poincare_(poincareIndices(*field_)),
      resting_(fixedPointFaces(*field_)) {
  checkTau(options.tauMin, "tauMin");
  checkTau(options.tauMax, "tauMax");
  const CombinatorialMap coarse = geometryMap(*field_);
  rows_.resize(coarse.outside());
  taus_.assign(coarse.outside(), 0.0);
  for (Index f = 0; f < coarse.outside(); ++f) rows_[f].assign(coarse.graph.begin(f), coarse.graph.end(f));
  order_ = stronglyConnectedComponents(coarse.graph).of;
  Progress silent;
  MorseOptions morseOptions;
  morseOptions.resting = resting_;
  MorseDecomposition start = morseDecomposition(*field_, coarse, morseOptions, silent);
  sets_ = std::move(start.faces);
  indices_ = std::move(start.sets);
  for (Index set = 0; set < sets_.count(); ++set) trials_.push_back({0.0, edgeTau(sets_.members(set)), 0, false, {}});
}

CombinatorialMap MorseRefinement::map() const {
  return mapFromRows(rows_);
}

/// The time, or length, to cross an edge of these faces; infinite where the field is zero.
double MorseRefinement::edgeTau(const std::vector<Index>& faces) const {
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

/// Always the last tau doubled, or doubled again: what is outside a set at a tau stays outside at its multiples.
double MorseRefinement::nextTau(const Trial& trial) const {
  const double least = options_.tauMin.value_or(options_.edgesMin * trial.scale);
  if (trial.tau == 0.0 || !std::isfinite(least)) return least;
  double tau = 2.0 * trial.tau;
  while (tau < kSlower * least) tau *= 2.0;
  return tau;
}

double MorseRefinement::lastTau(const Trial& trial) const {
  return options_.tauMax.value_or(options_.edgesMax * trial.scale);
}

bool MorseRefinement::isOpen(Index set) const {
  const Trial& trial = trials_[set];
  const double tau = nextTau(trial);
  return !trial.done && std::isfinite(tau) && tau <= lastTau(trial) && priority(set) > options_.leastPriority;
}

double MorseRefinement::priority(Index set) const {
  return refinementPriority(indices_[set].index, sets_.members(set).size());
}

/// The sets of the next round, ascending; none when all are done.
std::vector<Index> MorseRefinement::chooseSets() const {
  std::vector<std::pair<double, Index>> open;
  for (Index s = 0; s < sets_.count(); ++s) {
    if (isOpen(s)) open.emplace_back(-priority(s), s);
  }
  std::sort(open.begin(), open.end());
  std::vector<Index> chosen;
  for (const auto& [p, s] : open) {
    const bool most = -p * kRound >= -open.front().first;
    if (most && steps_ + static_cast<Index>(chosen.size()) < options_.maxSteps) chosen.push_back(s);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

RefinementStop MorseRefinement::refine(Progress* progress) {
  const Deadline deadline(options_.maximalSeconds, progress);
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
      return RefinementStop::Memory;  // all that rows complain about
    }
  }
}

bool MorseRefinement::round(Progress* progress) {
  const std::vector<Index> chosen = chooseSets();
  if (chosen.empty()) return false;
  if (progress != nullptr) progress->range(doneFraction(), 1.0);
  refineAll(chosen, progress);
  return true;
}

bool MorseRefinement::refineSet(Index set, Progress* progress) {
  if (set < 0 || set >= sets_.count()) {
    throw InputError(message("there is no Morse set ", set, "; choose one from 0 to ", sets_.count() - 1));
  }
  const MorseRefinement before = *this;
  try {
    // As long as the set stays as it is, it keeps its number.
    while (std::isfinite(nextTau(trials_[set])) && nextTau(trials_[set]) <= lastTau(trials_[set])) {
      if (refineAll({set}, progress).front() != 0) return true;
    }
  } catch (const Cancelled&) {
    *this = before;
    throw;
  }
  return false;
}

/// How far the sets have come between the first tau and the last, by faces.
double MorseRefinement::doneFraction() const {
  double done = 0.0, all = 1e-300;
  for (Index s = 0; s < sets_.count(); ++s) {
    const auto size = static_cast<double>(sets_.members(s).size());
    const Trial& trial = trials_[s];
    all += size;
    if (!isOpen(s)) {
      done += size;
    } else if (trial.tau > 0.0) {
      const double first = 0.5 * nextTau({0.0, trial.scale, 0, false, {}});
      done += size * std::clamp(std::log2(trial.tau / first) / std::log2(lastTau(trial) / first), 0.0, 1.0);
    }
  }
  return std::min(0.99, done / all);
}

/// The sets that images at the next tau are followed in.
SetWindows MorseRefinement::windowsOf(Index set) const {
  const Trial& trial = trials_[set];
  const double tau = nextTau(trial);
  SetWindows windows;
  windows.memoryLimit = options_.map.memoryLimit.value_or(halfOfMemory());
  windows.steps = flow_->stepCount(tau);
  for (int level = 1; level < windows.steps; level *= 2) {
    SharedFaces faces;
    for (const Ancestor& ancestor : trial.ancestors) {
      if (ancestor.tau <= 1.001 * tau * level / windows.steps) faces = ancestor.faces;
    }
    windows.levels.push_back(faces);
  }
  return windows;
}

/// One step for each of the chosen sets; whether each of them changed. All or nothing.
std::vector<char> MorseRefinement::refineAll(const std::vector<Index>& chosen, Progress* progress) {
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
        computed[i] = tauRowsWithinSet(*flow_, sets_.members(s), nextTau(trials_[s]), windowsOf(s), progress, &work[i]);
      },
      tbb::simple_partitioner());

  std::vector<std::vector<Index>> seen(rows_.size());  // rows without those of smaller tau
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::vector<Index>& members = sets_.members(chosen[i]);
    const auto& [offsets, targets] = computed[i];
    for (std::size_t k = 0; k < members.size(); ++k) {
      seen[members[k]].assign(targets.data() + offsets[k], targets.data() + offsets[k + 1]);
      rows_[members[k]] = rowAfter(members[k], seen[members[k]]);
      taus_[members[k]] = nextTau(trials_[chosen[i]]);
    }
    work_.traces += work[i].traces;
  }
  for (const Index s : chosen) trials_[s].tau = nextTau(trials_[s]);
  steps_ += static_cast<Index>(chosen.size());
  return replace(chosen, std::move(seen));
}

/// The row of a face of a set at its next tau: what stays in the set is new. What leads out of it stays, or, at the
/// first tau, is what comes after the set in the geometry-based map.
std::vector<Index> MorseRefinement::rowAfter(Index face, const std::vector<Index>& seen) const {
  const auto stays = [&](Index target) {
    return target != faces_->mesh().faceCount() && sets_.setOf(target) == sets_.setOf(face);
  };
  const bool first = taus_[face] == 0.0;
  std::vector<Index> row;
  for (const Index target : seen) {
    if (stays(target) || (first && order_[target] < order_[face])) row.push_back(target);
  }
  if (first) return row;
  const auto middle = static_cast<std::ptrdiff_t>(row.size());
  std::copy_if(rows_[face].begin(), rows_[face].end(), std::back_inserter(row), [&](Index t) { return !stays(t); });
  std::inplace_merge(row.begin(), row.begin() + middle, row.end());
  return row;
}

/// Puts the components of the chosen sets in their place; whether each of them changed.
std::vector<char> MorseRefinement::replace(const std::vector<Index>& chosen, std::vector<std::vector<Index>> seen) {
  const auto faceCount = static_cast<std::size_t>(faces_->mesh().faceCount());
  const LocalParts parts = splitSets(sets_, chosen, rows_);
  std::vector<Index> number(parts.components.count(), kNone), setOf(faceCount, kNone), parent;
  for (std::size_t i = 0; i < parts.faces.size(); ++i) {
    const Index component = parts.components.of[i];
    if (parts.components.recurrent[component] == 0) continue;
    if (number[component] == kNone) {
      number[component] = static_cast<Index>(parent.size());
      parent.push_back(sets_.setOf(parts.faces[i]));
    }
    setOf[parts.faces[i]] = number[component];
  }
  const FaceSets fresh(std::move(setOf), static_cast<Index>(parent.size()));
  const std::vector<char> recurs = canRecur(faces_->mesh(), fresh, resting_);

  std::vector<char> mapped(faceCount, 0);
  for (const Index f : parts.faces) mapped[f] = 1;
  const CombinatorialMap map = mapFromRows(seen);

  struct Kept {
    const FaceSets* from;
    Index set;
    MorseSet index;
    Trial trial;
  };
  std::vector<Kept> kept;
  for (Index s = 0; s < sets_.count(); ++s) {
    if (!std::binary_search(chosen.begin(), chosen.end(), s)) kept.push_back({&sets_, s, indices_[s], trials_[s]});
  }
  std::vector<char> changed(chosen.size(), 1);
  for (Index s = 0; s < fresh.count(); ++s) {
    if (recurs[s] == 0) continue;
    Trial trial = trials_[parent[s]];
    const bool same = fresh.members(s).size() == sets_.members(parent[s]).size();
    trial.scale = edgeTau(fresh.members(s));
    trial.unchanged = same ? trial.unchanged + 1 : 0;
    trial.done = trial.unchanged >= options_.patience;
    trial.ancestors.push_back({trial.tau, std::make_shared<const std::vector<Index>>(fresh.members(s))});
    if (same) changed[std::lower_bound(chosen.begin(), chosen.end(), parent[s]) - chosen.begin()] = 0;
    kept.push_back({&fresh, s, morseSet(*field_, map, poincare_, mapped, fresh, s), trial});
  }
  std::sort(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) {
    return a.from->members(a.set).front() < b.from->members(b.set).front();
  });

  std::vector<Index> all(faceCount, kNone);
  std::vector<MorseSet> indices;
  std::vector<Trial> trials;
  for (const Kept& k : kept) {
    for (const Index f : k.from->members(k.set)) all[f] = static_cast<Index>(indices.size());
    indices.push_back(k.index);
    trials.push_back(k.trial);
  }
  sets_ = FaceSets(std::move(all), static_cast<Index>(indices.size()));
  indices_ = std::move(indices);
  trials_ = std::move(trials);
  return changed;
}

}  // namespace stormfield
