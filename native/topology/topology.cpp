#include "topology/topology.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "base/message.h"
#include "maps/geometry_map.h"
#include "topology/detail/entity_connection_graph.h"
#include "topology/detail/orbit_band.h"
#include "topology/detail/recurrent_components.h"
#include "topology/detail/separatrix_directions.h"
#include "topology/detail/streamline_search.h"
#include "topology/detail/topology_memory.h"

namespace stormfield {
namespace {

/// Nearer to each other than this, in mean edge lengths, two orbits are one.
constexpr double kSameOrbit = 2e-4;

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
    const auto isZero = [&](int k) { return field.values[mesh.vertex(f, k)] == 0.0; };
    zeros.faces += isZero(0) && isZero(1) && isZero(2) ? 1 : 0;
  }
  return zeros;
}

/// Per face whether it holds one of the fixed points, or has a zero vector at a corner.
std::vector<char> facesWithZeros(const VectorField& field, const std::vector<FixedPoint>& points,
                                 const ZeroRegions& zeros) {
  const TriangleMesh& mesh = field.mesh();
  std::vector<char> result(mesh.faceCount(), 0);
  for (const FixedPoint& p : points) result[p.point.face] = 1;
  for (Index f = 0; zeros.vertices > 0 && f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (field.values[mesh.vertex(f, k)] == 0.0) result[f] = 1;
    }
  }
  return result;
}

std::vector<TrappingRegion> trappingRegions(const VectorField& field, const std::vector<FixedPoint>& points) {
  std::vector<TrappingRegion> regions;
  for (const FixedPoint& p : points) regions.push_back(trappingRegion(field, p));
  return regions;
}

/// The place of each orbit in the order of the lowest faces that they cross, which does not depend on the order in
/// which they were found.
std::vector<Index> placesByLowestFace(const std::vector<PeriodicOrbit>& orbits) {
  std::vector<std::pair<std::pair<Index, double>, Index>> keys;
  for (std::size_t i = 0; i < orbits.size(); ++i) {
    Index lowest = orbits[i].points.front().face;
    for (const SurfacePoint& p : orbits[i].points) lowest = std::min(lowest, p.face);
    keys.push_back({{lowest, orbits[i].length}, static_cast<Index>(i)});
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Index> places(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) places[keys[i].second] = static_cast<Index>(i);
  return places;
}

/// Rounds of streamlines and of tested candidates, until all streamlines have ended.
class TopologySearch {
 public:
  TopologySearch(const FlatFaces& faces, const VectorField& field, const std::vector<FixedPoint>& points,
                 const RecurrentComponents& components, const TopologyOptions& options, Recollection* known,
                 Progress* progress)
      : faces_(faces),
        field_(field),
        mesh_(field.mesh()),
        points_(points),
        components_(components),
        options_(options),
        known_(known),
        progress_(progress),
        regions_(trappingRegions(field, points)),
        limitSets_(mesh_, points, regions_),
        orbitSearch_(faces, field, components.of, {.bandTolerance = options.bandTolerance}),
        forward_(faces, field, Direction::Forward, options.tolerance),
        backward_(faces, field, Direction::Backward, options.tolerance) {}

  void seedStreamlines(const std::vector<BoundaryPoint>& boundaryPoints) {
    adoptOrbits();
    for (std::size_t i = 0; i < points_.size(); ++i) seedSeparatrices(static_cast<Index>(i));
    for (std::size_t i = 0; i < points_.size(); ++i) seedBesideFixedPoint(static_cast<Index>(i));
    for (const BoundaryPoint& p : boundaryPoints) {
      if (p.halfIndex < 0) seedAtTangency(p);
    }
    for (const ComponentSeed& seed : components_.seeds) {
      add({.point = seed.point, .direction = seed.direction, .component = seed.component});
    }
  }

  /// All streamlines that have not ended, side by side.
  void traceRound() {
    std::vector<StreamlineSearch*> going;
    for (StreamlineSearch& streamline : streamlines_) {
      if (streamline.state() != StreamlineSearch::State::Ended) going.push_back(&streamline);
    }
    tbb::parallel_for(std::size_t{0}, going.size(), [&](std::size_t i) {
      const CrossingTrace& trace = going[i]->direction() == Direction::Forward ? forward_ : backward_;
      going[i]->trace(trace, limitSets_, components_.of, options_.maxSteps, progress_);
    });
    if (progress_ == nullptr) return;
    progress_->check();
    const auto ended = static_cast<double>(streamlines_.size() - going.size());
    progress_->report(ended / static_cast<double>(streamlines_.size() + 1));
  }

  /// The first candidate of each component and direction; the others are deferred, as most of them lead to the same
  /// orbit. False when there is none: all streamlines have ended.
  bool testOrbitCandidates() {
    const std::vector<StreamlineSearch*> candidates = firstCandidates();
    std::vector<OrbitSearch::Outcome> outcomes(candidates.size());
    tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
      if (progress_ != nullptr) progress_->check();
      outcomes[i] = orbitSearch_.findFrom(candidates[i]->candidate(),
                                          [&](const FoundOrbit& orbit) { return knownOrbit(orbit) != kNone; });
    });
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (outcomes[i].orbit) {
        acceptOrbit(*candidates[i], *outcomes[i].orbit);
      } else if (outcomes[i].restart) {
        candidates[i]->restartAt(*outcomes[i].restart);
      } else {
        candidates[i]->requireMoreReturns();
      }
    }
    return !candidates.empty();
  }

  /// Orbits, separatrices and links of the result.
  void collect(Topology& result) {
    evidence_.ends.reserve(streamlines_.size());
    for (const StreamlineSearch& streamline : streamlines_) evidence_.ends.push_back(streamline.end());
    const std::vector<Index> places = placesByLowestFace(orbits_);
    evidence_.renumberOrbits(places);
    result.periodicOrbits.resize(orbits_.size());
    for (std::size_t i = 0; i < orbits_.size(); ++i) result.periodicOrbits[places[i]] = orbits_[i];
    for (const auto& s : evidence_.separatrices) result.separatrices.push_back(separatrix(s));
    result.links = entityLinks(points_, result.periodicOrbits, evidence_);
    result.memory = memory(places);
  }

 private:
  // Seeds ------------------------------------------------------------------------------------------------------------

  /// The number of a new streamline.
  std::size_t add(const StreamlineSeed& seed) {
    streamlines_.emplace_back(seed);
    if (known_ != nullptr) {
      if (auto same = known_->find(seed)) streamlines_.back().endAfter(std::move(same->course), same->end);
    }
    return streamlines_.size() - 1;
  }

  /// Outgoing ones first.
  void seedSeparatrices(Index saddle) {
    for (const bool outgoing : {true, false}) {
      for (const SeparatrixDirection& d : points_[saddle].separatrices) {
        if (d.outgoing != outgoing) continue;
        const std::size_t streamline = add({.point = separatrixStart(faces_, points_[saddle].point, d),
                                            .direction = outgoing ? Direction::Forward : Direction::Backward,
                                            .keepsPoints = true});
        evidence_.separatrices.push_back({saddle, outgoing, streamline});
      }
    }
  }

  /// From sources with the flow, from sinks against it.
  void seedBesideFixedPoint(Index point) {
    if (points_[point].index <= 0) return;
    const TrappingRegion& region = regions_[point];
    const Direction direction = region.forward && !region.backward ? Direction::Backward : Direction::Forward;
    evidence_.fixedPoints.push_back({point, direction, add({.point = region.seed, .direction = direction})});
  }

  void seedAtTangency(const BoundaryPoint& p) {
    const std::size_t forward = add({.point = p.point, .direction = Direction::Forward});
    const std::size_t backward = add({.point = p.point, .direction = Direction::Backward});
    evidence_.tangencies.push_back({forward, backward});
  }

  /// Away from both sides of an orbit: with the flow from a side that repels, against it from one that attracts.
  void seedBesideOrbit(Index orbit, const OrbitSection& section) {
    for (const OrbitSide side : kOrbitSides) {
      const Direction away =
          limitSets_.sideFlow(orbit, side) == SideFlow::Attracted ? Direction::Backward : Direction::Forward;
      const double position = side == OrbitSide::Left ? section.low : section.high;
      const std::size_t streamline = add({.point = section.section.point(mesh_, position, away), .direction = away});
      evidence_.orbitSides.push_back({orbit, side, away, streamline});
    }
  }

  /// Orbits that no change has touched.
  void adoptOrbits() {
    if (known_ == nullptr) return;
    for (const Index before : known_->orbits()) {
      const RememberedOrbit& orbit = known_->orbit(before);
      known_->numberOrbit(before, limitSets_.orbitCount());
      limitSets_.addOrbit(orbit.found);
      orbits_.push_back(orbit.found.orbit);
      remembered_.push_back(orbit);
    }
    for (std::size_t i = 0; i < remembered_.size(); ++i) {
      seedBesideOrbit(static_cast<Index>(i), remembered_[i].found.bestSection);
    }
  }

  /// Marks the faces of an orbit's band, and seeds streamlines where it ends.
  void seedBeyondBand(Index orbit, const FoundOrbit& found, Index component) {
    const OrbitBand band =
        findBand(faces_, field_, orbitSearch_, found, component, options_.tolerance, options_.bandTolerance, progress_);
    for (const Index face : band.faces) limitSets_.addBandFace(face, orbit);
    for (const OrbitSide side : kOrbitSides) {
      if (!band.ends[side]) continue;
      const std::size_t forward = add({.point = *band.ends[side], .direction = Direction::Forward});
      const std::size_t backward = add({.point = *band.ends[side], .direction = Direction::Backward});
      evidence_.bandEnds.push_back({orbit, forward, backward});
    }
  }

  // Candidates -------------------------------------------------------------------------------------------------------

  std::vector<StreamlineSearch*> firstCandidates() {
    std::vector<StreamlineSearch*> chosen;
    std::map<std::pair<Index, Direction>, StreamlineSearch*> first;
    for (StreamlineSearch& streamline : streamlines_) {
      if (streamline.state() != StreamlineSearch::State::Returned) continue;
      if (first.try_emplace({streamline.candidate().component, streamline.direction()}, &streamline).second) {
        chosen.push_back(&streamline);
      } else {
        streamline.defer();
      }
    }
    return chosen;
  }

  /// The orbit that has been found before, or kNone.
  Index knownOrbit(const FoundOrbit& found) const {
    const bool inBand = found.inBand || std::abs(found.orbit.multiplier - 1.0) <= options_.bandTolerance;
    for (const EdgePassage& passage : found.passages) {
      Index orbit = limitSets_.orbitAt(passage, kSameOrbit * mesh_.meanEdgeLength());
      if (orbit == kNone && inBand && passage.halfedge != kNone) {
        orbit = limitSets_.bandAt(TriangleMesh::face(passage.halfedge));
      }
      if (orbit != kNone) return orbit;
    }
    return kNone;
  }

  void acceptOrbit(StreamlineSearch& streamline, const FoundOrbit& found) {
    const Index known = knownOrbit(found);
    const Index orbit = known != kNone ? known : addOrbit(found, streamline.candidate().component);
    // The streamline has ended there, unless the flow leaves the orbit on its side.
    const SideFlow flow = limitSets_.sideFlow(orbit, found.foundSide);
    const bool forward = streamline.direction() == Direction::Forward;
    if (flow == SideFlow::Closed || flow == (forward ? SideFlow::Attracted : SideFlow::Repelled)) {
      limitSets_.addSection(orbit, found.foundSection);
      remember(orbit, orbitSearch_.facesBeside(found, found.foundSection, streamline.candidate().component));
      streamline.endIn({{EntityKind::PeriodicOrbit, orbit}, found.foundSide});
    } else {
      streamline.requireMoreReturns();
    }
  }

  /// The number of a new orbit.
  Index addOrbit(const FoundOrbit& found, Index component) {
    const Index orbit = limitSets_.orbitCount();
    limitSets_.addOrbit(found);
    orbits_.push_back(found.orbit);
    remembered_.push_back({found, {}});
    for (const SurfacePoint& p : found.orbit.points) remembered_.back().faces.push_back(p.face);
    remember(orbit, orbitSearch_.facesBeside(found, found.bestSection, component));
    if (found.orbit.kind == OrbitKind::Center) {
      seedBeyondBand(orbit, found, component);
    } else {
      seedBesideOrbit(orbit, found.bestSection);
    }
    return orbit;
  }

  void remember(Index orbit, const std::vector<Index>& faces) {
    std::vector<Index>& all = remembered_[orbit].faces;
    all.insert(all.end(), faces.begin(), faces.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }

  // The result -------------------------------------------------------------------------------------------------------

  /// The curve of its streamline, continued to the saddle.
  Separatrix separatrix(const ConnectionEvidence::OfSeparatrix& s) {
    const auto course = streamlines_[s.streamline].course();
    Separatrix result{s.saddle,       s.outgoing,    evidence_.ends[s.streamline].entity,
                      course->points, course->times, course->length};
    const FixedPoint& saddle = points_[s.saddle];
    result.length += (position(mesh_, result.points.front()) - saddle.position).norm();
    result.points.insert(result.points.begin(), saddle.point);
    result.times.insert(result.times.begin(), 0.0);
    return result;
  }

  /// places: of the orbits in the result.
  std::shared_ptr<const TopologyMemory> memory(const std::vector<Index>& places) {
    auto kept = std::make_shared<TopologyMemory>();
    kept->orbits.resize(remembered_.size());
    for (std::size_t i = 0; i < remembered_.size(); ++i) kept->orbits[places[i]] = std::move(remembered_[i]);
    for (std::size_t i = 0; i < streamlines_.size(); ++i) {
      const StreamlineEnd& end = evidence_.ends[i];
      auto course = streamlines_[i].course();
      if (end.entity.kind == EntityKind::None || !course->complete) continue;
      kept->streamlines.push_back({streamlines_[i].seed(), end, std::move(course)});
    }
    return kept;
  }

  const FlatFaces& faces_;
  const VectorField& field_;
  const TriangleMesh& mesh_;
  const std::vector<FixedPoint>& points_;
  const RecurrentComponents& components_;
  const TopologyOptions& options_;
  Recollection* known_;
  Progress* progress_;
  const std::vector<TrappingRegion> regions_;
  KnownLimitSets limitSets_;
  const OrbitSearch orbitSearch_;
  const CrossingTrace forward_, backward_;
  std::deque<StreamlineSearch> streamlines_;  // a deque: candidates keep their addresses while streamlines are added
  std::vector<PeriodicOrbit> orbits_;         // in the order in which they are found
  std::vector<RememberedOrbit> remembered_;   // of each orbit
  ConnectionEvidence evidence_;
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

/// topologyBefore, before: none, or of another field that is known.
Topology search(const FlatFaces& faces, const VectorField& field, const VectorField* before,
                const Topology* topologyBefore, const TopologyOptions& options, Progress* progress) {
  check(faces, field, options);
  Topology result;
  Stopwatch watch(result.seconds);
  result.fixedPoints = findFixedPoints(field, options.fixedPoints);
  result.boundaryPoints = findBoundaryPoints(field);
  result.zeros = countZeros(field);
  watch.lap("fixed_points");

  const RecurrentComponents components =
      recurrentComponents(field, geometryMap(field), facesWithZeros(field, result.fixedPoints, result.zeros));
  watch.lap("recurrent_components");

  std::optional<Recollection> known;
  if (before != nullptr) known.emplace(*topologyBefore, *before, field, result.fixedPoints);
  TopologySearch streamlines(faces, field, result.fixedPoints, components, options, known ? &*known : nullptr,
                             progress);
  streamlines.seedStreamlines(result.boundaryPoints);
  while (true) {
    streamlines.traceRound();
    watch.lap("streamlines");
    if (!streamlines.testOrbitCandidates()) break;
    watch.lap("periodic_orbits");
  }
  streamlines.collect(result);
  watch.lap("links");
  return result;
}

}  // namespace

Topology findTopology(const FlatFaces& faces, const VectorField& field, const TopologyOptions& options,
                      Progress* progress) {
  return search(faces, field, nullptr, nullptr, options, progress);
}

Topology updatedTopology(const FlatFaces& faces, const VectorField& field, const VectorField& before,
                         const Topology& topologyBefore, const TopologyOptions& options, Progress* progress) {
  if (before.values.size() != field.values.size() || topologyBefore.memory == nullptr) {
    return findTopology(faces, field, options, progress);
  }
  return search(faces, field, &before, &topologyBefore, options, progress);
}

}  // namespace stormfield
