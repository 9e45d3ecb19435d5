// The flow phi(tau, .) of a field, prepared once for many advectors (thesis 6.3; by arc length: thesis 7.2).
//
// tau is in the flow's unit: seconds, or mesh units of arc length. Beside the trajectories, the flow has rates per
// face, per unit of tau, which bound how the images of curves grow and bend (edge_image.h).
//
//   const PreparedFlow flow(faces, field, TauUnit::Time, 1e-5);
//   const AdvectedPoint end = flow.advector(Direction::Forward, nullptr)->advect(SurfacePoint{0}, 0.5);
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "maps/point_advector.h"
#include "maps/tau_options.h"
#include "tracing/face_flow.h"
#include "tracing/flat_faces.h"
#include "tracing/trace.h"

namespace stormfield {

class DivergenceBound;

/// The faces and the field must outlive it. All members are thread-safe.
class PreparedFlow {
 public:
  /// tolerance: largest estimated error of one step of a trace, in mean edge lengths. Throws InputError for a field of
  /// another mesh, for values that are not finite, and for an error that checkFieldError refuses.
  PreparedFlow(const FlatFaces& faces, const VectorField& field, TauUnit unit, double tolerance,
               const FieldError& error = {});

  const FlatFaces& faces() const { return *faces_; }
  const TriangleMesh& mesh() const { return faces_->mesh(); }
  const VectorField& field() const { return *field_; }
  TauUnit unit() const { return unit_; }
  /// Forward advectors bound the radius of their images. Advectors check the progress and throw Cancelled.
  std::unique_ptr<PointAdvector> advector(Direction direction, const Progress* progress) const;
  /// Whether the field points out of the surface somewhere on a boundary halfedge.
  bool flowsOut(Index h) const { return flowsOut_[h] != 0; }
  bool holdsFixedPoint(Index f) const { return holdsFixedPoint_[f] != 0; }
  /// Largest rate at which the length of a vector grows in a face (its logarithmic norm: Dahlquist 1958); less than 0
  /// where all vectors shrink.
  double growthRate(Index f) const { return growthRate_[f]; }
  /// Rate at which an area grows in a face.
  double divergenceRate(Index f) const { return divergenceRate_[f]; }
  /// Frobenius norm of the gradient in a face.
  double gradientNorm(Index f) const { return gradientNorm_[f]; }
  /// Number of equal steps in which images are followed for tau: a power of two, so that the field changes little along
  /// most trajectories within a step, but at most 128.
  int stepCount(double tau) const;

 private:
  void measureFaces();

  const FlatFaces* faces_;
  const VectorField* field_;
  TauUnit unit_;
  double tolerance_;
  double stepTau_;  ///< in which the field turns by kRotationOfStep; infinite for a field that is zero
  std::vector<double> slowSpeeds_, growthRate_, divergenceRate_, gradientNorm_;
  std::vector<char> flowsOut_, holdsFixedPoint_;
  std::unique_ptr<FaceFlow[]> along_, against_;             ///< per face, for TauUnit::Time
  std::shared_ptr<const DivergenceBound> divergenceBound_;  ///< null without an error
};

}  // namespace stormfield
