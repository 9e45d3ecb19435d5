// Data sets that are too large for the repository, and made by others: those of the thesis, from its authors.
// STORMFIELD_DATA names the folder that holds them.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fixtures.h"

namespace stormfield::test {

struct SampledSurface {
  Surface surface;
  Points vectors;
};

/// A .t file: "faces vertices", then triangles, positions and vectors row by row. None where it is absent.
inline std::optional<SampledSurface> dataSet(const std::string& name) {
  const char* folder = std::getenv("STORMFIELD_DATA");
  if (folder == nullptr) return std::nullopt;
  std::ifstream file(std::filesystem::path(folder) / name);
  if (!file) return std::nullopt;
  Eigen::Index faces = 0, vertices = 0;
  file >> faces >> vertices;
  SampledSurface s{{Points(vertices, 3), Triangles(faces, 3)}, Points(vertices, 3)};
  for (Eigen::Index i = 0; i < s.surface.triangles.size(); ++i) file >> s.surface.triangles.data()[i];
  for (Eigen::Index i = 0; i < s.surface.points.size(); ++i) file >> s.surface.points.data()[i];
  for (Eigen::Index i = 0; i < s.vectors.size(); ++i) file >> s.vectors.data()[i];
  return s;
}

/// What a test or benchmark says that has to do without a data set.
inline std::string withoutDataSet(const std::string& name) {
  return name + " is not in the folder that STORMFIELD_DATA names (a data set of the thesis, from its authors)";
}

/// Every edge cut in `parts` equal pieces and every face in parts^2, vectors in between linear.
inline SampledSurface subdivided(const SampledSurface& coarse, Index parts = 2) {
  const auto& [points, triangles] = coarse.surface;
  using Row = Eigen::Matrix<double, 1, 6>;  // position and vector
  std::vector<Row> rows(points.rows());
  for (Eigen::Index v = 0; v < points.rows(); ++v) rows[v] << points.row(v), coarse.vectors.row(v);
  const auto add = [&](const Row& row) {
    rows.push_back(row);
    return static_cast<Index>(rows.size()) - 1;
  };
  std::map<std::tuple<Index, Index, Index>, Index> onEdges;  // by the ends and the pieces from the first of them
  SampledSurface fine{{Points(), Triangles(parts * parts * triangles.rows(), 3)}, Points()};
  Eigen::Index count = 0;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const Index a = triangles(f, 0), b = triangles(f, 1), c = triangles(f, 2);
    const auto onEdge = [&](Index from, Index to, Index pieces) {
      if (pieces == 0) return from;
      if (pieces == parts) return to;
      if (from > to) std::swap(from, to), pieces = parts - pieces;
      const auto [place, fresh] = onEdges.try_emplace({from, to, pieces}, kNone);
      if (fresh) place->second = add(rows[from] + static_cast<double>(pieces) / parts * (rows[to] - rows[from]));
      return place->second;
    };
    std::vector<Index> inside((parts + 1) * (parts + 1), kNone);
    // i pieces from a towards b, j towards c.
    const auto at = [&](Index i, Index j) {
      if (j == 0) return onEdge(a, b, i);
      if (i == 0) return onEdge(a, c, j);
      if (i + j == parts) return onEdge(b, c, j);
      Index& place = inside[i * parts + j];
      if (place == kNone)
        place = add(rows[a] + (i * (rows[b] - rows[a]) + j * (rows[c] - rows[a])) / static_cast<double>(parts));
      return place;
    };
    for (Index j = 0; j < parts; ++j) {
      for (Index i = 0; i + j < parts; ++i) {
        fine.surface.triangles.row(count++) << at(i, j), at(i + 1, j), at(i, j + 1);
        if (i + j + 1 == parts) continue;
        fine.surface.triangles.row(count++) << at(i + 1, j), at(i + 1, j + 1), at(i, j + 1);
      }
    }
  }
  fine.surface.points.resize(static_cast<Eigen::Index>(rows.size()), 3);
  fine.vectors.resize(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t v = 0; v < rows.size(); ++v) {
    fine.surface.points.row(static_cast<Eigen::Index>(v)) = rows[v].head<3>();
    fine.vectors.row(static_cast<Eigen::Index>(v)) = rows[v].tail<3>();
  }
  return fine;
}

inline VectorField fieldOn(const SampledSurface& s) {
  return fromSpace(makeCharts(s.surface), s.vectors);
}

}  // namespace stormfield::test
