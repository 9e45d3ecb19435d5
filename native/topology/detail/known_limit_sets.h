// The limit sets that are known already (fixed points, periodic orbits and bands; thesis 2.2.1), and the places on the
// surface from which a streamline ends in one of them.
//
//   KnownLimitSets limitSets(mesh, fixedPoints, trappingRegions);
//   const EntityRef node = limitSets.fixedPointTrapping(faces, p, Direction::Forward);
#pragma once

#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "topology/detail/orbit_search.h"
#include "topology/detail/trapping_region.h"

namespace stormfield {

/// What a streamline ends in.
struct StreamlineEnd {
  EntityRef entity;
  OrbitSide side = OrbitSide::Left;  ///< of an orbit: the side from which the streamline comes
};

/// Grows between the rounds of the search and is only read while streamlines are traced. The mesh, the fixed points and
/// their regions are kept by reference.
class KnownLimitSets {
 public:
  KnownLimitSets(const TriangleMesh& mesh, const std::vector<FixedPoint>& points,
                 const std::vector<TrappingRegion>& regions);

  /// The fixed point whose trapping region holds p, for a streamline of this direction.
  EntityRef fixedPointTrapping(const FlatFaces& faces, const SurfacePoint& p, Direction direction) const;
  /// The fixed point around which a streamline stays that does not leave this face.
  EntityRef centerIn(Index face) const;
  /// The fixed point, of any kind, next to which a streamline has stopped.
  EntityRef fixedPointNear(const SurfacePoint& p) const;
  /// The orbit that a streamline approaches once it crosses this edge or vertex.
  std::optional<StreamlineEnd> orbitReachedFrom(const EdgePassage& passage, Direction direction) const;
  /// The orbit to which this passage belongs, within a distance (mesh units); kNone where there is none.
  Index orbitAt(const EdgePassage& passage, double distance) const;
  /// The orbit whose band covers a face, kNone where there is none.
  Index bandAt(Index face) const;
  /// Whether the surface has genus 1 or more.
  bool hasHandles() const { return hasHandles_; }

  void addOrbit(const FoundOrbit& found);
  void addSection(Index orbit, const OrbitSection& section);
  void addBandFace(Index face, Index orbit) { bands_.try_emplace(face, orbit); }
  Index orbitCount() const { return static_cast<Index>(sides_.size()); }
  SideFlow sideFlow(Index orbit, OrbitSide side) const { return sides_[orbit][side]; }

 private:
  struct KnownSection {
    Index orbit;
    OrbitSection section;
  };

  const TriangleMesh& mesh_;
  const std::vector<FixedPoint>& points_;
  const std::vector<TrappingRegion>& regions_;
  std::unordered_map<Index, std::vector<std::pair<Index, int>>> ellipsesIn_;  ///< region and ellipse in it, by face
  std::vector<char> hasEllipse_, hasSection_;                                 ///< by face, by edge: before the look-up
  std::vector<BothSides<SideFlow>> sides_;                                    ///< by orbit
  std::vector<KnownSection> sections_;
  std::unordered_map<Index, std::vector<Index>> sectionsOn_, sectionsAt_;  ///< by halfedge, by vertex
  std::unordered_map<Index, Index> bands_;                                 ///< orbit by face
  bool hasHandles_ = false;
};

}  // namespace stormfield
