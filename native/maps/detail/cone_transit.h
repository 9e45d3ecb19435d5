// How every field within an error bound flows through one face: face_transit.h for all of them at once.
//
// Let |W - V| <= epsilon(p) at every point p, where epsilon(p) is epsilon times the weights at the vertices, blended as
// the field is. Where |V| > epsilon, W points within alpha = asin(epsilon / |V|) of V: within a cone. In a face let
// alpha be the largest such angle. V rotated by alpha is again a field of the face, because the interpolation commutes
// with rotation, also where the surface is curved. The trajectories of the two rotated fields, the extremes, are
// barriers: W crosses those of V rotated to the right from their right side to their left side only, and those of V
// rotated to the left the other way. So what enters over the part [a, b] of the boundary, counter-clockwise, leaves
// over the arc
//     from where the right extreme from b leaves, counter-clockwise, to where the left extreme from a leaves,
// whatever W does between, steady or not. The arcs grow with epsilon and with the part.
//
// An extreme that leaves where it should enter bounds nothing: the arc then begins at b itself (ends at a). This is so
// around places where V runs along the edge, which fields within the bound cross both ways. Only the points of [a, b]
// over which the cone points into the face count.
//
// Where trajectories touch the boundary from inside, some of those nearby leave there and the others continue and leave
// elsewhere. What leaves between these two places entered beyond the tangency. The extreme from the tangency, on the
// side of those that continue, is a barrier too, and what it encloses is taken out of the arc.
//
// A face that may hold a fixed point of some field within the bound (error_bound.h) has no such arcs: what enters it
// may stay, or leave anywhere.
//
// The extremes are rotated by kSpare more, against the errors of tracing them and so that they part from an edge that
// they touch.
//
//   const auto flatFaces = std::make_shared<const FlatFaces>(field.charts);
//   const ConeTransit cones(flatFaces, std::make_shared<const VectorField>(field), 0.01);
//   const int sign = cones.crossingSign(0, 0.0, 0.5);  // over the first half of edge 0's canonical halfedge
//   const ExitArcs arcs = cones.exitArcs(0, 1, 0.25, 0.5);
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "field/vector_field.h"
#include "maps/detail/face_boundary.h"
#include "maps/geometry_map.h"
#include "tracing/flat_faces.h"

namespace stormfield {

/// Arcs over which flow can leave a face.
struct ExitArcs {
  std::array<BoundaryArc, 16> arcs{};
  int count = 0;

  void add(const BoundaryArc& arc) { arcs[count++] = arc; }
  /// Removes the inner points of an arc.
  void remove(const BoundaryArc& arc);

  const BoundaryArc* begin() const { return arcs.data(); }
  const BoundaryArc* end() const { return arcs.data() + count; }
};

class ConeTransit {
 public:
  /// Rotation of the extremes beyond alpha, radians: above the relative error of tracing them.
  static constexpr double kSpare = 1e-5;

  /// faces: of the field's mesh. weights: one per vertex, factors of epsilon; empty for 1 everywhere. Throws InputError
  /// for an epsilon or weights that are not numbers >= 0, and for a wrong number of weights.
  ConeTransit(std::shared_ptr<const FlatFaces> faces, std::shared_ptr<const VectorField> field, double epsilon,
              const std::vector<double>& weights = {});
  /// The same field and weights with another epsilon; shares what both need. Throws InputError as above.
  ConeTransit withinEpsilon(double epsilon) const;

  double epsilon() const { return epsilon_; }
  /// Whether the face can hold a fixed point of a field within the bound, or nearly.
  bool mayHoldFixedPoint(Index f) const { return mayHoldFixedPoint_[f] != 0; }
  const std::vector<char>& fixedPointFaces() const { return mayHoldFixedPoint_; }

  /// How fields within the bound cross a part of an edge: +1 into the face of its canonical halfedge only, -1 out of it
  /// only, 0 both ways.
  int crossingSign(Index e, double from, double to) const;
  /// The fractions of an edge, ascending, at which that changes: two at most.
  std::vector<double> signChanges(Index e) const;

  /// The arcs over which flow can leave a face without a fixed point after it entered over a part of a side, fractions
  /// from `begin` to `end`. It may also leave over that part itself. No arcs where nothing enters.
  ExitArcs exitArcs(Index f, int side, double begin, double end) const;

 private:
  /// What does not depend on epsilon.
  struct Shared {
    std::shared_ptr<const FlatFaces> faces;
    std::shared_ptr<const VectorField> field;
    std::vector<double> weights;      ///< per vertex
    std::vector<EndVectors> ends;     ///< per edge, along its canonical halfedge
    std::vector<double> faceEpsilon;  ///< per face the least epsilon for a fixed point
  };
  enum class Side { Right, Left };

  static std::shared_ptr<const Shared> share(std::shared_ptr<const FlatFaces> faces,
                                             std::shared_ptr<const VectorField> field,
                                             const std::vector<double>& weights);
  ConeTransit(std::shared_ptr<const Shared> shared, double epsilon);
  const TriangleMesh& mesh() const { return shared_->faces->mesh(); }
  EndVectors endsOf(Index h) const;
  BoundaryArc exitArc(Index f, int side, double begin, double end, double alpha) const;
  double exitOfExtreme(Index f, int side, double begin, double end, double alpha, Side which) const;
  void removeBeyondTangencies(Index f, int side, double begin, double end, double alpha, ExitArcs& arcs) const;
  ExitPosition exitOfRotated(Index f, int side, double fraction, double angle) const;

  std::shared_ptr<const Shared> shared_;
  double epsilon_;
  std::vector<char> mayHoldFixedPoint_;
};

}  // namespace stormfield
