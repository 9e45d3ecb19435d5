// How the flow passes through one face: from where a trajectory enters, over the boundary of the face, to where it
// leaves.
//
// The boundary of a face is a circle; a position on it is side + fraction, from 0 to 3. The component of the field
// across an edge is linear (thesis 2.5), so that the circle falls into a few arcs along which flow enters or leaves.
// The transit map takes the points of an arc of entry to where their trajectories leave, or to rest when they stay.
// Since trajectories do not cross, it is monotone, and continuous but for jumps: trajectories that come to a saddle,
// and those that touch the boundary from within. Trajectories that enter at a and b and leave through one arc of exit
// bound a box that all between them pass: there is no fixed point in it (its index is 0), and no jump.
//
//   const FaceTransit transit(faces, field);
//   const double to = transit.leaves(f, from);        // or FaceTransit::kRest
//   transit.sameArc(f, to, other);
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "field/vector_field.h"
#include "maps/geometry_map.h"
#include "tracing/face_flow.h"
#include "tracing/flat_faces.h"
#include "tracing/trace.h"

namespace stormfield {

/// How flow crosses an edge, seen along its canonical halfedge.
struct EdgeFlow {
  /// Before the turn: +1 into the halfedge's face, -1 out of it, 0 both ways (a fixed point rests on the edge). Beyond
  /// the turn, which is 1 where there is none, the other way.
  int sign = 0;
  double turn = 1.0;
  /// Whether the trajectory through the turn touches the edge within the halfedge's face, or in the other one.
  bool touchesWithin = false;
  /// +1 where the flow runs along the edge, as the halfedge does, -1 against it, else 0. No trajectory crosses such an
  /// edge: it is one, and counts to the arcs of entry of both its faces, as the limit of what comes in beside it.
  int along = 0;

  /// Whether flow may cross it anywhere, both ways.
  bool isOpen() const { return sign == 0 && along == 0; }
};

/// Part of the boundary of a face, from `begin` counter-clockwise.
struct BoundaryArc {
  double begin = 0.0, length = 0.0;
};

/// Part of an arc of entry without jumps, with the images of its ends as limits from within.
struct ContinuousArc {
  BoundaryArc entry;
  double imageOfBegin, imageOfEnd;
};

class FaceTransit {
 public:
  static constexpr double kRest = -1.0;
  /// Accuracy of positions across the flow: images are enclosed with so much to spare, and more where trajectories
  /// graze the side that they leave over (widened).
  static constexpr double kSlack = 1e-5;

  FaceTransit(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field);

  const TriangleMesh& mesh() const { return faces_->mesh(); }
  const EdgeFlow& edgeFlow(Index e) const { return edges_[e]; }
  /// Whether flow through the face is only known by its directions across the edges: a fixed point rests on one.
  bool isCoarse(Index f) const { return coarse_[f] != 0; }
  /// Whether it holds a fixed point, inside or on its boundary.
  bool holdsFixedPoint(Index f) const { return resting_[f] != 0; }
  const std::vector<char>& fixedPointFaces() const { return resting_; }
  const std::vector<int>& poincare() const { return poincare_; }

  /// Where the trajectory through a position leaves the face, or where it comes from; kRest when it stays.
  double leaves(Index f, double position, Direction direction = Direction::Forward) const;
  /// The same for an end of a part of an arc of entry, as its limit from within the part.
  double leavesFromEnd(Index f, double end, double otherEnd) const;
  /// Whether two places where trajectories leave are both rest or in one arc of exit (going back: of entry).
  bool sameArc(Index f, double a, double b, Direction direction = Direction::Forward) const;
  /// The arc of exit of a place where trajectories leave, and whether another one lies in it too (rest lies in none).
  std::pair<BoundaryArc, bool> arcOfBoth(Index f, double a, double b) const;
  /// Whether the trajectory through an end of an arc touches the boundary there from within the face.
  bool touchesAt(Index f, double position) const;
  /// An arc over which trajectories leave, widened by the accuracy of its ends: what is kSlack across the flow is more
  /// along a side that the flow grazes.
  BoundaryArc widened(Index f, const BoundaryArc& arc) const;
  /// The arc of exit that a position lies in, or the nearest one. Length 0 when there is none.
  BoundaryArc arcOf(Index f, double position, Direction direction = Direction::Forward) const;

  /// The arcs of entry in continuous parts, cut at the jumps, which are found by bisection.
  std::vector<ContinuousArc> parts(Index f, Direction direction = Direction::Forward) const;

 private:
  struct Arcs;
  double slackAt(Index f, double position) const;
  Arcs arcs(Index f, Direction direction) const;
  double leavesSlowly(Index f, const SurfacePoint& from, Direction direction) const;

  std::shared_ptr<const FlatFaces> faces_;
  std::shared_ptr<const VectorField> field_;
  std::vector<EndVectors> ends_;  ///< of each edge, along its canonical halfedge
  std::vector<EdgeFlow> edges_;
  std::vector<int> poincare_;
  std::vector<char> resting_, coarse_;
  std::unique_ptr<FaceFlow[]> along_;
};

}  // namespace stormfield
