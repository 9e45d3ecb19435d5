// The thesis's data sets, which stand beside the repository where they are at hand.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>

#include "fixtures.h"

namespace stormfield::test {

struct SampledSurface {
  Surface surface;
  Points vectors;
};

/// A .t file: "faces vertices", then triangles, positions and vectors row by row. None where it is absent.
inline std::optional<SampledSurface> dataSet(const std::string& name) {
  const auto root = std::filesystem::path(__FILE__).lexically_normal().parent_path().parent_path().parent_path();
  std::ifstream file(root.parent_path() / "shared" / "data" / name);
  if (!file) return std::nullopt;
  Eigen::Index faces = 0, vertices = 0;
  file >> faces >> vertices;
  SampledSurface s{{Points(vertices, 3), Triangles(faces, 3)}, Points(vertices, 3)};
  for (Eigen::Index i = 0; i < s.surface.triangles.size(); ++i) file >> s.surface.triangles.data()[i];
  for (Eigen::Index i = 0; i < s.surface.points.size(); ++i) file >> s.surface.points.data()[i];
  for (Eigen::Index i = 0; i < s.vectors.size(); ++i) file >> s.vectors.data()[i];
  return s;
}

/// Every face cut in four at the middles of its edges, vectors in between linear.
inline SampledSurface subdivided(const SampledSurface& coarse) {
  const Eigen::Index vertices = coarse.surface.points.rows(), faces = coarse.surface.triangles.rows();
  std::map<std::pair<Index, Index>, Index> middles;
  SampledSurface fine{{Points(), Triangles(4 * faces, 3)}, Points()};
  const auto middle = [&](Index a, Index b) {
    return middles.try_emplace(std::minmax(a, b), static_cast<Index>(vertices + middles.size())).first->second;
  };
  for (Eigen::Index f = 0; f < faces; ++f) {
    const Index a = coarse.surface.triangles(f, 0), b = coarse.surface.triangles(f, 1),
                c = coarse.surface.triangles(f, 2);
    const Index x = middle(a, b), y = middle(b, c), z = middle(c, a);
    fine.surface.triangles.middleRows<4>(4 * f) << a, x, z, x, b, y, z, y, c, x, y, z;
  }
  const Eigen::Index all = vertices + static_cast<Eigen::Index>(middles.size());
  fine.surface.points.resize(all, 3);
  fine.vectors.resize(all, 3);
  fine.surface.points.topRows(vertices) = coarse.surface.points;
  fine.vectors.topRows(vertices) = coarse.vectors;
  for (const auto& [ends, at] : middles) {
    const auto& [a, b] = ends;
    fine.surface.points.row(at) = 0.5 * (coarse.surface.points.row(a) + coarse.surface.points.row(b));
    fine.vectors.row(at) = 0.5 * (coarse.vectors.row(a) + coarse.vectors.row(b));
  }
  return fine;
}

inline VectorField fieldOn(const SampledSurface& s) {
  return fromSpace(makeCharts(s.surface), s.vectors);
}

}  // namespace stormfield::test
