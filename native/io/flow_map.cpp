#include "io/flow_map.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <thread>

#include "base/error.h"
#include "base/message.h"
#include "field/interpolation.h"
#include "io/detail/slices.h"

namespace stormfield {
namespace {

/// Pixels drawn between two looks at the progress.
constexpr std::size_t kSlice = 16384;
/// Rows that OpenEXR compresses together, and pixels that each of its threads gets between two looks at the progress.
constexpr Index kBlock = 16, kBlockPixels = 65536;

/// Largest finite 16 bit float.
constexpr float kHalfMax = 65504.0f;

/// Maps a vector in space to the velocity of the UV coordinates, for one face: the inverse of (dP/du, dP/dv).
class UvVelocity {
 public:
  UvVelocity(const TriangleMesh& mesh, Index f, const std::array<Eigen::Vector2d, 3>& uv) {
    Eigen::Matrix<double, 3, 2> edges;
    Eigen::Matrix2d uvEdges;
    for (int k = 0; k < 2; ++k) {
      edges.col(k) = mesh.point(mesh.vertex(f, k + 1)) - mesh.point(mesh.vertex(f, 0));
      uvEdges.col(k) = uv[k + 1] - uv[0];
    }
    // vector = edges * w for w in the face's own coordinates (least squares: the normal part drops out).
    map_ = uvEdges * (edges.transpose() * edges).inverse() * edges.transpose();
  }
  Eigen::Vector2d operator()(const Vec3& vector) const { return map_ * vector; }

 private:
  Eigen::Matrix<double, 2, 3> map_;
};

void checkHalf(const FlowMapImage& image) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (std::abs(image.pixels[i]) > kHalfMax) {
      const std::size_t p = i / 4;
      throw InputError(message("pixel (", p % image.width, ", ", p / image.width, ") holds ", image.pixels[i],
                               ", more than 16 bit floats can; write 32 bit floats"));
    }
  }
}

Index rowsAtOnce(Index width) {
  const auto threads = static_cast<Index>(std::max(1u, std::thread::hardware_concurrency()));
  return kBlock * threads * std::max(Index{1}, kBlockPixels / (kBlock * width));
}

}  // namespace

FlowMapImage flowMap(const VectorField& field, const FaceUvs& uvs, const UvRaster& raster, FlowMapBasis basis,
                     Progress* progress) {
  const TriangleMesh& mesh = field.mesh();
  if (static_cast<Index>(uvs.size()) != mesh.faceCount()) {
    throw InputError("the UV layer and the field belong to different meshes; read both from the same mesh");
  }
  FlowMapImage image{raster.width, raster.height, {}};
  resizeInSlices(image.pixels, raster.points.size() * 4, 0.0f, progress);
  const auto draw = [&](std::size_t i) {
    const SurfacePoint& p = raster.points[i];
    if (p.face == kNone) return;
    const Vec3 vector = evaluate(field, p);
    float* rgba = image.pixels.data() + 4 * i;
    if (basis == FlowMapBasis::Uv) {
      Eigen::Map<Eigen::Vector2f>{rgba} = UvVelocity(mesh, p.face, uvs[p.face])(vector).cast<float>();
      rgba[2] = static_cast<float>(vector.norm());
    } else {
      Eigen::Map<Eigen::Vector3f>{rgba} = vector.cast<float>();
    }
    rgba[3] = 1.0f;
  };
  inSlices(raster.points.size(), kSlice, progress, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) draw(i);
  });
  return image;
}

std::string exrBytes(const FlowMapImage& image, bool half, const Metadata& metadata, Progress* progress) {
  namespace oiio = OIIO;
  if (half) checkHalf(image);
  oiio::ImageSpec spec(image.width, image.height, 4, half ? oiio::TypeHalf : oiio::TypeFloat);
  spec.attribute("compression", "zip");
  spec.attribute("oiio:ColorSpace", "raw");
  // Without a date OpenImageIO writes the present one, and no two bakes would be equal.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  for (const auto& [name, text] : metadata) spec.attribute(name, text);

  std::vector<unsigned char> bytes;
  oiio::Filesystem::IOVecOutput memory(bytes);
  const auto output = oiio::ImageOutput::create("flow.exr", &memory);
  bool done = output && output->open("flow.exr", spec);
  const Index rows = rowsAtOnce(image.width);
  for (Index y = 0; done && y < image.height; y += rows) {
    if (progress) progress->check();
    const Index end = std::min(y + rows, image.height);
    const float* from = image.pixels.data() + std::size_t{4} * y * image.width;
    done = output->write_scanlines(y, end, 0, oiio::TypeFloat, from);
    if (progress) progress->report(static_cast<double>(end) / image.height);
  }
  done = done && output->close();
  if (!done)
    throw std::runtime_error("OpenImageIO cannot write EXR: " + (output ? output->geterror() : oiio::geterror()));
  return {bytes.begin(), bytes.end()};
}

}  // namespace stormfield
