#include "tracking/detail/sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stormfield {
namespace {

/// Paths that live shorter than this interval of lambda are round-off of one event.
constexpr double kInstant = 1e-12;

class ChargeSweep {
 public:
  ChargeSweep(const TriangleMesh& mesh, const std::vector<int>& firstIndices)
      : mesh_(mesh), first_(mesh.faceCount(), kNone) {
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      for (int k = 0; k < std::abs(firstIndices[f]); ++k) put(appear(firstIndices[f] > 0 ? 1 : -1, kNone), f);
    }
  }

  void cross(Index crossing, Index edge, int charge) {
    const Index h = mesh_.edgeHalfedge(edge), t = mesh_.twin(h);
    const Index gains = TriangleMesh::face(h), loses = t == kNone ? kNone : TriangleMesh::face(t);
    const Index opposite = take(gains, -charge);
    const Index passing = loses == kNone ? kNone : take(loses, charge);
    if (opposite != kNone && passing != kNone) {  // they annihilate
      vanish(opposite, crossing, passing);
      vanish(passing, crossing, opposite);
    } else if (passing != kNone) {
      crossOver(passing, crossing, gains);
    } else if (opposite != kNone) {
      if (loses != kNone) {
        crossOver(opposite, crossing, loses);
      } else {
        vanish(opposite, crossing, kNone);
      }
    } else {  // a pair is created, or one charge enters over the boundary
      const Index born = appear(charge, crossing);
      put(born, gains);
      if (loses == kNone) return;
      const Index opposed = appear(-charge, crossing);
      put(opposed, loses);
      paths_[born].createdWith = opposed;
      paths_[opposed].createdWith = born;
    }
  }

  std::vector<ChargePath> release() { return std::move(paths_); }

 private:
  Index appear(int charge, Index crossing) {
    paths_.emplace_back();
    paths_.back().charge = charge;
    paths_.back().begin = crossing;
    next_.push_back(kNone);
    return static_cast<Index>(paths_.size()) - 1;
  }
  void vanish(Index path, Index crossing, Index other) {
    paths_[path].end = crossing;
    paths_[path].annihilatedWith = other;
  }
  void crossOver(Index path, Index crossing, Index face) {
    paths_[path].crossings.push_back(crossing);
    put(path, face);
  }

  /// The charges of a face form a queue: all are of one sign, and the one that came first leaves first.
  void put(Index path, Index face) {
    paths_[path].faces.push_back(face);
    next_[path] = kNone;
    Index* last = &first_[face];
    while (*last != kNone) last = &next_[*last];
    *last = path;
  }
  Index take(Index face, int charge) {
    const Index path = first_[face];
    if (path == kNone || paths_[path].charge != charge) return kNone;
    first_[face] = next_[path];
    return path;
  }

  const TriangleMesh& mesh_;
  std::vector<ChargePath> paths_;
  std::vector<Index> first_, next_;
};

/// Removes paths without life: the two that one of them connects are one fixed point, which moves through a vertex.
class PathSplicing {
 public:
  PathSplicing(std::vector<ChargePath> paths, const std::vector<ZeroCrossing>& crossings)
      : paths_(std::move(paths)), crossings_(crossings), removed_(paths_.size(), 0) {}

  std::vector<ChargePath> spliced() {
    for (Index i = 0; i < static_cast<Index>(paths_.size()); ++i) {
      if (!removed_[i] && isLifeless(paths_[i])) splice(i);
    }
    return renumbered();
  }

 private:
  bool isLifeless(const ChargePath& path) const {
    return path.begin != kNone && path.end != kNone &&
           crossings_[path.end].lambda - crossings_[path.begin].lambda <= kInstant;
  }

  void splice(Index i) {
    const ChargePath& path = paths_[i];
    const Index before = path.annihilatedWith, after = path.createdWith;
    removed_[i] = 1;
    if (before != kNone && before == after) {
      removed_[before] = 1;
    } else if (before != kNone) {
      // The path that is annihilated with it continues, back along it and as the one that is created with it.
      ChargePath& kept = paths_[before];
      append(kept, path.end, path.faces.rbegin(), path.faces.rend(), path.crossings.rbegin(), path.crossings.rend());
      if (after == kNone) {
        kept.end = path.begin;
        kept.annihilatedWith = kNone;
        return;
      }
      ChargePath& next = paths_[after];
      append(kept, path.begin, next.faces.begin(), next.faces.end(), next.crossings.begin(), next.crossings.end());
      kept.end = next.end;
      kept.annihilatedWith = next.annihilatedWith;
      if (kept.annihilatedWith != kNone) paths_[kept.annihilatedWith].annihilatedWith = before;
      removed_[after] = 1;
    } else if (after != kNone) {
      // It vanishes at a boundary: the path that is created with it comes from there.
      ChargePath from;
      from.faces.assign(path.faces.rbegin(), path.faces.rend());
      from.crossings.assign(path.crossings.rbegin(), path.crossings.rend());
      ChargePath& kept = paths_[after];
      append(from, path.begin, kept.faces.begin(), kept.faces.end(), kept.crossings.begin(), kept.crossings.end());
      kept.faces = std::move(from.faces);
      kept.crossings = std::move(from.crossings);
      kept.begin = path.end;
      kept.createdWith = kNone;
    }
  }

  template <typename Faces, typename Crossings>
  static void append(ChargePath& path, Index crossing, Faces faces, Faces facesEnd, Crossings crossings,
                     Crossings crossingsEnd) {
    path.crossings.push_back(crossing);
    path.faces.insert(path.faces.end(), faces, facesEnd);
    path.crossings.insert(path.crossings.end(), crossings, crossingsEnd);
  }

  std::vector<ChargePath> renumbered() {
    std::vector<Index> number(paths_.size(), kNone);
    std::vector<ChargePath> left;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      if (removed_[i]) continue;
      number[i] = static_cast<Index>(left.size());
      left.push_back(std::move(paths_[i]));
    }
    for (ChargePath& path : left) {
      if (path.createdWith != kNone) path.createdWith = number[path.createdWith];
      if (path.annihilatedWith != kNone) path.annihilatedWith = number[path.annihilatedWith];
    }
    return left;
  }

  std::vector<ChargePath> paths_;
  const std::vector<ZeroCrossing>& crossings_;
  std::vector<char> removed_;
};

}  // namespace

std::vector<ChargePath> sweepCharges(const TriangleMesh& mesh, const std::vector<int>& firstIndices,
                                     const std::vector<ZeroCrossing>& crossings, Progress& progress) {
  ChargeSweep sweep(mesh, firstIndices);
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    if (i % 65536 == 0) progress.check();
    sweep.cross(static_cast<Index>(i), crossings[i].edge, crossings[i].charge);
  }
  return PathSplicing(sweep.release(), crossings).spliced();
}

}  // namespace stormfield
