#include "io/voxel_band.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/message.h"
#include "field/interpolation.h"
#include "io/detail/inside.h"
#include "io/detail/slices.h"

namespace stormfield {
namespace {

constexpr double kMaxVoxels = 268435456.0;
/// Blocks between two checks of the progress.
constexpr std::size_t kSlice = 4;
/// Of distances against the band's width, so that rounding never prunes a block that holds a voxel.
constexpr double kSlack = 1e-9;

using Voxel = std::array<std::int64_t, 3>;

/// A cube of voxels that may hold some of the band, with the surface point closest to its centre.
struct Cube {
  Voxel origin;
  SurfacePoint nearby;
};

/// The band of one block.
struct Block {
  std::vector<std::int16_t> places;
  std::vector<SurfacePoint> points;
  std::vector<float> distances;
};

class BandSearch {
 public:
  BandSearch(const TriangleMesh& mesh, const ClosestPointQuery& query, double size, double halfWidth)
      : mesh_(mesh), query_(query), size_(size), halfWidth_(halfWidth) {
    if (mesh.boundaryLoopCount() == 0) enclosed_.emplace(mesh);
  }

  /// The blocks that may hold voxels of the band, by halving a cube around all of it.
  std::vector<Cube> blocks(Progress* progress) const {
    std::int64_t side = VoxelBand::kSide;
    Voxel low{}, high{};
    for (int k = 0; k < 3; ++k) {
      low[k] = floorToBlock(std::floor(mesh_.points().col(k).minCoeff() / size_ - halfWidth_));
      high[k] = static_cast<std::int64_t>(std::ceil(mesh_.points().col(k).maxCoeff() / size_ + halfWidth_));
      while (low[k] + side <= high[k]) side *= 2;
    }
    std::vector<Cube> cubes = {{low, query_.closest(center(low, side)).point}};
    for (; side > VoxelBand::kSide; side /= 2) {
      std::vector<std::vector<Cube>> parts(cubes.size());
      inSlices(cubes.size(), kSlice, nullptr, [&](std::size_t first, std::size_t last) {
        if (progress) progress->check();
        for (std::size_t i = first; i < last; ++i) {
          eachOctant(cubes[i].origin, side, [&](const Voxel& origin) {
            const ClosestPoint closest = query_.closest(center(origin, side / 2), cubes[i].nearby);
            if (mayMeetBand(closest.distance, side / 2)) parts[i].push_back({origin, closest.point});
          });
        }
      });
      cubes.clear();
      for (const std::vector<Cube>& part : parts) cubes.insert(cubes.end(), part.begin(), part.end());
    }
    return cubes;
  }

  Block block(const Cube& cube) const {
    Block result;
    search(cube.origin, VoxelBand::kSide, cube, result);
    sort(result);
    return result;
  }

 private:
  static std::int64_t floorToBlock(double voxel) {
    return static_cast<std::int64_t>(std::floor(voxel / VoxelBand::kSide)) * VoxelBand::kSide;
  }

  Vec3 center(const Voxel& origin, std::int64_t side) const {
    const double middle = 0.5 * static_cast<double>(side - 1);
    return size_ *
           (Vec3(static_cast<double>(origin[0]), static_cast<double>(origin[1]), static_cast<double>(origin[2])) +
            Vec3::Constant(middle));
  }

  /// Whether a cube can hold a voxel of the band, by the distance of its centre from the surface.
  bool mayMeetBand(double distance, std::int64_t side) const {
    const double halfDiagonal = 0.5 * std::sqrt(3.0) * static_cast<double>(side - 1);
    return distance <= size_ * (halfWidth_ + halfDiagonal) * (1.0 + kSlack);
  }

  template <typename Visit>
  static void eachOctant(const Voxel& origin, std::int64_t side, const Visit& visit) {
    const std::int64_t half = side / 2;
    for (int octant = 0; octant < 8; ++octant) {
      visit(Voxel{origin[0] + (octant >> 2 & 1) * half, origin[1] + (octant >> 1 & 1) * half,
                  origin[2] + (octant & 1) * half});
    }
  }

  void search(const Voxel& origin, std::int64_t side, const Cube& block, Block& found) const {
    SurfacePoint nearby = found.points.empty() ? block.nearby : found.points.back();
    eachOctant(origin, side, [&](const Voxel& part) {
      const Vec3 p = center(part, side / 2);
      const ClosestPoint closest = query_.closest(p, nearby);
      nearby = closest.point;
      if (side > 2) {
        if (mayMeetBand(closest.distance, side / 2)) search(part, side / 2, block, found);
      } else if (closest.distance < size_ * halfWidth_) {
        add(part, p, closest, block, found);
      }
    });
  }

  void add(const Voxel& voxel, const Vec3& p, const ClosestPoint& closest, const Cube& block, Block& found) const {
    int place = 0;
    for (int k = 0; k < 3; ++k) place = place * VoxelBand::kSide + static_cast<int>(voxel[k] - block.origin[k]);
    const bool inside = enclosed_ && enclosed_->contains(p, closest.point);
    found.places.push_back(static_cast<std::int16_t>(place));
    found.points.push_back(closest.point);
    found.distances.push_back(static_cast<float>(inside ? -closest.distance : closest.distance));
  }

  /// Octants are visited in another order than places ascend.
  static void sort(Block& block) {
    std::vector<std::size_t> order(block.places.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return block.places[a] < block.places[b]; });
    Block sorted;
    for (const std::size_t i : order) {
      sorted.places.push_back(block.places[i]);
      sorted.points.push_back(block.points[i]);
      sorted.distances.push_back(block.distances[i]);
    }
    block = std::move(sorted);
  }

  const TriangleMesh& mesh_;
  const ClosestPointQuery& query_;
  double size_, halfWidth_;
  std::optional<EnclosedSpace> enclosed_;
};

/// Throws InputError unless the band of this voxel size (mesh units) can be held.
void checkSize(const TriangleMesh& mesh, double size, double halfWidth) {
  const double estimate = mesh.totalArea() / (size * size) * 2.0 * halfWidth;
  const double reach = mesh.points().cwiseAbs().maxCoeff() / size;
  if (estimate > kMaxVoxels || reach > 1e9) {
    throw InputError(message("a voxel size of ", size, " gives about ", std::ceil(estimate / 1e6),
                             " million voxels; choose one above ",
                             size * std::max(std::sqrt(estimate / kMaxVoxels), reach / 1e9)));
  }
}

/// Fills some blocks: value(voxel, out) writes `width` floats; the other voxels keep kOutsideBand.
template <typename Value>
std::vector<float> filled(const VoxelBand& band, BlockRange range, std::size_t width, const Value& value) {
  std::vector<float> result((range.last - range.first) * VoxelBand::kVoxels * width, kOutsideBand);
  inSlices(range.last - range.first, kSlice, nullptr, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      const std::size_t block = range.first + b;
      for (std::size_t i = band.offsets[block]; i < band.offsets[block + 1]; ++i) {
        value(i, &result[(b * VoxelBand::kVoxels + static_cast<std::size_t>(band.places[i])) * width]);
      }
    }
  });
  return result;
}

void checkMesh(const VoxelBand& band, const VectorField& field) {
  if (field.mesh().faceCount() != band.faceCount) {
    throw InputError("the field and the band belong to different meshes; make both from the same mesh");
  }
}

}  // namespace

VoxelBand voxelBand(const TriangleMesh& mesh, const ClosestPointQuery& query, const VoxelBandOptions& options,
                    Progress* progress) {
  if (!std::isfinite(options.voxelSize) || options.voxelSize < 0.0) {
    throw InputError("the voxel size is not a positive length; give mesh units, or 0 for the mean edge length");
  }
  if (!(options.halfWidth >= 1.0 && options.halfWidth <= 64.0)) {
    throw InputError("the half width of the band is outside 1..64 voxels; 3 is usual");
  }
  const double size = options.voxelSize > 0.0 ? options.voxelSize : mesh.meanEdgeLength();
  checkSize(mesh, size, options.halfWidth);
  const BandSearch search(mesh, query, size, options.halfWidth);
  const std::vector<Cube> cubes = search.blocks(progress);
  std::vector<Block> blocks(cubes.size());
  inSlices(cubes.size(), kSlice, progress, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) blocks[i] = search.block(cubes[i]);
  });

  VoxelBand band;
  band.voxelSize = size;
  band.halfWidth = options.halfWidth;
  band.closed = mesh.boundaryLoopCount() == 0;
  band.faceCount = mesh.faceCount();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (progress) progress->check();
    const Block& block = blocks[b];
    if (block.places.empty()) continue;
    std::array<std::int32_t, 3> origin{};
    for (int k = 0; k < 3; ++k) origin[k] = static_cast<std::int32_t>(cubes[b].origin[k]);
    band.origins.push_back(origin);
    band.places.insert(band.places.end(), block.places.begin(), block.places.end());
    band.points.insert(band.points.end(), block.points.begin(), block.points.end());
    band.distances.insert(band.distances.end(), block.distances.begin(), block.distances.end());
    band.offsets.push_back(band.places.size());
  }
  return band;
}

std::vector<float> blockDistances(const VoxelBand& band, BlockRange range) {
  return filled(band, range, 1, [&](std::size_t i, float* out) { *out = band.distances[i]; });
}

std::vector<float> blockVectors(const VoxelBand& band, const VectorField& field, BlockRange range) {
  checkMesh(band, field);
  return filled(band, range, 3, [&](std::size_t i, float* out) {
    Eigen::Map<Eigen::Vector3f>{out} = evaluate(field, band.points[i]).template cast<float>();
  });
}

std::vector<float> blockSpeeds(const VoxelBand& band, const VectorField& field, BlockRange range) {
  checkMesh(band, field);
  return filled(band, range, 1,
                [&](std::size_t i, float* out) { *out = static_cast<float>(evaluate(field, band.points[i]).norm()); });
}

}  // namespace stormfield
