#include "topology/detail/recurrent_parts.h"

#include <algorithm>

#include "topology/detail/section.h"

namespace stormfield {
namespace {

/// Runs of a part's border that get a seed of their own, the longest first; a border with more is too ragged to matter.
constexpr std::size_t kMostRuns = 16;

struct Part {
  Index faces = 0, borderEdges = 0, fans = 0;
  bool rests = false;

  /// Of the part as a surface of its own: V - E + F with each fan of its faces around a vertex as a vertex.
  Index eulerCharacteristic() const { return fans - (3 * faces + borderEdges) / 2 + faces; }
};

bool inside(const TriangleMesh& mesh, const std::vector<Index>& of, Index h, Index part) {
  const Index twin = mesh.twin(h);
  return twin != kNone && of[TriangleMesh::face(twin)] == part;
}

void countFans(const TriangleMesh& mesh, const std::vector<Index>& of, std::vector<Part>& parts) {
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    // A fan begins where the face clockwise of its first halfedge is of another part; whole rings have no beginning.
    bool whole = mesh.outgoing(v) != kNone && !mesh.isBoundaryVertex(v);
    for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
      const Index part = of[TriangleMesh::face(h)];
      const bool begins = !(part != kNone && inside(mesh, of, h, part));
      whole = whole && !begins;
      if (part != kNone && begins) ++parts[part].fans;
    }
    if (whole) ++parts[of[TriangleMesh::face(mesh.outgoing(v))]].fans;
  }
}

std::vector<Part> measure(const TriangleMesh& mesh, const std::vector<Index>& of, Index count,
                          const std::vector<char>& resting) {
  std::vector<Part> parts(count);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    if (of[f] == kNone) continue;
    Part& part = parts[of[f]];
    ++part.faces;
    part.rests = part.rests || resting[f] != 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) part.borderEdges += inside(mesh, of, h, of[f]) ? 0 : 1;
  }
  countFans(mesh, of, parts);
  return parts;
}

/// Consecutive halfedges of a border that the flow crosses in one direction.
struct Run {
  Index middle;
  std::size_t length;
  bool entering;
};

class SeedSearch {
 public:
  SeedSearch(const VectorField& field, const std::vector<Index>& of)
      : field_(field), mesh_(field.mesh()), of_(of), seen_(mesh_.halfedgeCount(), 0) {}

  void search(Index h, std::vector<std::vector<Run>>& runs) {
    const Index part = of_[TriangleMesh::face(h)];
    if (seen_[h] != 0 || inside(mesh_, of_, h, part)) return;
    std::vector<Index> loop;
    for (Index at = h; seen_[at] == 0; at = nextOnBorder(at, part)) {
      seen_[at] = 1;
      loop.push_back(at);
    }
    std::vector<int> signs;
    for (const Index at : loop) signs.push_back(crossing(at));
    // Begin where a run begins.
    std::size_t begin = 0;
    while (begin + 1 < loop.size() && signs[begin] == signs[(begin + loop.size() - 1) % loop.size()]) ++begin;
    for (std::size_t i = 0; i < loop.size();) {
      std::size_t end = i;
      while (end < loop.size() && signs[(begin + end) % loop.size()] == signs[(begin + i) % loop.size()]) ++end;
      const std::size_t middle = (begin + (i + end) / 2) % loop.size();
      if (signs[middle] != 0) runs[part].push_back({loop[middle], end - i, signs[middle] > 0});
      i = end;
    }
  }

 private:
  Index nextOnBorder(Index h, Index part) const {
    Index next = TriangleMesh::next(h);
    while (inside(mesh_, of_, next, part)) next = TriangleMesh::next(mesh_.twin(next));
    return next;
  }
  /// +1 into the part, -1 out of it, 0 neither or both.
  int crossing(Index h) const {
    const auto across = acrossEnds(field_, h);
    if (across[0] * across[1] < 0.0) return 0;
    return across[0] + across[1] > 0.0 ? 1 : across[0] + across[1] < 0.0 ? -1 : 0;
  }

  const VectorField& field_;
  const TriangleMesh& mesh_;
  const std::vector<Index>& of_;
  std::vector<char> seen_;
};

SurfacePoint middleOf(Index h) {
  SurfacePoint p;
  p.face = TriangleMesh::face(h);
  p.barycentric[TriangleMesh::corner(h)] = p.barycentric[TriangleMesh::corner(TriangleMesh::next(h))] = 0.5;
  return p;
}

std::vector<PartSeed> findSeeds(const VectorField& field, const std::vector<Index>& of,
                                const std::vector<Part>& parts) {
  const TriangleMesh& mesh = field.mesh();
  std::vector<PartSeed> seeds;
  if (std::all_of(parts.begin(), parts.end(), [](const Part& part) { return part.rests; })) return seeds;
  std::vector<std::vector<Run>> runs(parts.size());
  std::vector<Index> firstFace(parts.size(), kNone);
  SeedSearch search(field, of);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const Index part = of[f];
    if (part == kNone || parts[part].rests) continue;
    if (firstFace[part] == kNone) firstFace[part] = f;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) search.search(h, runs);
  }
  for (Index part = 0; part < static_cast<Index>(parts.size()); ++part) {
    if (firstFace[part] == kNone) continue;
    auto& own = runs[part];
    std::stable_sort(own.begin(), own.end(), [](const Run& a, const Run& b) { return a.length > b.length; });
    if (own.size() > kMostRuns) own.resize(kMostRuns);
    for (const Run& run : own) {
      seeds.push_back({middleOf(run.middle), run.entering ? Direction::Forward : Direction::Backward, part});
    }
    if (!own.empty()) continue;
    const SurfacePoint centre{firstFace[part], Eigen::Vector3d::Constant(1.0 / 3.0)};
    seeds.push_back({centre, Direction::Forward, part});
    seeds.push_back({centre, Direction::Backward, part});
  }
  return seeds;
}

}  // namespace

RecurrentParts recurrentParts(const VectorField& field, const CombinatorialMap& map, const std::vector<char>& resting) {
  const TriangleMesh& mesh = field.mesh();
  const Components components = stronglyConnectedComponents(map.graph);
  RecurrentParts result;
  std::vector<Index> number(components.count(), kNone);
  const auto assign = [&] {
    // By the first face, so that the numbers do not depend on how the graph was searched.
    result.of.assign(mesh.faceCount(), kNone);
    for (Index f = 0; f < mesh.faceCount(); ++f) {
      Index& part = number[components.of[f]];
      if (part == kNone && components.sizes[components.of[f]] > 1) part = result.count++;
      if (part >= 0) result.of[f] = part;
    }
  };
  assign();
  const std::vector<Part> all = measure(mesh, result.of, result.count, resting);
  // Once more, without the parts that cannot hold an orbit.
  constexpr Index kLeftOut = -2;
  for (Index& part : number) {
    if (part != kNone) part = !all[part].rests && all[part].eulerCharacteristic() == 1 ? kLeftOut : kNone;
  }
  result.count = 0;
  assign();
  result.seeds = findSeeds(field, result.of, measure(mesh, result.of, result.count, resting));
  return result;
}

}  // namespace stormfield
