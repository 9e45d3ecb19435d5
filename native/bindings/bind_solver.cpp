#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "design/even_speed.h"
#include "solver/space_time_solver.h"

namespace stormfield::bindings {
namespace {

using MeshPointer = std::shared_ptr<MeshHandle>;

struct SolveOutput {
  MeshPointer mesh;
  SpaceTimeResult result;
};

ConstraintSet makeConstraints(const ArrayArgument<Index>& vertex, const ArrayArgument<Index>& sample,
                              const ArrayArgument<Complex>& value, const ArrayArgument<double>& weight,
                              const ArrayArgument<Index>& element, std::vector<std::string> names) {
  const auto v = inputArray<Index>(vertex, "vertex", {kAny});
  const py::ssize_t n = v.shape(0);
  ConstraintSet set;
  set.vertex = toVector(v);
  set.sample = toVector(inputArray<Index>(sample, "sample", {n}));
  set.value = toVector(inputArray<Complex>(value, "value", {n}));
  set.weight = toVector(inputArray<double>(weight, "weight", {n}));
  set.element = toVector(inputArray<Index>(element, "element", {n}));
  set.elementNames = std::move(names);
  return set;
}

SpaceTimeOptions makeOptions(Index samples, double lambdaWeight, double tolerance) {
  SpaceTimeOptions options;
  options.samples = samples;
  options.lambdaWeight = lambdaWeight;
  options.tolerance = tolerance;
  return options;
}

SolveOutput solveNow(const MeshPointer& mesh, const ConstraintSet& constraints, const SpaceTimeOptions& options,
                     Progress& progress, const ParameterizedField* warmStart) {
  const SpaceTimeSolver solver(mesh->charts(), options, progress);
  SpaceTimeState state = warmStart ? solver.startFrom(*warmStart) : SpaceTimeState();
  return {mesh, solver.solve(constraints, progress, state)};
}

Work<SolveOutput> prepareSolve(const MeshPointer& mesh, const ConstraintSet& constraints,
                               const SpaceTimeOptions& options, const ParameterizedFieldHandle* warmStart) {
  // The work outlives the arguments, so it has copies.
  auto start = warmStart ? std::make_shared<const ParameterizedField>(warmStart->field) : nullptr;
  return [=](Progress& p) { return solveNow(mesh, constraints, options, p, start.get()); };
}

ParameterizedFieldHandle evened(const ParameterizedFieldHandle& field, double amount, double reach) {
  const py::gil_scoped_release release;
  return {field.mesh, evenSpeed(field.field, amount, reach)};
}

}  // namespace

void bind_solver(py::module_& m) {
  py::class_<ConstraintSet>(m, "ConstraintSet", py::module_local(),
                            "Values that the solution must meet at vertices and samples of lambda.")
      .def(py::init(&makeConstraints), py::arg("vertex"), py::arg("sample"), py::arg("value"), py::arg("weight"),
           py::arg("element"), py::arg("names"),
           "vertex, sample, element: (k,) int32; value: (k,) complex128 in the chart of the vertex, mesh units per "
           "second;\n"
           "weight: (k,) float64 > 0 in 1/size^2, infinite where the value is met exactly; names: those of the "
           "elements.\n"
           "Raises InputError on arrays of other shapes; solve refuses values that cannot be used.")
      .def("__len__", &ConstraintSet::size)
      .def_property_readonly(
          "vertex", [](const ConstraintSet& s) { return copied(s.vertex); }, "(k,) int32.")
      .def_property_readonly(
          "sample", [](const ConstraintSet& s) { return copied(s.sample); }, "(k,) int32.")
      .def_property_readonly(
          "value", [](const ConstraintSet& s) { return copied(s.value); },
          "(k,) complex128 in the charts of the vertices, mesh units per second.")
      .def_property_readonly(
          "weight", [](const ConstraintSet& s) { return copied(s.weight); }, "(k,) float64, infinite when hard.")
      .def_property_readonly(
          "element", [](const ConstraintSet& s) { return copied(s.element); }, "(k,) int32, index into names.")
      .def_readonly("names", &ConstraintSet::elementNames, "Names of the elements.");

  const SpaceTimeOptions defaults;
  py::class_<SpaceTimeOptions>(m, "SolveOptions", py::module_local(), "Settings of the space-time solve.")
      .def(py::init(&makeOptions), py::arg("samples") = defaults.samples,
           py::arg("lambda_weight") = defaults.lambdaWeight, py::arg("tolerance") = defaults.tolerance,
           "samples: of lambda in [0, 1]; lambda_weight: of thesis eq. 11.3; tolerance: relative residual.")
      .def_readonly("samples", &SpaceTimeOptions::samples, "Of lambda in [0, 1].")
      .def_readonly("lambda_weight", &SpaceTimeOptions::lambdaWeight, "Omega of thesis eq. 11.3.")
      .def_readonly("tolerance", &SpaceTimeOptions::tolerance, "Relative residual.");

  py::class_<SolveOutput>(m, "SpaceTimeResult", py::module_local(), "What a solve returns.")
      .def_property_readonly(
          "field",
          [](const SolveOutput& r) {
            return ParameterizedFieldHandle{r.mesh, r.result.field};
          },
          "The field as a ParameterizedField.")
      .def_property_readonly(
          "iterations", [](const SolveOutput& r) { return r.result.iterations; }, "Of the Krylov method.")
      .def_property_readonly(
          "residual", [](const SolveOutput& r) { return r.result.residual; }, "True relative residual.")
      .def_property_readonly(
          "error", [](const SolveOutput& r) { return r.result.error; },
          "Estimated difference to the exact field, relative, in the mean square.")
      .def_property_readonly(
          "components_without_constraint", [](const SolveOutput& r) { return r.result.componentsWithoutConstraint; },
          "Components of the mesh that no constraint touches: their field is zero.");

  bindJob<SolveOutput>(m, "SolveJob", "A space-time solve on a thread of its own.",
                       [](const SolveOutput& r) { return r; })
      .def(m, "solve", &prepareSolve,
           "The field on mesh x lambda that meets the constraints (thesis 11.1.3.1) -> SpaceTimeResult.\n\n"
           "warm_start: a ParameterizedField to start from, with as many vertices and samples. Raises InputError (no\n"
           "constraints, bad or contradicting ones), SolverError, Cancelled.",
           py::arg("mesh"), py::arg("constraints"), py::arg_v("options", SpaceTimeOptions(), "SolveOptions()"),
           py::arg("warm_start") = py::none());
  m.def("even_speed", &evened, py::arg("field"), py::arg("amount"), py::arg("reach"),
        "The field with its speed evened out: amount 0 (as it is) to 1 (the same speed everywhere, falling to 0 over "
        "the\n"
        "length reach, in mesh units, around fixed points). Fixed points and their indices stay.");
}

}  // namespace stormfield::bindings
