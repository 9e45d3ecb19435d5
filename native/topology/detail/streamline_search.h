// One streamline of the search for a field's topology: traced until it ends in a limit set or at the boundary, or until
// it returns to an edge often enough to be a candidate for a periodic orbit (thesis 3.1; Wischgoll and Scheuermann
// 2001).
//
// It is traced in rounds: a streamline that has returned stops, its candidate is examined, and then it has ended, or it
// is resumed.
//
//   StreamlineSearch streamline({.point = seed, .direction = Direction::Forward});
//   streamline.trace(trace, limitSets, componentOf, 500000, nullptr);
//   const bool isCandidate = streamline.state() == StreamlineSearch::State::Returned;
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "topology/detail/known_limit_sets.h"

namespace stormfield {

/// Where and how a streamline of the search starts.
struct StreamlineSeed {
  SurfacePoint point;
  Direction direction = Direction::Forward;
  bool keepsPoints = false;             ///< the curve itself is wanted
  std::optional<Index> component = {};  ///< the streamline ends where it leaves this recurrent component
};

/// Where a streamline went.
struct StreamlineCourse {
  std::vector<Index> faces;          ///< in their order
  bool complete = true;              ///< whether no part was skipped
  std::vector<SurfacePoint> points;  ///< where the seed keeps points
  std::vector<double> times;         ///< per point, seconds
  double length = 0.0;               ///< mesh units
};

class StreamlineSearch {
 public:
  enum class State { Going, Returned, Ended };

  explicit StreamlineSearch(const StreamlineSeed& seed) : seed_(seed), at_(seed.point) {}

  /// From where it stands. trace must have its direction; componentOf is the recurrent component of each face.
  /// maxSteps: integration steps after which the streamline ends in nothing known.
  void trace(CrossingTrace trace, const KnownLimitSets& limitSets, const std::vector<Index>& componentOf,
             Index maxSteps, const Progress* progress);

  Direction direction() const { return seed_.direction; }
  State state() const { return state_; }
  const OrbitCandidate& candidate() const { return candidate_; }  ///< where it has Returned
  const StreamlineEnd& end() const { return end_; }               ///< where it has Ended
  const StreamlineSeed& seed() const { return seed_; }
  /// Where it has Ended.
  std::shared_ptr<const StreamlineCourse> course() {
    if (course_ == nullptr) course_ = std::make_shared<const StreamlineCourse>(std::move(going_));
    return course_;
  }

  // What came of its candidate:
  void endIn(const StreamlineEnd& end) {
    end_ = end;
    state_ = State::Ended;
  }
  /// Where it goes is known.
  void endAfter(std::shared_ptr<const StreamlineCourse> course, const StreamlineEnd& end) {
    course_ = std::move(course);
    endIn(end);
  }
  /// No orbit: the streamline becomes a candidate again after twice as many returns.
  void requireMoreReturns() { returnsRequired_ *= 2; }
  /// Deferred: another candidate of this component is examined first.
  void defer() { ++returnsRequired_; }
  /// Continues from a later point of the same slow spiral.
  void restartAt(const SurfacePoint& p) {
    going_.complete = false;
    at_ = p;
    visits_.clear();
    returnsRequired_ = kFirstReturns;
  }

 private:
  static constexpr Index kFirstReturns = 2;

  /// The last crossings of one halfedge.
  struct Visits {
    static constexpr int kKept = 8;
    Index count = 0;
    double time = -1.0;  ///< of the last one, seconds since the start; before any other
    std::array<double, kKept> fractions{};
    std::array<Index, kKept> numbers{};  ///< of the crossing, since the start
  };

  /// Whether the streamline has not left the component it is confined to; notes a change of component.
  bool staysInComponent(Index component);
  /// Whether the trace continues after a crossing.
  bool continuesAfter(const EdgePassage& passage, const KnownLimitSets& limitSets, double time);
  bool hasReturned(const KnownLimitSets& limitSets, const EdgePassage& passage, double time);
  void setCandidate(const KnownLimitSets& limitSets, const EdgePassage& passage, const Visits& visits);

  StreamlineSeed seed_;
  SurfacePoint at_;  ///< where it stands
  State state_ = State::Going;
  StreamlineEnd end_;
  OrbitCandidate candidate_;
  StreamlineCourse going_;  ///< so far
  std::shared_ptr<const StreamlineCourse> course_;
  double time_ = 0.0;
  std::unordered_map<Index, Visits> visits_;  ///< by halfedge, of the component at hand
  Index component_ = kNone, crossings_ = 0, steps_ = 0, returnsRequired_ = kFirstReturns;
};

}  // namespace stormfield
