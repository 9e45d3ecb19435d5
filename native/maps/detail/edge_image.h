// The faces that the images phi(tau, e) of mesh edges meet: adaptive sampling of the edges (thesis 7.1.1).
//
// An image is followed in `steps` equal steps of tau. An interval of the edge has two ends and a middle; after each
// step their images lie, or the interval is halved until they lie,
//   - in the same or in neighbouring faces, which unfold into one plane, and
//   - nearly in line.
// The steps before the last are judged too: a curve that the flow lengthens and folds back would not be seen at the
// end. Between samples the image follows the chords. It may deviate from them by an estimate that is carried from step
// to step (chord_shape.h) and is at least the distance of the middle from the line between the ends. F gets all faces
// within that distance, plus a small padding, of the chords.
//
// Two samples as close as traces resolve may have images that are far apart: where one leaves the surface and the other
// passes a tangency to the boundary, or where a saddle separates them. Then F gets the faces along the trajectories
// between the two.
//
// Within a Morse set, an image is followed only as long as it is in the set's windows (set_windows.h): intervals
// outside are not sampled further. Images of sets are followed for long times, where the deviation is taken for a
// fraction of the chords' length at most; this is less careful than elsewhere.
//
// The samples of many edges are advected side by side. The image of an edge does not depend on the others.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "maps/detail/chord_shape.h"
#include "maps/detail/unfolding.h"
#include "maps/prepared_flow.h"
#include "maps/set_windows.h"

namespace stormfield {

struct EdgeImage {
  std::vector<Index> faces;    ///< that the image meets, ascending, each once
  bool leavesSurface = false;  ///< some of it may have left the surface
};

/// An edge, and the images of the ends of its canonical halfedge after the first steps, one step at least.
struct EdgeToSample {
  Index edge;
  std::span<const AdvectedPoint> tail, head;
};

/// Computes edge images for one tau; one sampler per thread.
class EdgeImageSampler final : private AdvectionQueue {
 public:
  /// Receives the index of an edge in the list and its image, which is valid during the call.
  using OnImage = std::function<void(std::size_t, const EdgeImage&)>;

  static constexpr std::size_t kMaxSamples = 5000;

  /// steps: flow.stepCount(tau), or another number of steps. windows: of the set in which images are followed, or null.
  /// The flow and the windows must outlive the sampler. Gaps of an edge that needs more samples than maxSamples are
  /// bridged as if its samples were as close as traces resolve.
  EdgeImageSampler(const PreparedFlow& flow, double tau, int steps, const SetWindows* windows, const Progress* progress,
                   std::size_t maxSamples = kMaxSamples);

  /// Computes the image of every edge, in any order. Throws Cancelled.
  void sample(std::span<const EdgeToSample> edges, const OnImage& onImage);
  /// Traces so far.
  std::size_t traces() const { return traces_; }

 private:
  // Samples, their images, intervals and edges are numbered by int within their edge or slot; kNone: there is none.

  /// The image of a sample after some steps, and the number of its next image.
  struct SampleImage {
    AdvectedPoint at;
    int next = kNone;
  };
  /// A point of the edge.
  struct Sample {
    double fraction;                           ///< along the edge, from 0 to 1
    int step = 0;                              ///< steps that were followed
    int image = kNone;                         ///< after them
    bool isQueued = false;                     ///< for its next image
    std::array<int, 2> waiting{kNone, kNone};  ///< intervals that wait for it
  };
  /// A sample at the step of an interval.
  struct Node {
    int sample, image;
  };
  /// Two samples and the one in their middle.
  struct Interval {
    std::array<Node, 3> nodes;
    std::array<bool, 3> isBehind;  ///< whether the node's image is that before the step
    int step, level;
    std::optional<double>
        deviation;                 ///< of the image from its chords, mesh units; none while chords are not comparable
    std::array<double, 2> chords;  ///< their lengths after the step before
    bool isFirstStep = true;
  };
  /// An edge whose image is being computed.
  struct Edge {
    std::size_t number = 0;  ///< in the list
    Index halfedge = kNone;
    EdgeImage image;
    std::vector<Sample> samples;
    std::vector<SampleImage> images;
    std::vector<Interval> intervals;
    std::size_t openIntervals = 0;
    bool isCrowded = false;  ///< needs more than maxSamples
  };
  /// The next step of a sample, or its first ones.
  struct Advection {
    std::size_t slot;
    int sample;
    int steps;
  };
  enum class Verdict { NextStep, Done, Halve };

  bool next(int lane, AdvectedPoint& from, double& tau) override;
  void arrive(int lane, const AdvectedPoint& image) override;

  void startEdge(std::size_t number);
  void finishEdge(std::size_t slot);
  int addKnownSample(Edge& edge, double fraction, std::span<const AdvectedPoint> images);
  void addImage(Edge& edge, int sample, const AdvectedPoint& at, int steps);
  void addInterval(std::size_t slot, Node a, Node b, int step, int level, std::optional<double> deviation);
  void advanceInterval(std::size_t slot, int number);
  bool isWaiting(const Edge& edge, int number) const;
  bool fetchImages(std::size_t slot, int number);
  void halve(std::size_t slot, const Interval& interval);

  Verdict judge(Edge& edge, Interval& interval);
  void updateDeviation(Interval& interval, const std::array<const AdvectedPoint*, 3>& at,
                       const ChordShape& shape) const;
  void collectFaces(const AdvectedPoint& a, const AdvectedPoint& middle, const AdvectedPoint& b,
                    const ChordShape& shape, double padding);
  void keepFaces(Edge& edge) const;
  bool isInWindow(int step) const;

  SurfacePoint pointAt(const Edge& edge, double fraction) const;
  void bridge(Edge& edge, const Node& from, const Node& to, int step);
  void addTangentTrajectory(Edge& edge, double staying);
  void addSeparatingTrajectories(Edge& edge, double a, double b, double radius);

  const PreparedFlow* flow_;
  double tau_;
  const SetWindows* windows_;
  int steps_;
  std::size_t maxSamples_;
  std::unique_ptr<PointAdvector> forward_, backward_;
  NearFaces near_;
  std::span<const EdgeToSample> edges_;
  const OnImage* onImage_ = nullptr;
  std::size_t started_ = 0;  ///< edges
  bool isAlone_ = false;     ///< one edge at a time
  std::vector<Edge> slots_;  ///< edges in progress, and those of before, for their memory
  std::vector<std::size_t> freeSlots_;
  std::vector<std::size_t> crowded_;  ///< numbers of edges
  std::vector<Advection> queue_;
  std::array<Advection, kMaxLanes> inLane_{};
  std::vector<Index> found_;  ///< faces near the chords of one interval
  bool foundExit_ = false;    ///< a boundary halfedge near them that flow crosses outwards
  std::size_t traces_ = 0;
};

}  // namespace stormfield
