// The block of an edit: a set N of faces around an interval of the entity connection graph, which alone may change, with
// its exit set and Conley index (thesis 2.3, 4.3; docs/algorithms/edits.md).
//
// N grows ring by ring from the faces of the entities and of the separatrices between them. Faces of other entities,
// and of separatrices between them, are walls. Regions that N encloses and that hold no entity belong to it. Where
// the flow touches the border of N from inside, the faces beyond join, so that N becomes an isolating block.
//
//   const BlockGrowth growth(field, topology, interval);
//   const std::optional<Block> block = growth.grown(Growth::Rings, 2, Walls::EntitiesAndSeparatrices);
#pragma once

#include <optional>
#include <vector>

#include "edit/detail/face_region.h"
#include "edit/interval.h"
#include "morse/conley_index.h"

namespace stormfield {

struct Block {
  std::vector<Index> faces;         ///< N, ascending
  std::vector<Index> freeVertices;  ///< all faces around which are in N, away from the surface's boundary; ascending
  ConleyIndex index;                ///< of (N, L)
  bool isolating = false;           ///< else the index is none of the flow's
  int components = 0;               ///< of the faces of N that hang together by edges
};

/// How a block is made from the faces of its core.
enum class Growth {
  Rings,  ///< all faces within a number of rings
  /// Of these, those that flow reaches from the core and that reach the core by the geometry-based map: between two of
  /// the rings' faces flow crosses the border in one direction.
  Hull
};

/// What a block keeps away from besides the entities outside its interval.
enum class Walls { EntitiesAndSeparatrices, Entities };

class BlockGrowth {
 public:
  BlockGrowth(const VectorField& field, const Topology& topology, const Interval& interval);

  /// None where walls leave no face around an entity, or where no vertex is free.
  std::optional<Block> grown(Growth growth, int rings, Walls walls) const;
  bool isWall(Index face, Walls walls) const;
  /// The same with further faces in the core.
  BlockGrowth withCore(const std::vector<Index>& faces) const;
  /// Faces of the entities of the interval and of the separatrices between them.
  const std::vector<Index>& core() const { return core_; }

 private:
  FaceRegion rings(int count, Walls walls) const;
  FaceRegion hull(const FaceRegion& within) const;
  void addRing(FaceRegion& region, Walls walls) const;
  void fillEnclosed(FaceRegion& region) const;
  void isolate(FaceRegion& region, Walls walls) const;
  const VectorField& field_;
  std::vector<Index> core_;
  std::vector<char> entityFaces_;      ///< of entities outside the interval
  std::vector<char> separatrixFaces_;  ///< of separatrices that have nothing to do with the interval
};

/// Faces of a closed or open curve.
std::vector<Index> facesAlong(const TriangleMesh& mesh, const std::vector<SurfacePoint>& curve);

}  // namespace stormfield
