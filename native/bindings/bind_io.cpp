#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "io/flow_map.h"
#include "io/vdb_band.h"

namespace stormfield::bindings {
namespace {

using MeshPointer = std::shared_ptr<MeshHandle>;
using ProgressPointer = std::shared_ptr<Progress>;

/// Where an image is drawn and compression begins, in parts of the whole.
constexpr double kDrawn = 0.3;

/// Contents of a file.
using BytesJob = Job<std::string>;

/// Python's FlowMap: a UV layer and what each pixel of its image shows.
struct FlowMapHandle {
  MeshPointer mesh;
  FaceUvs uvs;
  UvRaster raster;
};

using FlowMapPointer = std::shared_ptr<FlowMapHandle>;
using FlowMapJob = Job<FlowMapPointer>;

FaceUvs inputUvs(const TriangleMesh& mesh, const py::object& uvs) {
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

FlowMapPointer makeFlowMap(const MeshPointer& mesh, const py::object& uvs, Index width, Index height, Index margin,
                           const ProgressPointer& progress) {
  FaceUvs corners = inputUvs(mesh->mesh(), uvs);
  const py::gil_scoped_release release;
  return drawnFlowMap(mesh, std::move(corners), {width, height, margin}, progress.get());
}

std::shared_ptr<FlowMapJob> startFlowMap(const MeshPointer& mesh, const py::object& uvs, Index width, Index height,
                                         Index margin) {
  const UvRasterOptions options{width, height, margin};
  return std::make_shared<FlowMapJob>([mesh, corners = inputUvs(mesh->mesh(), uvs), options](Progress& progress) {
    return drawnFlowMap(mesh, corners, options, &progress);
  });
}

py::bytes waited(const std::shared_ptr<BytesJob>& job) {
  {
    const py::gil_scoped_release release;
    job->wait();
  }
  return job->result();
}

FlowMapBasis basisOf(const std::string& word) {
  if (word == "uv") return FlowMapBasis::Uv;
  if (word == "object") return FlowMapBasis::Object;
  throw InputError("basis is '" + word + "'; choose 'uv' or 'object'");
}

void checkMesh(const FlowMapHandle& self, const FieldHandle& field) {
  if (field.mesh != self.mesh) throw InputError("the field lives on another mesh object; make both on the same one");
}

py::array_t<float> image(const FlowMapHandle& self, const FieldHandle& field, const std::string& basis) {
  checkMesh(self, field);
  FlowMapImage result;
  {
    const py::gil_scoped_release release;
    result = flowMap(field.field, self.uvs, self.raster, basisOf(basis));
  }
  py::array_t<float> array({py::ssize_t{result.height}, py::ssize_t{result.width}, py::ssize_t{4}});
  std::copy(result.pixels.begin(), result.pixels.end(), array.mutable_data());
  return array;
}

std::shared_ptr<BytesJob> startExr(const FlowMapPointer& self, const FieldHandle& field, const std::string& basis,
                                   bool half, const Metadata& metadata) {
  checkMesh(*self, field);
  return std::make_shared<BytesJob>([self, field = field.field, basis = basisOf(basis), half, metadata](Progress& p) {
    p.range(0.0, kDrawn);
    const FlowMapImage image = flowMap(field, self->uvs, self->raster, basis, &p);
    p.range(kDrawn, 1.0);
    return exrBytes(image, half, metadata, &p);
  });
}

struct VdbBandHandle {
  MeshPointer mesh;
  VdbBand band;
};
using VdbBandPointer = std::shared_ptr<VdbBandHandle>;
using VdbBandJob = Job<VdbBandPointer>;

VdbBandPointer builtBand(const MeshPointer& mesh, const VdbBandOptions& options, Progress* progress) {
  VdbBand band(mesh->charts()->meshPointer(), mesh->closestPoints(), options, progress);
  return std::make_shared<VdbBandHandle>(VdbBandHandle{mesh, std::move(band)});
}

VdbBandPointer makeBand(const MeshPointer& mesh, double voxelSize, double halfWidth, const ProgressPointer& progress) {
  const py::gil_scoped_release release;
  return builtBand(mesh, {voxelSize, halfWidth}, progress.get());
}

std::shared_ptr<VdbBandJob> startBand(const MeshPointer& mesh, double voxelSize, double halfWidth) {
  const VdbBandOptions options{voxelSize, halfWidth};
  return std::make_shared<VdbBandJob>([mesh, options](Progress& p) { return builtBand(mesh, options, &p); });
}

std::shared_ptr<BytesJob> startVdb(const VdbBandPointer& self, const std::map<std::string, const FieldHandle*>& fields,
                                   const std::string& speedOf, const Metadata& metadata) {
  std::map<std::string, VectorField> copies;
  for (const auto& [name, field] : fields) {
    if (!field || field->mesh != self->mesh) {
      throw InputError("field " + name + " lives on another mesh object; make both on the same one");
    }
    copies.emplace(name, field->field);
  }
  return std::make_shared<BytesJob>([self, copies = std::move(copies), speedOf, metadata](Progress& p) {
    std::map<std::string, const VectorField*> plain;
    for (const auto& [name, field] : copies) plain[name] = &field;
    return self->band.bytes(plain, speedOf, metadata, &p);
  });
}

}  // namespace

void bind_io(py::module_& m) {
  bindJob<BytesJob>(m, "BytesJob", "Makes a file in memory; its result is its bytes.",
                    [](const std::string& bytes) { return py::bytes(bytes); });

  py::class_<FlowMapHandle, FlowMapPointer>(m, "FlowMap", py::module_local(),
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
      .def(
          "exr",
          [](const FlowMapPointer& self, const FieldHandle& field, const std::string& basis, bool half,
             const Metadata& metadata) { return waited(startExr(self, field, basis, half, metadata)); },
          py::arg("field"), py::arg("basis") = "uv", py::arg("half") = false, py::arg("metadata") = Metadata(),
          "The image as the bytes of an OpenEXR file, 32 bit floats or (half) 16; metadata: {name: text}.")
      .def("start_exr", &startExr, py::arg("field"), py::arg("basis") = "uv", py::arg("half") = false,
           py::arg("metadata") = Metadata(), "exr on other threads: a BytesJob to watch.");
  bindJob<FlowMapJob>(m, "FlowMapJob", "Runs start_flow_map; its result is a FlowMap.",
                      [](const FlowMapPointer& map) { return map; });
  m.def("start_flow_map", &startFlowMap, py::arg("mesh"), py::arg("uvs"), py::arg("width"), py::arg("height"),
        py::arg("margin") = 8, "FlowMap(...) on other threads: a FlowMapJob to watch.");

  py::class_<VdbBandHandle, VdbBandPointer>(m, "VdbBand", py::module_local(),
                                            "The voxels around a surface; writes fields on them.")
      .def(py::init(&makeBand), py::arg("mesh"), py::arg("voxel_size") = 0.0, py::arg("half_width") = 3.0,
           py::arg("progress") = ProgressPointer(),
           "voxel_size: mesh units, 0 for the mean edge length; half_width: voxels on each side of the surface.\n"
           "Raises InputError on sizes out of range, Cancelled.")
      .def_property_readonly(
          "voxel_size", [](const VdbBandHandle& h) { return h.band.voxelSize(); }, "Mesh units.")
      .def_property_readonly(
          "voxel_count", [](const VdbBandHandle& h) { return h.band.voxelCount(); }, "Voxels of the band.")
      .def(
          "vdb",
          [](const VdbBandPointer& self, const std::map<std::string, const FieldHandle*>& fields,
             const std::string& speedOf,
             const Metadata& metadata) { return waited(startVdb(self, fields, speedOf, metadata)); },
          py::arg("fields"), py::arg("speed_of") = "", py::arg("metadata") = Metadata(),
          "The bytes of an OpenVDB file: a vec3 grid per entry of fields {name: VectorField} (mesh units per second),\n"
          "sf_speed from the field named speed_of, sf_distance; metadata: {name: text}.")
      .def("start_vdb", &startVdb, py::arg("fields"), py::arg("speed_of") = "", py::arg("metadata") = Metadata(),
           "vdb on other threads: a BytesJob to watch.");
  bindJob<VdbBandJob>(m, "VdbBandJob", "Runs start_vdb_band; its result is a VdbBand.",
                      [](const VdbBandPointer& band) { return band; });
  m.def("start_vdb_band", &startBand, py::arg("mesh"), py::arg("voxel_size") = 0.0, py::arg("half_width") = 3.0,
        "VdbBand(...) on other threads: a VdbBandJob to watch.");
}

}  // namespace stormfield::bindings
