#include "mesh/detail/connectivity.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {
namespace {

/// A face is without area when its height is this fraction of its longest edge: below, its angles are round-off.
constexpr double kFlatHeight = 1e-13;

Index next(Index h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
Index prev(Index h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

struct Corners {
  const Index* data;
  Index tail(Index h) const { return data[h]; }
  Index head(Index h) const { return data[next(h)]; }
  Index opposite(Index h) const { return data[prev(h)]; }
};

bool hasArea(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  return ab.cross(ac).norm() > kFlatHeight * longest;
}

/// The halfedges of one edge, already sorted.
void pairGroup(const Corners& corners, const Index* group, std::size_t count, std::vector<Index>& mate) {
  if (count == 1) return;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      if (corners.opposite(group[i]) == corners.opposite(group[j])) {
        throw MeshError(
            message("face ", group[j] / 3, " has the same corners as face ", group[i] / 3, "; delete one of the two"));
      }
    }
  }
  if (count > 2) {
    throw MeshError(message("edge (", corners.tail(group[0]), ", ", corners.head(group[0]), ") belongs to ", count,
                            " faces (", group[0] / 3, ", ", group[1] / 3, ", ", group[2] / 3, count > 3 ? ", ..." : "",
                            "); separate the sheets so that each edge has at most two"));
  }
  mate[group[0]] = group[1];
  mate[group[1]] = group[0];
}

}  // namespace

void checkTriangles(const Points& points, const Triangles& triangles) {
  const Index n = static_cast<Index>(points.rows()), m = static_cast<Index>(triangles.rows());
  if (m == 0) throw MeshError("the mesh has no faces; add at least one triangle");
  for (Index v = 0; v < n; ++v) {
    if (!points.row(v).allFinite()) {
      throw MeshError(message("vertex ", v, " has a coordinate that is not finite; give it a real position"));
    }
  }
  for (Index f = 0; f < m; ++f) {
    const Index a = triangles(f, 0), b = triangles(f, 1), c = triangles(f, 2);
    for (const Index v : {a, b, c}) {
      if (v < 0 || v >= n) {
        throw MeshError(message("face ", f, " refers to vertex ", v, ", but the mesh has vertices 0 to ", n - 1,
                                "; correct the index"));
      }
    }
    if (a == b || b == c || c == a) {
      throw MeshError(message("face ", f, " uses vertex ", a == b || c == a ? a : b, " twice; delete the face"));
    }
    if (!hasArea(points.row(a), points.row(b), points.row(c))) {
      throw MeshError(
          message("face ", f, " (vertices ", a, ", ", b, ", ", c, ") has no area; dissolve it or merge its vertices"));
    }
  }
}

std::vector<Index> pairHalfedges(Index vertexCount, const Triangles& triangles) {
  const Corners corners{triangles.data()};
  const Index count = static_cast<Index>(triangles.size());
  const auto lower = [&](Index h) { return std::min(corners.tail(h), corners.head(h)); };
  const auto upper = [&](Index h) { return std::max(corners.tail(h), corners.head(h)); };

  // Bucket by the lower vertex, then sort the few halfedges of each bucket: linear in the size of the mesh.
  std::vector<Index> start(static_cast<std::size_t>(vertexCount) + 1, 0), bucket(count), mate(count, kNone);
  for (Index h = 0; h < count; ++h) ++start[lower(h) + 1];
  for (Index v = 0; v < vertexCount; ++v) start[v + 1] += start[v];
  std::vector<Index> fill(start.begin(), start.end() - 1);
  for (Index h = 0; h < count; ++h) bucket[fill[lower(h)]++] = h;

  for (Index v = 0; v < vertexCount; ++v) {
    const auto begin = bucket.begin() + start[v], end = bucket.begin() + start[v + 1];
    std::sort(begin, end, [&](Index g, Index h) { return upper(g) != upper(h) ? upper(g) < upper(h) : g < h; });
    for (auto first = begin; first != end;) {
      const auto last = std::find_if(first, end, [&](Index h) { return upper(h) != upper(*first); });
      pairGroup(corners, &*first, static_cast<std::size_t>(last - first), mate);
      first = last;
    }
  }
  return mate;
}

Orientation orientFaces(Triangles& triangles, std::vector<Index>& mate) {
  const Corners corners{triangles.data()};
  const Index faceCount = static_cast<Index>(triangles.rows());
  Orientation result;
  result.faceComponent.assign(faceCount, kNone);
  std::vector<char> flip(faceCount, 0);
  std::vector<Index> members;
  for (Index seed = 0; seed < faceCount; ++seed) {
    if (result.faceComponent[seed] != kNone) continue;
    members.assign(1, seed);
    result.faceComponent[seed] = result.componentCount;
    Index flipped = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Index f = members[i];
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        if (mate[h] == kNone) continue;
        const Index g = mate[h] / 3;
        const bool disagree = corners.tail(h) == corners.tail(mate[h]);
        const char wanted = static_cast<char>(flip[f] ^ static_cast<char>(disagree));
        if (result.faceComponent[g] == kNone) {
          result.faceComponent[g] = result.componentCount;
          flip[g] = wanted;
          flipped += wanted;
          members.push_back(g);
        } else if (flip[g] != wanted) {
          throw MeshError(message("faces ", std::min(f, g), " and ", std::max(f, g),
                                  " cannot be oriented alike across edge (", corners.tail(h), ", ", corners.head(h),
                                  "): the surface is one-sided; cut it open along a line of edges"));
        }
      }
    }
    const bool majority = 2 * static_cast<std::size_t>(flipped) > members.size();
    if (majority) {
      for (const Index f : members) flip[f] ^= 1;
      flipped = static_cast<Index>(members.size()) - flipped;
    }
    result.flippedFaceCount += flipped;
    ++result.componentCount;
  }
  if (result.flippedFaceCount == 0) return result;

  // Exchanging the corners 1 and 2 of a face renames its halfedges k to 2 - k.
  const auto renamed = [&](Index h) { return flip[h / 3] ? 3 * (h / 3) + 2 - h % 3 : h; };
  std::vector<Index> twin(mate.size());
  for (Index h = 0; h < 3 * faceCount; ++h) twin[renamed(h)] = mate[h] == kNone ? kNone : renamed(mate[h]);
  mate.swap(twin);
  for (Index f = 0; f < faceCount; ++f) {
    if (flip[f]) std::swap(triangles(f, 1), triangles(f, 2));
  }
  return result;
}

std::vector<Index> firstOutgoing(Index vertexCount, const Triangles& triangles, const std::vector<Index>& twin) {
  const Corners corners{triangles.data()};
  const Index count = static_cast<Index>(triangles.size());
  std::vector<Index> first(vertexCount, kNone), degree(vertexCount, 0);
  for (Index h = 0; h < count; ++h) {
    const Index v = corners.tail(h);
    ++degree[v];
    if (first[v] == kNone || (twin[h] == kNone && twin[first[v]] != kNone)) first[v] = h;
  }
  for (Index v = 0; v < vertexCount; ++v) {
    if (first[v] == kNone) continue;
    Index reached = 0;
    Index h = first[v];
    do {
      ++reached;
      h = twin[prev(h)];
    } while (h != kNone && h != first[v]);
    if (reached != degree[v]) {
      throw MeshError(message("vertex ", v, " joins separate fans of faces (", reached, " of its ", degree[v],
                              " faces hang together); split the vertex so that each fan has its own"));
    }
  }
  return first;
}

}  // namespace stormfield
