#include "topology/detail/recurrent_components.h"

#include <algorithm>

#include "topology/detail/section.h"

namespace stormfield {
namespace {

/// Runs of a component's border that get a seed of their own, the longest first: a border with more is ragged, and its
/// short runs lead to what the long ones lead to.
constexpr std::size_t kMaxRuns = 16;

struct ComponentShape {
  Index faces = 0, borderEdges = 0, fans = 0;
  bool holdsFixedPoint = false;

  /// Of the component as a surface of its own: V - E + F with each fan of its faces around a vertex as a vertex.
  Index eulerCharacteristic() const { return fans - (3 * faces + borderEdges) / 2 + faces; }
};

/// Whether the face across a halfedge belongs to the component.
bool continuesAcross(const TriangleMesh& mesh, const std::vector<Index>& of, Index h, Index component) {
  const Index twin = mesh.twin(h);
  return twin != kNone && of[TriangleMesh::face(twin)] == component;
}

void countFans(const TriangleMesh& mesh, const std::vector<Index>& of, std::vector<ComponentShape>& shapes) {
  for (Index v = 0; v < mesh.vertexCount(); ++v) {
    // A fan begins where the face clockwise of its first halfedge is of another component; a full ring has no
    // beginning.
    bool ring = mesh.outgoing(v) != kNone && !mesh.isBoundaryVertex(v);
    for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) {
      const Index component = of[TriangleMesh::face(h)];
      const bool begins = !(component != kNone && continuesAcross(mesh, of, h, component));
      ring = ring && !begins;
      if (component != kNone && begins) ++shapes[component].fans;
    }
    if (ring) ++shapes[of[TriangleMesh::face(mesh.outgoing(v))]].fans;
  }
}

std::vector<ComponentShape> measure(const TriangleMesh& mesh, const std::vector<Index>& of, Index count,
                                    const std::vector<char>& holdsFixedPoint) {
  std::vector<ComponentShape> shapes(count);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    if (of[f] == kNone) continue;
    ComponentShape& shape = shapes[of[f]];
    ++shape.faces;
    shape.holdsFixedPoint = shape.holdsFixedPoint || holdsFixedPoint[f] != 0;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) shape.borderEdges += continuesAcross(mesh, of, h, of[f]) ? 0 : 1;
  }
  countFans(mesh, of, shapes);
  return shapes;
}

/// Consecutive halfedges of a border that the flow crosses in one direction.
struct BorderRun {
  Index middle;
  std::size_t length;
  Direction into;  ///< of the streamlines that enter the component there
};

class BorderSearch {
 public:
  BorderSearch(const VectorField& field, const std::vector<Index>& of)
      : field_(field), mesh_(field.mesh()), of_(of), seen_(mesh_.halfedgeCount(), 0) {}

  /// Adds the runs of the border loop through this halfedge, unless it is no border or its loop has been searched.
  void addRuns(Index h, std::vector<std::vector<BorderRun>>& runs) {
    const Index component = of_[TriangleMesh::face(h)];
    if (seen_[h] != 0 || continuesAcross(mesh_, of_, h, component)) return;
    std::vector<Index> loop;
    for (Index at = h; seen_[at] == 0; at = nextOnBorder(at, component)) {
      seen_[at] = 1;
      loop.push_back(at);
    }
    std::vector<int> signs;
    for (const Index at : loop) signs.push_back(crossing(at));
    // Start where a run begins, so that none is cut in two.
    std::size_t begin = 0;
    while (begin + 1 < loop.size() && signs[begin] == signs[(begin + loop.size() - 1) % loop.size()]) ++begin;
    for (std::size_t i = 0; i < loop.size();) {
      std::size_t end = i;
      while (end < loop.size() && signs[(begin + end) % loop.size()] == signs[(begin + i) % loop.size()]) ++end;
      const std::size_t middle = (begin + (i + end) / 2) % loop.size();
      if (signs[middle] != 0)
        runs[component].push_back(
            {loop[middle], end - i, signs[middle] > 0 ? Direction::Forward : Direction::Backward});
      i = end;
    }
  }

 private:
  Index nextOnBorder(Index h, Index component) const {
    Index next = TriangleMesh::next(h);
    while (continuesAcross(mesh_, of_, next, component)) next = TriangleMesh::next(mesh_.twin(next));
    return next;
  }
  /// +1 into the component, -1 out of it, 0 neither or both.
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

std::vector<ComponentSeed> findSeeds(const VectorField& field, const std::vector<Index>& of,
                                     const std::vector<ComponentShape>& shapes) {
  const TriangleMesh& mesh = field.mesh();
  std::vector<ComponentSeed> seeds;
  if (std::all_of(shapes.begin(), shapes.end(), [](const ComponentShape& shape) { return shape.holdsFixedPoint; })) {
    return seeds;
  }
  std::vector<std::vector<BorderRun>> runs(shapes.size());
  std::vector<Index> firstFace(shapes.size(), kNone);
  BorderSearch search(field, of);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const Index component = of[f];
    if (component == kNone || shapes[component].holdsFixedPoint) continue;
    if (firstFace[component] == kNone) firstFace[component] = f;
    for (Index h = 3 * f; h < 3 * f + 3; ++h) search.addRuns(h, runs);
  }
  for (Index component = 0; component < static_cast<Index>(shapes.size()); ++component) {
    if (firstFace[component] == kNone) continue;
    auto& own = runs[component];
    std::stable_sort(own.begin(), own.end(),
                     [](const BorderRun& a, const BorderRun& b) { return a.length > b.length; });
    if (own.size() > kMaxRuns) own.resize(kMaxRuns);
    for (const BorderRun& run : own) seeds.push_back({middleOf(run.middle), run.into, component});
    if (!own.empty()) continue;
    const SurfacePoint centre{firstFace[component], Eigen::Vector3d::Constant(1.0 / 3.0)};
    seeds.push_back({centre, Direction::Forward, component});
    seeds.push_back({centre, Direction::Backward, component});
  }
  return seeds;
}

/// Numbers the accepted components of the graph by their first face, so that the numbers do not depend on how the graph
/// was searched.
void numberByFirstFace(const TriangleMesh& mesh, const Components& graph, const std::vector<char>& accepted,
                       RecurrentComponents& result) {
  std::vector<Index> number(graph.count(), kNone);
  result.count = 0;
  result.of.assign(mesh.faceCount(), kNone);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    const Index own = graph.of[f];
    if (accepted[own] == 0) continue;
    if (number[own] == kNone) number[own] = result.count++;
    result.of[f] = number[own];
  }
}

}  // namespace

RecurrentComponents recurrentComponents(const VectorField& field, const CombinatorialMap& map,
                                        const std::vector<char>& holdsFixedPoint) {
  const TriangleMesh& mesh = field.mesh();
  const Components graph = stronglyConnectedComponents(map.graph);
  RecurrentComponents result;
  std::vector<char> accepted(graph.count(), 0);
  for (Index i = 0; i < graph.count(); ++i) accepted[i] = graph.sizes[i] > 1 ? 1 : 0;
  numberByFirstFace(mesh, graph, accepted, result);
  // Then without the disks that cannot hold an orbit.
  const std::vector<ComponentShape> shapes = measure(mesh, result.of, result.count, holdsFixedPoint);
  for (Index f = 0; f < mesh.faceCount(); ++f) {
    if (result.of[f] == kNone) continue;
    const ComponentShape& shape = shapes[result.of[f]];
    if (!shape.holdsFixedPoint && shape.eulerCharacteristic() == 1) accepted[graph.of[f]] = 0;
  }
  numberByFirstFace(mesh, graph, accepted, result);
  result.seeds = findSeeds(field, result.of, measure(mesh, result.of, result.count, holdsFixedPoint));
  return result;
}

}  // namespace stormfield
