// How far the trajectories of two fields part whose vectors differ by at most an error: the distance d of two points
// that start together grows by
//     d' <= growth d + error,
// growth being the largest rate at which the flow draws a vector out near them (the symmetric part of the gradient),
// error the bound on the difference of the fields there (Gronwall's inequality along the segment between the points,
// along which the field is continuous), and never faster than the two can move. A face's growth is that of its linear
// part and of the correction for curvature as seen at the size of the face: an estimate, as that of edge images is, and
// rigorous where the surface is flat.
#pragma once

#include <vector>

#include "maps/tau_map.h"

namespace stormfield {

/// Throws InputError for an epsilon or weights that are not numbers >= 0, for a wrong number of weights, and for an
/// epsilon > 0 on a surface with a boundary (what leaves in one field may pass in another).
void checkError(const TriangleMesh& mesh, const FieldError& error);

class DivergenceBound {
 public:
  /// growth: per face, of the linear part, per unit of tau. slowSpeeds: per vertex, for TauUnit::Length.
  DivergenceBound(const FlatFaces& faces, const VectorField& field, TauUnit unit, const std::vector<double>& growth,
                  const std::vector<double>& slowSpeeds, const FieldError& error);

  /// The distance after a while in a face. Throws InputError where it is beyond all that can be told.
  double after(double distance, Index face, double duration) const;

 private:
  struct Rates {
    double growth, error, fastest;
  };
  /// The largest of each face and of those around its corners.
  std::vector<Rates> around(const std::vector<Rates>& rates) const;

  const FlatFaces* faces_;
  double epsilon_;
  std::vector<std::vector<Rates>> within_;  ///< 1, 2, 4 ... rings of neighbours, per face
};

}  // namespace stormfield
