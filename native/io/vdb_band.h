// Vector fields as volumes: grids on the voxels around the surface, for smoke, particles and other programs.
//
// A band holds every voxel whose centre is closer to the surface than halfWidth voxels; its value is the field at the
// closest surface point, so that it is constant along the normal. Space is the mesh's own (object space), lengths are
// mesh units. The grids of a file: one vec3 grid per field (mesh units per second), sf_speed when given, and
// sf_distance: signed for closed surfaces (negative inside), else unsigned.
//
//   const VdbBand band(mesh, query, {0.02});                               // once per mesh
//   const std::string bytes = band.bytes({{"sf_advection", field}}, {});   // once per sample
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "field/vector_field.h"
#include "mesh/closest_point.h"

namespace stormfield {

struct VdbBandOptions {
  double voxelSize = 0.0;  ///< mesh units; 0 takes the mean edge length
  double halfWidth = 3.0;  ///< voxels on each side of the surface, 1..64
};

class VdbBand {
 public:
  /// Throws InputError on options out of range or a voxel size so small that the band has more than 2^28 voxels;
  /// Cancelled.
  VdbBand(std::shared_ptr<const TriangleMesh> mesh, const ClosestPointQuery& query, const VdbBandOptions& options,
          Progress* progress = nullptr);
  ~VdbBand();
  VdbBand(VdbBand&&) noexcept;

  double voxelSize() const;
  std::size_t voxelCount() const;

  /// An OpenVDB file in memory. `fields` names vec3 grids; the speed of field `speedOf`, where that is not empty,
  /// becomes the grid sf_speed. Metadata goes to the file's header. Equal input gives equal bytes. Throws
  /// InputError when a field belongs to another mesh, Cancelled.
  std::string bytes(const std::map<std::string, const VectorField*>& fields, const std::string& speedOf,
                    const std::map<std::string, std::string>& metadata, Progress* progress = nullptr) const;

 private:
  struct Layout;
  std::unique_ptr<const Layout> layout_;
};

}  // namespace stormfield
