#include <pybind11/stl.h>
#include <tbb/parallel_for.h>

#include "bindings/bindings.h"
#include "field/interpolation.h"
#include "field/poincare_index.h"

namespace stormfield::bindings {
namespace {

using MeshPointer = std::shared_ptr<MeshHandle>;

FieldHandle makeField(const MeshPointer& mesh, const ArrayArgument<Complex>& values) {
  return {mesh, makeVectorField(mesh->charts(), toVector(inputArray<Complex>(values, "values", {kAny})))};
}

FieldHandle fieldFromSpace(const MeshPointer& mesh, const ArrayArgument<double>& vectors) {
  return {mesh, fromSpace(mesh->charts(), toPoints(inputArray<double>(vectors, "vectors", {kAny, 3})))};
}

py::array_t<double> evaluateAll(const FieldHandle& self, const ArrayArgument<Index>& faces,
                                const ArrayArgument<double>& barycentric) {
  const auto where = inputSurfacePoints(self.mesh->mesh(), faces, barycentric);
  Points result(static_cast<Eigen::Index>(where.size()), 3);
  {
    const py::gil_scoped_release release;
    tbb::parallel_for(std::size_t{0}, where.size(),
                      [&](std::size_t i) { result.row(i) = evaluate(self.field, where[i]); });
  }
  return fromPoints(result);
}

py::array_t<int> indices(const FieldHandle& self) {
  std::vector<int> result;
  {
    const py::gil_scoped_release release;
    result = poincareIndices(self.field);
  }
  return copied(result);
}

ParameterizedFieldHandle makeParameterized(const MeshPointer& mesh, const ArrayArgument<double>& lambdas,
                                           const ArrayArgument<Complex>& values) {
  const auto l = inputArray<double>(lambdas, "lambdas", {kAny});
  const auto v = inputArray<Complex>(values, "values", {l.shape(0), mesh->mesh().vertexCount()});
  return {mesh, makeParameterizedField(mesh->charts(), toVector(l), toVector(v))};
}

}  // namespace

void bind_field(py::module_& m) {
  py::class_<FieldHandle>(m, "VectorField", py::module_local(),
                          "Tangent vector field: one vector per vertex, continuous in between. Immutable.")
      .def(py::init(&makeField), py::arg("mesh"), py::arg("values"),
           "values: (n,) complex128, one tangent vector per vertex in its chart, mesh units per second.\n"
           "Raises InputError on a wrong size or values that are not finite.")
      .def_static("from_space", &fieldFromSpace, py::arg("mesh"), py::arg("vectors"),
                  "vectors: (n, 3) float64, mesh units per second; their normal parts are dropped. Raises InputError "
                  "on a wrong size\n"
                  "or values that are not finite.")
      .def_readonly("mesh", &FieldHandle::mesh, "The TriangleMesh it lives on.")
      .def_property_readonly(
          "values",
          [](const py::object& self) {
            const auto& values = self.cast<const FieldHandle&>().field.values;
            return readOnlyView(values.data(), {static_cast<py::ssize_t>(values.size())}, self);
          },
          "(n,) complex128.")
      .def(
          "to_space", [](const FieldHandle& self) { return fromPoints(toSpace(self.field)); },
          "The vectors in space, (n, 3) float64, mesh units per second.")
      .def("evaluate", &evaluateAll, py::arg("faces"), py::arg("barycentric"),
           "faces (k,) int32, barycentric (k, 3) float64 -> vectors in space (k, 3) float64, mesh units per second "
           "(thesis\n"
           "2.5). Raises InputError on points outside their faces.")
      .def("poincare_indices", &indices,
           "(m,) int32: index per face; on a closed mesh they add up to the Euler characteristic.");

  py::class_<ParameterizedFieldHandle, std::shared_ptr<ParameterizedFieldHandle>>(
      m, "ParameterizedField", py::module_local(),
      "A field for every lambda in [0, 1]: samples, linear between. Immutable.")
      .def(py::init(&makeParameterized), py::arg("mesh"), py::arg("lambdas"), py::arg("values"),
           "lambdas: (s,) float64, increasing in [0, 1]; values: (s, n) complex128.\n"
           "Raises InputError on sizes, lambdas or values that do not fit.")
      .def_readonly("mesh", &ParameterizedFieldHandle::mesh, "The TriangleMesh it lives on.")
      .def_property_readonly(
          "lambdas",
          [](const py::object& self) {
            const auto& lambdas = self.cast<const ParameterizedFieldHandle&>().field.lambdas;
            return readOnlyView(lambdas.data(), {static_cast<py::ssize_t>(lambdas.size())}, self);
          },
          "(s,) float64.")
      .def_property_readonly(
          "values",
          [](const py::object& self) {
            const auto& field = self.cast<const ParameterizedFieldHandle&>().field;
            return readOnlyView(field.values.data(), {field.sampleCount(), field.vertexCount()}, self);
          },
          "(s, n) complex128.")
      .def(
          "at",
          [](const ParameterizedFieldHandle& self, double lam) {
            return FieldHandle{self.mesh, at(self.field, lam)};
          },
          py::arg("lam"), "The field at lambda, linear between samples, clamped to the first and last.")
      .def(
          "sample",
          [](const ParameterizedFieldHandle& self, Index j) {
            return FieldHandle{self.mesh, sampleField(self.field, j)};
          },
          py::arg("j"), "Sample j as a field of its own.");
}

}  // namespace stormfield::bindings
