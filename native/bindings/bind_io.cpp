#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "io/flow_map.h"
#include "io/voxel_band.h"

namespace stormfield::bindings {
namespace {

using MeshPointer = std::shared_ptr<MeshHandle>;
using ImagePointer = std::shared_ptr<const FlowMapImage>;

/// Python's FlowMap: a UV layer and what each pixel of its image shows.
struct FlowMapHandle {
  MeshPointer mesh;
  FaceUvs uvs;
  UvRaster raster;
};

using FlowMapPointer = std::shared_ptr<FlowMapHandle>;

FaceUvs inputUvs(const TriangleMesh& mesh, const ArrayArgument<float>& uvs) {
  const auto array = inputArray<float>(uvs, "uvs", {mesh.faceCount(), 3, 2});
  FaceUvs result(array.shape(0));
  for (py::ssize_t f = 0; f < array.shape(0); ++f) {
    for (int k = 0; k < 3; ++k) result[f][k] = {array.at(f, k, 0), array.at(f, k, 1)};
  }
  return result;
}

FlowMapPointer drawnFlowMap(const MeshPointer& mesh, FaceUvs uvs, const UvRasterOptions& options, Progress* progress) {
  UvRaster raster = rasterizeUv(mesh->mesh(), uvs, options, progress);
  return std::make_shared<FlowMapHandle>(FlowMapHandle{mesh, std::move(uvs), std::move(raster)});
}

Work<FlowMapPointer> prepareFlowMap(const MeshPointer& mesh, const ArrayArgument<float>& uvs, Index width, Index height,
                                    Index margin) {
  const UvRasterOptions options{width, height, margin};
  return [mesh, corners = inputUvs(mesh->mesh(), uvs), options](Progress& progress) {
    return drawnFlowMap(mesh, corners, options, &progress);
  };
}

void checkMesh(const FlowMapHandle& self, const FieldHandle& field) {
  if (field.mesh != self.mesh) throw InputError("the field lives on another mesh object; make both on the same one");
}

/// (height, width, 4), a view that keeps the image alive.
py::array_t<float> pixels(const ImagePointer& image) {
  const py::capsule owner(new ImagePointer(image), [](void* p) { delete static_cast<ImagePointer*>(p); });
  return py::array_t<float>({py::ssize_t{image->height}, py::ssize_t{image->width}, py::ssize_t{4}},
                            image->pixels.data(), owner);
}

Work<ImagePointer> prepareImage(const FlowMapPointer& self, const FieldHandle& field, FlowMapBasis basis) {
  checkMesh(*self, field);
  return [self, field = field.field, basis](Progress& p) {
    return std::make_shared<const FlowMapImage>(flowMap(field, self->uvs, self->raster, basis, &p));
  };
}

/// Python's VoxelBand.
struct VoxelBandHandle {
  MeshPointer mesh;
  VoxelBand band;
};
using VoxelBandPointer = std::shared_ptr<VoxelBandHandle>;

Work<VoxelBandPointer> prepareBand(const MeshPointer& mesh, double voxelSize, double halfWidth) {
  const VoxelBandOptions options{voxelSize, halfWidth};
  return [mesh, options](Progress& p) {
    VoxelBand band = voxelBand(mesh->mesh(), mesh->closestPoints(), options, &p);
    return std::make_shared<VoxelBandHandle>(VoxelBandHandle{mesh, std::move(band)});
  };
}

BlockRange checkedRange(const VoxelBandHandle& self, py::ssize_t first, py::ssize_t last) {
  const auto count = static_cast<py::ssize_t>(self.band.blockCount());
  if (first < 0 || last < first || last > count) {
    throw InputError("blocks " + std::to_string(first) + ".." + std::to_string(last) + " are not within 0.." +
                     std::to_string(count));
  }
  return {static_cast<std::size_t>(first), static_cast<std::size_t>(last)};
}

/// (blocks, 8, 8, 8), or with a last axis of `width` > 1.
py::array_t<float> blockArray(std::vector<float> values, BlockRange range, py::ssize_t width) {
  constexpr py::ssize_t kSide = VoxelBand::kSide;
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(range.last - range.first), kSide, kSide, kSide};
  if (width > 1) shape.push_back(width);
  auto* kept = new std::vector<float>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<float>*>(p); });
  return py::array_t<float>(shape, kept->data(), owner);
}

py::array_t<std::int32_t> origins(const VoxelBandHandle& self) {
  const auto& from = self.band.origins;
  py::array_t<std::int32_t> array({static_cast<py::ssize_t>(from.size()), py::ssize_t{3}});
  std::int32_t* to = array.mutable_data();
  for (const auto& origin : from) to = std::copy(origin.begin(), origin.end(), to);
  return array;
}

py::array_t<float> distances(const VoxelBandHandle& self, py::ssize_t first, py::ssize_t last) {
  const BlockRange range = checkedRange(self, first, last);
  return blockArray(blockDistances(self.band, range), range, 1);
}

/// Some blocks of what `values` gives of a field, `width` numbers a voxel.
template <py::ssize_t width, std::vector<float> (&values)(const VoxelBand&, const VectorField&, BlockRange)>
py::array_t<float> fieldBlocks(const VoxelBandHandle& self, const FieldHandle& field, py::ssize_t first,
                               py::ssize_t last) {
  const BlockRange range = checkedRange(self, first, last);
  if (field.mesh != self.mesh) throw InputError("the field lives on another mesh object; make both on the same one");
  std::vector<float> found;
  {
    const py::gil_scoped_release release;
    found = values(self.band, field.field, range);
  }
  return blockArray(std::move(found), range, width);
}

}  // namespace

void bind_io(py::module_& m) {
  py::class_<FlowMapHandle, FlowMapPointer> flowMaps(m, "FlowMap", py::module_local(),
                                                     "The image of a UV layer; draws fields into it. Immutable.");
  flowMaps
      .def_property_readonly(
          "covered_pixels", [](const FlowMapHandle& h) { return h.raster.coveredPixels; },
          "Pixels whose centre lies inside a face.")
      .def_property_readonly(
          "overlapping_pixels", [](const FlowMapHandle& h) { return h.raster.overlappingPixels; },
          "Pixels inside two faces or more; the face of smallest index shows.")
      .def_property_readonly(
          "zero_area_faces", [](const FlowMapHandle& h) { return h.raster.zeroAreaFaces; },
          "Faces without UV area; they show nowhere.")
      .def_property_readonly(
          "outside_faces", [](const FlowMapHandle& h) { return h.raster.outsideFaces; },
          "Faces that reach beyond the unit square, where they show nowhere.");
  bindJob<ImagePointer>(m, "ImageJob", "A flow map that is being drawn.",
                        [](const ImagePointer& image) { return pixels(image); })
      .def(flowMaps, "image", &prepareImage,
           "A VectorField as an image, (height, width, 4) float32, row 0 at v = 1.\n\n"
           "basis: 'uv' for the velocity of u and v (UV units per second), speed (mesh units per second), 1; 'object'\n"
           "for the vector (mesh units per second), 1. Zero where nothing shows. Raises InputError for a field of\n"
           "another mesh object, Cancelled.",
           py::arg("field"), py::arg("basis") = FlowMapBasis::Uv);
  bindJob<FlowMapPointer>(m, "FlowMapJob", "A FlowMap that is being made.",
                          [](const FlowMapPointer& map) { return map; })
      .defInit(flowMaps, m, "flow_map", &prepareFlowMap,
               "uvs: (m, 3, 2) float32, one pair per corner; width, height, margin: pixels.\n"
               "Raises InputError on a layer that does not fit or has no area, Cancelled.",
               py::arg("mesh"), py::arg("uvs"), py::arg("width"), py::arg("height"),
               py::arg("margin") = UvRasterOptions().margin);

  py::class_<VoxelBandHandle, VoxelBandPointer> bands(
      m, "VoxelBand", py::module_local(),
      "The voxels around a surface, in blocks of 8 x 8 x 8; gives a field on them. Immutable.");
  bands
      .def_property_readonly(
          "voxel_size", [](const VoxelBandHandle& h) { return h.band.voxelSize; }, "Mesh units.")
      .def_property_readonly(
          "half_width", [](const VoxelBandHandle& h) { return h.band.halfWidth; }, "Voxels.")
      .def_property_readonly(
          "voxel_count", [](const VoxelBandHandle& h) { return h.band.voxelCount(); }, "Voxels of the band.")
      .def_property_readonly(
          "closed", [](const VoxelBandHandle& h) { return h.band.closed; },
          "Whether the surface has no boundary, so that distances are signed.")
      .def_property_readonly("origins", &origins,
                             "(b, 3) int32: the lowest voxel of each block, a multiple of 8. Voxel (i, j, k) has its\n"
                             "centre at (i, j, k) * voxel_size.")
      .def("distances", &distances, py::arg("first"), py::arg("last"),
           "(last - first, 8, 8, 8) float32, mesh units: the distance from the surface of the voxels of some blocks,\n"
           "negative in what a closed surface encloses; OUTSIDE_BAND where a voxel is not of the band.\n"
           "Raises InputError for blocks that do not exist.")
      .def("vectors", &fieldBlocks<3, blockVectors>, py::arg("field"), py::arg("first"), py::arg("last"),
           "(last - first, 8, 8, 8, 3) float32, mesh units per second: the field at the closest surface points;\n"
           "OUTSIDE_BAND where a voxel is not of the band. Raises InputError for a field of another mesh.")
      .def("speeds", &fieldBlocks<1, blockSpeeds>, py::arg("field"), py::arg("first"), py::arg("last"),
           "(last - first, 8, 8, 8) float32, mesh units per second: the lengths of these vectors.");
  m.attr("OUTSIDE_BAND") = kOutsideBand;
  const VoxelBandOptions options;
  bindJob<VoxelBandPointer>(m, "VoxelBandJob", "A VoxelBand that is being made.",
                            [](const VoxelBandPointer& band) { return band; })
      .defInit(bands, m, "voxel_band", &prepareBand,
               "voxel_size: mesh units, 0 for the mean edge length; half_width: voxels on each side of the surface.\n"
               "Raises InputError on sizes out of range, Cancelled.",
               py::arg("mesh"), py::arg("voxel_size") = options.voxelSize, py::arg("half_width") = options.halfWidth);
}

}  // namespace stormfield::bindings
