// The lines near a point of the surface: samples of all lines in a hashed grid (Teschner et al. 2003).
//
// The distance of two points is estimated as if each lay in its face's plane and the surface were these two planes:
// with c the chord, n and m the normals,
//     distance^2 = |c|^2 - 2 (c . n)(c . m) / (1 + n . m),
// the length of the straight line over the crease where they meet; |c| where the crease does not lie between the
// points. In a plane and over a crease that is exact, on a round surface too long by less than a fraction theta^2 / 12,
// theta the angle between the normals. Beyond an angle of 135 degrees, as between the two sides of a sheet, points are
// not near. Nor are they where no part of the surface inside the ball around one of them connects them: layers, folds
// and other components never block each other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "mesh/surface_point.h"

namespace stormfield {

/// A point of a line, with what distances on the surface need.
struct LineSample {
  Vec3 position = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  Index face = kNone;
  Index line = kNone;
  double arc = 0.0;  ///< along the line from where it was begun, mesh units, negative on its backward side
};

/// Estimate of the squared distance along the surface, see above.
inline double squaredSurfaceDistance(const Vec3& p, const Vec3& n, const Vec3& q, const Vec3& m) {
  constexpr double kOpposed = -0.7071;
  const double cosine = n.dot(m);
  if (cosine < kOpposed) return std::numeric_limits<double>::infinity();
  const Vec3 c = q - p;
  return c.squaredNorm() + std::max(0.0, -2.0 * c.dot(n) * c.dot(m) / (1.0 + cosine));
}

/// The connected part of the surface around a point, inside a ball. One per thread, used again and again.
class SurfacePatch {
 public:
  explicit SurfacePatch(const TriangleMesh& mesh) : mesh_(&mesh), visited_(mesh.faceCount(), 0) {}

  /// Collects the faces that are reached from `face` over edges that meet the ball.
  void gather(Index face, const Vec3& center, double radius);
  bool contains(Index face) const { return visited_[face] == round_; }
  const std::vector<Index>& faces() const { return faces_; }

 private:
  const TriangleMesh* mesh_;
  std::vector<std::uint32_t> visited_;  ///< round of the last visit
  std::uint32_t round_ = 0;
  std::vector<Index> faces_;
};

class NearLines {
 public:
  /// cell: about the radius that is asked for most, mesh units.
  NearLines(const TriangleMesh& mesh, double cell);

  void add(const LineSample& sample);
  /// Removes the sample that was added last.
  void dropLast();
  std::size_t size() const { return samples_.size(); }
  const LineSample& operator[](std::size_t i) const { return samples_[i]; }

  struct Found {
    double distance;
    const LineSample* sample;
  };
  /// The nearest of the samples within the radius that accept(sample) admits.
  template <typename Accept>
  std::optional<Found> nearest(const Vec3& p, Index face, double radius, SurfacePatch& patch,
                               const Accept& accept) const;

 private:
  static constexpr std::uint32_t kEnd = 0xffffffffU;
  using Cell = Eigen::Matrix<std::int64_t, 3, 1>;

  Cell cellOf(const Vec3& p) const { return ((p - origin_) / cell_).array().floor().cast<std::int64_t>(); }
  std::size_t bucket(const Cell& c) const {
    const auto mixed = static_cast<std::uint64_t>(c[0]) * 0x9E3779B97F4A7C15ULL ^
                       static_cast<std::uint64_t>(c[1]) * 0xC2B2AE3D27D4EB4FULL ^
                       static_cast<std::uint64_t>(c[2]) * 0x165667B19E3779F9ULL;
    return (mixed ^ mixed >> 32) & (heads_.size() - 1);
  }
  void link(std::size_t i);

  const TriangleMesh* mesh_;
  Vec3 origin_;
  double cell_;
  std::vector<LineSample> samples_;
  std::vector<std::uint32_t> heads_, next_;  ///< chains of samples, the latest first
};

// Inline: the inner loop of placement
// ----------------------------------------------------------------------------------

template <typename Accept>
std::optional<NearLines::Found> NearLines::nearest(const Vec3& p, Index face, double radius, SurfacePatch& patch,
                                                   const Accept& accept) const {
  const Vec3 normal = mesh_->faceNormal(face), reach = Vec3::Constant(radius);
  const Cell low = cellOf(p - reach), high = cellOf(p + reach);
  double best = radius * radius;
  const LineSample* found = nullptr;
  bool gathered = false;
  Cell c;
  for (c[0] = low[0]; c[0] <= high[0]; ++c[0]) {
    for (c[1] = low[1]; c[1] <= high[1]; ++c[1]) {
      for (c[2] = low[2]; c[2] <= high[2]; ++c[2]) {
        for (std::uint32_t i = heads_[bucket(c)]; i != kEnd; i = next_[i]) {
          const LineSample& sample = samples_[i];
          const double squared = squaredSurfaceDistance(p, normal, sample.position, sample.normal);
          if (squared >= best || !accept(sample)) continue;
          if (sample.face != face) {
            if (!gathered) patch.gather(face, p, radius);
            gathered = true;
            if (!patch.contains(sample.face)) continue;
          }
          best = squared;
          found = &sample;
        }
      }
    }
  }
  if (found == nullptr) return std::nullopt;
  return Found{std::sqrt(best), found};
}

}  // namespace stormfield
