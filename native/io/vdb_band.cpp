#include "io/vdb_band.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <sstream>

#include "base/error.h"
#include "base/message.h"
#include "field/interpolation.h"
#include "io/detail/slices.h"

namespace stormfield {
namespace {

using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

constexpr double kMaxVoxels = 268435456.0;
/// Voxels, leaves of 512 voxels, and bytes between two looks at the progress.
constexpr std::size_t kVoxels = 1024, kLeaves = 16, kBytes = std::size_t{1} << 22;
/// Where OpenVDB has built the band and the search for surface points begins, and where writing begins, of the whole.
constexpr double kBuilt = 0.5, kFilled = 0.5;

void check(const Progress* progress) {
  if (progress) progress->check();
}

/// OpenVDB asks the interrupter while it builds the band.
struct Interrupter {
  Progress* progress;
  void start(const char* = nullptr) {}
  void end() {}
  bool wasInterrupted(int percent = -1) {
    if (progress && percent >= 0) progress->report(percent / 100.0);
    return progress && progress->cancelled();
  }
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

/// Memory that looks at the progress whenever OpenVDB writes a leaf.
class CancellableBuffer : public std::stringbuf {
 public:
  explicit CancellableBuffer(const Progress* progress) : std::stringbuf(std::ios_base::out), progress_(progress) {}

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    check(progress_);
    return std::stringbuf::xsputn(bytes, count);
  }

 private:
  const Progress* progress_;
};

/// Writes a file, with the table of its grids, into memory.
class MemoryArchive : public openvdb::io::Archive {
 public:
  std::string bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata,
                    const Progress* progress) const {
    CancellableBuffer buffer(progress);
    std::ostream out(&buffer);
    // Or else the stream would keep Cancelled to itself.
    out.exceptions(std::ios_base::badbit);
    Archive::write(out, grids, /*seekable=*/true, metadata);
    if (!out) throw std::runtime_error("OpenVDB could not write the file into memory");
    return std::move(buffer).str();
  }
};

std::uint64_t fnv1a(const std::string& bytes, std::uint64_t hash, const Progress* progress) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (i % kBytes == 0) check(progress);
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 1099511628211ull;
  }
  return hash;
}

/// OpenVDB puts a random identifier into the header; a hash of the content makes equal content equal files.
void makeDeterministic(std::string& file, const Progress* progress) {
  // Magic number (8 bytes), file version (4), library version (8), flag of the grid table (1); then 36 letters.
  constexpr std::size_t kAt = 21, kLength = 36;
  file.replace(kAt, kLength, kLength, '0');
  const std::uint64_t a = fnv1a(file, 14695981039346656037ull, progress), b = fnv1a(file, a, progress);
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
  typename Grid::Ptr grid(const std::string& name, Progress* progress, const Value& value) const {
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
    inSlices(leaves.size(), kLeaves, progress, [&](std::size_t first, std::size_t last) {
      std::size_t i = offsets[first];
      for (std::size_t l = first; l < last; ++l) {
        for (auto voxel = leaves[l]->beginValueOn(); voxel; ++voxel) voxel.setValue(value(i++));
      }
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
  if (progress) progress->range(0.0, kBuilt);
  layout->distance = openvdb::tools::meshToVolume<FloatGrid>(interrupter, IndexSpaceMesh{m, size}, *layout->transform(),
                                                             width, width, flags);
  check(progress);
  layout->distance->setName("sf_distance");

  std::vector<FloatGrid::TreeType::LeafNodeType*> leaves;
  layout->distance->tree().getNodes(leaves);
  for (const auto* leaf : leaves) {
    check(progress);
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) layout->coords.push_back(voxel.getCoord());
  }
  layout->points.resize(layout->coords.size());
  if (progress) progress->range(kBuilt, 1.0);
  inSlices(layout->coords.size(), kVoxels, progress, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const openvdb::Coord& c = layout->coords[i];
      const Vec3 p = Vec3(c.x(), c.y(), c.z()) * size;
      // Neighbours in the tree are neighbours in space.
      layout->points[i] = (i == first ? query.closest(p) : query.closest(p, layout->points[i - 1])).point;
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
                           const std::map<std::string, std::string>& metadata, Progress* progress) const {
  const Layout& layout = *layout_;
  openvdb::GridCPtrVec grids;
  const double part = kFilled / static_cast<double>(fields.size() + 1);
  const auto next = [&] {
    const auto done = static_cast<double>(grids.size());
    if (progress) progress->range(done * part, (done + 1.0) * part);
    return progress;
  };
  for (const auto& [name, field] : fields) {
    if (field->mesh().faceCount() != layout.mesh->faceCount()) {
      throw InputError(message("field ", name, " and the band belong to different meshes"));
    }
    const VectorField& f = *field;
    const auto vectors = layout.grid<Vec3SGrid>(name, next(), [&](std::size_t i) {
      const Vec3 v = evaluate(f, layout.points[i]);
      return openvdb::Vec3s(openvdb::Vec3d(v.x(), v.y(), v.z()));
    });
    vectors->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
    grids.push_back(vectors);
    if (name == speedOf) {
      grids.push_back(layout.grid<FloatGrid>(
          "sf_speed", next(), [&](std::size_t i) { return static_cast<float>(evaluate(f, layout.points[i]).norm()); }));
    }
  }
  grids.push_back(layout.distance);
  openvdb::MetaMap header;
  for (const auto& [name, text] : metadata) header.insertMeta(name, openvdb::StringMetadata(text));
  std::string file = MemoryArchive().bytes(grids, header, progress);
  makeDeterministic(file, progress);
  return file;
}

}  // namespace stormfield
