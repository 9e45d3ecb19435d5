#include "tracking/persistence.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {
namespace {

void check(const char* what, double value) {
  if (value >= 0.0 && std::isfinite(value)) return;
  throw InputError(message("the ", what, " is ", value, "; choose one from 0"));
}

/// Mean of a quantity over the lives of two paths.
double meanOverLives(double a, double lifeA, double b, double lifeB) {
  return lifeA + lifeB > 0.0 ? (a * lifeA + b * lifeB) / (lifeA + lifeB) : a;
}

class Cancellation {
 public:
  explicit Cancellation(Tracking tracking)
      : tracking_(std::move(tracking)),
        creation_(tracking_.paths.size(), kNone),
        annihilation_(tracking_.paths.size(), kNone),
        hopfs_(tracking_.paths.size()),
        owner_(tracking_.paths.size()),
        removedEvents_(tracking_.bifurcations.size(), 0) {
    for (Index i = 0; i < static_cast<Index>(tracking_.paths.size()); ++i) {
      owner_[i] = i;
      byLife_.insert({life(i), i});
    }
    for (Index e = 0; e < static_cast<Index>(tracking_.bifurcations.size()); ++e) {
      const Bifurcation& event = tracking_.bifurcations[e];
      if (event.kind == BifurcationKind::Hopf) {
        hopfs_[event.paths[0]].push_back(e);
        continue;
      }
      for (const Index path : event.paths) {
        (event.kind == BifurcationKind::Creation ? creation_ : annihilation_)[path] = e;
      }
    }
  }

  void removeShorterThan(double minLife) {
    while (!byLife_.empty() && byLife_.begin()->first < minLife) removeShort(byLife_.begin()->second);
  }

  Tracking withStrength(double minStrength) {
    std::vector<Index> number(tracking_.paths.size(), kNone);
    std::vector<char> alive(tracking_.paths.size(), 0);
    for (const auto& [life, path] : byLife_) alive[path] = 1;
    Tracking result;
    for (std::size_t i = 0; i < alive.size(); ++i) {
      if (!alive[i] || tracking_.paths[i].strength < minStrength) continue;
      number[i] = static_cast<Index>(result.paths.size());
      result.paths.push_back(std::move(tracking_.paths[i]));
      result.paths.back().kind = prevailingKind(result.paths.back().samples);
    }
    for (std::size_t e = 0; e < removedEvents_.size(); ++e) {
      if (removedEvents_[e]) continue;
      Bifurcation event = tracking_.bifurcations[e];
      for (Index& path : event.paths) path = path == kNone ? kNone : number[ownerOf(path)];
      if (event.paths[0] != kNone || event.paths[1] != kNone) result.bifurcations.push_back(event);
    }
    return result;
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
  void removeEvent(Index event) {
    if (event != kNone) removedEvents_[event] = 1;
  }
  /// Cuts the path, with its Hopf bifurcations, down to an interval of lambda.
  void cutTo(Index i, double from, double to) {
    auto& samples = path(i).samples;
    const auto end =
        std::find_if(samples.rbegin(), samples.rend(), [=](const PathSample& s) { return s.lambda <= to; });
    samples.erase(end.base(), samples.end());
    const auto begin =
        std::find_if(samples.begin(), samples.end(), [=](const PathSample& s) { return s.lambda >= from; });
    samples.erase(samples.begin(), begin);
    for (const Index event : hopfs_[i]) {
      const double lambda = tracking_.bifurcations[event].lambda;
      if (lambda < from || lambda > to) removeEvent(event);
    }
  }

  void removeShort(Index i) {
    const Index before = other(annihilation_[i], i), after = other(creation_[i], i);
    remove(i);
    removeEvent(annihilation_[i]);
    removeEvent(creation_[i]);
    // Its life is the shortest, so that both neighbours reach over the interval of lambda in which it lives.
    const PathSample first = path(i).samples.front(), last = path(i).samples.back();
    if (before == after || (before != kNone && path(i).begin == PathEnd::Range) ||
        (after != kNone && path(i).end == PathEnd::Range)) {
      removePartner(before != kNone ? before : after);
    } else if (after == kNone) {
      endAtBoundary(before, first);
    } else if (before == kNone) {
      beginAtBoundary(after, last);
    } else {
      join(before, after, first.lambda, last.lambda);
    }
  }

  /// Removes the other path of a pair. A third path that met it at its other end then begins or ends with the range of
  /// lambda.
  void removePartner(Index i) {
    if (i == kNone) return;
    remove(i);
    if (const Index more = other(liveEvent(creation_[i]), i); more != kNone) {
      path(more).begin = PathEnd::Range;
      creation_[more] = kNone;
    }
    if (const Index more = other(liveEvent(annihilation_[i]), i); more != kNone) {
      path(more).end = PathEnd::Range;
      annihilation_[more] = kNone;
    }
    removeEvent(creation_[i]);
    removeEvent(annihilation_[i]);
  }
  Index liveEvent(Index event) const { return event == kNone || removedEvents_[event] ? kNone : event; }

  void endAtBoundary(Index i, const PathSample& end) {
    remove(i);
    cutTo(i, 0.0, end.lambda);
    path(i).samples.push_back(end);
    path(i).end = PathEnd::Boundary;
    annihilation_[i] = kNone;
    insert(i);
  }
  void beginAtBoundary(Index i, const PathSample& begin) {
    remove(i);
    cutTo(i, begin.lambda, 1.0);
    path(i).samples.insert(path(i).samples.begin(), begin);
    path(i).begin = PathEnd::Boundary;
    creation_[i] = kNone;
    insert(i);
  }

  /// One path of both, with the chord over the fold between the two values of lambda.
  void join(Index before, Index after, double foldBegin, double foldEnd) {
    remove(before);
    remove(after);
    TrackedPath &kept = path(before), &next = path(after);
    kept.strength = meanOverLives(kept.strength, kept.life(), next.strength, next.life());
    kept.rotation = meanOverLives(kept.rotation, kept.life(), next.rotation, next.life());
    cutTo(before, 0.0, foldBegin);
    cutTo(after, foldEnd, 1.0);
    hopfs_[before].insert(hopfs_[before].end(), hopfs_[after].begin(), hopfs_[after].end());
    kept.samples.insert(kept.samples.end(), next.samples.begin(), next.samples.end());
    kept.end = next.end;
    annihilation_[before] = annihilation_[after];
    owner_[after] = before;
    insert(before);
  }

  void insert(Index i) { byLife_.insert({life(i), i}); }

  Tracking tracking_;
  std::vector<Index> creation_, annihilation_;  ///< of each path, kNone without
  std::vector<std::vector<Index>> hopfs_;       ///< of each path
  std::vector<Index> owner_;                    ///< path that a joined one continues
  std::vector<char> removedEvents_;
  std::set<std::pair<double, Index>> byLife_;
};

}  // namespace

Tracking persistent(const Tracking& tracking, const PersistenceOptions& options) {
  check("shortest life", options.minLife);
  check("least strength", options.minStrength);
  Cancellation cancellation(tracking);
  cancellation.removeShorterThan(options.minLife);
  return cancellation.withStrength(options.minStrength);
}

}  // namespace stormfield
