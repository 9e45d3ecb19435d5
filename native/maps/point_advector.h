// Moving points along a flow for a given tau: the map phi(tau, x) behind tau maps (thesis 6.3).
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "maps/detail/divergence_bound.h"
#include "maps/tau_map.h"
#include "tracing/face_flow.h"
#include "tracing/trace.h"

namespace stormfield {

/// Where a point has come to.
struct AdvectedPoint {
  SurfacePoint point;
  bool left = false;    ///< the boundary stopped it, at point, before tau was over
  double radius = 0.0;  ///< how far from it fields within the error may have taken it, mesh units
};

/// A point on the way, and how much of tau it took to get there.
struct TrajectoryPoint {
  SurfacePoint point;
  double tau;
};

/// Points to move, for PointAdvector::advectAll: what arrives may ask for more of them. Of one lane they come one after
/// the other.
class AdvectionQueue {
 public:
  static constexpr int kLanes = 32;  ///< at most

  virtual ~AdvectionQueue() = default;
  /// Where the lane's next point has come to and how far to move it; false where there is none now.
  virtual bool next(int lane, AdvectedPoint& from, double& tau) = 0;
  virtual void arrive(int lane, const AdvectedPoint& at) = 0;
};

/// AdvectionQueue points along the flow, alone or several side by side, to the same bits; one advector per thread.
class PointAdvector {
 public:
  virtual ~PointAdvector() = default;
  virtual AdvectedPoint advect(const AdvectedPoint& from, double tau) = 0;
  AdvectedPoint advect(const SurfacePoint& from, double tau) { return advect(AdvectedPoint{.point = from}, tau); }
  /// Until there are no more.
  virtual void advectAll(AdvectionQueue& moves) = 0;
  /// All points where the trajectory enters a face or a step of the integrator ends, from the first to the last.
  virtual std::vector<TrajectoryPoint> trajectory(const SurfacePoint& from, double tau) = 0;
};

/// The flow of a field in time or arc length, prepared once for many advectors. The faces and the field must outlive
/// it.
class PreparedFlow {
 public:
  /// Throws InputError for a field of another mesh or with values that are not finite, and for an error without meaning
  /// or on a surface with a boundary.
  PreparedFlow(const FlatFaces& faces, const VectorField& field, TauUnit unit, double tolerance,
               const FieldError& error = {});

  const FlatFaces& faces() const { return *faces_; }
  const TriangleMesh& mesh() const { return faces_->mesh(); }
  const VectorField& field() const { return *field_; }
  TauUnit unit() const { return unit_; }
  /// Movers look at the progress now and then and throw Cancelled. Forward, arrivals come with their radius.
  std::unique_ptr<PointAdvector> advector(Direction direction, const Progress* progress) const;
  /// Whether the field points out of the surface somewhere on a boundary halfedge.
  bool flowsOut(Index h) const { return flowsOut_[h] != 0; }
  /// Whether the face holds a fixed point (recurrence.h).
  bool holdsFixedPoint(Index f) const { return holdsFixedPoint_[f] != 0; }
  /// How fast the flow draws curves apart and bends them in a face, per unit of tau: the largest rates at which a
  /// vector and an area grow there (less than 0 where all shrink), and the size of the field's gradient.
  double growth(Index f) const { return growth_[f]; }
  double divergence(Index f) const { return divergence_[f]; }
  double bending(Index f) const { return bending_[f]; }
  /// Time, or length, in which the field changes little along most trajectories; infinite for a field that is zero.
  double stepTau() const { return stepTau_; }

 private:
  void measureFaces();

  const FlatFaces* faces_;
  const VectorField* field_;
  TauUnit unit_;
  double tolerance_, stepTau_;
  std::vector<double> slowSpeeds_, growth_, divergence_, bending_;
  std::vector<char> flowsOut_, holdsFixedPoint_;
  std::unique_ptr<FaceFlow[]> along_, against_;             ///< per face, for advectors in time
  std::unique_ptr<const DivergenceBound> divergenceBound_;  ///< where there is an error
};

}  // namespace stormfield
