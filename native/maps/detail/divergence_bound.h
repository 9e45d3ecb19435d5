// A bound on the distance d between the trajectories of two fields whose vectors differ by at most an error, from
// Gronwall's inequality (Gronwall 1919): two points that start together separate by
//     d' <= growth d + error.
// growth is the largest rate at which the flow lengthens a vector near them (its logarithmic norm: the largest
// eigenvalue of the gradient's symmetric part), error the bound on the difference of the two fields there. The
// inequality holds along the segment between the points, on which the field is continuous. d also never grows faster
// than the two points move.
//
// The growth of a face is that of its linear part plus that of the correction for curvature, taken at the size of the
// face. The latter is an estimate, so that the bound is rigorous where the surface is flat and estimated elsewhere.
#pragma once

#include <vector>

#include "field/vector_field.h"
#include "maps/tau_options.h"
#include "tracing/flat_faces.h"

namespace stormfield {

class DivergenceBound {
 public:
  /// faces must outlive it. growthRate: per face, of the linear part, per unit of tau. slowSpeeds: per vertex, for
  /// TauUnit::Length. error: one that checkFieldError accepts.
  DivergenceBound(const FlatFaces& faces, const VectorField& field, TauUnit unit, const std::vector<double>& growthRate,
                  const std::vector<double>& slowSpeeds, const FieldError& error);

  /// Bound on the distance after `duration` (in the unit of tau) in a face, from one before. Throws InputError where
  /// the one before exceeds the largest ring of neighbours.
  double after(double distance, Index face, double duration) const;

 private:
  /// Upper bounds in a face or in a ring of faces.
  struct Rates {
    double growth, error, speed;  ///< speed: at which the distance of two points can grow
  };
  std::vector<Rates> withNeighbours(const std::vector<Rates>& rates) const;

  const FlatFaces* faces_;
  double epsilon_;
  std::vector<std::vector<Rates>> rings_;  ///< per face, over 1, 2, 4 ... rings of neighbours
};

}  // namespace stormfield
