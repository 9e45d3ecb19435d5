#include "topology/topology.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>

#include "base/message.h"
#include "maps/geometry_map.h"
#include "topology/detail/connection_graph.h"
#include "topology/detail/separatrix_directions.h"
#include "topology/detail/streamline_search.h"

namespace stormfield {
namespace {

/// Nearer to each other than this, in mean edge lengths, two orbits are one.
constexpr double kSameOrbit = 2e-4;
/// Length of a separatrix' first step, in lengths of its face.
constexpr double kFirstStep = 1e-3;

class Stopwatch {
 public:
  explicit Stopwatch(std::map<std::string, double>& seconds) : seconds_(seconds) {}
  void lap(const char* phase) {
    const auto now = std::chrono::steady_clock::now();
    seconds_[phase] += std::chrono::duration<double>(now - began_).count();
    began_ = now;
  }

 private:
  std::map<std::string, double>& seconds_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

ZeroRegions countZeros(const VectorField& field) {
  const TriangleMesh& mesh = field.mesh();
  ZeroRegions zeros;
  for (const Complex& v : field.values) zeros.vertices += v == 0.0 ? 1 : 0;
  for (Index f = 0; zeros.vertices > 0 && f < mesh.faceCount(); ++f) {
    const auto zero = [&](int k) { return field.values[mesh.vertex(f, k)] == 0.0; };
    zeros.faces += zero(0) && zero(1) && zero(2) ? 1 : 0;
  }
  return zeros;
}

class Search {
 public:
  Search(const FlatFaces& faces, const VectorField& field, const TopologyOptions& options, Progress* progress)
      : faces_(faces),
        field_(field),
        mesh_(field.mesh()),
        options_(options),
        progress_(progress),
        watch_(result_.seconds),
        forward_(faces, field, Direction::Forward, options.tolerance),
        backward_(faces, field, Direction::Backward, options.tolerance) {}

  Topology run() && {
    result_.fixedPoints = findFixedPoints(field_, options_.fixedPoints);
    result_.boundaryPoints = findBoundaryPoints(field_);
    result_.zeros = countZeros(field_);
    for (const FixedPoint& p : result_.fixedPoints) basins_.push_back(nodeBasin(field_, p));
    watch_.lap("fixed_points");
    findParts();
    watch_.lap("recurrent_parts");
    Destinations destinations(mesh_, result_.fixedPoints, basins_);
    destinations_ = &destinations;
    OrbitSearch orbits(faces_, field_, parts_.of, {.bandTolerance = options_.bandTolerance});
    orbitSearch_ = &orbits;
    setOut();
    while (true) {
      travel();
      watch_.lap("streamlines");
      if (!lookAtCandidates()) break;
      watch_.lap("periodic_orbits");
    }
    finish();
    watch_.lap("links");
    return std::move(result_);
  }

 private:
  void findParts() {
    std::vector<char> resting(mesh_.faceCount(), 0);
    for (const FixedPoint& p : result_.fixedPoints) {
      resting[p.point.face] = 1;
    }
    for (Index f = 0; result_.zeros.vertices > 0 && f < mesh_.faceCount(); ++f) {
      for (int k = 0; k < 3; ++k)
        if (field_.values[mesh_.vertex(f, k)] == 0.0) resting[f] = 1;
    }
    parts_ = recurrentParts(field_, geometryMap(field_), resting);
  }

  // Setting out ------------------------------------------------------------------------------------------------------
  std::size_t add(const SurfacePoint& from, Direction direction, bool keepsPoints = false, Index within = kNone) {
    Journey& journey = journeys_.emplace_back();
    journey.at = from;
    journey.direction = direction;
    journey.keepsPoints = keepsPoints;
    journey.within = within;
    return journeys_.size() - 1;
  }

  void setOut() {
    for (std::size_t i = 0; i < result_.fixedPoints.size(); ++i) {
      const FixedPoint& p = result_.fixedPoints[i];
      for (const bool outgoing : {true, false}) {
        for (const SeparatrixDirection& d : p.separatrices) {
          if (d.outgoing == outgoing) addSeparatrix(static_cast<Index>(i), d);
        }
      }
    }
    for (std::size_t i = 0; i < result_.fixedPoints.size(); ++i) {
      const FixedPoint& p = result_.fixedPoints[i];
      if (p.index <= 0) continue;
      const Direction direction = basins_[i].forward && !basins_[i].backward ? Direction::Backward : Direction::Forward;
      graph_.nodes.push_back({static_cast<Index>(i), direction == Direction::Forward, add(basins_[i].seed, direction)});
    }
    for (const BoundaryPoint& p : result_.boundaryPoints) {
      if (p.halfIndex >= 0) continue;
      graph_.tangencies.push_back({add(p.point, Direction::Forward), add(p.point, Direction::Backward)});
    }
    for (const PartSeed& seed : parts_.seeds) add(seed.point, seed.direction, false, seed.part);
  }

  void addSeparatrix(Index saddle, const SeparatrixDirection& d) {
    const FlatFace& flat = faces_[d.face];
    const FixedPoint& p = result_.fixedPoints[saddle];
    Complex apex = flat.point(p.point.barycentric);
    for (const Sector& sector : sectorsAround(*field_.charts, p.point)) {
      if (sector.face == d.face) apex = sector.apex;
    }
    // Not over the border of its face.
    const Eigen::Vector3d b = flat.barycentric(apex), rate = flat.barycentricRate(d.direction);
    double step = kFirstStep * std::sqrt(2.0 * mesh_.faceArea(d.face));
    for (int k = 0; k < 3; ++k) {
      if (rate[k] < 0.0 && b[k] > 0.0) step = std::min(step, -0.5 * b[k] / rate[k]);
    }
    Eigen::Vector3d start = (b + step * rate).cwiseMax(0.0);
    start /= start.sum();
    const std::size_t journey = add({d.face, start}, d.outgoing ? Direction::Forward : Direction::Backward, true);
    graph_.separatrices.push_back({saddle, d.outgoing, journey});
  }

  // Rounds -----------------------------------------------------------------------------------------------------------
  void travel() {
    std::vector<std::size_t> going;
    for (std::size_t i = 0; i < journeys_.size(); ++i) {
      if (journeys_[i].state != Journey::State::Ended) going.push_back(i);
    }
    tbb::parallel_for(std::size_t{0}, going.size(), [&](std::size_t i) {
      Journey& journey = journeys_[going[i]];
      const FlowWalk& walk = journey.direction == Direction::Forward ? forward_ : backward_;
      journey.travel(walk, *destinations_, parts_.of, options_, progress_);
    });
    if (progress_ != nullptr) {
      progress_->check();
      const auto ended = static_cast<double>(journeys_.size() - going.size());
      progress_->report(ended / static_cast<double>(journeys_.size() + 1));
    }
  }

  /// The first candidate of each part and direction; the others wait for what comes of it. False when all have ended.
  bool lookAtCandidates() {
    std::vector<std::size_t> chosen;
    std::map<std::pair<Index, bool>, std::size_t> first;
    bool any = false;
    for (std::size_t i = 0; i < journeys_.size(); ++i) {
      Journey& journey = journeys_[i];
      if (journey.state != Journey::State::CameBack) continue;
      any = true;
      const bool forward = journey.direction == Direction::Forward;
      if (first.try_emplace({journey.candidate.part, forward}, i).second) {
        chosen.push_back(i);
      } else {
        journey.wait();
      }
    }
    std::vector<OrbitSearch::Outcome> found(chosen.size());
    tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
      if (progress_ != nullptr) progress_->check();
      found[i] = orbitSearch_->follow(journeys_[chosen[i]].candidate,
                                      [&](const FoundOrbit& orbit) { return knownOrbit(orbit) != kNone; });
    });
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (found[i].orbit) {
        accept(chosen[i], std::move(*found[i].orbit));
      } else if (found[i].onward) {
        journeys_[chosen[i]].skipTo(*found[i].onward);
      } else {
        journeys_[chosen[i]].doubt();
      }
    }
    return any;
  }

  Index knownOrbit(const FoundOrbit& found) const {
    const bool inBand = found.closedAround || std::abs(found.orbit.multiplier - 1.0) <= options_.bandTolerance;
    for (const EdgePassage& passage : found.passages) {
      Index orbit = destinations_->orbitAt(passage, kSameOrbit * mesh_.meanEdgeLength());
      if (orbit == kNone && inBand && passage.halfedge != kNone) {
        orbit = destinations_->bandAt(TriangleMesh::face(passage.halfedge));
      }
      if (orbit != kNone) return orbit;
    }
    return kNone;
  }

  void accept(std::size_t traveller, FoundOrbit found) {
    const Index part = journeys_[traveller].candidate.part;
    Index orbit = knownOrbit(found);
    if (orbit == kNone) {
      orbit = destinations_->orbitCount();
      destinations_->addOrbit(found);
      result_.periodicOrbits.push_back(found.orbit);
      if (found.orbit.kind == OrbitKind::Center) {
        followBand(orbit, found, part);
      } else {
        leaveBothSides(orbit, found.best);
      }
    }
    // The streamline that led here has arrived, unless the orbit sends away what comes from its side.
    const SideFlow flow = destinations_->side(orbit, found.side);
    const bool forward = journeys_[traveller].direction == Direction::Forward;
    if (flow == SideFlow::Closed || flow == (forward ? SideFlow::Attracted : SideFlow::Repelled)) {
      destinations_->addSection(orbit, found.found);
      journeys_[traveller].arrive({{EntityKind::PeriodicOrbit, orbit}, found.side});
    } else {
      journeys_[traveller].doubt();
    }
  }

  void leaveBothSides(Index orbit, const OrbitSection& section) {
    for (const int side : {0, 1}) {
      const Direction away =
          destinations_->side(orbit, side) == SideFlow::Attracted ? Direction::Backward : Direction::Forward;
      const double from = side == 0 ? section.low : section.high;
      const std::size_t journey = add(section.section.point(mesh_, from, away), away);
      graph_.sides.push_back({orbit, side, away == Direction::Forward, journey});
    }
  }

  /// Across a band along the streamlines of the field turned by a right angle: every face of the band is marked, and
  /// streamlines set out from where it ends.
  void followBand(Index orbit, const FoundOrbit& found, Index part) {
    VectorField turned = field_;
    for (Complex& v : turned.values) v *= Complex(0.0, 1.0);
    for (const SurfacePoint& p : found.orbit.points) destinations_->addBandFace(p.face, orbit);
    for (const Direction direction : {Direction::Forward, Direction::Backward}) {
      FlowWalk across(faces_, turned, direction, options_.tolerance);
      const int side = direction == Direction::Forward ? 0 : 1;
      across.run(found.best.section.point(mesh_, found.best.position, Direction::Forward),
                 [&](const SurfacePoint& p, double, const EdgePassage& passage) {
                   if (progress_ != nullptr) progress_->check();
                   if (!passage) return true;
                   return stepOverBand(orbit, side, p, passage, part, found.crossings);
                 });
    }
  }
  bool stepOverBand(Index orbit, int side, const SurfacePoint& p, const EdgePassage& passage, Index part,
                    Index crossings) {
    // The edge as the field itself crosses it.
    Index h = passage.halfedge;
    double fraction = passage.fraction;
    if (h == kNone) {
      h = crossedAt(field_, passage.vertex, true);
      fraction = 0.05;
      if (h == kNone) return true;
    }
    const auto ends = acrossEnds(field_, h);
    const double across = (1.0 - fraction) * ends[0] + fraction * ends[1];
    if (std::abs(across) < 0.1 * (std::abs(ends[0]) + std::abs(ends[1]))) return true;
    if (across < 0.0) {
      h = mesh_.twin(h);
      fraction = 1.0 - fraction;
    }
    std::vector<Index> crossed;
    if (!orbitSearch_->closes(h, fraction, part, 4 * crossings, options_.bandTolerance, &crossed)) {
      const std::size_t onward = add(p, Direction::Forward), back = add(p, Direction::Backward);
      graph_.bandSides.push_back({orbit, side, onward, back});
      return false;
    }
    for (const Index face : crossed) destinations_->addBandFace(face, orbit);
    return true;
  }

  // The end ----------------------------------------------------------------------------------------------------------
  void finish() {
    graph_.journeyEnds.reserve(journeys_.size());
    for (const Journey& journey : journeys_) graph_.journeyEnds.push_back(journey.end);
    sortOrbits();
    for (const auto& s : graph_.separatrices) {
      Journey& journey = journeys_[s.journey];
      Separatrix separatrix{s.saddle,
                            s.outgoing,
                            graph_.journeyEnds[s.journey].entity,
                            std::move(journey.points),
                            std::move(journey.times),
                            journey.length};
      const FixedPoint& saddle = result_.fixedPoints[s.saddle];
      separatrix.length += (position(mesh_, separatrix.points.front()) - saddle.position).norm();
      separatrix.points.insert(separatrix.points.begin(), saddle.point);
      separatrix.times.insert(separatrix.times.begin(), 0.0);
      result_.separatrices.push_back(std::move(separatrix));
    }
    result_.links = connectionGraph(result_, graph_);
  }

  /// By the lowest face that they cross, whatever order they were found in.
  void sortOrbits() {
    std::vector<std::pair<std::pair<Index, double>, Index>> keys;
    for (std::size_t i = 0; i < result_.periodicOrbits.size(); ++i) {
      const PeriodicOrbit& orbit = result_.periodicOrbits[i];
      Index lowest = mesh_.faceCount();
      for (const SurfacePoint& p : orbit.points) lowest = std::min(lowest, p.face);
      keys.push_back({{lowest, orbit.length}, static_cast<Index>(i)});
    }
    std::sort(keys.begin(), keys.end());
    std::vector<PeriodicOrbit> sorted;
    std::vector<Index> place(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      place[keys[i].second] = static_cast<Index>(i);
      sorted.push_back(std::move(result_.periodicOrbits[keys[i].second]));
    }
    result_.periodicOrbits = std::move(sorted);
    graph_.renumberOrbits(place);
  }

  const FlatFaces& faces_;
  const VectorField& field_;
  const TriangleMesh& mesh_;
  const TopologyOptions& options_;
  Progress* progress_;
  Topology result_;
  Stopwatch watch_;
  FlowWalk forward_, backward_;
  std::vector<NodeBasin> basins_;
  RecurrentParts parts_;
  Destinations* destinations_ = nullptr;
  OrbitSearch* orbitSearch_ = nullptr;
  std::deque<Journey> journeys_;
  ConnectionEvidence graph_;
};

void check(const FlatFaces& faces, const VectorField& field, const TopologyOptions& options) {
  if (field.values.size() != static_cast<std::size_t>(faces.mesh().vertexCount())) {
    throw InputError("the field to analyze belongs to another mesh");
  }
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    if (!std::isfinite(field.values[v].real()) || !std::isfinite(field.values[v].imag())) {
      throw InputError(message("the vector of vertex ", v, " is not finite; replace it, for example by zero"));
    }
  }
  if (!(options.tolerance > 0.0) || !(options.bandTolerance > 0.0) || options.maxSteps <= 0) {
    throw InputError("tolerances and the number of steps of an analysis must be positive");
  }
}

}  // namespace

Topology findTopology(const FlatFaces& faces, const VectorField& field, const TopologyOptions& options,
                      Progress* progress) {
  check(faces, field, options);
  return Search(faces, field, options, progress).run();
}

}  // namespace stormfield
