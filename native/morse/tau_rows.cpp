#include "morse/tau_rows.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "base/message.h"
#include "morse/edge_image.h"

namespace stormfield {
namespace {

/// Work is cut into pieces of this size whatever the number of threads.
constexpr std::size_t kPiece = 128;

/// Lists of faces, one after the other, in pieces that are filled in parallel.
class PiecewiseLists {
 public:
  explicit PiecewiseLists(std::size_t count) : ends_(count, 0), pieces_((count + kPiece - 1) / kPiece) {}

  std::size_t pieceCount() const { return pieces_.size(); }
  std::size_t begin(std::size_t piece) const { return piece * kPiece; }
  std::size_t end(std::size_t piece) const { return std::min(ends_.size(), (piece + 1) * kPiece); }

  /// Lists are appended in order within a piece.
  void append(std::size_t i, const std::vector<Index>& list) {
    auto& piece = pieces_[i / kPiece];
    piece.insert(piece.end(), list.begin(), list.end());
    ends_[i] = static_cast<std::uint32_t>(piece.size());
  }
  void finish(std::size_t piece) { pieces_[piece].shrink_to_fit(); }

  const Index* listBegin(std::size_t i) const {
    return pieces_[i / kPiece].data() + (i % kPiece == 0 ? 0 : ends_[i - 1]);
  }
  const Index* listEnd(std::size_t i) const { return pieces_[i / kPiece].data() + ends_[i]; }
  std::size_t size(std::size_t i) const { return static_cast<std::size_t>(listEnd(i) - listBegin(i)); }
  std::size_t pieceBytes(std::size_t piece) const { return sizeof(Index) * pieces_[piece].size(); }
  void release(std::size_t piece) { std::vector<Index>().swap(pieces_[piece]); }

 private:
  std::vector<std::uint32_t> ends_;
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

constexpr double kMostSteps = 64.0;

/// Images are followed in steps that the field changes little in.
int stepsOf(const TauFlow& flow, double tau) {
  return static_cast<int>(std::clamp(std::ceil(tau / flow.stepTau()), 1.0, kMostSteps));
}

class RowMaker {
 public:
  RowMaker(const TauFlow& flow, const std::vector<Index>& faces, double tau, const SetWindows* windows,
           std::size_t memoryLimit, Progress* progress)
      : flow_(flow),
        mesh_(flow.mesh()),
        faces_(faces),
        tau_(tau),
        windows_(windows),
        steps_(windows == nullptr ? stepsOf(flow, tau) : windows->steps),
        progress_(progress),
        budget_(memoryLimit),
        vertices_(mesh_.vertexCount()),
        edges_(mesh_.edgeCount()),
        total_(0) {}

  TauRows run(TauWork* work) {
    collectElements();
    mapVertices();
    PiecewiseLists images(edges_.elements().size());
    leaves_.assign(edges_.elements().size(), 0);
    mapEdges(images);
    TauRows rows = joinRows(images);
    if (work != nullptr) {
      work->traces += traces_;
      work->peakBytes = std::max(work->peakBytes, budget_.peak());
    }
    return rows;
  }

 private:
  static constexpr Index kUnknown = -2, kOutside = -1;

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

  /// body(i, mover) for i in [0, count), in pieces.
  template <typename Body>
  void eachTrace(std::size_t count, Direction direction, const Body& body) {
    tbb::parallel_for(std::size_t{0}, (count + kPiece - 1) / kPiece, [&](std::size_t piece) {
      const auto mover = flow_.mover(direction, progress_);
      const std::size_t end = std::min(count, (piece + 1) * kPiece);
      for (std::size_t i = piece * kPiece; i < end; ++i) body(i, *mover);
      advance(end - piece * kPiece);
    });
    traces_ += count;
  }

  void mapVertices() {
    arrivals_.resize(vertices_.elements().size() * steps_);
    known_.resize(vertices_.elements().size());
    budget_.take(sizeof(Arrival) * arrivals_.size());
    eachTrace(vertices_.elements().size(), Direction::Forward, [&](std::size_t i, Mover& mover) {
      Arrival at{vertexPoint(mesh_, vertices_.elements()[i])};
      int& known = known_[i] = 0;
      while (known < steps_ && (known == 0 || isInSight(known, at))) {
        if (!at.left) at = mover.move(at.point, tau_ / steps_);
        arrivals_[i * steps_ + known++] = at;
      }
    });
  }

  bool isInSight(int step, const Arrival& at) const {
    return windows_ == nullptr || windows_->holds(step, at.point.face);
  }

  void copyArrivals(Index v, std::vector<Arrival>& arrivals) const {
    const auto first = arrivals_.begin() + static_cast<std::ptrdiff_t>(vertices_.slot(v)) * steps_;
    arrivals.assign(first, first + known_[vertices_.slot(v)]);
  }

  void mapEdges(PiecewiseLists& images) {
    tbb::parallel_for(std::size_t{0}, images.pieceCount(), [&](std::size_t piece) {
      EdgeImageMaker maker(flow_, tau_, steps_, windows_, progress_);
      std::vector<Arrival> tail, head;
      for (std::size_t i = images.begin(piece); i < images.end(piece); ++i) {
        const Index edge = edges_.elements()[i], h = mesh_.edgeHalfedge(edge);
        copyArrivals(mesh_.tail(h), tail);
        copyArrivals(mesh_.head(h), head);
        const EdgeImage& image = maker.make(edge, tail, head);
        images.append(i, image.faces);
        leaves_[i] = image.leaves;
      }
      images.finish(piece);
      budget_.take(images.pieceBytes(piece));
      traces_ += maker.traces();
      advance(2 * (images.end(piece) - images.begin(piece)));
    });
    budget_.giveBack(sizeof(Arrival) * arrivals_.size());
    std::vector<Arrival>().swap(arrivals_);
  }

  /// What one thread needs to fill images.
  struct Scratch {
    std::unique_ptr<Mover> backward;
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
      row.insert(row.end(), images.listBegin(slot), images.listEnd(slot));
      leaves |= leaves_[slot] != 0;
    }
    sortOnce(row);
    fill(face, scratch);
    for (const Index f : row) {
      for (int k = 0; k < 3 && !leaves; ++k) leaves = flow_.flowsOut(TriangleMesh::halfedge(f, k));
    }
    if (leaves) row.push_back(mesh_.faceCount());
  }

  static void sortOnce(std::vector<Index>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

  /// The face that the flow takes a vertex from, kOutside when it enters the surface on the way. Asked for when needed,
  /// and kept: several threads may find the same answer.
  Index origin(Index v, Scratch& scratch) {
    Index known = origins_[v].load(std::memory_order_relaxed);
    if (known != kUnknown) return known;
    ++traces_;
    Arrival from{vertexPoint(mesh_, v)};
    bool inSight = true;
    const int steps = windows_ == nullptr ? 1 : steps_;
    for (int k = steps; k-- > 0 && inSight;) {
      from = scratch.backward->move(from.point, tau_ / steps);
      inSight = !from.left && (k == 0 || isInSight(k, from));
    }
    known = inSight ? from.point.face : kOutside;
    origins_[v].store(known, std::memory_order_relaxed);
    return known;
  }

  /// A vertex of the set and the face that the flow takes it from.
  struct Inside {
    Index origin, vertex;
  };

  /// Of all vertices of the set: an image may hold some of it while its boundary is out of sight.
  void findOrigins(tbb::enumerable_thread_specific<Scratch>& scratches) {
    const std::vector<Index>& vertices = vertices_.elements();
    tbb::parallel_for(std::size_t{0}, (vertices.size() + kPiece - 1) / kPiece, [&](std::size_t piece) {
      Scratch& scratch = scratches.local();
      const std::size_t end = std::min(vertices.size(), (piece + 1) * kPiece);
      for (std::size_t i = piece * kPiece; i < end; ++i) origin(vertices[i], scratch);
      if (progress_ != nullptr) progress_->check();
    });
    for (const Index v : vertices) inside_.push_back({origins_[v].load(std::memory_order_relaxed), v});
    std::sort(inside_.begin(), inside_.end(), [](const Inside& a, const Inside& b) {
      return a.origin != b.origin ? a.origin < b.origin : a.vertex < b.vertex;
    });
  }

  /// Adds the faces around the vertices inside the image, whose boundary meets the faces of the row.
  void fill(Index face, Scratch& scratch) {
    auto& [backward, row, stack, stamps, stamp] = scratch;
    ++stamp;
    stack.clear();
    const auto meet = [&](Index v) {
      if (stamps[v] == stamp) return;
      stamps[v] = stamp;
      if (origin(v, scratch) == face) stack.push_back(v);
    };
    for (const Index f : row) {
      for (int k = 0; k < 3; ++k) meet(mesh_.vertex(f, k));
    }
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
    origins_ = std::vector<std::atomic<Index>>(mesh_.vertexCount());
    for (auto& known : origins_) known.store(kUnknown, std::memory_order_relaxed);
    budget_.take(sizeof(Index) * origins_.size());
    tbb::enumerable_thread_specific<Scratch> scratches([this] {
      budget_.take(sizeof(Index) * mesh_.vertexCount());
      return Scratch{
          flow_.mover(Direction::Backward, progress_), {}, {}, std::vector<std::uint32_t>(mesh_.vertexCount(), 0)};
    });
    if (windows_ != nullptr) findOrigins(scratches);
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
    for (std::size_t i = 0; i < faces_.size(); ++i) result.offsets[i + 1] = result.offsets[i] + rows.size(i);
    budget_.take(sizeof(Index) * result.offsets.back());
    result.targets.resize(result.offsets.back());
    tbb::parallel_for(std::size_t{0}, rows.pieceCount(), [&](std::size_t piece) {
      const std::size_t first = rows.begin(piece);
      std::copy(rows.listBegin(first), rows.listEnd(rows.end(piece) - 1),
                result.targets.begin() + static_cast<std::ptrdiff_t>(result.offsets[first]));
      rows.release(piece);
    });
    return result;
  }

  const TauFlow& flow_;
  const TriangleMesh& mesh_;
  const std::vector<Index>& faces_;
  double tau_;
  const SetWindows* windows_;
  int steps_;
  Progress* progress_;
  Budget budget_;
  Numbering vertices_, edges_;
  std::vector<Arrival> arrivals_;  ///< after every step, of each vertex
  std::vector<int> known_;         ///< steps of each vertex that were followed
  std::vector<Inside> inside_;     ///< by origin
  std::vector<char> leaves_;
  std::vector<std::atomic<Index>> origins_;  ///< per vertex
  std::atomic<std::size_t> done_{0}, traces_{0};
  std::size_t total_;
};

}  // namespace

TauRows tauRows(const TauFlow& flow, const std::vector<Index>& faces, double tau, std::size_t memoryLimit,
                Progress* progress, TauWork* work) {
  return RowMaker(flow, faces, tau, nullptr, memoryLimit, progress).run(work);
}

TauRows tauRowsInside(const TauFlow& flow, const std::vector<Index>& faces, double tau, const SetWindows& windows,
                      Progress* progress, TauWork* work) {
  constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
  return RowMaker(flow, faces, tau, &windows, kNoLimit, progress).run(work);
}

TauRows geometryRows(const CombinatorialMap& geometry, const std::vector<Index>& faces) {
  TauRows rows;
  for (const Index f : faces) {
    rows.targets.insert(rows.targets.end(), geometry.graph.begin(f), geometry.graph.end(f));
    rows.offsets.push_back(rows.targets.size());
  }
  return rows;
}

CombinatorialMap joinRows(Index faceCount, std::vector<TauRowsOf> parts) {
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
