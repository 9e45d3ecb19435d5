#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "maps/geometry_map.h"
#include "maps/tau_map.h"

namespace stormfield::bindings {
namespace {

using MapPointer = std::shared_ptr<const CombinatorialMap>;

/// tau: a number, or one for every face.
std::vector<double> inputTaus(const NumberOrArray<double>& tau, Index faces) {
  if (py::isinstance<py::array>(tau)) return toVector(inputArray<double>(tau, "tau", {faces}));
  const double value = tau.cast<double>();
  if (!(value > 0.0)) throw InputError(message("tau is ", value, "; it must be a positive number"));
  return std::vector<double>(static_cast<std::size_t>(faces), value);
}

Work<CombinatorialMap> prepareTauMap(const FieldHandle& field, const NumberOrArray<double>& tau, TauUnit unit,
                                     const std::optional<double>& memoryLimit) {
  TauMapOptions options;
  options.unit = unit;
  if (memoryLimit) {
    if (!(*memoryLimit > 0.0)) throw InputError("memory_limit must be a positive number of MiB");
    options.memoryLimit = static_cast<std::size_t>(*memoryLimit * 1048576.0);
  }
  return [mesh = field.mesh, f = field.field, options, taus = inputTaus(tau, field.mesh->mesh().faceCount())](
             Progress& progress) { return tauMap(*mesh->flatFaces(), f, taus, options, &progress); };
}

template <typename T>
py::array_t<T> viewOf(const std::vector<T>& values, const py::object& owner) {
  return readOnlyView(values.data(), {static_cast<py::ssize_t>(values.size())}, owner);
}

}  // namespace

void bind_morse_maps(py::module_& m) {
  py::class_<CombinatorialMap, std::shared_ptr<CombinatorialMap>>(
      m, "CombinatorialMap", py::module_local(),
      "A directed graph on faces that encloses the flow (thesis 2.4): face f leads to "
      "targets[offsets[f]:offsets[f+1]].")
      .def_property_readonly(
          "offsets",
          [](const py::object& self) { return viewOf(self.cast<const CombinatorialMap&>().graph.offsets, self); },
          "(m + 2,) uint64: where the rows of faces and of outside begin and end.")
      .def_property_readonly(
          "targets",
          [](const py::object& self) { return viewOf(self.cast<const CombinatorialMap&>().graph.targets, self); },
          "(k,) int32: faces, ascending within a row; outside for flow that leaves the surface.")
      .def_property_readonly("outside", &CombinatorialMap::outside, "The node beyond the boundary: the face count m.")
      .def("__repr__", [](const CombinatorialMap& map) {
        return message("<CombinatorialMap of ", map.outside(), " faces and ", map.graph.edgeCount(), " edges>");
      });

  m.def(
      "geometry_map",
      [](const FieldHandle& field) {
        const py::gil_scoped_release release;
        return std::make_shared<CombinatorialMap>(geometryMap(field.field));
      },
      py::arg("field"), "The map by directions across the edges (thesis 2.4.2) of a VectorField.");
  const TauMapOptions defaults;
  bindJob<CombinatorialMap>(m, "MapJob", "A combinatorial map that is being computed.",
                            [](const CombinatorialMap& map) { return std::make_shared<CombinatorialMap>(map); })
      .def(
          m, "tau_map", &prepareTauMap,
          "The map of moving faces along the flow for tau (thesis 6.3, 7.1) -> CombinatorialMap.\n\n"
          "tau: a number > 0, or (m,) float64 with one for every face, where 0 means its row of geometry_map. unit:\n"
          "time (seconds) or length (mesh units). memory_limit: MiB it may take (None: half of the machine's). Raises\n"
          "InputError for a tau that is not positive, or names the largest one that fits into memory; Cancelled.",
          py::arg("field"), py::arg("tau"), py::arg("unit") = defaults.unit, py::arg("memory_limit") = py::none());
  m.def(
      "starting_tau",
      [](const FieldHandle& field, TauUnit unit, double edges) { return startingTau(field.field, unit, edges); },
      py::arg("field"), py::arg("unit") = defaults.unit, py::arg("edges") = 4.0,
      "A tau to start with: the time (seconds) or length (mesh units) to cross `edges` mean edges at the mean speed.\n"
      "Raises InputError for a zero field.");
}

}  // namespace stormfield::bindings
