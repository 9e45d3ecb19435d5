#include "maps/tau_rows.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "base/message.h"
#include "maps/detail/boundary_tangencies.h"
#include "maps/detail/edge_image.h"

namespace stormfield {
namespace {

/// Work is cut into pieces of this size whatever the number of threads.
constexpr std::size_t kPiece = 128;

/// Lists of faces, one after the other, in pieces that are filled in parallel.
class PiecewiseLists {
 public:
  explicit PiecewiseLists(std::size_t count) : lists_(count), pieces_((count + kPiece - 1) / kPiece) {}

  std::size_t pieceCount() const { return pieces_.size(); }
  std::size_t begin(std::size_t piece) const { return piece * kPiece; }
  std::size_t end(std::size_t piece) const { return std::min(lists_.size(), (piece + 1) * kPiece); }

  /// Each list once, in any order within a piece.
  void append(std::size_t i, const std::vector<Index>& list) {
    auto& piece = pieces_[i / kPiece];
    lists_[i] = {static_cast<std::uint32_t>(piece.size()), static_cast<std::uint32_t>(list.size())};
    piece.insert(piece.end(), list.begin(), list.end());
  }
  void finish(std::size_t piece) { pieces_[piece].shrink_to_fit(); }

  std::span<const Index> list(std::size_t i) const {
    return {pieces_[i / kPiece].data() + lists_[i].begin, lists_[i].size};
  }
  std::size_t pieceBytes(std::size_t piece) const { return sizeof(Index) * pieces_[piece].size(); }
  void release(std::size_t piece) { std::vector<Index>().swap(pieces_[piece]); }

 private:
  struct List {
    std::uint32_t begin, size;
  };
  std::vector<List> lists_;
  std::vector<std::vector<Index>> pieces_;
};

/// Elements of the mesh that take part, numbered in ascending order.
class Numbering {
 public:
  explicit Numbering(std::size_t size) : slots_(size, kNone) {}
  void mark(Index element) { slots_[element] = 0; }
  void number() {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (slots_[i] == kNone) continue;
      slots_[i] = static_cast<Index>(elements_.size());
      elements_.push_back(static_cast<Index>(i));
    }
  }
  Index slot(Index element) const { return slots_[element]; }
  const std::vector<Index>& elements() const { return elements_; }
  std::size_t bytes() const { return sizeof(Index) * (slots_.size() + elements_.size()); }

 private:
  std::vector<Index> slots_, elements_;
};

/// Stops work that takes more memory than it may.
class Budget {
 public:
  explicit Budget(std::size_t limit) : limit_(limit) {}
  void take(std::size_t bytes) {
    const std::size_t now = used_ += bytes;
    std::size_t peak = peak_;
    while (now > peak && !peak_.compare_exchange_weak(peak, now)) {
    }
    if (now > limit_) {
      throw InputError(message("the tau map needs more than ", limit_ >> 20, " MiB; choose a smaller tau"));
    }
  }
  void giveBack(std::size_t bytes) { used_ -= bytes; }
  std::size_t peak() const { return peak_; }

 private:
  std::size_t limit_;
  std::atomic<std::size_t> used_{0}, peak_{0};
};

/// Follows points in equal steps, side by side, each as long as it is wanted. Asked for: start(i), the first point;
/// keep(i, k, arrival), told where it is after k steps, whether to go on.
template <typename Start, typename Keep>
class StepwiseAdvection final : public AdvectionQueue {
 public:
  StepwiseAdvection(std::size_t first, std::size_t last, double step, Start start, Keep keep)
      : next_(first), last_(last), step_(step), start_(std::move(start)), keep_(std::move(keep)) {}

  bool next(int lane, AdvectedPoint& from, double& tau) override {
    auto& [now, place, steps] = points_[lane];
    if (steps == 0) {
      if (next_ == last_) return false;
      place = next_++;
      now = {.point = start_(place)};
    }
    from = now;
    tau = step_;
    return true;
  }
  void arrive(int lane, const AdvectedPoint& at) override {
    auto& [now, place, steps] = points_[lane];
    bool going = keep_(place, ++steps, at);
    while (going && at.left) going = keep_(place, ++steps, at);
    now = at;
    if (!going) steps = 0;
  }

 private:
  struct Point {
    AdvectedPoint now;
    std::size_t place = 0;
    int steps = 0;
  };
  std::size_t next_, last_;
  double step_;
  Start start_;
  Keep keep_;
  std::array<Point, kLanes> points_;
};

class RowMaker {
 public:
  RowMaker(const PreparedFlow& flow, const std::vector<Index>& faces, double tau, const SetWindows* windows,
           std::size_t memoryLimit, Progress* progress)
      : flow_(flow),
        mesh_(flow.mesh()),
        faces_(faces),
        tau_(tau),
        windows_(windows),
        steps_(advectionStepCount(flow, tau)),
        progress_(progress),
        budget_(memoryLimit),
        vertices_(mesh_.vertexCount()),
        edges_(mesh_.edgeCount()),
        total_(0) {}

  TauRows run(TauWork* work) {
    collectElements();
    torn_ = boundaryTangencyEdges(flow_, tau_, progress_);
    mapVertices();
    PiecewiseLists images(edges_.elements().size());
    leaves_.assign(edges_.elements().size(), 0);
    mapEdges(images);
    findOrigins(images);
    if (windows_ != nullptr) listInside();
    TauRows rows = joinRows(images);
    if (work != nullptr) {
      work->traces += traces_;
      work->peakBytes = std::max(work->peakBytes, budget_.peak());
    }
    return rows;
  }

 private:
  static constexpr Index kUnknown = -3, kAsked = -2, kOutside = -1;

  /// Done items of all phases, as a fraction of what all together are about to be.
  void advance(std::size_t items) {
    if (progress_ == nullptr) return;
    progress_->check();
    if (windows_ != nullptr) return;  // one set of many
    progress_->report(std::min(1.0, static_cast<double>(done_ += items) / static_cast<double>(total_)));
  }

  void collectElements() {
    for (const Index f : faces_) {
      for (int i = 0; i < 3; ++i) {
        vertices_.mark(mesh_.vertex(f, i));
        edges_.mark(mesh_.edge(TriangleMesh::halfedge(f, i)));
      }
    }
    vertices_.number();
    edges_.number();
    total_ = vertices_.elements().size() + 2 * edges_.elements().size() + faces_.size();
    budget_.take(vertices_.bytes() + edges_.bytes());
  }

  /// Follows vertices in steps: start and keep as in StepwiseAdvection.
  template <typename Start, typename Keep>
  void follow(std::size_t count, Direction direction, int steps, const Start& start, const Keep& keep) {
    tbb::parallel_for(std::size_t{0}, (count + kPiece - 1) / kPiece, [&](std::size_t piece) {
      const std::size_t end = std::min(count, (piece + 1) * kPiece);
      StepwiseAdvection moves(piece * kPiece, end, tau_ / steps, start, keep);
      flow_.advector(direction, progress_)->advectAll(moves);
      if (direction == Direction::Forward) advance(end - piece * kPiece);
    });
    traces_ += count;
  }

  void mapVertices() {
    const std::vector<Index>& vertices = vertices_.elements();
    arrivals_.resize(vertices.size() * steps_);
    known_.assign(vertices.size(), 0);
    budget_.take(sizeof(AdvectedPoint) * arrivals_.size());
    follow(
        vertices.size(), Direction::Forward, steps_, [&](std::size_t i) { return vertexPoint(mesh_, vertices[i]); },
        [&](std::size_t i, int step, const AdvectedPoint& at) {
          arrivals_[i * steps_ + step - 1] = at;
          known_[i] = step;
          return step < steps_ && isInSight(step, at);
        });
  }

  bool isInSight(int step, const AdvectedPoint& at) const {
    return windows_ == nullptr || windows_->holds(step, at.point.face);
  }

  std::span<const AdvectedPoint> arrivalsOf(Index v) const {
    const Index slot = vertices_.slot(v);
    return {arrivals_.data() + static_cast<std::size_t>(slot) * steps_, static_cast<std::size_t>(known_[slot])};
  }

  void mapEdges(PiecewiseLists& images) {
    tbb::parallel_for(std::size_t{0}, images.pieceCount(), [&](std::size_t piece) {
      const std::size_t begin = images.begin(piece), end = images.end(piece);
      std::vector<EdgeToSample> edges;
      for (std::size_t i = begin; i < end; ++i) {
        const Index edge = edges_.elements()[i], h = mesh_.edgeHalfedge(edge);
        edges.push_back({edge, arrivalsOf(mesh_.tail(h)), arrivalsOf(mesh_.head(h))});
      }
      EdgeImageSampler maker(flow_, tau_, steps_, windows_, progress_);
      maker.make(edges, [&](std::size_t i, const EdgeImage& image) {
        images.append(begin + i, image.faces);
        leaves_[begin + i] = image.leaves;
      });
      images.finish(piece);
      budget_.take(images.pieceBytes(piece));
      traces_ += maker.traces();
      advance(2 * (end - begin));
    });
    budget_.giveBack(sizeof(AdvectedPoint) * arrivals_.size());
    std::vector<AdvectedPoint>().swap(arrivals_);
  }

  /// Which face the flow takes vertices from, kOutside for those that enter the surface on the way: the vertices of the
  /// faces that edges and tears meet, those of the faces whose rows are made (an image may hold them while its boundary
  /// is out of sight, or has left the surface all around), and the neighbours of those that come from such faces.
  void findOrigins(const PiecewiseLists& images) {
    origins_.assign(mesh_.vertexCount(), kUnknown);
    budget_.take(sizeof(Index) * origins_.size());
    std::vector<Index> asked, next;
    const auto ask = [this](std::vector<Index>& list, Index v) {
      if (origins_[v] != kUnknown) return;
      origins_[v] = kAsked;
      list.push_back(v);
    };
    for (std::size_t i = 0; i < edges_.elements().size(); ++i) {
      for (const Index f : images.list(i)) {
        for (int k = 0; k < 3; ++k) ask(asked, mesh_.vertex(f, k));
      }
    }
    for (const auto& [face, met] : torn_) {
      for (int k = 0; k < 3; ++k) ask(asked, mesh_.vertex(met, k));
    }
    for (const Index v : vertices_.elements()) ask(asked, v);
    while (!asked.empty()) {
      std::sort(asked.begin(), asked.end());
      traceBack(asked);
      next.clear();
      for (const Index v : asked) {
        if (!std::binary_search(faces_.begin(), faces_.end(), origins_[v])) continue;
        for (Index h = mesh_.outgoing(v); h != kNone; h = mesh_.nextOutgoing(h)) {
          ask(next, mesh_.head(h));
          ask(next, mesh_.tail(TriangleMesh::prev(h)));
        }
      }
      asked.swap(next);
    }
  }

  void traceBack(const std::vector<Index>& vertices) {
    follow(
        vertices.size(), Direction::Backward, steps_, [&](std::size_t i) { return vertexPoint(mesh_, vertices[i]); },
        [&](std::size_t i, int step, const AdvectedPoint& at) {
          const bool inSight = !at.left && (step == steps_ || isInSight(steps_ - step, at));
          origins_[vertices[i]] = inSight ? at.point.face : kOutside;
          return inSight && step < steps_;
        });
  }

  /// What one thread needs to fill images.
  struct Scratch {
    std::vector<Index> row, stack;
    std::vector<std::uint32_t> stamps;  ///< per vertex: the last row that met it
    std::uint32_t stamp = 0;
  };

  void makeRow(std::size_t i, const PiecewiseLists& images, Scratch& scratch) {
    const Index face = faces_[i];
    auto& row = scratch.row;
    row.clear();
    bool leaves = false;
    for (int k = 0; k < 3; ++k) {
      const Index slot = edges_.slot(mesh_.edge(TriangleMesh::halfedge(face, k)));
      const auto image = images.list(slot);
      row.insert(row.end(), image.begin(), image.end());
      leaves |= leaves_[slot] != 0;
    }
    for (auto it = std::lower_bound(torn_.begin(), torn_.end(), std::pair(face, Index{0}));
         it != torn_.end() && it->first == face; ++it) {
      row.push_back(it->second);
    }
    sortOnce(row);
    fill(face, scratch);
    // A fixed point stays, though its face may be drawn out beyond what samples of the edges can tell.
    if (flow_.holdsFixedPoint(face)) {
      row.push_back(face);
      sortOnce(row);
    }
    for (const Index f : row) {
      for (int k = 0; k < 3 && !leaves; ++k) leaves = flow_.flowsOut(TriangleMesh::halfedge(f, k));
    }
    if (leaves) row.push_back(mesh_.faceCount());
  }

  static void sortOnce(std::vector<Index>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

  /// A vertex of the set and the face that the flow takes it from.
  struct Inside {
    Index origin, vertex;
  };

  void listInside() {
    for (const Index v : vertices_.elements()) inside_.push_back({origins_[v], v});
    std::sort(inside_.begin(), inside_.end(), [](const Inside& a, const Inside& b) {
      return a.origin != b.origin ? a.origin < b.origin : a.vertex < b.vertex;
    });
  }

  /// Adds the faces around the vertices inside the image, whose boundary meets the faces of the row.
  void fill(Index face, Scratch& scratch) {
    auto& [row, stack, stamps, stamp] = scratch;
    ++stamp;
    stack.clear();
    const auto meet = [&](Index v) {
      if (stamps[v] == stamp) return;
      stamps[v] = stamp;
      if (origins_[v] == face) stack.push_back(v);
    };
    for (const Index f : row) {
      for (int k = 0; k < 3; ++k) meet(mesh_.vertex(f, k));
    }
    for (int k = 0; k < 3; ++k) meet(mesh_.vertex(face, k));
    if (windows_ != nullptr) {
      const auto [first, last] = std::equal_range(inside_.begin(), inside_.end(), Inside{face, kNone},
                                                  [](const Inside& a, const Inside& b) { return a.origin < b.origin; });
      for (auto it = first; it != last; ++it) meet(it->vertex);
    }
    if (stack.empty()) return;
    while (!stack.empty()) {
      const Index v = stack.back();
      stack.pop_back();
      for (Index h = mesh_.outgoing(v); h != kNone; h = mesh_.nextOutgoing(h)) {
        row.push_back(TriangleMesh::face(h));
        meet(mesh_.head(h));
        meet(mesh_.tail(TriangleMesh::prev(h)));
      }
    }
    sortOnce(row);
  }

  TauRows joinRows(const PiecewiseLists& images) {
    PiecewiseLists rows(faces_.size());
    tbb::enumerable_thread_specific<Scratch> scratches([this] {
      budget_.take(sizeof(std::uint32_t) * mesh_.vertexCount());
      return Scratch{{}, {}, std::vector<std::uint32_t>(mesh_.vertexCount(), 0)};
    });
    tbb::parallel_for(std::size_t{0}, rows.pieceCount(), [&](std::size_t piece) {
      Scratch& scratch = scratches.local();
      for (std::size_t i = rows.begin(piece); i < rows.end(piece); ++i) {
        if (progress_ != nullptr) progress_->check();
        makeRow(i, images, scratch);
        rows.append(i, scratch.row);
      }
      rows.finish(piece);
      budget_.take(rows.pieceBytes(piece));
      advance(rows.end(piece) - rows.begin(piece));
    });
    TauRows result;
    result.offsets.resize(faces_.size() + 1, 0);
    for (std::size_t i = 0; i < faces_.size(); ++i) result.offsets[i + 1] = result.offsets[i] + rows.list(i).size();
    budget_.take(sizeof(Index) * result.offsets.back());
    result.targets.resize(result.offsets.back());
    tbb::parallel_for(std::size_t{0}, rows.pieceCount(), [&](std::size_t piece) {
      for (std::size_t i = rows.begin(piece); i < rows.end(piece); ++i) {
        const auto row = rows.list(i);
        std::copy(row.begin(), row.end(), result.targets.begin() + static_cast<std::ptrdiff_t>(result.offsets[i]));
      }
      rows.release(piece);
    });
    return result;
  }

  const PreparedFlow& flow_;
  const TriangleMesh& mesh_;
  const std::vector<Index>& faces_;
  double tau_;
  const SetWindows* windows_;
  int steps_;
  Progress* progress_;
  Budget budget_;
  Numbering vertices_, edges_;
  std::vector<AdvectedPoint> arrivals_;  ///< after every step, of each vertex
  std::vector<int> known_;               ///< steps of each vertex that were followed
  std::vector<std::pair<Index, Index>> torn_;
  std::vector<Inside> inside_;  ///< by origin
  std::vector<char> leaves_;
  std::vector<Index> origins_;  ///< per vertex
  std::atomic<std::size_t> done_{0}, traces_{0};
  std::size_t total_;
};

}  // namespace

int advectionStepCount(const PreparedFlow& flow, double tau) {
  constexpr int kMost = 128;
  int steps = 1;
  while (steps < kMost && tau / steps > 1.5 * flow.stepTau()) steps *= 2;
  return steps;
}

TauRows tauRows(const PreparedFlow& flow, const std::vector<Index>& faces, double tau, std::size_t memoryLimit,
                Progress* progress, TauWork* work) {
  return RowMaker(flow, faces, tau, nullptr, memoryLimit, progress).run(work);
}

TauRows tauRowsWithinSet(const PreparedFlow& flow, const std::vector<Index>& faces, double tau,
                         const SetWindows& windows, Progress* progress, TauWork* work) {
  return RowMaker(flow, faces, tau, &windows, windows.memoryLimit, progress).run(work);
}

TauRows geometryRows(const CombinatorialMap& geometry, const std::vector<Index>& faces) {
  TauRows rows;
  for (const Index f : faces) {
    rows.targets.insert(rows.targets.end(), geometry.graph.begin(f), geometry.graph.end(f));
    rows.offsets.push_back(rows.targets.size());
  }
  return rows;
}

CombinatorialMap mapFromRowGroups(Index faceCount, std::vector<RowGroup> parts) {
  CombinatorialMap map;
  auto& [offsets, targets] = map.graph;
  if (parts.size() == 1) {  // all faces in their order
    offsets = std::move(parts[0].rows.offsets);
    targets = std::move(parts[0].rows.targets);
    offsets.push_back(targets.size());
    return map;
  }
  offsets.assign(static_cast<std::size_t>(faceCount) + 2, 0);
  for (const auto& [faces, rows] : parts) {
    for (std::size_t i = 0; i < faces.size(); ++i) offsets[faces[i] + 1] = rows.offsets[i + 1] - rows.offsets[i];
  }
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  targets.resize(offsets.back());
  for (const auto& [faces, rows] : parts) {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      std::copy(rows.targets.begin() + static_cast<std::ptrdiff_t>(rows.offsets[i]),
                rows.targets.begin() + static_cast<std::ptrdiff_t>(rows.offsets[i + 1]),
                targets.begin() + static_cast<std::ptrdiff_t>(offsets[faces[i]]));
    }
  }
  return map;
}

}  // namespace stormfield
