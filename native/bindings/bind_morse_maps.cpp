#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "maps/geometry_map.h"
#include "maps/tau_map.h"

namespace stormfield::bindings {
namespace {

using MapPointer = std::shared_ptr<const CombinatorialMap>;
using MapJob = Job<CombinatorialMap>;

TauUnit tauUnit(const std::string& unit) {
  if (unit == "time") return TauUnit::Time;
  if (unit == "length") return TauUnit::Length;
  throw InputError(message("there is no unit '", unit, "' of tau; choose time or length"));
}

/// tau: a number, or one for every face.
std::vector<double> inputTaus(const py::object& tau, Index faces) {
  if (py::isinstance<py::array>(tau)) return toVector(inputArray<double>(tau, "tau", {faces}));
  const double value = tau.cast<double>();
  if (!(value > 0.0)) throw InputError(message("tau is ", value, "; it must be a positive number"));
  return std::vector<double>(static_cast<std::size_t>(faces), value);
}

std::shared_ptr<MapJob> startTauMap(const FieldHandle& field, const py::object& tau, const std::string& unit,
                                    const std::optional<double>& memoryLimit) {
  TauMapOptions options;
  options.unit = tauUnit(unit);
  if (memoryLimit) {
    if (!(*memoryLimit > 0.0)) throw InputError("memory_limit must be a positive number of MiB");
    options.memoryLimit = static_cast<std::size_t>(*memoryLimit * 1048576.0);
  }
  return std::make_shared<MapJob>([mesh = field.mesh, f = field.field, options,
                                   taus = inputTaus(tau, field.mesh->mesh().faceCount())](Progress& progress) {
    return tauMap(*mesh->flatFaces(), f, taus, options, &progress);
  });
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
  bindJob<MapJob>(m, "MapJob", "A combinatorial map that is being computed.",
                  [](const CombinatorialMap& map) { return std::make_shared<CombinatorialMap>(map); });
  m.def(
      "geometry_map",
      [](const FieldHandle& field) {
        const py::gil_scoped_release release;
        return std::make_shared<CombinatorialMap>(geometryMap(field.field));
      },
      py::arg("field"), "The map by directions across the edges (thesis 2.4.2) of a VectorField -> CombinatorialMap.");
  m.def(
      "start_tau_map", &startTauMap, py::arg("field"), py::arg("tau"), py::arg("unit") = "time",
      py::arg("memory_limit") = py::none(),
      "Start the map of moving faces along the flow for tau (thesis 7) -> MapJob, result a CombinatorialMap.\n"
      "tau: a number > 0, or (m,) float64 with one for every face, where 0 means its row of geometry_map. unit: time\n"
      "(seconds) or length (spatial tau, mesh units). memory_limit: MiB it may take (None: half of the machine's).\n"
      "Raises InputError for a tau that is not positive, and for one that does not fit (it names the largest that "
      "does).");
  m.def(
      "starting_tau",
      [](const FieldHandle& field, const std::string& unit, double edges) {
        return startingTau(field.field, tauUnit(unit), edges);
      },
      py::arg("field"), py::arg("unit") = "time", py::arg("edges") = 4.0,
      "The time (or length) to cross `edges` mean edges at the mean speed. Raises InputError for a zero field.");
}

}  // namespace stormfield::bindings
