#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "io/flow_map.h"
#include "io/vdb_band.h"

namespace stormfield::bindings {
namespace {

using MeshPointer = std::shared_ptr<MeshHandle>;
using ProgressPointer = std::shared_ptr<Progress>;

/// Python's FlowMap: a UV layer and what each pixel of its image shows.
struct FlowMapHandle {
  MeshPointer mesh;
  FaceUvs uvs;
  UvRaster raster;
};

FlowMapHandle makeFlowMap(const MeshPointer& mesh, const py::object& uvs, Index width, Index height, Index margin,
                          const ProgressPointer& progress) {
  const auto array = inputArray<float>(uvs, "uvs", {mesh->mesh().faceCount(), 3, 2});
  FlowMapHandle map{mesh, FaceUvs(array.shape(0)), {}};
  for (py::ssize_t f = 0; f < array.shape(0); ++f) {
    for (int k = 0; k < 3; ++k) map.uvs[f][k] = {array.at(f, k, 0), array.at(f, k, 1)};
  }
  const py::gil_scoped_release release;
  map.raster = rasterizeUv(mesh->mesh(), map.uvs, {width, height, margin}, progress.get());
  return map;
}

FlowMapBasis basisOf(const std::string& word) {
  if (word == "uv") return FlowMapBasis::Uv;
  if (word == "object") return FlowMapBasis::Object;
  throw InputError("basis is '" + word + "'; choose 'uv' or 'object'");
}

FlowMapImage draw(const FlowMapHandle& self, const FieldHandle& field, const std::string& basis) {
  if (field.mesh != self.mesh) throw InputError("the field lives on another mesh object; make both on the same one");
  return flowMap(field.field, self.uvs, self.raster, basisOf(basis));
}

py::array_t<float> image(const FlowMapHandle& self, const FieldHandle& field, const std::string& basis) {
  FlowMapImage result;
  {
    const py::gil_scoped_release release;
    result = draw(self, field, basis);
  }
  py::array_t<float> array({py::ssize_t{result.height}, py::ssize_t{result.width}, py::ssize_t{4}});
  std::copy(result.pixels.begin(), result.pixels.end(), array.mutable_data());
  return array;
}

py::bytes exr(const FlowMapHandle& self, const FieldHandle& field, const std::string& basis, bool half,
              const Metadata& metadata) {
  std::string bytes;
  {
    const py::gil_scoped_release release;
    bytes = exrBytes(draw(self, field, basis), half, metadata);
  }
  return bytes;
}

struct VdbBandHandle {
  MeshPointer mesh;
  VdbBand band;
};

VdbBandHandle makeBand(const MeshPointer& mesh, double voxelSize, double halfWidth, const ProgressPointer& progress) {
  const py::gil_scoped_release release;
  return {mesh, VdbBand(mesh->charts()->meshPointer(), mesh->closestPoints(), {voxelSize, halfWidth}, progress.get())};
}

py::bytes vdb(const VdbBandHandle& self, const std::map<std::string, const FieldHandle*>& fields,
              const std::string& speedOf, const Metadata& metadata) {
  std::map<std::string, const VectorField*> plain;
  for (const auto& [name, field] : fields) {
    if (!field || field->mesh != self.mesh) {
      throw InputError("field " + name + " lives on another mesh object; make both on the same one");
    }
    plain[name] = &field->field;
  }
  std::string bytes;
  {
    const py::gil_scoped_release release;
    bytes = self.band.bytes(plain, speedOf, metadata);
  }
  return bytes;
}

}  // namespace

void bind_io(py::module_& m) {
  py::class_<FlowMapHandle>(m, "FlowMap", py::module_local(),
                            "The image of a UV layer; draws fields into it. Immutable.")
      .def(py::init(&makeFlowMap), py::arg("mesh"), py::arg("uvs"), py::arg("width"), py::arg("height"),
           py::arg("margin") = 8, py::arg("progress") = ProgressPointer(),
           "uvs: (m, 3, 2) float32, one pair per corner; width, height, margin: pixels.\n"
           "Raises InputError on a layer that does not fit or has no area, Cancelled.")
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
          "Faces that reach beyond the unit square, where they show nowhere.")
      .def("image", &image, py::arg("field"), py::arg("basis") = "uv",
           "(height, width, 4) float32, row 0 at v = 1. Basis 'uv': velocity of u and v (UV units per second), speed\n"
           "(mesh units per second), 1; 'object': the vector (mesh units per second), 1. Zero where nothing shows.")
      .def("exr", &exr, py::arg("field"), py::arg("basis") = "uv", py::arg("half") = false,
           py::arg("metadata") = Metadata(),
           "The image as the bytes of an OpenEXR file, 32 bit floats or (half) 16; metadata: {name: text}.");

  py::class_<VdbBandHandle>(m, "VdbBand", py::module_local(), "The voxels around a surface; writes fields on them.")
      .def(py::init(&makeBand), py::arg("mesh"), py::arg("voxel_size") = 0.0, py::arg("half_width") = 3.0,
           py::arg("progress") = ProgressPointer(),
           "voxel_size: mesh units, 0 for the mean edge length; half_width: voxels on each side of the surface.\n"
           "Raises InputError on sizes out of range, Cancelled.")
      .def_property_readonly(
          "voxel_size", [](const VdbBandHandle& h) { return h.band.voxelSize(); }, "Mesh units.")
      .def_property_readonly(
          "voxel_count", [](const VdbBandHandle& h) { return h.band.voxelCount(); }, "Voxels of the band.")
      .def(
          "vdb", &vdb, py::arg("fields"), py::arg("speed_of") = "", py::arg("metadata") = Metadata(),
          "The bytes of an OpenVDB file: a vec3 grid per entry of fields {name: VectorField} (mesh units per second),\n"
          "sf_speed from the field named speed_of, sf_distance; metadata: {name: text}.");
}

}  // namespace stormfield::bindings
