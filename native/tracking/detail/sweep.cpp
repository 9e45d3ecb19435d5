#include "tracking/detail/sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stormfield {
namespace {

/// What lives shorter than this part of lambda is round-off of one event.
constexpr double kInstant = 1e-12;

class Sweep {
 public:
  Sweep(const TriangleMesh& mesh, const std::vector<int>& firstIndices) : mesh_(mesh), first_(mesh.faceCount(), kNone) {
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      for (int k = 0; k < std::abs(firstIndices[f]); ++k) put(appear(firstIndices[f] > 0 ? 1 : -1, kNone), f);
    }
  }

  void cross(Index crossing, Index edge, int charge) {
    const Index h = mesh_.edgeHalfedge(edge), t = mesh_.twin(h);
    const Index gains = TriangleMesh::face(h), loses = t == kNone ? kNone : TriangleMesh::face(t);
    const Index opposite = take(gains, -charge);
    const Index passing = loses == kNone ? kNone : take(loses, charge);
    if (opposite != kNone && passing != kNone) {
      vanish(opposite, crossing, passing);
      vanish(passing, crossing, opposite);
    } else if (passing != kNone) {
      pass(passing, crossing, gains);
    } else if (opposite != kNone) {
      if (loses != kNone)
        pass(opposite, crossing, loses);
      else
        vanish(opposite, crossing, kNone);
    } else {
      const Index born = appear(charge, crossing);
      put(born, gains);
      if (loses == kNone) return;
      const Index partner = appear(-charge, crossing);
      put(partner, loses);
      ways_[born].partner = partner;
      ways_[partner].partner = born;
    }
  }

  std::vector<FaceWay> take() { return std::move(ways_); }

 private:
  Index appear(int charge, Index crossing) {
    ways_.emplace_back();
    ways_.back().charge = charge;
    ways_.back().begin = crossing;
    next_.push_back(kNone);
    return static_cast<Index>(ways_.size()) - 1;
  }
  void vanish(Index way, Index crossing, Index rival) {
    ways_[way].end = crossing;
    ways_[way].rival = rival;
  }
  void pass(Index way, Index crossing, Index face) {
    ways_[way].crossings.push_back(crossing);
    put(way, face);
  }

  /// The ways of a face form a queue: all have the same charge, and the one that came first leaves first.
  void put(Index way, Index face) {
    ways_[way].faces.push_back(face);
    next_[way] = kNone;
    Index* last = &first_[face];
    while (*last != kNone) last = &next_[*last];
    *last = way;
  }
  Index take(Index face, int charge) {
    const Index way = first_[face];
    if (way == kNone || ways_[way].charge != charge) return kNone;
    first_[face] = next_[way];
    return way;
  }

  const TriangleMesh& mesh_;
  std::vector<FaceWay> ways_;
  std::vector<Index> first_, next_;
};

/// Takes out ways without life: the two that one of them connects are one fixed point, which went through a vertex.
class Splicing {
 public:
  Splicing(std::vector<FaceWay> ways, const std::vector<ZeroCrossing>& crossings)
      : ways_(std::move(ways)), crossings_(crossings), gone_(ways_.size(), 0) {}

  std::vector<FaceWay> spliced() {
    for (Index i = 0; i < static_cast<Index>(ways_.size()); ++i) {
      if (!gone_[i] && lifeless(ways_[i])) takeOut(i);
    }
    return numberedAnew();
  }

 private:
  bool lifeless(const FaceWay& way) const {
    return way.begin != kNone && way.end != kNone &&
           crossings_[way.end].lambda - crossings_[way.begin].lambda <= kInstant;
  }

  void takeOut(Index i) {
    const FaceWay& way = ways_[i];
    const Index before = way.rival, after = way.partner;
    gone_[i] = 1;
    if (before != kNone && before == after) {
      gone_[before] = 1;
    } else if (before != kNone) {
      // The one that vanishes with it lives on, back along it and as the one that appears with it.
      FaceWay& kept = ways_[before];
      follow(kept, way.end, way.faces.rbegin(), way.faces.rend(), way.crossings.rbegin(), way.crossings.rend());
      if (after == kNone) {
        kept.end = way.begin;
        kept.rival = kNone;
        return;
      }
      FaceWay& rest = ways_[after];
      follow(kept, way.begin, rest.faces.begin(), rest.faces.end(), rest.crossings.begin(), rest.crossings.end());
      kept.end = rest.end;
      kept.rival = rest.rival;
      if (kept.rival != kNone) ways_[kept.rival].rival = before;
      gone_[after] = 1;
    } else if (after != kNone) {
      // It vanishes at a boundary: the one that appears with it comes from there.
      FaceWay from;
      from.faces.assign(way.faces.rbegin(), way.faces.rend());
      from.crossings.assign(way.crossings.rbegin(), way.crossings.rend());
      FaceWay& kept = ways_[after];
      follow(from, way.begin, kept.faces.begin(), kept.faces.end(), kept.crossings.begin(), kept.crossings.end());
      kept.faces = std::move(from.faces);
      kept.crossings = std::move(from.crossings);
      kept.begin = way.end;
      kept.partner = kNone;
    }
  }

  template <typename Faces, typename Crossings>
  static void follow(FaceWay& way, Index crossing, Faces faces, Faces facesEnd, Crossings onward, Crossings onwardEnd) {
    way.crossings.push_back(crossing);
    way.faces.insert(way.faces.end(), faces, facesEnd);
    way.crossings.insert(way.crossings.end(), onward, onwardEnd);
  }

  std::vector<FaceWay> numberedAnew() {
    std::vector<Index> number(ways_.size(), kNone);
    std::vector<FaceWay> left;
    for (std::size_t i = 0; i < ways_.size(); ++i) {
      if (gone_[i]) continue;
      number[i] = static_cast<Index>(left.size());
      left.push_back(std::move(ways_[i]));
    }
    for (FaceWay& way : left) {
      if (way.partner != kNone) way.partner = number[way.partner];
      if (way.rival != kNone) way.rival = number[way.rival];
    }
    return left;
  }

  std::vector<FaceWay> ways_;
  const std::vector<ZeroCrossing>& crossings_;
  std::vector<char> gone_;
};

}  // namespace

std::vector<FaceWay> sweepCharges(const TriangleMesh& mesh, const std::vector<int>& firstIndices,
                                  const std::vector<ZeroCrossing>& crossings, Progress& progress) {
  Sweep sweep(mesh, firstIndices);
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    if (i % 65536 == 0) progress.check();
    sweep.cross(static_cast<Index>(i), crossings[i].edge, crossings[i].charge);
  }
  return Splicing(sweep.take(), crossings).spliced();
}

}  // namespace stormfield
