// Advection of points along a flow: x -> phi(tau, x), the map behind tau maps (thesis 6.3).
//
// tau is in the unit of the flow, seconds or mesh units (prepared_flow.h). An advector belongs to one thread.
//
//   const PreparedFlow flow(faces, field, TauUnit::Time, 1e-5);
//   const auto advector = flow.advector(Direction::Forward, nullptr);
//   const AdvectedPoint end = advector->advect(SurfacePoint{0}, 0.5);
//   const std::vector<TrajectoryPoint> trajectory = advector->trajectory(SurfacePoint{0}, 0.5);
#pragma once

#include <vector>

#include "mesh/surface_point.h"

namespace stormfield {

/// The image of a point.
struct AdvectedPoint {
  SurfacePoint point;
  bool leftSurface = false;  ///< the trajectory reached the boundary, at `point`, before tau was over
  double radius = 0.0;       ///< bound on the distance to its image under any field within the error, mesh units
};

/// A point of a trajectory, and its tau from the start.
struct TrajectoryPoint {
  SurfacePoint point;
  double tau;
};

/// Points that wait for their advection by PointAdvector::advectAll. The points of one lane are advected one after the
/// other, and an arrival may add further points.
class AdvectionQueue {
 public:
  static constexpr int kMaxLanes = 32;

  virtual ~AdvectionQueue() = default;
  /// Sets the lane's next point and its tau. False: there is none now.
  virtual bool next(int lane, AdvectedPoint& from, double& tau) = 0;
  /// Receives the image of the lane's point.
  virtual void arrive(int lane, const AdvectedPoint& image) = 0;
};

/// Advects points alone or several side by side; the bits of an image do not depend on which.
class PointAdvector {
 public:
  virtual ~PointAdvector() = default;
  virtual AdvectedPoint advect(const AdvectedPoint& from, double tau) = 0;
  AdvectedPoint advect(const SurfacePoint& from, double tau) { return advect(AdvectedPoint{.point = from}, tau); }
  /// Advects the points of a queue until it has no more.
  virtual void advectAll(AdvectionQueue& queue) = 0;
  /// The points where the trajectory enters a face and where a step of the integrator ends, from start to end.
  virtual std::vector<TrajectoryPoint> trajectory(const SurfacePoint& from, double tau) = 0;
};

}  // namespace stormfield
