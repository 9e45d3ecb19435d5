// The faces that the image of a mesh edge under the flow meets: adaptive sampling of the edge (thesis 7.1.1).
//
// An interval of the edge is halved until the images of its two ends and its middle are in the same or in neighbouring
// faces and nearly in line, at the end and on the way there, in steps that the field changes little in: a piece that
// the flow draws out and folds back would not be seen at the end. Between samples the image follows the chords. How far
// it may leave them is estimated along with it: it grows at the rate at which the flow draws vectors out, is fed where
// a chord lies in more than one face (within one, the field is all but linear), and is at least the distance of the
// middle from the straight line of the ends. All faces within that distance of the chords are collected. Where the flow
// tears the edge (one part leaves the surface, another touches the boundary and goes on) or stretches it beyond double
// precision, the faces along the trajectories between the two parts are collected.
//
// Inside a Morse set an image is followed in steps, and only as long as it comes back to the set (set_windows.h): what
// a step takes away from it is not sampled further.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "morse/flow_mover.h"
#include "morse/set_windows.h"
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
  /// windows: of the set that images are followed in, or null. It must outlive the maker.
  EdgeImageMaker(const TauFlow& flow, double tau, int steps, const SetWindows* windows, const Progress* progress);

  /// tail and head are the arrivals of the ends of the edge's canonical halfedge after the first steps, one at least.
  /// The reference is valid until the next call.
  const EdgeImage& make(Index edge, const std::vector<Arrival>& tail, const std::vector<Arrival>& head);
  /// Traces so far.
  std::size_t traces() const { return traces_; }

 private:
  /// A point of the edge on its way, as far as it was followed.
  struct Sample {
    double s;  ///< along the edge, from 0 to 1
    int step;  ///< so many steps of tau were followed
    Arrival at;
    const std::vector<Arrival>* known = nullptr;  ///< first steps that need no tracing
  };
  /// How the images of an interval's ends and middle lie.
  struct Shape {
    Unfoldings toA, toB;  ///< into the plane of the middle's face
    Complex at{}, inA{}, inB{};
    double apart = 0.0;    ///< distance of the middle from the straight line of the ends, at most
    double longest = 0.0;  ///< of the two chords
    double size = 0.0;     ///< of the middle's face
    double spread = 0.0;

    bool comparable() const { return toA.count() > 0 && toB.count() > 0; }
  };

  SurfacePoint pointAt(double s) const;
  Sample sample(double s);
  void advance(Sample& sample, int step);
  void interval(Sample a, Sample b, int step, int level, double away);
  double grown(double away, const Sample& a, const Sample& middle, const Sample& b, double longest) const;
  Shape shapeOf(const Sample& a, const Sample& middle, const Sample& b) const;
  void collect(const Sample& a, const Sample& middle, const Sample& b, const Shape& shape, double padding);
  void keep();
  bool staysInSight(int step) const;
  void bridge(const Sample& a, const Sample& b);
  void addTorn(const Sample& staying);
  void addParting(const Sample& a, const Sample& b);

  const TauFlow* flow_;
  double tau_;
  const SetWindows* windows_;
  int steps_;
  std::unique_ptr<Mover> forward_, backward_;
  NearFaces near_;
  Index halfedge_ = kNone;
  EdgeImage image_;
  std::vector<Index> met_;  ///< by one interval
  bool meetsExit_ = false;
  std::size_t traces_ = 0, samples_ = 0;  ///< in all, and of the edge at hand
};

}  // namespace stormfield
