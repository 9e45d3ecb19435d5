// How every field within an error bound flows through one face: face_transit.h for all of them at once.
//
// Let |W - V| <= epsilon(p) at every point, epsilon(p) being epsilon times the weights at the vertices, blended as the
// field is. Where |V| > epsilon, W points within alpha = asin(epsilon / |V|) of V. In a face let alpha be the largest
// such angle. V turned by alpha is again a field of the face (the interpolation commutes with turning, also where the
// surface is curved), and its trajectories are barriers: W crosses those of V turned to the right from their right side
// to their left side only, those of V turned to the left the other way. So what enters over the part [a, b] of the
// boundary, counter-clockwise, leaves over the arc
//     from where the right extreme from b leaves, counter-clockwise, to where the left extreme from a leaves,
// whatever the field does in between, steady or not. The arcs grow with epsilon, and with the part.
//
// An extreme that leaves where it should enter bounds nothing: the arc then begins at b itself (ends at a). This is so
// about places where V runs along the edge, and fields within the bound cross it both ways. Only the points of [a, b]
// over which the cone of alpha points into the face count.
//
// Where trajectories touch the boundary from within, some of what comes near leaves there and the rest goes on, to
// leave somewhere else. In between lies what leaves after it has entered beyond the place of touching: the extreme from
// there, on the side of what goes on, is a barrier too, and that is taken out of the arc.
//
// A face that some field within the bound can rest in (error_bound.h) has no such arcs: whatever enters it may come to
// rest, or leave anywhere.
//
// The extremes are turned further by kSpare, against the errors of following them and so that they part from an edge
// that they touch.
//
//   const ConeTransit cones(faces, field, 0.01);
//   cones.crossing(e, 0.0, 0.5);                 // over the first half of the edge's canonical halfedge
//   const ExitArcs arcs = cones.leaving(f, side, 0.25, 0.5);
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "field/vector_field.h"
#include "maps/detail/face_transit.h"
#include "maps/geometry_map.h"
#include "tracing/flat_faces.h"

namespace stormfield {

/// Parts of the boundary of a face.
struct ExitArcs {
  std::array<BoundaryArc, 16> arcs{};
  int count = 0;

  void add(const BoundaryArc& arc) { arcs[count++] = arc; }
  /// Takes the inner points of a part out.
  void takeOut(const BoundaryArc& part);

  const BoundaryArc* begin() const { return arcs.data(); }
  const BoundaryArc* end() const { return arcs.data() + count; }
};

class ConeTransit {
 public:
  /// Radians, of the extremes beyond alpha.
  static constexpr double kSpare = 1e-5;

  /// faces: of the field's mesh. weights: one per vertex, factors of epsilon; empty for 1 everywhere. Throws InputError
  /// for an epsilon or weights that are not numbers >= 0.
  ConeTransit(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field, double epsilon,
              const std::vector<double>& weights = {});
  /// The same field and weights with another epsilon; shares what both need. Throws InputError as above.
  ConeTransit withinEpsilon(double epsilon) const;

  double epsilon() const { return epsilon_; }
  /// Whether a field within the bound can rest in the face, or nearly.
  bool mayHoldFixedPoint(Index f) const { return resting_[f] != 0; }
  const std::vector<char>& fixedPointFaces() const { return resting_; }

  /// How fields within the bound cross a part of an edge: +1 into the face of its canonical halfedge only, -1 out of it
  /// only, 0 both ways.
  int crossing(Index e, double from, double to) const;
  /// Places on an edge, ascending, where that changes: two at most.
  std::vector<double> turns(Index e) const;

  /// Over what arcs flow can leave a face that does not rest which entered it over a part of a side, fractions from
  /// `begin` to `end`; it may also leave over that part itself. None where nothing enters.
  ExitArcs leaving(Index f, int side, double begin, double end) const;

 private:
  struct Given {
    std::shared_ptr<const FlatFaces> faces;
    std::shared_ptr<const VectorField> field;
    std::vector<double> weights;      ///< per vertex
    std::vector<EndVectors> ends;     ///< per edge, along its canonical halfedge
    std::vector<double> faceEpsilon;  ///< per face
  };
  enum class Side { Right, Left };

  ConeTransit(std::shared_ptr<const Given> given, double epsilon);
  const TriangleMesh& mesh() const { return given_->faces->mesh(); }
  EndVectors endsOf(Index h) const;
  BoundaryArc leavingPart(Index f, int side, double begin, double end, double alpha) const;
  double extreme(Index f, int side, double begin, double end, double alpha, Side which) const;
  void takeOutBeyondTouching(Index f, int side, double begin, double end, double alpha, ExitArcs& arcs) const;
  double leaves(Index f, int side, double fraction, double turn) const;

  std::shared_ptr<const Given> given_;
  double epsilon_;
  std::vector<char> resting_;
};

}  // namespace stormfield
