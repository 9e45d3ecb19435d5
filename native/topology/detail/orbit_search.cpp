#include "topology/detail/orbit_search.h"

#include <algorithm>
#include <cmath>

#include "field/interpolation.h"

namespace stormfield {
namespace {

// Lengths in mean edge lengths.
constexpr double kClosed = 1e-9;       ///< a streamline that returns within this is the orbit
constexpr double kConverged = 1e-11;   ///< width of the last bracket
constexpr double kMargin = 1e-9;       ///< the search stays this far from the ends of a section
constexpr double kNearLimit = 1e-4;    ///< nearer to the last position that returns, the search is given up
constexpr double kMaxJump = 1e-5;      ///< a return map that jumps by more has no fixed point there
constexpr double kSlow = 0.02;         ///< a displacement so small that loops may be left out
constexpr double kProbeSpacing = 0.1;  ///< orbits farther from each other than this are told apart
constexpr double kFirstProbe = 3e-4;   ///< distances from the orbit at which its sides are examined
constexpr double kLastProbe = 1.0;     ///< and the last of them
constexpr double kBand = 0.5;          ///< distance at which a band of closed streamlines shows
constexpr double kHyperbolic = 0.1;    ///< |log multiplier| beyond which both sides do the same
constexpr double kMinGrowth = 1e-2, kMaxGrowth = 1e2;  ///< between them, growth is measured better than integrated
constexpr int kMaxSecantSteps = 40, kMaxFalsePositionSteps = 80, kMaxSignChangeRounds = 4, kMaxSignChangeProbes = 24;
/// Edges beyond each end of the candidate's edge that belong to its section, and of an orbit's best section.
constexpr int kBeyond = 2, kBeyondBest = 1;

/// Enough for a streamline that needs some more edges than the one that led here.
Index maxCrossings(Index once) {
  return 4 * once + 200;
}

/// The position of a point of one of the section's own halfedges.
double positionOn(const Section& section, Index halfedge, double fraction) {
  const auto own = std::find(section.halfedges().begin(), section.halfedges().end(), halfedge);
  return section.at(static_cast<std::size_t>(own - section.halfedges().begin()), fraction);
}

}  // namespace

OrbitSearch::OrbitSearch(const FlatFaces& faces, const VectorField& field, const std::vector<Index>& componentOf,
                         const OrbitSearchOptions& options)
    : faces_(faces),
      field_(field),
      componentOf_(componentOf),
      options_(options),
      edge_(faces.mesh().meanEdgeLength()),
      forward_(faces, field, Direction::Forward, options.tolerance),
      backward_(faces, field, Direction::Backward, options.tolerance) {}

ReturnMap OrbitSearch::returnMap(Direction direction, const Section& section, int loops, Index component,
                                 Index crossings) const {
  const CrossingTrace& trace = direction == Direction::Forward ? forward_ : backward_;
  return {trace, section, loops, componentOf_, component, maxCrossings(crossings)};
}

std::optional<double> OrbitSearch::displacement(ReturnMap& returns, double position) {
  const auto back = returns(position);
  return back ? std::optional(back->position - position) : std::nullopt;
}

OrbitSearch::Outcome OrbitSearch::findFrom(const OrbitCandidate& candidate,
                                           const std::function<bool(const FoundOrbit&)>& isKnown) const {
  const Section section(field_, candidate.halfedge, kBeyond);
  const double start = positionOn(section, candidate.halfedge, candidate.fraction);
  ReturnMap returns =
      returnMap(candidate.direction, section, candidate.loops, candidate.component, candidate.crossings);
  const Approach result = firstSignChange(returns, start, approach(returns, start));
  if (!result.orbit) {
    if (std::abs(result.reached - start) <= 4.0 * result.maxDisplacement) return {};
    return {std::nullopt, section.point(field_.mesh(), result.reached, candidate.direction)};
  }
  const double orbit = *result.orbit;
  FoundOrbit found;
  found.loops = fewestLoops(returns, orbit);
  found.inBand = result.inBand;
  ReturnMap once = returnMap(candidate.direction, section, found.loops, candidate.component, candidate.crossings);
  if (!record(once, orbit, found)) return {};
  found.foundSide = start < orbit ? OrbitSide::Left : OrbitSide::Right;
  found.foundSection = {section, orbit, std::min(start, orbit), std::max(start, orbit)};
  found.known = isKnown(found);
  if (!found.known) examineSides(candidate, found);
  return {std::move(found), std::nullopt};
}

// The search along the section ---------------------------------------------------------------------------------------

/// From the start in the direction in which the streamline moves, with secant steps that overshoot a little, until the
/// displacement changes its sign. Without handles, return maps grow with the position: an orbit then lies beyond the
/// position to which the streamline itself returns.
OrbitSearch::Approach OrbitSearch::approach(ReturnMap& returns, double start) const {
  const double low = returns.section().low() + kMargin * edge_, high = returns.section().high() - kMargin * edge_;
  const auto first = displacement(returns, start);
  if (!first) return {std::nullopt, start, 0.0, false};
  if (std::abs(*first) <= kClosed * edge_) return {start, start, 0.0, false};
  if (std::abs(*first) <= bandDrift() && neighboursClose(returns, start)) return {start, start, 0.0, true};

  const double sign = *first > 0.0 ? 1.0 : -1.0;
  double limit = sign > 0.0 ? high : low;  // as far as is known, streamlines return up to here
  Sample a{start, *first};
  double next = std::clamp(a.position + a.displacement, low, high);
  Approach result{std::nullopt, start, std::abs(a.displacement), false};
  bool slow = result.maxDisplacement <= kSlow * edge_;
  for (int step = 0; step < kMaxSecantSteps && sign * (limit - a.position - a.displacement) > kNearLimit * edge_;
       ++step) {
    const auto there = displacement(returns, next);
    if (!there) {
      limit = next;
      next = 0.5 * (a.position + next);
      continue;
    }
    const Sample b{next, *there};
    if (sign * b.displacement <= 0.0) {
      result.orbit = falsePosition(returns, a, b);
      return result;
    }
    const double length = secantStep(a, b);
    a = b;
    slow = slow && std::abs(a.displacement) <= kSlow * edge_;
    if (slow) {
      result.reached = a.position;
      result.maxDisplacement = std::max(result.maxDisplacement, std::abs(a.displacement));
    }
    next = sign > 0.0 ? std::min(a.position + length, limit) : std::max(a.position - length, limit);
  }
  return result;
}

double OrbitSearch::bandDrift() const {
  return options_.bandTolerance * kBand * edge_;
}

/// Whether the streamlines half an edge away on both sides return within the tolerance of a band.
bool OrbitSearch::neighboursClose(ReturnMap& returns, double position) const {
  const double low = returns.section().low() + kMargin * edge_, high = returns.section().high() - kMargin * edge_;
  const auto closes = [&](double s) {
    const auto d = s > low && s < high ? displacement(returns, s) : std::nullopt;
    return d && std::abs(*d) <= bandDrift();
  };
  return closes(position + kBand * edge_) && closes(position - kBand * edge_);
}

/// Length of the next step: a quarter beyond the secant's zero where the displacement falls, else three times the last.
double OrbitSearch::secantStep(const Sample& before, const Sample& last) const {
  const double slope = (last.displacement - before.displacement) / (last.position - before.position);
  const double triple = 3.0 * std::abs(last.position - before.position);
  if (!(slope < 0.0)) return triple;
  return std::min(1.25 * std::abs(last.displacement / slope) + 10.0 * kConverged * edge_, 20.0 * triple);
}

/// The approach may have stepped over two orbits at once: short steps from the start find the first sign change.
OrbitSearch::Approach OrbitSearch::firstSignChange(ReturnMap& returns, double start, Approach approach) const {
  for (int round = 0; round < kMaxSignChangeRounds; ++round) {
    const double end = approach.orbit ? *approach.orbit : approach.reached;
    const int probes =
        std::min(kMaxSignChangeProbes, static_cast<int>(std::abs(end - start) / (kProbeSpacing * edge_)) + 1);
    Sample before{start, 0.0};
    bool changed = false;
    for (int i = 0; i < probes && !changed; ++i) {
      const double s = start + (end - start) * i / probes;
      const auto d = displacement(returns, s);
      if (!d) continue;
      if (before.displacement * *d < 0.0) {
        approach.orbit = falsePosition(returns, before, {s, *d});
        changed = true;
      }
      before = {s, *d};
    }
    if (!changed) break;
  }
  return approach;
}

/// The zero of the displacement between a and b by false position with halved weights (the Illinois rule: Dowell and
/// Jarratt 1971); every fourth step bisects.
std::optional<double> OrbitSearch::falsePosition(ReturnMap& returns, Sample a, Sample b) const {
  Sample best = std::abs(a.displacement) < std::abs(b.displacement) ? a : b;
  double weightA = a.displacement, weightB = b.displacement;
  const auto error = [&] { return std::abs(best.displacement); };
  for (int step = 0; step < kMaxFalsePositionSteps && std::abs(b.position - a.position) > kConverged * edge_ &&
                     error() > 0.1 * kClosed * edge_;
       ++step) {
    double s = step % 4 == 3 ? 0.5 * (a.position + b.position)
                             : (a.position * weightB - b.position * weightA) / (weightB - weightA);
    if (!(std::min(a.position, b.position) < s && s < std::max(a.position, b.position))) {
      s = 0.5 * (a.position + b.position);
    }
    const auto d = displacement(returns, s);
    if (!d) return std::nullopt;
    if (std::abs(*d) < error()) best = {s, *d};
    if ((*d > 0.0) == (a.displacement > 0.0)) {
      a = {s, *d};
      weightA = *d;
      weightB *= 0.5;
    } else {
      b = {s, *d};
      weightB = *d;
      weightA *= 0.5;
    }
  }
  return error() <= kMaxJump * edge_ ? std::optional(best.position) : std::nullopt;
}

// The orbit as a curve -----------------------------------------------------------------------------------------------

/// An orbit may close after fewer loops than the streamline that led to it.
int OrbitSearch::fewestLoops(ReturnMap& returns, double position) const {
  if (returns.loops() == 1) return 1;
  int loops = 0;
  std::optional<int> fewest;
  returns.run(position, [&](const SurfacePoint&, double time, const EdgePassage& passage) {
    const auto at = time > 0.0 ? returns.section().at(field_.mesh(), passage) : std::nullopt;
    if (!at) return;
    ++loops;
    if (!fewest && std::abs(*at - position) <= kMaxJump * edge_) fewest = loops;
  });
  return fewest.value_or(returns.loops());
}

bool OrbitSearch::record(ReturnMap& returns, double position, FoundOrbit& found) const {
  PeriodicOrbit& orbit = found.orbit;
  const auto back = returns.run(position, [&](const SurfacePoint& p, double time, const EdgePassage& passage) {
    orbit.points.push_back(p);
    orbit.times.push_back(time);
    if (passage) found.passages.push_back(passage);
  });
  if (!back || std::abs(back->position - position) > options_.bandTolerance * edge_) return false;
  orbit.length = back->length;
  orbit.period = back->time;
  found.crossings = back->crossings;
  // In the order of the trace, before it is turned into the flow's.
  orbit.multiplier = multiplier(orbit);
  orbit.points.back() = orbit.points.front();
  if (returns.direction() == Direction::Backward) {
    std::reverse(orbit.points.begin(), orbit.points.end());
    std::reverse(orbit.times.begin(), orbit.times.end());
    for (double& time : orbit.times) time = orbit.period - time;
  }
  return true;
}

/// Areas along a streamline grow with the divergence of the field (Liouville), and so do distances from a closed one:
/// log m = integral of div V dt (Perko 2001, section 3.4). The divergence of a linear field is constant within a face.
/// The curve must be in the order in which it was traced: each step then lies in the face of the point before it.
double OrbitSearch::multiplier(const PeriodicOrbit& orbit) const {
  const TriangleMesh& mesh = field_.mesh();
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < orbit.points.size(); ++i) {
    const double duration = orbit.times[i + 1] - orbit.times[i];
    if (duration <= 0.0) continue;
    const Index f = orbit.points[i].face;
    const FaceInterpolant local = faceInterpolant(field_, f);
    const Vec3 a = position(mesh, orbit.points[i]), b = position(mesh, orbit.points[i + 1]);
    const auto divergence = [&](double s) {
      const Vec3 between = (1.0 - s) * a + s * b - mesh.point(mesh.vertex(f, 0));
      return local.jacobian(field_.charts->spaceToFace(f, between)).trace();
    };
    // Gauss' rule of two points, on the chord.
    sum += 0.5 * duration * (divergence(0.2113248654) + divergence(0.7886751346));
  }
  return std::exp(sum);
}

// Its sides ----------------------------------------------------------------------------------------------------------

OrbitSection OrbitSearch::widestSection(const std::vector<EdgePassage>& passages) const {
  const EdgePassage* best = nullptr;
  double widest = -1.0;
  for (const EdgePassage& passage : passages) {
    if (passage.halfedge == kNone) continue;
    // The part of the edge that the flow crosses to the left.
    const auto across = acrossEnds(field_, passage.halfedge);
    double low = 0.0, high = 1.0;
    if (across[0] < 0.0) low = across[0] / (across[0] - across[1]);
    if (across[1] < 0.0) high = across[0] / (across[0] - across[1]);
    const double margin = field_.mesh().edgeLength(field_.mesh().edge(passage.halfedge)) *
                          std::min(passage.fraction - low, high - passage.fraction);
    if (margin > widest) {
      widest = margin;
      best = &passage;
    }
  }
  OrbitSection result;
  result.section = Section(field_, best->halfedge, kBeyondBest);
  result.position = *result.section.at(field_.mesh(), *best);
  return result;
}

void OrbitSearch::examineSides(const OrbitCandidate& candidate, FoundOrbit& found) const {
  found.bestSection = widestSection(found.passages);
  OrbitSection& best = found.bestSection;
  if (found.inBand) {
    found.orbit.kind = OrbitKind::Center;
    found.sides = {SideFlow::Closed, SideFlow::Closed};
    best.low = best.high = best.position;
    return;
  }
  // The orbit may cross this section another number of times than the one where it was found.
  int loops = 0;
  for (const EdgePassage& passage : found.passages) loops += best.section.at(field_.mesh(), passage) ? 1 : 0;
  loops = std::max(loops, 1);
  ReturnMap forward = returnMap(Direction::Forward, best.section, loops, candidate.component, found.crossings);
  ReturnMap backward = returnMap(Direction::Backward, best.section, loops, candidate.component, found.crossings);
  const BothSides<SideProbe> probes{probe(forward, backward, best.position, -1.0),
                                    probe(forward, backward, best.position, 1.0)};
  best.low = best.position - probes.left.reach;
  best.high = best.position + probes.right.reach;
  // Differences of the return map give the multiplier best, where it is neither too steep nor too flat for them.
  const auto measures = [](const SideProbe& side) {
    return side.growth && *side.growth > kMinGrowth && *side.growth < kMaxGrowth;
  };
  if (loops == found.loops && measures(probes.left) && measures(probes.right)) {
    found.orbit.multiplier = std::sqrt(*probes.left.growth * *probes.right.growth);
  }
  classify(probes, candidate.direction, found);
}

/// Moves away from the orbit in growing steps for as long as the flow keeps doing the same.
OrbitSearch::SideProbe OrbitSearch::probe(ReturnMap& forward, ReturnMap& backward, double position, double sign) const {
  // Distance from the orbit after one return over the distance before it.
  const auto growth = [&](double distance) -> std::optional<double> {
    const double s = position + sign * distance;
    if (const auto back = forward(s)) return sign * (back->position - position) / distance;
    if (const auto back = backward(s)) return distance / std::max(sign * (back->position - position), 1e-300);
    return std::nullopt;
  };
  const Section& section = forward.section();
  const double room = 0.999 * (sign > 0.0 ? section.high() - position : position - section.low());
  SideProbe side;
  double distance = std::min(kFirstProbe * edge_, 0.5 * room);
  while (true) {
    const auto grown = growth(distance);
    if (!grown) break;
    const SideFlow flow = *grown < 1.0 ? SideFlow::Attracted : SideFlow::Repelled;
    const bool closed = std::abs(*grown - 1.0) <= options_.bandTolerance;
    if (side.flow == SideFlow::Unknown) side = {flow, distance, true, grown};
    side.closed = side.closed && closed;
    if (flow != side.flow && !side.closed) break;
    if (flow == side.flow) side.reach = distance;
    if (distance >= room || distance >= kLastProbe * edge_ || (side.closed && distance >= kBand * edge_)) break;
    distance = std::min({5.0 * distance, distance + kProbeSpacing * edge_, room});
  }
  return side;
}

/// Sides and kind of the orbit. direction: of the streamline that led to it, which decides where no side is known.
void OrbitSearch::classify(const BothSides<SideProbe>& probes, Direction direction, FoundOrbit& found) {
  const auto& [left, right] = probes;
  PeriodicOrbit& orbit = found.orbit;
  BothSides<SideFlow>& sides = found.sides;
  sides = {left.flow, right.flow};
  // A hyperbolic orbit does the same on both sides, whatever round-off makes of the nearest probes.
  if (!left.closed && !right.closed && std::abs(std::log(orbit.multiplier)) > kHyperbolic) {
    sides.left = sides.right = orbit.multiplier < 1.0 ? SideFlow::Attracted : SideFlow::Repelled;
  }
  const SideFlow known = sides.left == SideFlow::Unknown ? sides.right : sides.left;
  if (left.closed && right.closed && known != SideFlow::Unknown) {
    orbit.kind = OrbitKind::Center;
    sides = {SideFlow::Closed, SideFlow::Closed};
  } else if (known == SideFlow::Unknown) {
    orbit.kind = direction == Direction::Forward ? OrbitKind::Attracting : OrbitKind::Repelling;
  } else if (sides.left == sides.right || sides.left == SideFlow::Unknown || sides.right == SideFlow::Unknown) {
    orbit.kind = known == SideFlow::Attracted ? OrbitKind::Attracting : OrbitKind::Repelling;
  }
}

std::vector<Index> OrbitSearch::facesBeside(const FoundOrbit& found, const OrbitSection& section,
                                            Index component) const {
  const TriangleMesh& mesh = field_.mesh();
  std::vector<Index> faces;
  for (const Index h : section.section.halfedges()) {
    faces.push_back(TriangleMesh::face(h));
    if (mesh.twin(h) != kNone) faces.push_back(TriangleMesh::face(mesh.twin(h)));
  }
  int loops = 0;
  for (const EdgePassage& passage : found.passages) loops += section.section.at(mesh, passage) ? 1 : 0;
  for (const double end : {section.low, section.high}) {
    for (const Direction direction : {Direction::Forward, Direction::Backward}) {
      ReturnMap returns = returnMap(direction, section.section, std::max(loops, 1), component, found.crossings);
      const auto back =
          returns.run(end, [&](const SurfacePoint& p, double, const EdgePassage&) { faces.push_back(p.face); });
      if (back) break;
    }
  }
  return faces;
}

std::optional<std::vector<Index>> OrbitSearch::facesIfClosed(Index halfedge, double fraction, Index component,
                                                             Index crossings, double tolerance) const {
  const Section section(field_, halfedge, 1);
  const double start = positionOn(section, halfedge, fraction);
  ReturnMap returns = returnMap(Direction::Forward, section, 1, component, crossings);
  std::vector<Index> faces;
  const auto back =
      returns.run(start, [&](const SurfacePoint& p, double, const EdgePassage&) { faces.push_back(p.face); });
  if (!back || std::abs(back->position - start) > tolerance * edge_) return std::nullopt;
  return faces;
}

}  // namespace stormfield
