#include "io/flow_map.h"

#include "base/error.h"
#include "field/interpolation.h"
#include "io/detail/slices.h"

namespace stormfield {
namespace {

/// Pixels between two checks of the progress.
constexpr std::size_t kSlice = 16384;
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
    // vector = edges * w for w in the face's own coordinates (least squares: the normal component drops out).
    map_ = uvEdges * (edges.transpose() * edges).inverse() * edges.transpose();
  }
  Eigen::Vector2d operator()(const Vec3& vector) const { return map_ * vector; }

 private:
  Eigen::Matrix<double, 2, 3> map_;
};

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

}  // namespace stormfield
