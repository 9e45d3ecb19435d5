// The voxels around a surface, each with the closest surface point: what a volume file of a field is made of.
//
// Voxel (i, j, k) has its centre at (i, j, k) * voxelSize, in the mesh's own space (object space, mesh units). The band
// holds every voxel whose centre is closer to the surface than halfWidth voxels. The field of a voxel is that of its
// closest surface point, so that it is constant along the normal.
//
// The distance is signed where the surface is closed: negative in what the surface encloses, which is all that cannot
// be reached from far away, whatever way its normals point. The sign comes from angle-weighted normals (Baerentzen and
// Aanaes 2005) and holds for surfaces that do not cross themselves; elsewhere it is that of the nearest component.
//
// Voxels come in blocks of 8 x 8 x 8, as OpenVDB stores them; the file itself is written elsewhere.
//
//   const VoxelBand band = voxelBand(mesh, query, {.voxelSize = 0.02});             // once per mesh
//   const std::vector<float> vectors = blockVectors(band, field, {0, band.blockCount()});    // once per sample
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "mesh/closest_point.h"

namespace stormfield {

struct VoxelBandOptions {
  double voxelSize = 0.0;  ///< mesh units; 0 takes the mean edge length
  double halfWidth = 3.0;  ///< voxels on each side of the surface, 1..64
};

struct VoxelBand {
  static constexpr int kSide = 8;                        ///< voxels along a side of a block
  static constexpr int kVoxels = kSide * kSide * kSide;  ///< of a block
  double voxelSize = 0.0;                                ///< mesh units
  double halfWidth = 0.0;                                ///< voxels
  bool closed = false;                                   ///< the mesh has no boundary: distances are signed
  Index faceCount = 0;                                   ///< of the mesh
  std::vector<std::array<std::int32_t, 3>> origins;      ///< per block its lowest voxel, multiples of kSide
  std::vector<std::size_t> offsets{0};                   ///< block b has the voxels offsets[b] .. offsets[b + 1]
  std::vector<std::int16_t> places;                      ///< of a voxel in its block: (x * 8 + y) * 8 + z, ascending
  std::vector<SurfacePoint> points;                      ///< the closest surface point of a voxel
  std::vector<float> distances;                          ///< of a voxel, mesh units, signed where closed

  std::size_t blockCount() const { return origins.size(); }
  std::size_t voxelCount() const { return places.size(); }
};

/// Throws InputError for options out of range and for a voxel size so small that the band has more than 2^28 voxels;
/// Cancelled. The same bits for any number of threads.
VoxelBand voxelBand(const TriangleMesh& mesh, const ClosestPointQuery& query, const VoxelBandOptions& options,
                    Progress* progress = nullptr);

/// Blocks first .. last of a band.
struct BlockRange {
  std::size_t first, last;
};

/// What voxels of a block hold that are not in the band. No field has it, so that who writes the file can tell.
inline constexpr float kOutsideBand = -3.402823466e38f;

/// The distances of some blocks, 512 values a block in the order of places.
std::vector<float> blockDistances(const VoxelBand& band, BlockRange range);
/// The vectors of a field at the closest surface points, three values a voxel, mesh units per second; and their
/// lengths. Throws InputError for a field of another mesh.
std::vector<float> blockVectors(const VoxelBand& band, const VectorField& field, BlockRange range);
std::vector<float> blockSpeeds(const VoxelBand& band, const VectorField& field, BlockRange range);

}  // namespace stormfield
