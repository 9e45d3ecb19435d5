#include "base/progress.h"
#include "bindings/bindings.h"

namespace stormfield::bindings {

void bind_base(py::module_& m) {
  // The last registered is asked first: bases before what derives from them.
  const auto& input = py::register_local_exception<InputError>(m, "InputError", PyExc_ValueError);
  input.attr("__doc__") = "The data cannot be used; the message names the element and the cure.";
  const auto& mesh = py::register_local_exception<MeshError>(m, "MeshError", input);
  mesh.attr("__doc__") = "The mesh is not an oriented 2-manifold of proper triangles.";
  const auto& solver = py::register_local_exception<SolverError>(m, "SolverError", PyExc_RuntimeError);
  solver.attr("__doc__") = "The solver did not reach its tolerance.";
  const auto& cancelled = py::register_local_exception<Cancelled>(m, "Cancelled", PyExc_RuntimeError);
  cancelled.attr("__doc__") = "The work was stopped through its Progress.";

  py::class_<Progress, std::shared_ptr<Progress>>(
      m, "Progress", py::module_local(), "Progress and cancellation of long work; safe to use from any thread.")
      .def(py::init<>())
      .def_property_readonly("fraction", &Progress::fraction, "Part of the work that is done, 0 to 1.")
      .def_property_readonly("cancelled", &Progress::cancelled, "Whether cancel() was called.")
      .def("cancel", &Progress::cancel, "Ask the worker to stop; it raises Cancelled within 0.1 s.");
}

}  // namespace stormfield::bindings
