#include "io/uv_raster.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/error.h"
#include "base/message.h"
#include "io/detail/slices.h"

namespace stormfield {
namespace {

using Vec2 = Eigen::Vector2d;

/// Rows handled by one task; a face is drawn by every band it touches, in face order, so no two tasks share a pixel.
constexpr Index kBand = 16;
/// Faces between two checks of the progress.
constexpr Index kBatch = 4096;
/// A triangle this far (pixels) from a pixel's centre still touches its square.
constexpr double kTouch = 0.70711;
constexpr Index kMaxSize = 32768;

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// A face in pixel coordinates (x right, y down), with what its barycentric coordinates need.
struct PixelTriangle {
  std::array<Vec2, 3> corner;
  double doubleArea;

  PixelTriangle(const std::array<Vec2, 3>& uv, const UvRasterOptions& options) {
    for (int k = 0; k < 3; ++k) corner[k] = {uv[k].x() * options.width, (1.0 - uv[k].y()) * options.height};
    doubleArea = cross(corner[1] - corner[0], corner[2] - corner[0]);
  }

  Eigen::Vector3d barycentric(const Vec2& p) const {
    return Eigen::Vector3d(cross(corner[1] - p, corner[2] - p), cross(corner[2] - p, corner[0] - p),
                           cross(corner[0] - p, corner[1] - p)) /
           doubleArea;
  }

  /// The closest point of the triangle, and its squared distance.
  Eigen::Vector3d closest(const Vec2& p, double& squaredDistance) const {
    const Eigen::Vector3d inside = barycentric(p);
    if (inside.minCoeff() >= 0.0) {
      squaredDistance = 0.0;
      return inside;
    }
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    squaredDistance = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const Vec2 a = corner[k], edge = corner[(k + 1) % 3] - a;
      const double t = std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      const double distance = (a + t * edge - p).squaredNorm();
      if (distance < squaredDistance) {
        squaredDistance = distance;
        best.setZero();
        best[k] = 1.0 - t;
        best[(k + 1) % 3] = t;
      }
    }
    return best;
  }
};

/// Area below which a UV triangle has none: far below what a pixel can show.
bool hasArea(const PixelTriangle& t) {
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, (t.corner[(k + 1) % 3] - t.corner[k]).squaredNorm());
  return std::abs(t.doubleArea) > 1e-12 * longest && std::abs(t.doubleArea) > 1e-12;
}

Vec2 centre(Index x, Index y) {
  return {x + 0.5, y + 0.5};
}

class Rasterizer {
 public:
  Rasterizer(const FaceUvs& uvs, const UvRasterOptions& options, Progress* progress)
      : uvs_(uvs), options_(options), progress_(progress) {
    raster_.width = options.width;
    raster_.height = options.height;
    resizeInSlices(raster_.points, pixelCount(), SurfacePoint(), progress);
    resizeInSlices(squaredDistance_, pixelCount(), std::numeric_limits<float>::infinity(), progress);
    resizeInSlices(overlaps_, pixelCount(), std::uint8_t{0}, progress);
  }

  UvRaster run() {
    sortIntoBands();
    phase(0.0, 0.5);
    inSlices(bands_.size(), 1, progress_, [&](std::size_t band, std::size_t) { drawBand(static_cast<Index>(band)); });
    check();
    raster_.coveredPixels = static_cast<Index>(std::count(squaredDistance_.begin(), squaredDistance_.end(), 0.0f));
    raster_.overlappingPixels =
        static_cast<Index>(std::count_if(overlaps_.begin(), overlaps_.end(), [](auto n) { return n > 1; }));
    for (Index step = 0; step < options_.margin; ++step) {
      phase(0.5 + 0.5 * step / options_.margin, 0.5 + 0.5 * (step + 1) / options_.margin);
      grow();
    }
    return std::move(raster_);
  }

 private:
  void check() const {
    if (progress_) progress_->check();
  }
  void phase(double from, double to) const {
    if (progress_) progress_->range(from, to);
  }
  std::size_t pixelCount() const { return static_cast<std::size_t>(options_.width) * options_.height; }
  std::size_t pixel(Index x, Index y) const { return static_cast<std::size_t>(y) * options_.width + x; }

  void sortIntoBands() {
    bands_.resize((options_.height + kBand - 1) / kBand);
    for (Index f = 0; f < static_cast<Index>(uvs_.size()); ++f) {
      if (f % kBatch == 0) check();
      const PixelTriangle t(uvs_[f], options_);
      const auto& uv = uvs_[f];
      raster_.outsideFaces += std::any_of(
          uv.begin(), uv.end(), [](const Vec2& p) { return p.minCoeff() < -1e-6 || p.maxCoeff() > 1.0 + 1e-6; });
      if (!hasArea(t)) {
        ++raster_.zeroAreaFaces;
        continue;
      }
      const auto [top, bottom] = rows(t);
      for (Index band = top / kBand; top <= bottom && band <= bottom / kBand; ++band) bands_[band].push_back(f);
    }
    if (raster_.zeroAreaFaces == static_cast<Index>(uvs_.size())) {
      throw InputError("no face of the UV layer has an area; unwrap the mesh first");
    }
  }

  static Index clampPixel(double value, Index size) {
    return static_cast<Index>(std::clamp(std::floor(value), 0.0, static_cast<double>(size - 1)));
  }
  std::pair<Index, Index> range(const PixelTriangle& t, int axis, Index size) const {
    const auto [low, high] = std::minmax({t.corner[0][axis], t.corner[1][axis], t.corner[2][axis]});
    if (high < -1.0 || low > size + 1.0) return {1, 0};
    return {clampPixel(low - 1.0, size), clampPixel(high + 1.0, size)};
  }
  std::pair<Index, Index> rows(const PixelTriangle& t) const { return range(t, 1, options_.height); }

  void drawBand(Index band) {
    const Index first = band * kBand, last = std::min(first + kBand, options_.height) - 1;
    for (const Index f : bands_[band]) {
      const PixelTriangle t(uvs_[f], options_);
      const auto [top, bottom] = rows(t);
      const auto [left, right] = range(t, 0, options_.width);
      for (Index y = std::max(top, first); y <= std::min(bottom, last); ++y) {
        check();
        for (Index x = left; x <= right; ++x) draw(f, t, x, y);
      }
    }
  }

  void draw(Index f, const PixelTriangle& t, Index x, Index y) {
    double distance = 0.0;
    const Eigen::Vector3d where = t.closest(centre(x, y), distance);
    if (distance > kTouch * kTouch) return;
    const std::size_t i = pixel(x, y);
    // Shared edges are no overlap: only points well inside count.
    if (distance == 0.0 && where.minCoeff() > 1e-6)
      overlaps_[i] = static_cast<std::uint8_t>(std::min(overlaps_[i] + 1, 2));
    if (static_cast<float>(distance) < squaredDistance_[i]) {
      squaredDistance_[i] = static_cast<float>(distance);
      raster_.points[i] = {f, where};
    }
  }

  /// One ring of pixels more: each takes the closest of the faces its neighbours show.
  void grow() {
    std::vector<std::vector<std::pair<Index, SurfacePoint>>> ring(options_.height);
    const auto rows = [&](Progress* progress, const auto& body) {
      inSlices(ring.size(), kBand, progress, [&](std::size_t first, std::size_t last) {
        for (std::size_t y = first; y < last; ++y) body(static_cast<Index>(y));
      });
    };
    rows(progress_, [&](Index y) {
      for (Index x = 0; x < options_.width; ++x) {
        if (raster_.points[pixel(x, y)].face != kNone) continue;
        const SurfacePoint shown = closestOfNeighbours(x, y);
        if (shown.face != kNone) ring[y].emplace_back(x, shown);
      }
    });
    rows(nullptr, [&](Index y) {
      for (const auto& [x, shown] : ring[y]) raster_.points[pixel(x, y)] = shown;
    });
  }

  SurfacePoint closestOfNeighbours(Index x, Index y) const {
    SurfacePoint best;
    double bestDistance = std::numeric_limits<double>::infinity();
    for (Index ny = std::max(y - 1, Index{0}); ny <= std::min(y + 1, options_.height - 1); ++ny) {
      for (Index nx = std::max(x - 1, Index{0}); nx <= std::min(x + 1, options_.width - 1); ++nx) {
        const Index f = raster_.points[pixel(nx, ny)].face;
        if (f == kNone || f == best.face) continue;
        double distance = 0.0;
        const Eigen::Vector3d where = PixelTriangle(uvs_[f], options_).closest(centre(x, y), distance);
        if (distance < bestDistance || (distance == bestDistance && f < best.face)) {
          bestDistance = distance;
          best = {f, where};
        }
      }
    }
    return best;
  }

  const FaceUvs& uvs_;
  const UvRasterOptions& options_;
  Progress* progress_;
  UvRaster raster_;
  std::vector<std::vector<Index>> bands_;
  std::vector<float> squaredDistance_;
  std::vector<std::uint8_t> overlaps_;
};

void check(const TriangleMesh& mesh, const FaceUvs& uvs, const UvRasterOptions& options) {
  if (static_cast<Index>(uvs.size()) != mesh.faceCount()) {
    throw InputError(message("the UV layer has ", uvs.size(), " faces, the mesh ", mesh.faceCount(),
                             "; read both from the same mesh"));
  }
  for (std::size_t f = 0; f < uvs.size(); ++f) {
    for (const Vec2& p : uvs[f]) {
      if (!p.allFinite())
        throw InputError(message("UV coordinates of face ", f, " are not finite; unwrap the mesh again"));
    }
  }
  if (std::min(options.width, options.height) < 1 || std::max(options.width, options.height) > kMaxSize) {
    throw InputError(message("an image of ", options.width, " x ", options.height, " pixels; choose 1 to ", kMaxSize));
  }
  if (options.margin < 0) throw InputError("the margin of a flow map is negative; choose 0 pixels or more");
}

}  // namespace

UvRaster rasterizeUv(const TriangleMesh& mesh, const FaceUvs& uvs, const UvRasterOptions& options, Progress* progress) {
  check(mesh, uvs, options);
  return Rasterizer(uvs, options, progress).run();
}

}  // namespace stormfield
