#include "topology/detail/streamline_search.h"

#include <algorithm>
#include <cmath>

namespace stormfield {
namespace {

/// Steps inside one face after which a streamline is taken to stay there.
constexpr int kMaxIdleSteps = 5000;
constexpr int kStepsPerCheck = 1024;

}  // namespace

void StreamlineSearch::trace(CrossingTrace trace, const KnownLimitSets& limitSets,
                             const std::vector<Index>& componentOf, Index maxSteps, const Progress* progress) {
  const FlatFaces& faces = trace.faces();
  state_ = State::Going;
  bool first = true;
  int sinceCheck = 0, idleSteps = 0;
  const TraceEnd traced = trace.run(at_, [&](const SurfacePoint& p, double time, const EdgePassage& passage) {
    at_ = p;
    if (progress != nullptr && ++sinceCheck % kStepsPerCheck == 0) progress->check();
    if (going_.faces.empty() || going_.faces.back() != p.face) going_.faces.push_back(p.face);
    if (seed_.keepsPoints && (!first || going_.points.empty())) {
      going_.points.push_back(p);
      going_.times.push_back(time_ + time);
    }
    // A resumed streamline has been tested at this point when it came here.
    const bool resumed = first && crossings_ > 0;
    first = false;
    if (resumed) return true;
    if (const EntityRef node = limitSets.fixedPointTrapping(faces, p, seed_.direction); node.kind != EntityKind::None) {
      endIn({node});
      return false;
    }
    if (!staysInComponent(componentOf[p.face]) || ++steps_ >= maxSteps) {
      endIn({});
      return false;
    }
    if (!passage) {
      if (++idleSteps <= kMaxIdleSteps) return true;
      endIn({limitSets.centerIn(p.face)});
      return false;
    }
    idleSteps = 0;
    return continuesAfter(passage, limitSets, time_ + time);
  });
  time_ += traced.time;
  going_.length += traced.length;
  if (traced.reason == StopReason::Boundary) endIn({{EntityKind::Boundary, kNone}});
  if (traced.reason == StopReason::MinSpeed) endIn({limitSets.fixedPointNear(at_)});
  if (traced.reason == StopReason::StepLimit) endIn({});
}

bool StreamlineSearch::staysInComponent(Index component) {
  if (component == component_) return true;
  if (seed_.component && component != *seed_.component) return false;
  component_ = component;
  visits_.clear();
  return true;
}

bool StreamlineSearch::continuesAfter(const EdgePassage& passage, const KnownLimitSets& limitSets, double time) {
  ++crossings_;
  if (const auto orbit = limitSets.orbitReachedFrom(passage, seed_.direction)) {
    endIn(*orbit);
    return false;
  }
  return component_ == kNone || !hasReturned(limitSets, passage, time);
}

/// Counts the crossing; true where the halfedge has been crossed as often as is required of a candidate.
bool StreamlineSearch::hasReturned(const KnownLimitSets& limitSets, const EdgePassage& passage, double time) {
  if (passage.halfedge == kNone) return false;
  Visits& visits = visits_[passage.halfedge];
  // Back and forth across an edge in no time is no return.
  if (time <= visits.time) return false;
  visits.time = time;
  const bool often = visits.count + 1 >= returnsRequired_;
  if (often) setCandidate(limitSets, passage, visits);
  visits.fractions[visits.count % Visits::kKept] = passage.fraction;
  visits.numbers[visits.count % Visits::kKept] = crossings_;
  ++visits.count;
  return often;
}

/// On a sphere with holes a streamline comes nearer at each return, by Jordan's curve theorem; around handles it can
/// wind several times before it does, and the nearest earlier crossing counts.
void StreamlineSearch::setCandidate(const KnownLimitSets& limitSets, const EdgePassage& passage, const Visits& visits) {
  const int kept = std::min<Index>(visits.count, Visits::kKept);
  const int maxLoops = limitSets.hasHandles() ? kept : 1;
  int loops = 0;
  double nearest = 2.0;  // more than any distance along an edge
  for (int back = 1; back <= maxLoops; ++back) {
    const double distance = std::abs(visits.fractions[(visits.count - back) % Visits::kKept] - passage.fraction);
    if (distance < nearest) {
      nearest = distance;
      loops = back;
    }
  }
  const Index before = visits.numbers[(visits.count - loops) % Visits::kKept];
  candidate_ = {passage.halfedge, passage.fraction, loops, crossings_ - before, seed_.direction, component_};
  state_ = State::Returned;
}

}  // namespace stormfield
