#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "topology/fixed_points.h"

namespace stormfield::bindings {
namespace {

std::vector<FixedPoint> fixedPoints(const FieldHandle& field, double relativeTolerance) {
  if (!(relativeTolerance >= 0.0 && relativeTolerance < 1.0)) {
    throw InputError(message("relative_tolerance is ", relativeTolerance, "; choose one from 0 up to 1"));
  }
  const py::gil_scoped_release release;
  return findFixedPoints(field.field, {relativeTolerance});
}

py::array_t<double> jacobianArray(const FixedPoint& p) {
  py::array_t<double> result({2, 2});
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) result.mutable_at(i, k) = p.jacobian(i, k);
  }
  return result;
}

py::array_t<double> vectorArray(const Vec3& v) {
  return py::array_t<double>(3, v.data());
}

}  // namespace

void bind_topology(py::module_& m) {
  py::class_<FixedPoint>(m, "FixedPoint", py::module_local(), "Zero of a field. Immutable.")
      .def_property_readonly(
          "face", [](const FixedPoint& p) { return p.point.face; }, "Face that holds the point.")
      .def_property_readonly(
          "barycentric", [](const FixedPoint& p) { return vectorArray(p.point.barycentric); },
          "(3,) float64, coordinates in the face.")
      .def_property_readonly(
          "position", [](const FixedPoint& p) { return vectorArray(p.position); }, "(3,) float64, mesh units.")
      .def_readonly("index", &FixedPoint::index, "Poincare index.")
      .def_property_readonly(
          "kind", [](const FixedPoint& p) { return name(p.kind); }, "source, sink, saddle, center or degenerate.")
      .def_property_readonly("jacobian", &jacobianArray, "(2, 2) float64 in the flat frame of the face, 1/s.")
      .def_readonly("rotation", &FixedPoint::rotation, "Curl, 1/s: > 0 turns counter-clockwise seen from outside.")
      .def("__repr__", [](const FixedPoint& p) {
        return message("<FixedPoint ", name(p.kind), " index ", p.index, " in face ", p.point.face, ">");
      });

  m.def("fixed_points", &fixedPoints, py::arg("field"), py::arg("relative_tolerance") = 1e-3,
        "Fixed points of a VectorField, in face order. relative_tolerance: |trace| below this part of the rotation "
        "counts\n"
        "as a center, |det| below its square (relative to the Jacobian) as degenerate.");
}

}  // namespace stormfield::bindings
