#include "topology/detail/streamline_search.h"

#include <algorithm>
#include <cmath>

namespace stormfield {
namespace {

/// Steps inside one face after which a streamline will not leave it.
constexpr int kIdleSteps = 5000;

}  // namespace

Destinations::Destinations(const TriangleMesh& mesh, const std::vector<FixedPoint>& points,
                           const std::vector<NodeBasin>& basins)
    : mesh_(mesh), points_(points), basins_(basins), hasPart_(mesh.faceCount(), 0), hasSection_(mesh.edgeCount(), 0) {
  // chi = 2 components - 2 handles - boundary loops
  hasHandles_ = 2 * mesh.componentCount() - mesh.boundaryLoopCount() > mesh.eulerCharacteristic();
  for (std::size_t i = 0; i < basins.size(); ++i) {
    for (std::size_t k = 0; k < basins[i].parts.size(); ++k) {
      const Index face = basins[i].parts[k].face;
      hasPart_[face] = 1;
      partsIn_[face].emplace_back(static_cast<Index>(i), static_cast<int>(k));
    }
  }
}

EntityRef Destinations::nodeAt(const FlatFaces& faces, const SurfacePoint& p, Direction direction) const {
  if (hasPart_[p.face] == 0) return {};
  for (const auto& [node, part] : partsIn_.at(p.face)) {
    const NodeBasin& basin = basins_[node];
    if (!(direction == Direction::Forward ? basin.forward : basin.backward)) continue;
    if (basin.parts[part].contains(faces[p.face].point(p.barycentric))) return {EntityKind::FixedPoint, node};
  }
  return {};
}

std::optional<Destinations::Arrival> Destinations::orbitBeyond(const EdgePassage& passage, Direction direction) const {
  const std::vector<Index>* candidates = nullptr;
  if (passage.halfedge != kNone) {
    if (hasSection_[mesh_.edge(passage.halfedge)] == 0) return std::nullopt;
    const auto found = sectionsOn_.find(passage.halfedge);
    if (found != sectionsOn_.end()) candidates = &found->second;
  } else if (passage.vertex != kNone) {
    const auto found = sectionsAt_.find(passage.vertex);
    if (found != sectionsAt_.end()) candidates = &found->second;
  }
  if (candidates == nullptr) return std::nullopt;
  const SideFlow wanted = direction == Direction::Forward ? SideFlow::Attracted : SideFlow::Repelled;
  for (const Index i : *candidates) {
    const OrbitSection& known = sections_[i].section;
    const double position = *known.section.at(mesh_, passage);
    if (position < known.low || position > known.high) continue;
    const int side = position < known.position ? 0 : 1;
    const SideFlow flow = sides_[sections_[i].orbit][side];
    if (flow == wanted || flow == SideFlow::Closed) {
      return Arrival{{EntityKind::PeriodicOrbit, sections_[i].orbit}, side};
    }
  }
  return std::nullopt;
}

Index Destinations::orbitAt(const EdgePassage& passage, double distance) const {
  const auto& table = passage.halfedge != kNone ? sectionsOn_ : sectionsAt_;
  const auto found = table.find(passage.halfedge != kNone ? passage.halfedge : passage.vertex);
  if (found == table.end()) return kNone;
  for (const Index i : found->second) {
    const OrbitSection& known = sections_[i].section;
    if (std::abs(*known.section.at(mesh_, passage) - known.position) <= distance) return sections_[i].orbit;
  }
  return kNone;
}

EntityRef Destinations::circledIn(Index face) const {
  if (hasPart_[face] == 0) return {};
  return {EntityKind::FixedPoint, partsIn_.at(face).front().first};
}

EntityRef Destinations::restingAt(const TriangleMesh& mesh, const SurfacePoint& p) const {
  const Vec3 here = position(mesh, p);
  EntityRef nearest;
  double squared = mesh.faceArea(p.face) * 1e-6;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double distance = (points_[i].position - here).squaredNorm();
    if (distance > squared) continue;
    squared = distance;
    nearest = {EntityKind::FixedPoint, static_cast<Index>(i)};
  }
  return nearest;
}

void Destinations::addOrbit(const FoundOrbit& found) {
  sides_.push_back(found.sides);
  addSection(orbitCount() - 1, found.best);
}

void Destinations::addSection(Index orbit, const OrbitSection& section) {
  const auto number = static_cast<Index>(sections_.size());
  sections_.push_back({orbit, section});
  const auto& halfedges = section.section.halfedges();
  for (std::size_t i = 0; i < halfedges.size(); ++i) {
    hasSection_[mesh_.edge(halfedges[i])] = 1;
    sectionsOn_[halfedges[i]].push_back(number);
    if (i > 0) sectionsAt_[mesh_.tail(halfedges[i])].push_back(number);
  }
}

void Journey::travel(FlowWalk walk, const Destinations& destinations, const std::vector<Index>& partOf,
                     const TopologyOptions& options, const Progress* progress) {
  const FlatFaces& faces = walk.faces();
  const TriangleMesh& mesh = faces.mesh();
  state = State::Going;
  bool first = true;
  int sinceCheck = 0, idle = 0;
  const TraceEnd trace = walk.run(at, [&](const SurfacePoint& p, double time, const EdgePassage& passage) {
    at = p;
    if (progress != nullptr && ++sinceCheck % 1024 == 0) progress->check();
    if (keepsPoints && (!first || points.empty())) {
      points.push_back(p);
      times.push_back(time_ + time);
    }
    // Where it stands was looked at when it came there.
    const bool resumed = first && crossings_ > 0;
    first = false;
    if (resumed) return true;
    if (const EntityRef node = destinations.nodeAt(faces, p, direction); node.kind != EntityKind::None) {
      arrive({node, 0});
      return false;
    }
    if (partOf[p.face] != part_) {
      if (within != kNone && partOf[p.face] != within) {
        arrive({});
        return false;
      }
      part_ = partOf[p.face];
      visits_.clear();
    }
    if (++steps_ >= options.maxSteps) {
      arrive({});
      return false;
    }
    if (!passage) {
      if (++idle <= kIdleSteps) return true;
      arrive({destinations.circledIn(p.face), 0});
      return false;
    }
    idle = 0;
    ++crossings_;
    if (const auto arrival = destinations.orbitBeyond(passage, direction)) {
      arrive(*arrival);
      return false;
    }
    return part_ == kNone || !cameBack(destinations, passage, time_ + time, part_);
  });
  time_ += trace.time;
  length += trace.length;
  if (trace.reason == StopReason::Boundary) arrive({{EntityKind::Boundary, kNone}, 0});
  if (trace.reason == StopReason::MinSpeed) arrive({destinations.restingAt(mesh, at), 0});
  if (trace.reason == StopReason::StepLimit) arrive({});
}

bool Journey::cameBack(const Destinations& destinations, const EdgePassage& passage, double time, Index part) {
  if (passage.halfedge == kNone) return false;
  Visits& visits = visits_[passage.halfedge];
  // To and fro across an edge without any time is no return.
  if (time <= visits.time) return false;
  visits.time = time;
  const int kept = std::min<Index>(visits.count, Visits::kKept);
  const bool often = visits.count + 1 >= returnsWanted_;
  if (often) {
    // On a sphere with holes a streamline comes nearer at each return (Jordan); around handles it can wind several
    // times before it does, and the nearest earlier crossing counts.
    int loops = 0;
    double nearest = 2.0;
    const int most = destinations.hasHandles() ? kept : 1;
    for (int back = 1; back <= most; ++back) {
      const double distance = std::abs(visits.fractions[(visits.count - back) % Visits::kKept] - passage.fraction);
      if (distance < nearest) {
        nearest = distance;
        loops = back;
      }
    }
    const Index before = visits.numbers[(visits.count - loops) % Visits::kKept];
    candidate = {passage.halfedge, passage.fraction, loops, crossings_ - before, direction, part};
    state = State::CameBack;
  }
  visits.fractions[visits.count % Visits::kKept] = passage.fraction;
  visits.numbers[visits.count % Visits::kKept] = crossings_;
  ++visits.count;
  return often;
}

}  // namespace stormfield
