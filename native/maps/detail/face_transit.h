// The transit map of a face: where a trajectory that enters the face leaves it.
//
// The field's component across an edge is linear (thesis 2.5), so that the boundary of a face consists of a few arcs
// over which flow enters or leaves. The transit map takes a position of an arc of entry to the position where its
// trajectory leaves, or to none where it stays. Since trajectories do not cross, it is monotone, and continuous but for
// jumps: at trajectories that come to a saddle, and at those that touch the boundary from inside. Trajectories that
// enter at a and b and leave through one arc of exit bound a box that all trajectories between them pass: the box has
// index 0, so that it holds no fixed point and no jump.
//
//   const auto flatFaces = std::make_shared<const FlatFaces>(field.charts);
//   const FaceTransit transit(flatFaces, std::make_shared<const VectorField>(field));
//   const ExitPosition exit = transit.exitOf(0, 0.5);
//   const bool same = transit.isSameArc(0, exit, kNoExit);
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "field/vector_field.h"
#include "maps/detail/face_boundary.h"
#include "maps/geometry_map.h"
#include "tracing/face_flow.h"
#include "tracing/flat_faces.h"
#include "tracing/trace.h"

namespace stormfield {

/// How flow crosses an edge, in the frame of its canonical halfedge.
struct EdgeFlow {
  /// Before the sign change: +1 into the halfedge's face, -1 out of it, 0 both ways (a fixed point lies on the edge).
  /// Beyond the sign change: the opposite.
  int sign = 0;
  double signChange = 1.0;  ///< fraction of the edge; 1: none
  /// Whether the trajectory through the sign change touches the edge from inside the halfedge's face, or from the other
  /// side.
  bool touchesInside = false;
  /// +1 where the flow runs along the edge in the direction of the halfedge, -1 against it, else 0. No trajectory
  /// crosses such an edge. The edge is a trajectory, and belongs to the arcs of entry of both its faces as the limit of
  /// what enters beside it.
  int along = 0;

  /// Whether flow may cross the edge anywhere, both ways.
  bool isOpen() const { return sign == 0 && along == 0; }
};

/// An arc of entry, or a part of it, on which the transit map is continuous, with its limits at the two ends.
struct ContinuousArc {
  BoundaryArc entry;
  ExitPosition exitOfBegin, exitOfEnd;
};

class FaceTransit {
 public:
  /// Accuracy of exit positions across the flow. Images are enclosed with this much to spare, and with more where
  /// trajectories graze the side over which they leave (widened).
  static constexpr double kSlack = 1e-5;

  /// faces: of the field's mesh.
  FaceTransit(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field);

  const TriangleMesh& mesh() const { return faces_->mesh(); }
  const EdgeFlow& edgeFlow(Index e) const { return edges_[e]; }
  /// Whether flow through the face is known by its directions across the edges only: a fixed point lies on an edge or
  /// at a vertex, or the face's index is not -1, 0 or 1.
  bool isCoarse(Index f) const { return isCoarse_[f] != 0; }
  /// Whether a fixed point lies inside the face or on its border.
  bool holdsFixedPoint(Index f) const { return holdsFixedPoint_[f] != 0; }
  const std::vector<char>& fixedPointFaces() const { return holdsFixedPoint_; }
  /// Poincare index of each face.
  const std::vector<int>& poincare() const { return poincare_; }

  /// Where the trajectory through a position leaves the face; backward, where it enters.
  ExitPosition exitOf(Index f, double position, Direction direction = Direction::Forward) const;
  /// The limit of that at one end of a part of an arc of entry, from inside the part.
  ExitPosition exitLimit(Index f, double end, double otherEnd) const;
  /// Whether two exits both do not exist or lie in one arc of exit (backward: of entry).
  bool isSameArc(Index f, ExitPosition a, ExitPosition b, Direction direction = Direction::Forward) const;
  /// The arc of exit that both exits lie in, if there is one.
  std::optional<BoundaryArc> commonExitArc(Index f, ExitPosition a, ExitPosition b) const;
  /// The arc of exit (backward: of entry) that a position lies in, or the nearest one. Length 0 when there is none.
  BoundaryArc exitArcAt(Index f, double position, Direction direction = Direction::Forward) const;
  /// Whether the trajectory through a position at an end of an arc touches the boundary there from inside the face.
  bool touchesAt(Index f, double position) const;
  /// An arc over which trajectories leave, widened by the accuracy of its ends: an error of kSlack across the flow is a
  /// larger one along a side that the flow grazes.
  BoundaryArc widened(Index f, const BoundaryArc& arc) const;

  /// The arcs of entry (backward: of exit) in continuous parts, cut at the jumps, which bisection finds.
  std::vector<ContinuousArc> continuousArcs(Index f, Direction direction = Direction::Forward) const;

 private:
  struct Arcs;
  double slackAt(Index f, double position) const;
  Arcs arcs(Index f, Direction direction) const;
  ExitPosition exitByIntegration(Index f, const SurfacePoint& from, Direction direction) const;

  std::shared_ptr<const FlatFaces> faces_;
  std::shared_ptr<const VectorField> field_;
  std::vector<EndVectors> ends_;  ///< of each edge, along its canonical halfedge
  std::vector<EdgeFlow> edges_;
  std::vector<int> poincare_;
  std::vector<char> holdsFixedPoint_, isCoarse_;
  std::unique_ptr<FaceFlow[]> along_;
};

}  // namespace stormfield
