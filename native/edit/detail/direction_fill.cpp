#include "edit/detail/direction_fill.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

#include "edit/detail/local_laplacian.h"
#include "field/poincare_index.h"

namespace stormfield {
namespace {

constexpr double kPi = std::numbers::pi;
using Matrix = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

double wrapped(double angle) {
  return std::remainder(angle, 2.0 * kPi);
}

/// The region of a fill: the faces around its free vertices, and what is given on their edges.
class Region {
 public:
  Region(const VectorField& given, const std::vector<Index>& freeVertices)
      : field(given), mesh(given.mesh()), charts(*given.charts), free(freeVertices), number(numbersOf(mesh, free)) {
    for (const Index v : free) {
      for (Index h = mesh.outgoing(v); h != kNone; h = mesh.nextOutgoing(h)) faces.push_back(TriangleMesh::face(h));
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    for (const Index f : faces) {
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        edges.push_back(mesh.edge(h));
        vertices.push_back(mesh.tail(h));
      }
    }
    for (std::vector<Index>* list : {&edges, &vertices}) {
      std::sort(list->begin(), list->end());
      list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    facePlaces_ = placesOf(faces, mesh.faceCount());
    edgePlaces_ = placesOf(edges, mesh.edgeCount());
    vertexPlaces_ = placesOf(vertices, mesh.vertexCount());
    for (const Index e : edges) weights_.push_back(positiveEdgeWeight(mesh, e));
  }

  bool isFree(Index v) const { return number[v] != kNone; }
  bool isGiven(Index edge) const {
    const Index h = mesh.edgeHalfedge(edge);
    return !isFree(mesh.tail(h)) && !isFree(mesh.head(h));
  }
  /// Places in the lists below, kNone for what is outside.
  Index facePlace(Index face) const { return facePlaces_[face]; }
  Index edgePlace(Index edge) const { return edgePlaces_[edge]; }
  Index vertexPlace(Index vertex) const { return vertexPlaces_[vertex]; }
  double weight(Index edge) const { return weights_[edgePlaces_[edge]]; }
  double givenRotation(Index edge) const {
    const Index h = mesh.edgeHalfedge(edge);
    return wrapped(std::arg(field.values[mesh.head(h)]) - charts.headAngle(h) - std::arg(field.values[mesh.tail(h)]) +
                   charts.tailAngle(h));
  }
  /// What the rotations around a face add up to without a zero in it.
  double twist(Index face) const {
    double sum = 0.0;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) sum += (1.0 - charts.scale(mesh.tail(h))) * mesh.cornerAngle(h);
    return sum;
  }
  double sign(Index h) const { return mesh.edgeHalfedge(mesh.edge(h)) == h ? 1.0 : -1.0; }

  const VectorField& field;
  const TriangleMesh& mesh;
  const VertexCharts& charts;
  const std::vector<Index>& free;
  std::vector<Index> number;
  std::vector<Index> faces, edges, vertices;

 private:
  static std::vector<Index> placesOf(const std::vector<Index>& list, Index count) {
    std::vector<Index> places(count, kNone);
    for (std::size_t i = 0; i < list.size(); ++i) places[list[i]] = static_cast<Index>(i);
    return places;
  }
  std::vector<Index> facePlaces_, edgePlaces_, vertexPlaces_;
  std::vector<double> weights_;  ///< per place of an edge
};

/// Faces by edges that are not given: the order of a search from a root, and the edge to the face that each was found
/// from.
struct FaceTree {
  std::vector<Index> order;   ///< places of faces
  std::vector<Index> parent;  ///< per place of a face the halfedge of that face to its parent, kNone at the root
};

FaceTree faceTree(const Region& region, Index root, std::vector<char>& seen) {
  FaceTree tree{{root}, std::vector<Index>(region.faces.size(), kNone)};
  seen[root] = 1;
  for (std::size_t i = 0; i < tree.order.size(); ++i) {
    const Index f = region.faces[tree.order[i]];
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (region.isGiven(region.mesh.edge(h)) || region.mesh.twin(h) == kNone) continue;
      const Index next = region.facePlace(TriangleMesh::face(region.mesh.twin(h)));
      if (next == kNone || seen[next] != 0) continue;
      seen[next] = 1;
      tree.parent[next] = region.mesh.twin(h);
      tree.order.push_back(next);
    }
  }
  return tree;
}

std::vector<FaceTree> faceTrees(const Region& region) {
  std::vector<char> seen(region.faces.size(), 0);
  std::vector<FaceTree> trees;
  for (Index i = 0; i < static_cast<Index>(region.faces.size()); ++i) {
    if (seen[i] == 0) trees.push_back(faceTree(region, i, seen));
  }
  return trees;
}

/// Sum of the indices inside that the given rotations around a tree of faces ask for.
int indexSum(const Region& region, const FaceTree& tree) {
  double sum = 0.0;
  for (const Index place : tree.order) {
    const Index f = region.faces[place];
    sum -= region.twist(f);
    for (Index h = 3 * f; h < 3 * f + 3; ++h) {
      if (region.isGiven(region.mesh.edge(h))) {
        sum += region.sign(h) * region.givenRotation(region.mesh.edge(h));
      }
    }
  }
  return static_cast<int>(std::lround(sum / (2.0 * kPi)));
}

/// Per place of a face how many edges it is from the given vertices.
std::vector<Index> depths(const Region& region) {
  std::vector<Index> distance(region.vertices.size(), kNone), order;
  for (std::size_t i = 0; i < region.vertices.size(); ++i) {
    if (region.isFree(region.vertices[i])) continue;
    distance[i] = 0;
    order.push_back(static_cast<Index>(i));
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    forEachNeighbour(region.mesh, region.vertices[order[i]], [&](Index neighbour, Index, bool) {
      if (!region.isFree(neighbour)) return;
      const Index place = region.vertexPlace(neighbour);
      if (distance[place] != kNone) return;
      distance[place] = distance[order[i]] + 1;
      order.push_back(place);
    });
  }
  std::vector<Index> result;
  for (const Index f : region.faces) {
    Index least = distance[region.vertexPlace(region.mesh.vertex(f, 0))];
    for (int k = 1; k < 3; ++k) {
      least = std::min(least, distance[region.vertexPlace(region.mesh.vertex(f, k))]);
    }
    result.push_back(least);
  }
  return result;
}

/// Places of faces of a tree for zeros, the preferred ones first, then the deepest.
std::vector<Index> zeroCandidates(const Region& region, const FaceTree& tree, const std::vector<Index>& depth,
                                  const std::vector<Index>& preferred) {
  std::vector<Index> inTree = tree.order;
  std::sort(inTree.begin(), inTree.end());
  std::vector<Index> candidates;
  for (const Index f : preferred) {
    const Index place = region.facePlace(f);
    if (place != kNone && depth[place] > 0 && std::binary_search(inTree.begin(), inTree.end(), place)) {
      candidates.push_back(place);
    }
  }
  std::stable_sort(inTree.begin(), inTree.end(), [&](Index a, Index b) { return depth[a] > depth[b]; });
  // Spread over the deepest quarter, so that neighbours do not all come first.
  const std::size_t deepest = std::max<std::size_t>(1, inTree.size() / 4);
  for (std::size_t part = 0; part < 4; ++part) candidates.push_back(inTree[part * deepest / 4]);
  candidates.insert(candidates.end(), inTree.begin(), inTree.end());
  std::vector<char> taken(region.faces.size(), 0);
  std::erase_if(candidates, [&](Index place) { return std::exchange(taken[place], 1) != 0; });
  return candidates;
}

/// One rotation per place of an edge that adds up around every face. indices: per place of a face.
std::vector<double> anyRotations(const Region& region, const std::vector<FaceTree>& trees,
                                 const std::vector<int>& indices) {
  std::vector<double> rotations(region.edges.size(), 0.0);
  for (std::size_t i = 0; i < region.edges.size(); ++i) {
    if (region.isGiven(region.edges[i])) rotations[i] = region.givenRotation(region.edges[i]);
  }
  for (const FaceTree& tree : trees) {
    for (auto place = tree.order.rbegin(); place != tree.order.rend(); ++place) {
      const Index toParent = tree.parent[*place];
      if (toParent == kNone) continue;
      const Index f = region.faces[*place];
      double rest = 2.0 * kPi * indices[*place] + region.twist(f);
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (h != toParent) rest -= region.sign(h) * rotations[region.edgePlace(region.mesh.edge(h))];
      }
      rotations[region.edgePlace(region.mesh.edge(toParent))] = region.sign(toParent) * rest;
    }
  }
  return rotations;
}

/// Angles of the vectors by these rotations, from a given vertex on; and the connected parts of the given vertices.
class Angles {
 public:
  Angles(const Region& region, const std::vector<double>& rotations)
      : region_(region),
        rotations_(rotations),
        angle(region.vertices.size(), 0.0),
        part(region.vertices.size(), kNone) {
    std::vector<char> seen(region.vertices.size(), 0);
    for (std::size_t i = 0; i < region.vertices.size(); ++i) {
      if (seen[i] == 0 && !region.isFree(region.vertices[i])) follow(static_cast<Index>(i), seen);
    }
    for (std::size_t i = 0; i < region.vertices.size(); ++i) {
      if (part[i] == kNone && !region.isFree(region.vertices[i])) markPart(static_cast<Index>(i));
    }
  }

  /// Whether the rotations around every closed curve lead back: not around handles.
  bool agree() const {
    for (std::size_t i = 0; i < region_.edges.size(); ++i) {
      const Index h = region_.mesh.edgeHalfedge(region_.edges[i]);
      const double step = angle[at(region_.mesh.head(h))] - angle[at(region_.mesh.tail(h))];
      if (std::abs(wrapped(step - stepAlong(h, rotations_[i]))) > 1e-6) return false;
    }
    return true;
  }

 private:
  Index at(Index vertex) const { return region_.vertexPlace(vertex); }
  double stepAlong(Index canonical, double rotation) const {
    return rotation + region_.charts.headAngle(canonical) - region_.charts.tailAngle(canonical);
  }
  bool inRegion(Index edge) const { return region_.edgePlace(edge) != kNone; }

  void follow(Index root, std::vector<char>& seen) {
    angle[root] = std::arg(region_.field.values[region_.vertices[root]]);
    seen[root] = 1;
    std::vector<Index> order{root};
    for (std::size_t i = 0; i < order.size(); ++i) {
      forEachNeighbour(region_.mesh, region_.vertices[order[i]], [&](Index neighbour, Index edge, bool along) {
        if (!inRegion(edge)) return;
        const Index next = at(neighbour);
        if (seen[next] != 0) return;
        seen[next] = 1;
        const double step = stepAlong(region_.mesh.edgeHalfedge(edge), rotations_[region_.edgePlace(edge)]);
        angle[next] = angle[order[i]] + (along ? step : -step);
        order.push_back(next);
      });
    }
  }
  void markPart(Index root) {
    part[root] = partCount++;
    std::vector<Index> order{root};
    for (std::size_t i = 0; i < order.size(); ++i) {
      forEachNeighbour(region_.mesh, region_.vertices[order[i]], [&](Index neighbour, Index edge, bool) {
        if (!inRegion(edge) || region_.isFree(neighbour)) return;
        const Index next = at(neighbour);
        if (part[next] != kNone) return;
        part[next] = part[root];
        order.push_back(next);
      });
    }
  }

  const Region& region_;
  const std::vector<double>& rotations_;

 public:
  std::vector<double> angle;
  std::vector<Index> part;
  Index partCount = 0;
};

Matrix laplacian(const Region& region) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Index v : region.free) {
    forEachNeighbour(region.mesh, v, [&](Index neighbour, Index edge, bool) {
      const double weight = region.weight(edge);
      entries.emplace_back(region.number[v], region.number[v], weight);
      if (region.isFree(neighbour)) entries.emplace_back(region.number[v], region.number[neighbour], -weight);
    });
  }
  const auto size = static_cast<Eigen::Index>(region.free.size());
  Matrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// The harmonic continuation of values that are given per place of a vertex, less what the rotations rotate.
Vector continuation(const Region& region, const Eigen::SimplicialLDLT<Matrix>& factors,
                    const std::vector<double>& given, const std::vector<double>* rotations) {
  Vector right = Vector::Zero(static_cast<Eigen::Index>(region.free.size()));
  for (const Index v : region.free) {
    forEachNeighbour(region.mesh, v, [&](Index neighbour, Index edge, bool along) {
      const double weight = region.weight(edge);
      if (!region.isFree(neighbour)) right[region.number[v]] += weight * given[region.vertexPlace(neighbour)];
      if (rotations == nullptr) return;
      const double rotation = (*rotations)[region.edgePlace(edge)];
      right[region.number[v]] += weight * (along ? rotation : -rotation);
    });
  }
  return factors.solve(right);
}

/// Potentials of one choice of places for the zeros.
class Potentials {
 public:
  Potentials(const Region& region, const Eigen::SimplicialLDLT<Matrix>& factors, const std::vector<double>& rotations,
             const Angles& angles)
      : region_(region), rotations_(rotations) {
    std::vector<double> given(region.vertices.size(), 0.0);
    std::vector<char> known(angles.partCount, 0);
    std::vector<double> shift(angles.partCount, 0.0);
    for (std::size_t i = 0; i < region.vertices.size(); ++i) {
      const Index part = angles.part[i];
      if (part == kNone) continue;
      if (known[part] == 0) {
        known[part] = 1;
        shift[part] = wrapped(std::arg(region.field.values[region.vertices[i]]) - angles.angle[i]);
      }
      given[i] = shift[part];
    }
    base_ = {given, continuation(region, factors, given, &rotations)};
    for (Index part = 1; part < std::min<Index>(angles.partCount, kMaxParts); ++part) {
      std::vector<double> turn(region.vertices.size(), 0.0);
      for (std::size_t i = 0; i < turn.size(); ++i) turn[i] = angles.part[i] == part ? 2.0 * kPi : 0.0;
      turns_.push_back({turn, continuation(region, factors, turn, nullptr)});
    }
  }

  /// The potentials per place of a vertex, by rising energy.
  std::vector<std::vector<double>> best(int count) const {
    std::vector<std::pair<double, std::vector<double>>> found;
    std::vector<int> turns(turns_.size(), -kMaxTurns);
    for (;;) {
      std::vector<double> potential = combined(turns);
      found.emplace_back(energy(potential), std::move(potential));
      std::size_t digit = 0;
      while (digit < turns.size() && turns[digit] == kMaxTurns) turns[digit++] = -kMaxTurns;
      if (digit == turns.size()) break;
      ++turns[digit];
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::vector<double>> result;
    for (auto& [e, potential] : found) {
      if (static_cast<int>(result.size()) < count) result.push_back(std::move(potential));
    }
    return result;
  }

 private:
  static constexpr Index kMaxParts = 4;
  static constexpr int kMaxTurns = 2;
  struct Solution {
    std::vector<double> given;
    Vector free;
  };

  std::vector<double> combined(const std::vector<int>& turns) const {
    std::vector<double> potential(region_.vertices.size());
    for (std::size_t i = 0; i < potential.size(); ++i) {
      const Index n = region_.number[region_.vertices[i]];
      const auto of = [&](const Solution& s) { return n == kNone ? s.given[i] : s.free[n]; };
      potential[i] = of(base_);
      for (std::size_t t = 0; t < turns.size(); ++t) potential[i] += turns[t] * of(turns_[t]);
    }
    return potential;
  }
  double energy(const std::vector<double>& potential) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < region_.edges.size(); ++i) {
      const Index h = region_.mesh.edgeHalfedge(region_.edges[i]);
      const double rotation = rotations_[i] + potential[region_.vertexPlace(region_.mesh.head(h))] -
                              potential[region_.vertexPlace(region_.mesh.tail(h))];
      sum += region_.weight(region_.edges[i]) * rotation * rotation;
    }
    return sum;
  }

  const Region& region_;
  const std::vector<double>& rotations_;
  Solution base_;
  std::vector<Solution> turns_;
};

/// Logarithms of the lengths, harmonic between the given ones.
Vector logLengths(const Region& region, const Eigen::SimplicialLDLT<Matrix>& factors) {
  double largest = 0.0;
  for (const Index v : region.vertices) largest = std::max(largest, std::abs(region.field.values[v]));
  std::vector<double> given(region.vertices.size(), 0.0);
  for (std::size_t i = 0; i < given.size(); ++i) {
    given[i] = std::log(std::max(std::abs(region.field.values[region.vertices[i]]), 1e-6 * largest));
  }
  return continuation(region, factors, given, nullptr);
}

/// Per place of a face its index, with the zeros of each tree at the candidates from this one on.
std::vector<int> placedIndices(const Region& region, const std::vector<FaceTree>& trees,
                               const std::vector<Index>& depth, const std::vector<Index>& preferred, int placement) {
  std::vector<int> indices(region.faces.size(), 0);
  for (const FaceTree& tree : trees) {
    const int sum = indexSum(region, tree);
    if (sum == 0) continue;
    const std::vector<Index> candidates = zeroCandidates(region, tree, depth, preferred);
    for (int i = 0; i < std::abs(sum); ++i) {
      indices[candidates[static_cast<std::size_t>(placement + i) % candidates.size()]] += sum > 0 ? 1 : -1;
    }
  }
  return indices;
}

}  // namespace

std::vector<VectorField> directionFills(const VectorField& field, const std::vector<Index>& freeVertices,
                                        const DirectionFillOptions& options) {
  const Region region(field, freeVertices);
  const std::vector<FaceTree> trees = faceTrees(region);
  const std::vector<Index> depth = depths(region);
  const Eigen::SimplicialLDLT<Matrix> factors(laplacian(region));
  const Vector lengths = logLengths(region, factors);
  const bool anyZero = std::any_of(trees.begin(), trees.end(), [&](const auto& t) { return indexSum(region, t) != 0; });
  std::vector<VectorField> fills;
  for (int placement = 0; placement < (anyZero ? options.placements : 1); ++placement) {
    const std::vector<double> rotations =
        anyRotations(region, trees, placedIndices(region, trees, depth, options.zeroFaces, placement));
    const Angles angles(region, rotations);
    if (!angles.agree()) return fills;
    for (const std::vector<double>& potential : Potentials(region, factors, rotations, angles).best(options.turns)) {
      VectorField filled = field;
      for (std::size_t i = 0; i < region.vertices.size(); ++i) {
        const Index v = region.vertices[i];
        if (!region.isFree(v)) continue;
        filled.values[v] = std::polar(std::exp(lengths[region.number[v]]), angles.angle[i] + potential[i]);
      }
      fills.push_back(std::move(filled));
    }
  }
  return fills;
}

}  // namespace stormfield
