// The faces that the image of a mesh edge under the flow meets: adaptive sampling of the edge (thesis 7.1.1).
//
// An interval of the edge is halved until the images of its two ends and its middle are in the same or in neighbouring
// faces and nearly in line. Between them the image then follows the two chords, and leaves them by a quarter of the
// distance of the middle from the straight line of the ends (Taylor; the flow map is C1 with bounded second
// derivatives): all faces within a multiple of that distance are collected. Where the flow tears the edge (one part
// leaves the surface, another touches the boundary and goes on) or stretches it beyond double precision, the faces
// along the trajectories between the two parts are collected.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "morse/flow_mover.h"
#include "morse/unfolding.h"

namespace stormfield {

/// What one edge's image meets.
struct EdgeImage {
  std::vector<Index> faces;  ///< ascending, each once
  bool leaves = false;       ///< some of it may have left the surface
};

/// Makes edge images one after the other, at one tau; one maker per thread.
class EdgeImageMaker {
 public:
  EdgeImageMaker(const TauFlow& flow, double tau, const Progress* progress);

  /// tail and head are the arrivals of the ends of the edge's canonical halfedge. The reference is valid until the next
  /// call.
  const EdgeImage& make(Index edge, const Arrival& tail, const Arrival& head);
  /// Traces so far.
  std::size_t traces() const { return traces_; }

 private:
  struct Sample {
    double s;  ///< along the edge, from 0 to 1
    Arrival at;
  };

  SurfacePoint pointAt(double s) const;
  Sample sample(double s);
  void interval(const Sample& a, const Sample& b, int level);
  bool accept(const Sample& a, const Sample& middle, const Sample& b, int level);
  bool enclose(const Arrival& a, const Arrival& middle, const Arrival& b);
  void bridge(const Sample& a, const Sample& b);
  void addTorn(const Sample& staying);
  void addParting(const Sample& a, const Sample& b);

  const TauFlow* flow_;
  double tau_;
  std::unique_ptr<Mover> forward_, backward_;
  NearFaces near_;
  Index halfedge_ = kNone;
  EdgeImage image_;
  std::size_t traces_ = 0, samples_ = 0;  ///< in all, and of the edge at hand
};

}  // namespace stormfield
