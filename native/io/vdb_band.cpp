#include "io/vdb_band.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <sstream>

#include "base/error.h"
#include "base/message.h"
#include "field/interpolation.h"

namespace stormfield {
namespace {

using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

constexpr double kMaxVoxels = 268435456.0;

/// OpenVDB asks the interrupter while it builds the band.
struct Interrupter {
  Progress* progress;
  void start(const char* = nullptr) {}
  void end() {}
  bool wasInterrupted(int = -1) { return progress && progress->cancelled(); }
};

/// The mesh in the index space of the grids.
struct IndexSpaceMesh {
  const TriangleMesh& mesh;
  double voxelSize;

  std::size_t polygonCount() const { return mesh.faceCount(); }
  std::size_t pointCount() const { return mesh.vertexCount(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t f, std::size_t corner, openvdb::Vec3d& p) const {
    const Vec3 x = mesh.point(mesh.vertex(static_cast<Index>(f), static_cast<int>(corner))) / voxelSize;
    p = {x.x(), x.y(), x.z()};
  }
};

/// Writes a file, with the table of its grids, into memory.
class MemoryArchive : public openvdb::io::Archive {
 public:
  std::string bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) const {
    std::ostringstream out(std::ios_base::binary);
    Archive::write(out, grids, /*seekable=*/true, metadata);
    if (!out) throw std::runtime_error("OpenVDB could not write the file into memory");
    return out.str();
  }
};

std::uint64_t fnv1a(const std::string& bytes, std::uint64_t hash) {
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ull;
  return hash;
}

/// OpenVDB puts a random identifier into the header; a hash of the content makes equal content equal files.
void makeDeterministic(std::string& file) {
  // Magic number (8 bytes), file version (4), library version (8), flag of the grid table (1); then 36 letters.
  constexpr std::size_t kAt = 21, kLength = 36;
  file.replace(kAt, kLength, kLength, '0');
  const std::uint64_t a = fnv1a(file, 14695981039346656037ull), b = fnv1a(file, a);
  char id[kLength + 1];
  std::snprintf(id, sizeof id, "%08x-%04x-4%03x-8%03x-%012llx", static_cast<unsigned>(a >> 32),
                static_cast<unsigned>(a >> 16 & 0xffff), static_cast<unsigned>(a & 0xfff),
                static_cast<unsigned>(b >> 48 & 0xfff), static_cast<unsigned long long>(b & 0xffffffffffffull));
  file.replace(kAt, kLength, id);
}

}  // namespace

/// The voxels of the band and the surface point each shows.
struct VdbBand::Layout {
  std::shared_ptr<const TriangleMesh> mesh;
  double voxelSize = 0.0, halfWidth = 0.0;
  FloatGrid::Ptr distance;
  std::vector<openvdb::Coord> coords;  ///< active voxels in the order of the tree
  std::vector<SurfacePoint> points;

  openvdb::math::Transform::Ptr transform() const { return openvdb::math::Transform::createLinearTransform(voxelSize); }

  /// A grid with the band's topology; value(i) fills voxel i.
  template <typename Grid, typename Value>
  typename Grid::Ptr grid(const std::string& name, const Value& value) const {
    const typename Grid::ValueType zero(0);
    auto tree = std::make_shared<typename Grid::TreeType>(distance->tree(), zero, openvdb::TopologyCopy());
    const auto result = Grid::create(tree);
    result->setName(name);
    result->setTransform(transform());
    // Leaves hold the voxels in the order in which coords was filled.
    std::vector<std::size_t> offsets;
    std::vector<typename Grid::TreeType::LeafNodeType*> leaves;
    tree->getNodes(leaves);
    std::size_t count = 0;
    for (const auto* leaf : leaves) {
      offsets.push_back(count);
      count += leaf->onVoxelCount();
    }
    tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t l) {
      std::size_t i = offsets[l];
      for (auto voxel = leaves[l]->beginValueOn(); voxel; ++voxel) voxel.setValue(value(i++));
    });
    return result;
  }
};

VdbBand::VdbBand(std::shared_ptr<const TriangleMesh> mesh, const ClosestPointQuery& query,
                 const VdbBandOptions& options, Progress* progress) {
  if (!std::isfinite(options.voxelSize) || options.voxelSize < 0.0) {
    throw InputError("the voxel size is not a positive length; give mesh units, or 0 for the mean edge length");
  }
  if (!(options.halfWidth >= 1.0 && options.halfWidth <= 64.0)) {
    throw InputError("the half width of the band is outside 1..64 voxels; 3 is usual");
  }
  openvdb::initialize();
  auto layout = std::make_unique<Layout>();
  layout->mesh = std::move(mesh);
  const TriangleMesh& m = *layout->mesh;
  const double size = options.voxelSize > 0.0 ? options.voxelSize : m.meanEdgeLength();
  layout->voxelSize = size;
  layout->halfWidth = options.halfWidth;
  const double estimate = m.totalArea() / (size * size) * 2.0 * options.halfWidth;
  const double reach = m.points().cwiseAbs().maxCoeff() / size;
  if (estimate > kMaxVoxels || reach > 1e9) {
    throw InputError(message("a voxel size of ", size, " gives about ", std::ceil(estimate / 1e6),
                             " million voxels; choose one above ", std::sqrt(estimate / kMaxVoxels) * size));
  }
  const auto width = static_cast<float>(options.halfWidth);
  const int flags = m.boundaryLoopCount() > 0 ? openvdb::tools::UNSIGNED_DISTANCE_FIELD : 0;
  Interrupter interrupter{progress};
  layout->distance = openvdb::tools::meshToVolume<FloatGrid>(interrupter, IndexSpaceMesh{m, size}, *layout->transform(),
                                                             width, width, flags);
  if (progress) progress->check();
  layout->distance->setName("sf_distance");

  std::vector<FloatGrid::TreeType::LeafNodeType*> leaves;
  layout->distance->tree().getNodes(leaves);
  for (const auto* leaf : leaves) {
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) layout->coords.push_back(voxel.getCoord());
  }
  layout->points.resize(layout->coords.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, layout->coords.size(), 4096), [&](const auto& part) {
    if (progress) progress->check();
    for (std::size_t i = part.begin(); i != part.end(); ++i) {
      const openvdb::Coord& c = layout->coords[i];
      layout->points[i] = query.closest(Vec3(Vec3(c.x(), c.y(), c.z()) * size)).point;
    }
  });
  layout_ = std::move(layout);
}

VdbBand::~VdbBand() = default;
VdbBand::VdbBand(VdbBand&&) noexcept = default;

double VdbBand::voxelSize() const {
  return layout_->voxelSize;
}
std::size_t VdbBand::voxelCount() const {
  return layout_->coords.size();
}

std::string VdbBand::bytes(const std::map<std::string, const VectorField*>& fields, const std::string& speedOf,
                           const std::map<std::string, std::string>& metadata) const {
  const Layout& layout = *layout_;
  openvdb::GridCPtrVec grids;
  for (const auto& [name, field] : fields) {
    if (field->mesh().faceCount() != layout.mesh->faceCount()) {
      throw InputError(message("field ", name, " and the band belong to different meshes"));
    }
    const VectorField& f = *field;
    const auto vectors = layout.grid<Vec3SGrid>(name, [&](std::size_t i) {
      const Vec3 v = evaluate(f, layout.points[i]);
      return openvdb::Vec3s(openvdb::Vec3d(v.x(), v.y(), v.z()));
    });
    vectors->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
    grids.push_back(vectors);
    if (name == speedOf) {
      grids.push_back(layout.grid<FloatGrid>(
          "sf_speed", [&](std::size_t i) { return static_cast<float>(evaluate(f, layout.points[i]).norm()); }));
    }
  }
  grids.push_back(layout.distance);
  openvdb::MetaMap header;
  for (const auto& [name, text] : metadata) header.insertMeta(name, openvdb::StringMetadata(text));
  std::string file = MemoryArchive().bytes(grids, header);
  makeDeterministic(file);
  return file;
}

}  // namespace stormfield
