// The faces that the images of mesh edges under the flow meet: adaptive sampling of the edges (thesis 7.1.1).
//
// An interval of an edge is halved until the images of its two ends and its middle are in the same or in neighbouring
// faces and nearly in line, at the end and on the way there, in steps that the field changes little in: a piece that
// the flow draws out and folds back would not be seen at the end. Between samples the image follows the chords. How far
// it may leave them is estimated along with it: it grows at the rate at which the flow draws vectors out, is fed where
// a chord lies in more than one face (within one, the field is all but linear), and is at least the distance of the
// middle from the straight line of the ends. All faces within that distance of the chords are collected. Where the flow
// tears the edge (one part leaves the surface, another touches the boundary and goes on) or stretches it beyond double
// precision, the faces along the trajectories between the two parts are collected.
//
// Inside a Morse set an image is followed only as long as it comes back to the set (set_windows.h): what a step takes
// away from it is not sampled further. There, where images go on for long, how far they leave chords is bounded by a
// part of the chords' length, which is less careful than elsewhere.
//
// The samples of many edges are traced side by side. An image does not depend on the others.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "maps/detail/unfolding.h"
#include "maps/point_advector.h"
#include "maps/set_windows.h"

namespace stormfield {

/// What one edge's image meets.
struct EdgeImage {
  std::vector<Index> faces;  ///< ascending, each once
  bool leaves = false;       ///< some of it may have left the surface
};

/// An edge, and the arrivals of the ends of its canonical halfedge after the first steps, one at least.
struct EdgeToSample {
  Index edge;
  std::span<const AdvectedPoint> tail, head;
};

/// Makes edge images at one tau; one maker per thread.
class EdgeImageSampler final : private AdvectionQueue {
 public:
  /// Told the place of an edge in the list, and its image, which is valid during the call.
  using Keep = std::function<void(std::size_t, const EdgeImage&)>;

  static constexpr std::size_t kMaxSamples = 5000;

  /// windows: of the set that images are followed in, or null. It must outlive the maker. Of an edge that needs more
  /// samples than maxSamples, gaps are bridged.
  EdgeImageSampler(const PreparedFlow& flow, double tau, int steps, const SetWindows* windows, const Progress* progress,
                   std::size_t maxSamples = kMaxSamples);

  /// Keeps the image of every edge, in any order.
  void make(std::span<const EdgeToSample> edges, const Keep& keep);
  /// Traces so far.
  std::size_t traces() const { return traces_; }

 private:
  static constexpr int kNowhere = -1;

  /// Where a point of the edge has come to after a step, and, once it is known, after the next.
  struct Place {
    AdvectedPoint at;
    int next = kNowhere;
  };
  /// A point of the edge.
  struct Sample {
    double s;                                        ///< along the edge, from 0 to 1
    int step = 0;                                    ///< so many steps of tau were followed
    int place = kNowhere;                            ///< after them
    bool underWay = false;                           ///< to its next place
    std::array<int, 2> waiting{kNowhere, kNowhere};  ///< intervals that wait for it
  };
  struct Stop {
    int sample, place;
  };
  /// Two samples and one in the middle.
  struct Interval {
    std::array<Stop, 3> stops;
    std::array<bool, 3> behind;  ///< whether a stop is that before the step
    int step, level;
    double away;                   ///< by how much the image may leave the chords
    std::array<double, 2> chords;  ///< their lengths after the step before
    bool first = true;
  };
  /// An edge whose image is being made.
  struct Edge {
    std::size_t number = 0;  ///< in the list
    Index halfedge = kNone;
    EdgeImage image;
    std::vector<Sample> samples;
    std::vector<Place> places;
    std::vector<Interval> intervals;
    std::size_t open = 0;  ///< intervals that are not done
    bool crowded = false;
  };
  /// The next step of a sample, or the first ones.
  struct Move {
    std::size_t edge;
    int sample;
    int steps;
  };
  /// How the images of an interval's ends and middle lie.
  struct Shape {
    Unfoldings toA, toB;  ///< into the plane of the middle's face
    Complex at{}, inA{}, inB{};
    double apart = 0.0;              ///< distance of the middle from the straight line of the ends, at most
    std::array<double, 2> chords{};  ///< their lengths
    double longest = 0.0;            ///< of the two
    double size = 0.0;               ///< of the middle's face
    double spread = 0.0;

    bool comparable() const { return toA.count() > 0 && toB.count() > 0; }
  };
  enum class Verdict { Goes, Done, Halve };

  bool next(int lane, AdvectedPoint& from, double& tau) override;
  void arrive(int lane, const AdvectedPoint& at) override;

  void start(std::size_t number);
  void finish(std::size_t slot);
  int addKnown(Edge& edge, double s, std::span<const AdvectedPoint> arrivals);
  void addPlace(Edge& edge, int sample, const AdvectedPoint& at, int steps);
  void open(std::size_t slot, Stop a, Stop b, int step, int level, double away);
  void proceed(std::size_t slot, int number);
  bool waits(const Edge& edge, int number) const;
  bool gather(std::size_t slot, int number);
  void halve(std::size_t slot, const Interval& interval);

  Verdict judge(Edge& edge, Interval& interval);
  double grown(const Interval& interval, const AdvectedPoint& a, const AdvectedPoint& middle, const AdvectedPoint& b,
               const Shape& shape) const;
  Shape shapeOf(const AdvectedPoint& a, const AdvectedPoint& middle, const AdvectedPoint& b) const;
  void collect(const AdvectedPoint& a, const AdvectedPoint& middle, const AdvectedPoint& b, const Shape& shape,
               double padding);
  void keep(Edge& edge);
  bool staysInSight(int step) const;

  SurfacePoint pointAt(const Edge& edge, double s) const;
  void bridge(Edge& edge, const Stop& from, const Stop& to, int step);
  void addTorn(Edge& edge, double staying);
  void addParting(Edge& edge, double a, double b, double radius);

  const PreparedFlow* flow_;
  double tau_;
  const SetWindows* windows_;
  int steps_;
  std::size_t maxSamples_;
  std::unique_ptr<PointAdvector> forward_, backward_;
  NearFaces near_;
  std::span<const EdgeToSample> edges_;
  const Keep* keep_ = nullptr;
  std::size_t started_ = 0;
  bool alone_ = false;                ///< the edge at hand is the only one
  std::vector<Edge> slots_;           ///< edges under way, and those that were
  std::vector<std::size_t> free_;     ///< slots
  std::vector<std::size_t> crowded_;  ///< numbers
  std::vector<Move> moves_;
  std::array<Move, kLanes> moving_{};
  std::vector<Index> met_;  ///< by one interval
  bool meetsExit_ = false;
  std::size_t traces_ = 0;
};

}  // namespace stormfield
