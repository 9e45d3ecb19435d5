#include "edit/detail/block_growth.h"

#include <algorithm>

#include "edit/detail/block_border.h"
#include "maps/geometry_map.h"
#include "tracing/trace.h"

namespace stormfield {
namespace {

std::vector<Index> entityFaces(const Topology& topology, const TriangleMesh& mesh, const EntityRef& entity) {
  if (entity.kind == EntityKind::PeriodicOrbit) return facesAlong(mesh, topology.periodicOrbits[entity.index].points);
  return facesAt(mesh, topology.fixedPoints[entity.index].point);
}

/// All entities of a topology.
std::vector<EntityRef> entities(const Topology& topology) {
  std::vector<EntityRef> result;
  for (std::size_t i = 0; i < topology.fixedPoints.size(); ++i) {
    result.push_back({EntityKind::FixedPoint, static_cast<Index>(i)});
  }
  for (std::size_t i = 0; i < topology.periodicOrbits.size(); ++i) {
    result.push_back({EntityKind::PeriodicOrbit, static_cast<Index>(i)});
  }
  return result;
}

FaceSets oneSet(const FaceRegion& region) {
  std::vector<Index> setOf(region.mesh().faceCount(), kNone);
  for (const Index f : region.faces()) setOf[f] = 0;
  return {std::move(setOf), 1};
}

bool touchesBoundary(const TriangleMesh& mesh, const std::vector<Index>& faces) {
  return std::any_of(faces.begin(), faces.end(), [&](Index f) {
    return mesh.twin(3 * f) == kNone || mesh.twin(3 * f + 1) == kNone || mesh.twin(3 * f + 2) == kNone;
  });
}

int componentCount(const FaceRegion& region) {
  std::vector<char> seen(region.mesh().faceCount(), 0);
  int count = 0;
  for (const Index f : region.faces()) {
    if (seen[f] != 0) continue;
    connected(region, f, seen);
    ++count;
  }
  return count;
}

/// Adds the faces that flow reaches, or comes from, across one edge after the other.
void spread(const VectorField& field, const FaceRegion& within, Direction direction, FaceRegion& region) {
  const TriangleMesh& mesh = field.mesh();
  for (std::size_t i = 0; i < region.faces().size(); ++i) {
    const Index f = region.faces()[i];
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (mesh.twin(h) == kNone || !within.holds(TriangleMesh::face(mesh.twin(h)))) continue;
      const EndVectors ends = endVectors(field, h);
      const double sign = direction == Direction::Forward ? -1.0 : 1.0;
      const bool crosses = sign * ends.tail.imag() > 0.0 || sign * ends.head.imag() > 0.0;
      if (crosses || holdsFixedPointOnEdge(ends)) region.add(TriangleMesh::face(mesh.twin(h)));
    }
  }
}

}  // namespace

std::vector<Index> facesAlong(const TriangleMesh& mesh, const std::vector<SurfacePoint>& curve) {
  std::vector<Index> faces;
  for (const SurfacePoint& p : curve) {
    for (const Index f : facesAt(mesh, p)) faces.push_back(f);
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

BlockGrowth::BlockGrowth(const VectorField& field, const Topology& topology, const Interval& interval)
    : field_(field), entityFaces_(field.mesh().faceCount(), 0), separatrixFaces_(field.mesh().faceCount(), 0) {
  const TriangleMesh& mesh = field.mesh();
  for (const EntityRef& entity : entities(topology)) {
    for (const Index f : entityFaces(topology, mesh, entity)) {
      if (interval.holds(entity)) {
        core_.push_back(f);
      } else {
        entityFaces_[f] = 1;
      }
    }
  }
  for (std::size_t s = 0; s < topology.separatrices.size(); ++s) {
    const Separatrix& separatrix = topology.separatrices[s];
    const bool from = interval.holds({EntityKind::FixedPoint, separatrix.saddle}), to = interval.holds(separatrix.end);
    if (from != to) continue;
    for (const Index f : facesAlong(mesh, separatrix.points)) {
      if (from) {
        core_.push_back(f);
      } else {
        separatrixFaces_[f] = 1;
      }
    }
  }
  std::sort(core_.begin(), core_.end());
  core_.erase(std::unique(core_.begin(), core_.end()), core_.end());
}

BlockGrowth BlockGrowth::withCore(const std::vector<Index>& faces) const {
  BlockGrowth larger = *this;
  larger.core_.insert(larger.core_.end(), faces.begin(), faces.end());
  return larger;
}

bool BlockGrowth::isWall(Index face, Walls walls) const {
  return entityFaces_[face] != 0 || (walls == Walls::EntitiesAndSeparatrices && separatrixFaces_[face] != 0);
}

std::optional<Block> BlockGrowth::grown(Growth growth, int count, Walls walls) const {
  FaceRegion region = rings(count, walls);
  if (growth == Growth::Hull) region = hull(region);
  fillEnclosed(region);
  isolate(region, walls);
  fillEnclosed(region);

  Block block{.faces = region.sortedFaces(), .freeVertices = region.innerVertices(), .index = {}};
  if (block.freeVertices.empty()) return std::nullopt;
  block.components = componentCount(region);
  const FaceSets sets = oneSet(region);
  const BlockBorder border = blockBorder(field_, sets);
  block.index = conleyIndex(field_.mesh(), sets, 0, border.pair);
  block.isolating = border.internalTangencies.empty();
  return block;
}

FaceRegion BlockGrowth::rings(int count, Walls walls) const {
  FaceRegion region(field_.mesh());
  // A separatrix of the interval may pass through the face of another entity.
  for (const Index f : core_) {
    if (!isWall(f, walls)) region.add(f);
  }
  for (int i = 0; i < count; ++i) addRing(region, walls);
  return region;
}

FaceRegion BlockGrowth::hull(const FaceRegion& within) const {
  FaceRegion reached(field_.mesh()), reaching(field_.mesh()), both(field_.mesh());
  for (const Index f : core_) {
    if (!within.holds(f)) continue;
    reached.add(f);
    reaching.add(f);
    both.add(f);
  }
  spread(field_, within, Direction::Forward, reached);
  spread(field_, within, Direction::Backward, reaching);
  for (const Index f : reached.faces()) {
    if (reaching.holds(f)) both.add(f);
  }
  return both;
}

void BlockGrowth::addRing(FaceRegion& region, Walls walls) const {
  const TriangleMesh& mesh = field_.mesh();
  const std::vector<Index> before = region.faces();
  for (const Index f : before) {
    for (int k = 0; k < 3; ++k) {
      for (const Index g : facesAround(mesh, mesh.vertex(f, k))) {
        if (!isWall(g, walls)) region.add(g);
      }
    }
  }
}

void BlockGrowth::fillEnclosed(FaceRegion& region) const {
  const TriangleMesh& mesh = field_.mesh();
  std::vector<char> seen(mesh.faceCount(), 0);
  std::vector<Index> enclosed;
  for (const Index f : region.faces()) {
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      const Index twin = mesh.twin(h);
      if (twin == kNone || region.holds(TriangleMesh::face(twin)) || seen[TriangleMesh::face(twin)] != 0) continue;
      const std::vector<Index> part = connected(region, TriangleMesh::face(twin), seen);
      const bool empty = std::none_of(part.begin(), part.end(), [&](Index g) { return entityFaces_[g] != 0; });
      if (empty && !touchesBoundary(mesh, part)) enclosed.insert(enclosed.end(), part.begin(), part.end());
    }
  }
  for (const Index f : enclosed) region.add(f);
}

/// Takes in what lies beyond internal tangencies, as long as there are fewer than that many faces more.
void BlockGrowth::isolate(FaceRegion& region, Walls walls) const {
  const TriangleMesh& mesh = field_.mesh();
  const std::size_t limit = 2 * region.faces().size() + 64;
  for (bool grew = true; grew && region.faces().size() < limit;) {
    grew = false;
    for (const auto& [halfedge, atTail] : blockBorder(field_, oneSet(region)).internalTangencies) {
      std::vector<Index> beyond;
      if (atTail) beyond = facesAround(mesh, mesh.tail(halfedge));
      if (!atTail && mesh.twin(halfedge) != kNone) beyond = {TriangleMesh::face(mesh.twin(halfedge))};
      for (const Index f : beyond) {
        if (region.holds(f) || isWall(f, walls)) continue;
        region.add(f);
        grew = true;
      }
    }
  }
}

}  // namespace stormfield
