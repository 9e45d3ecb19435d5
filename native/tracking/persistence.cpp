#include "tracking/persistence.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/message.h"
#include "tracking/detail/samples.h"

namespace stormfield {
namespace {

void check(const char* what, double value) {
  if (value >= 0.0 && std::isfinite(value)) return;
  throw InputError(message("the ", what, " is ", value, "; choose one from 0"));
}

/// Mean of two paths' quantities over both lives.
double shared(double a, double lifeA, double b, double lifeB) {
  return lifeA + lifeB > 0.0 ? (a * lifeA + b * lifeB) / (lifeA + lifeB) : a;
}

class Cancellation {
 public:
  explicit Cancellation(Tracking tracking)
      : tracking_(std::move(tracking)),
        appears_(tracking_.paths.size(), kNone),
        vanishes_(tracking_.paths.size(), kNone),
        turns_(tracking_.paths.size()),
        owner_(tracking_.paths.size()),
        goneEvents_(tracking_.bifurcations.size(), 0) {
    for (Index i = 0; i < static_cast<Index>(tracking_.paths.size()); ++i) {
      owner_[i] = i;
      byLife_.insert({life(i), i});
    }
    for (Index e = 0; e < static_cast<Index>(tracking_.bifurcations.size()); ++e) {
      const Bifurcation& event = tracking_.bifurcations[e];
      if (event.kind == BifurcationKind::Hopf) {
        turns_[event.paths[0]].push_back(e);
        continue;
      }
      for (const Index path : event.paths) {
        (event.kind == BifurcationKind::Creation ? appears_ : vanishes_)[path] = e;
      }
    }
  }

  void run(double minLife) {
    while (!byLife_.empty() && byLife_.begin()->first < minLife) takeOut(byLife_.begin()->second);
  }

  Tracking result(double minStrength) {
    std::vector<Index> number(tracking_.paths.size(), kNone);
    std::vector<char> alive(tracking_.paths.size(), 0);
    for (const auto& [life, path] : byLife_) alive[path] = 1;
    Tracking left;
    for (std::size_t i = 0; i < alive.size(); ++i) {
      if (!alive[i] || tracking_.paths[i].strength < minStrength) continue;
      number[i] = static_cast<Index>(left.paths.size());
      left.paths.push_back(std::move(tracking_.paths[i]));
      left.paths.back().kind = mostly(left.paths.back().samples);
    }
    for (std::size_t e = 0; e < goneEvents_.size(); ++e) {
      if (goneEvents_[e]) continue;
      Bifurcation event = tracking_.bifurcations[e];
      for (Index& path : event.paths) path = path == kNone ? kNone : number[ownerOf(path)];
      if (event.paths[0] != kNone || event.paths[1] != kNone) left.bifurcations.push_back(event);
    }
    return left;
  }

 private:
  TrackedPath& path(Index i) { return tracking_.paths[i]; }
  double life(Index i) const { return tracking_.paths[i].life(); }
  Index ownerOf(Index i) const {
    while (owner_[i] != i) i = owner_[i];
    return i;
  }
  /// The path that meets this one at the event, or kNone.
  Index other(Index event, Index i) const {
    if (event == kNone) return kNone;
    const auto& paths = tracking_.bifurcations[event].paths;
    return ownerOf(ownerOf(paths[0]) == i ? paths[1] : paths[0]);
  }

  void remove(Index i) { byLife_.erase({life(i), i}); }
  void forget(Index event) {
    if (event != kNone) goneEvents_[event] = 1;
  }
  /// Cuts the path down to lambda in between, with its Hopf bifurcations.
  void keep(Index i, double from, double to) {
    auto& samples = path(i).samples;
    const auto end =
        std::find_if(samples.rbegin(), samples.rend(), [=](const PathSample& s) { return s.lambda <= to; });
    samples.erase(end.base(), samples.end());
    const auto begin =
        std::find_if(samples.begin(), samples.end(), [=](const PathSample& s) { return s.lambda >= from; });
    samples.erase(samples.begin(), begin);
    for (const Index event : turns_[i]) {
      const double lambda = tracking_.bifurcations[event].lambda;
      if (lambda < from || lambda > to) forget(event);
    }
  }

  void takeOut(Index i) {
    const Index before = other(vanishes_[i], i), after = other(appears_[i], i);
    remove(i);
    forget(vanishes_[i]);
    forget(appears_[i]);
    // Its life is the shortest, so the neighbours reach at least as far as it does.
    const PathSample first = path(i).samples.front(), last = path(i).samples.back();
    if (before == after || (before != kNone && path(i).begin == PathEnd::Range) ||
        (after != kNone && path(i).end == PathEnd::Range)) {
      drop(before != kNone ? before : after);
    } else if (after == kNone) {
      endAtBoundary(before, first);
    } else if (before == kNone) {
      beginAtBoundary(after, last);
    } else {
      join(before, after, first.lambda, last.lambda);
    }
  }

  /// The other half of a pair that goes. It may have turned back at the first or the last lambda itself.
  void drop(Index i) {
    if (i == kNone) return;
    remove(i);
    if (const Index more = other(liveEvent(appears_[i]), i); more != kNone) {
      path(more).begin = PathEnd::Range;
      appears_[more] = kNone;
    }
    if (const Index more = other(liveEvent(vanishes_[i]), i); more != kNone) {
      path(more).end = PathEnd::Range;
      vanishes_[more] = kNone;
    }
    forget(appears_[i]);
    forget(vanishes_[i]);
  }
  Index liveEvent(Index event) const { return event == kNone || goneEvents_[event] ? kNone : event; }

  void endAtBoundary(Index i, const PathSample& end) {
    remove(i);
    keep(i, 0.0, end.lambda);
    path(i).samples.push_back(end);
    path(i).end = PathEnd::Boundary;
    vanishes_[i] = kNone;
    insert(i);
  }
  void beginAtBoundary(Index i, const PathSample& begin) {
    remove(i);
    keep(i, begin.lambda, 1.0);
    path(i).samples.insert(path(i).samples.begin(), begin);
    path(i).begin = PathEnd::Boundary;
    appears_[i] = kNone;
    insert(i);
  }

  /// One path of both, with the chord over the fold between the two values of lambda.
  void join(Index before, Index after, double foldBegin, double foldEnd) {
    remove(before);
    remove(after);
    TrackedPath &kept = path(before), &rest = path(after);
    kept.strength = shared(kept.strength, kept.life(), rest.strength, rest.life());
    kept.rotation = shared(kept.rotation, kept.life(), rest.rotation, rest.life());
    keep(before, 0.0, foldBegin);
    keep(after, foldEnd, 1.0);
    turns_[before].insert(turns_[before].end(), turns_[after].begin(), turns_[after].end());
    kept.samples.insert(kept.samples.end(), rest.samples.begin(), rest.samples.end());
    kept.end = rest.end;
    vanishes_[before] = vanishes_[after];
    owner_[after] = before;
    insert(before);
  }

  void insert(Index i) { byLife_.insert({life(i), i}); }

  Tracking tracking_;
  std::vector<Index> appears_, vanishes_;  ///< event where a path appears, vanishes
  std::vector<std::vector<Index>> turns_;  ///< its Hopf bifurcations
  std::vector<Index> owner_;               ///< path that a joined one became part of
  std::vector<char> goneEvents_;
  std::set<std::pair<double, Index>> byLife_;
};

}  // namespace

Tracking persistent(const Tracking& tracking, const PersistenceOptions& options) {
  check("shortest life", options.minLife);
  check("least strength", options.minStrength);
  Cancellation cancellation(tracking);
  cancellation.run(options.minLife);
  return cancellation.result(options.minStrength);
}

}  // namespace stormfield
