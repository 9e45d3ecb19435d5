#include "topology/detail/orbit_search.h"

#include <algorithm>
#include <cmath>

#include "field/interpolation.h"

namespace stormfield {
namespace {

// All in mean edge lengths.
constexpr double kClosed = 1e-9;      ///< a streamline that comes back so near is the orbit
constexpr double kConverged = 1e-11;  ///< width of the last bracket
constexpr double kNearLimit = 1e-4;   ///< as near as this to the end of what returns, the search is given up
constexpr double kJump = 1e-5;        ///< a return map that jumps by more has no fixed point there
constexpr double kSlow = 0.02;        ///< of one turn that moves so little, nothing is lost by leaving some out
constexpr double kNearest = 3e-4;     ///< first distance at which an orbit's sides are looked at
constexpr double kPiece = 0.1;        ///< orbits farther from each other than this are told apart for sure
constexpr double kFarthest = 1.0;     ///< and last distance
constexpr double kBand = 0.5;         ///< distance at which a band of closed streamlines shows
constexpr double kHyperbolic = 0.1;   ///< logarithm of a multiplier that is away from 1 for sure
constexpr int kMostPieces = 24;
/// Edges in a row with the candidate's own that are searched, and around an orbit's best section.
constexpr int kBeyond = 2, kBeyondBest = 1;

Index allowedCrossings(Index once) {
  return 4 * once + 200;
}

}  // namespace

OrbitSearch::OrbitSearch(const FlatFaces& faces, const VectorField& field, const std::vector<Index>& partOf,
                         const OrbitSearchOptions& options)
    : faces_(faces),
      field_(field),
      partOf_(partOf),
      options_(options),
      edge_(faces.mesh().meanEdgeLength()),
      forward_(faces, field, Direction::Forward, options.tolerance),
      backward_(faces, field, Direction::Backward, options.tolerance) {}

ReturnMap OrbitSearch::map(Direction direction, const Section& section, int loops, Index part, Index crossings) const {
  const FlowWalk& walk = direction == Direction::Forward ? forward_ : backward_;
  return {walk, section, loops, partOf_, part, allowedCrossings(crossings)};
}

OrbitSearch::Outcome OrbitSearch::follow(const Candidate& candidate,
                                         const std::function<bool(const FoundOrbit&)>& isKnown) const {
  const Section section(field_, candidate.halfedge, kBeyond);
  const auto own = std::find(section.halfedges().begin(), section.halfedges().end(), candidate.halfedge);
  const double start = section.at(static_cast<std::size_t>(own - section.halfedges().begin()), candidate.fraction);
  ReturnMap returns = map(candidate.direction, section, candidate.loops, candidate.part, candidate.crossings);
  const March way = checked(returns, start, march(returns, start));
  if (!way.fixed) {
    if (std::abs(way.reached - start) <= 4.0 * way.largest) return {};
    return {std::nullopt, section.point(field_.mesh(), way.reached, candidate.direction)};
  }
  FoundOrbit found;
  found.loops = fewestLoops(returns, *way.fixed);
  found.closedAround = way.closedAround;
  ReturnMap once = map(candidate.direction, section, found.loops, candidate.part, candidate.crossings);
  if (!record(once, *way.fixed, found)) return {};
  found.side = start < *way.fixed ? 0 : 1;
  found.found = {section, *way.fixed, std::min(start, *way.fixed), std::max(start, *way.fixed)};
  found.known = isKnown(found);
  if (!found.known) lookAround(candidate, found);
  return {std::move(found), std::nullopt};
}

/// From the start the way the streamline moves, with secant steps that mean to overshoot a little, until the
/// displacement changes its sign.
OrbitSearch::March OrbitSearch::march(ReturnMap& returns, double start) const {
  const double low = returns.section().low() + 1e-9 * edge_, high = returns.section().high() - 1e-9 * edge_;
  const auto displacement = [&](double s) -> std::optional<double> {
    const auto back = returns(s);
    return back ? std::optional(back->position - s) : std::nullopt;
  };
  const auto first = displacement(start);
  if (!first) return {std::nullopt, start, 0.0, false};
  if (std::abs(*first) <= kClosed * edge_) return {start, start, 0.0, false};
  const double sign = *first > 0.0 ? 1.0 : -1.0;

  // Closed but for a drift that is as small half an edge away: inside a band.
  const double drift = options_.bandTolerance * kBand * edge_;
  if (std::abs(*first) <= drift) {
    const auto isClosed = [&](double s) {
      const auto d = s > low && s < high ? displacement(s) : std::nullopt;
      return d && std::abs(*d) <= drift;
    };
    if (isClosed(start + kBand * edge_) && isClosed(start - kBand * edge_)) return {start, start, 0.0, true};
  }

  double limit = sign > 0.0 ? high : low;  // streamlines return as far as here, as far as is known
  double a = start, atA = *first, b = std::clamp(a + atA, low, high);
  double reached = start, largest = std::abs(atA);
  bool slow = largest <= kSlow * edge_;
  // Return maps grow with the position: an orbit lies beyond where the streamline itself comes back.
  for (int step = 0; step < 40 && sign * (limit - a - atA) > kNearLimit * edge_; ++step) {
    const auto atB = displacement(b);
    if (!atB) {
      limit = b;
      b = 0.5 * (a + b);
      continue;
    }
    if (sign * *atB <= 0.0) return {solve(returns, a, atA, b, *atB), reached, largest, false};
    const double slope = (*atB - atA) / (b - a);
    double reach = 3.0 * std::abs(b - a);
    if (slope < 0.0) reach = std::min(1.25 * std::abs(*atB / slope) + 10.0 * kConverged * edge_, 20.0 * reach);
    a = b;
    atA = *atB;
    slow = slow && std::abs(atA) <= kSlow * edge_;
    if (slow) {
      reached = a;
      largest = std::max(largest, std::abs(atA));
    }
    b = sign > 0.0 ? std::min(a + reach, limit) : std::max(a - reach, limit);
  }
  return {std::nullopt, reached, largest, false};
}

/// The march may have stepped over two orbits at once: looks again, in short steps, and turns to the first sign change.
OrbitSearch::March OrbitSearch::checked(ReturnMap& returns, double start, March way) const {
  for (int round = 0; round < 4; ++round) {
    const double end = way.fixed ? *way.fixed : way.reached;
    const int pieces = std::min(kMostPieces, static_cast<int>(std::abs(end - start) / (kPiece * edge_)) + 1);
    double before = start, atBefore = 0.0;
    bool changed = false;
    for (int i = 0; i < pieces && !changed; ++i) {
      const double s = start + (end - start) * i / pieces;
      const auto back = returns(s);
      if (!back) continue;
      const double d = back->position - s;
      if (atBefore * d < 0.0) {
        way.fixed = solve(returns, before, atBefore, s, d);
        changed = true;
      }
      before = s;
      atBefore = d;
    }
    if (!changed) break;
  }
  return way;
}

/// The zero of the displacement between a and b by the rule of false position (Illinois), with bisection now and then.
std::optional<double> OrbitSearch::solve(ReturnMap& returns, double a, double atA, double b, double atB) const {
  double best = std::abs(atA) < std::abs(atB) ? a : b, atBest = std::min(std::abs(atA), std::abs(atB));
  double weightA = atA, weightB = atB;
  for (int step = 0; step < 80 && std::abs(b - a) > kConverged * edge_ && atBest > 0.1 * kClosed * edge_; ++step) {
    double s = step % 4 == 3 ? 0.5 * (a + b) : (a * weightB - b * weightA) / (weightB - weightA);
    if (!(std::min(a, b) < s && s < std::max(a, b))) s = 0.5 * (a + b);
    const auto back = returns(s);
    if (!back) return std::nullopt;
    const double d = back->position - s;
    if (std::abs(d) < atBest) {
      best = s;
      atBest = std::abs(d);
    }
    if ((d > 0.0) == (atA > 0.0)) {
      a = s;
      atA = weightA = d;
      weightB *= 0.5;
    } else {
      b = s;
      atB = weightB = d;
      weightA *= 0.5;
    }
  }
  return atBest <= kJump * edge_ ? std::optional(best) : std::nullopt;
}

/// Goes away from the orbit in growing steps for as long as the flow keeps doing the same.
OrbitSearch::Side OrbitSearch::look(ReturnMap& forward, ReturnMap& backward, double position, double sign) const {
  // How many times farther from the orbit a streamline comes back.
  const auto growth = [&](double distance) -> std::optional<double> {
    const double s = position + sign * distance;
    if (const auto back = forward(s)) return sign * (back->position - position) / distance;
    if (const auto back = backward(s)) return distance / std::max(sign * (back->position - position), 1e-300);
    return std::nullopt;
  };
  const Section& section = forward.section();
  const double room = 0.999 * (sign > 0.0 ? section.high() - position : position - section.low());
  Side side;
  double distance = std::min(kNearest * edge_, 0.5 * room);
  while (true) {
    const auto grown = growth(distance);
    if (!grown) break;
    const SideFlow flow = *grown < 1.0 ? SideFlow::Attracted : SideFlow::Repelled;
    const bool closed = std::abs(*grown - 1.0) <= options_.bandTolerance;
    if (side.flow == SideFlow::Unknown) side = {flow, distance, true, grown};
    side.closed = side.closed && closed;
    if (flow != side.flow && !side.closed) break;
    if (flow == side.flow) side.reach = distance;
    if (distance >= room || distance >= kFarthest * edge_ || (side.closed && distance >= kBand * edge_)) break;
    distance = std::min({5.0 * distance, distance + kPiece * edge_, room});
  }
  return side;
}

void OrbitSearch::lookAround(const Candidate& candidate, FoundOrbit& found) const {
  found.best = bestSection(found.passages);
  if (found.closedAround) {
    found.orbit.kind = OrbitKind::Center;
    found.sides = {SideFlow::Closed, SideFlow::Closed};
    found.best.low = found.best.high = found.best.position;
    return;
  }
  // On that section the number of loops can be another.
  int loops = 0;
  for (const EdgePassage& passage : found.passages) loops += found.best.section.at(field_.mesh(), passage) ? 1 : 0;
  loops = std::max(loops, 1);
  ReturnMap forward = map(Direction::Forward, found.best.section, loops, candidate.part, found.crossings);
  ReturnMap backward = map(Direction::Backward, found.best.section, loops, candidate.part, found.crossings);
  const Side left = look(forward, backward, found.best.position, -1.0);
  const Side right = look(forward, backward, found.best.position, 1.0);
  found.best.low = found.best.position - left.reach;
  found.best.high = found.best.position + right.reach;
  found.sides = {left.flow, right.flow};

  PeriodicOrbit& orbit = found.orbit;
  // The return map says it best, where it is neither too steep nor too flat for differences.
  const auto tells = [](const Side& side) { return side.growth && *side.growth > 1e-2 && *side.growth < 1e2; };
  if (loops == found.loops && tells(left) && tells(right)) {
    found.orbit.multiplier = std::sqrt(*left.growth * *right.growth);
  }
  // An orbit with a multiplier away from 1 does the same on both sides, whatever round-off makes of the nearest ones.
  if (!left.closed && !right.closed && std::abs(std::log(orbit.multiplier)) > kHyperbolic) {
    found.sides.fill(orbit.multiplier < 1.0 ? SideFlow::Attracted : SideFlow::Repelled);
  }
  const SideFlow known = found.sides[0] == SideFlow::Unknown ? found.sides[1] : found.sides[0];
  if (left.closed && right.closed && known != SideFlow::Unknown) {
    orbit.kind = OrbitKind::Center;
    found.sides = {SideFlow::Closed, SideFlow::Closed};
  } else if (known == SideFlow::Unknown) {
    const bool forwards = candidate.direction == Direction::Forward;
    orbit.kind = forwards ? OrbitKind::Attracting : OrbitKind::Repelling;
  } else if (found.sides[0] == found.sides[1] || found.sides[0] == SideFlow::Unknown ||
             found.sides[1] == SideFlow::Unknown) {
    orbit.kind = known == SideFlow::Attracted ? OrbitKind::Attracting : OrbitKind::Repelling;
  }
}

/// An orbit comes back to itself after some of the loops of the streamline that led to it.
int OrbitSearch::fewestLoops(ReturnMap& returns, double position) const {
  if (returns.loops() == 1) return 1;
  int loops = 0, fewest = 0;
  returns.run(position, [&](const SurfacePoint&, double time, const EdgePassage& passage) {
    const auto at = time > 0.0 ? returns.section().at(field_.mesh(), passage) : std::nullopt;
    if (!at) return;
    ++loops;
    if (fewest == 0 && std::abs(*at - position) <= kJump * edge_) fewest = loops;
  });
  return fewest == 0 ? returns.loops() : fewest;
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
  orbit.multiplier = multiplier(orbit);
  orbit.points.back() = orbit.points.front();
  if (returns.direction() == Direction::Backward) {
    std::reverse(orbit.points.begin(), orbit.points.end());
    std::reverse(orbit.times.begin(), orbit.times.end());
    for (double& time : orbit.times) time = orbit.period - time;
  }
  return true;
}

OrbitSection OrbitSearch::bestSection(const std::vector<EdgePassage>& passages) const {
  const EdgePassage* best = nullptr;
  double most = -1.0;
  for (const EdgePassage& passage : passages) {
    if (passage.halfedge == kNone) continue;
    const auto across = acrossEnds(field_, passage.halfedge);
    double low = 0.0, high = 1.0;
    if (across[0] < 0.0) low = across[0] / (across[0] - across[1]);
    if (across[1] < 0.0) high = across[0] / (across[0] - across[1]);
    const double margin = field_.mesh().edgeLength(field_.mesh().edge(passage.halfedge)) *
                          std::min(passage.fraction - low, high - passage.fraction);
    if (margin > most) {
      most = margin;
      best = &passage;
    }
  }
  OrbitSection result;
  result.section = Section(field_, best->halfedge, kBeyondBest);
  result.position = *result.section.at(field_.mesh(), *best);
  return result;
}

/// Areas beside a streamline grow with the divergence of the field (Liouville), and so do distances from a closed one:
/// log m = integral of div V dt. The divergence of a linear field is constant within a face. The curve must be in the
/// order in which it was traced: each step then lies in the face of the point before it.
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

bool OrbitSearch::closes(Index halfedge, double fraction, Index part, Index crossings, double tolerance,
                         std::vector<Index>* crossedFaces) const {
  const Section section(field_, halfedge, 1);
  const auto own = std::find(section.halfedges().begin(), section.halfedges().end(), halfedge);
  const double start = section.at(static_cast<std::size_t>(own - section.halfedges().begin()), fraction);
  ReturnMap returns = map(Direction::Forward, section, 1, part, crossings);
  const auto back = returns.run(start, [&](const SurfacePoint& p, double, const EdgePassage&) {
    if (crossedFaces != nullptr) crossedFaces->push_back(p.face);
  });
  return back && std::abs(back->position - start) <= tolerance * edge_;
}

const char* name(OrbitKind kind) {
  switch (kind) {
    case OrbitKind::Attracting:
      return "attracting";
    case OrbitKind::Repelling:
      return "repelling";
    case OrbitKind::Center:
      return "center";
    case OrbitKind::Degenerate:
      break;
  }
  return "degenerate";
}

}  // namespace stormfield
