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

ConstraintSet makeConstraints(const py::object& vertex, const py::object& sample, const py::object& value,
                              const py::object& weight, const py::object& element, std::vector<std::string> names) {
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

SolveOutput solve(const MeshPointer& mesh, const ConstraintSet& constraints, const SpaceTimeOptions& options,
                  const std::shared_ptr<Progress>& progress, const ParameterizedFieldHandle* warmStart) {
  const py::gil_scoped_release release;
  Progress own;
  return solveNow(mesh, constraints, options, progress ? *progress : own, warmStart ? &warmStart->field : nullptr);
}

std::shared_ptr<Job<SolveOutput>> startSolve(const MeshPointer& mesh, const ConstraintSet& constraints,
                                             const SpaceTimeOptions& options, const std::shared_ptr<Progress>& progress,
                                             const ParameterizedFieldHandle* warmStart) {
  // The job outlives the arguments, so it works on copies.
  auto start = warmStart ? std::make_shared<const ParameterizedField>(warmStart->field) : nullptr;
  return std::make_shared<Job<SolveOutput>>(
      [=](Progress& p) { return solveNow(mesh, constraints, options, p, start.get()); }, progress);
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
           "weight: (k,) float64 > 0 in 1/size^2, infinite where the value is met exactly; names: list of the "
           "elements' names.")
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

  py::class_<SpaceTimeOptions>(m, "SolveOptions", py::module_local(), "Settings of the space-time solve.")
      .def(py::init(&makeOptions), py::arg("samples") = 100, py::arg("lambda_weight") = 10.0,
           py::arg("tolerance") = 1e-4,
           "samples: of lambda in [0, 1]; lambda_weight: of thesis eq. 11.3; tolerance: relative residual.")
      .def_readonly("samples", &SpaceTimeOptions::samples)
      .def_readonly("lambda_weight", &SpaceTimeOptions::lambdaWeight)
      .def_readonly("tolerance", &SpaceTimeOptions::tolerance);

  py::class_<SolveOutput>(m, "SpaceTimeResult", py::module_local(), "What a solve returns.")
      .def_property_readonly(
          "field",
          [](const SolveOutput& r) {
            return ParameterizedFieldHandle{r.mesh, r.result.field};
          },
          "The field as a ParameterizedField.")
      .def_property_readonly("iterations", [](const SolveOutput& r) { return r.result.iterations; })
      .def_property_readonly(
          "residual", [](const SolveOutput& r) { return r.result.residual; }, "True relative residual.")
      .def_property_readonly(
          "error", [](const SolveOutput& r) { return r.result.error; },
          "Estimated difference to the exact field, relative, in the mean square.")
      .def_property_readonly(
          "components_without_constraint", [](const SolveOutput& r) { return r.result.componentsWithoutConstraint; },
          "Components of the mesh that no constraint touches: their field is zero.");

  bindJob<Job<SolveOutput>>(m, "SpaceTimeJob", "A space-time solve on a thread of its own.",
                            [](const SolveOutput& r) { return r; });

  m.def("solve", &solve, py::arg("mesh"), py::arg("constraints"), py::arg("options") = SpaceTimeOptions(),
        py::arg("progress") = py::none(), py::arg("warm_start") = py::none(),
        "Solve for the field on mesh x lambda. warm_start: a ParameterizedField to start from, with as many vertices "
        "and\n"
        "samples. Raises InputError (no constraints, bad or contradicting ones), SolverError, Cancelled.");
  m.def("start_space_time_solve", &startSolve, py::arg("mesh"), py::arg("constraints"),
        py::arg("options") = SpaceTimeOptions(), py::arg("progress") = py::none(), py::arg("warm_start") = py::none(),
        "The same without waiting: a SpaceTimeJob.");
  m.def("even_speed", &evened, py::arg("field"), py::arg("amount"), py::arg("reach"),
        "The field with its speed evened out: amount 0 (as it is) to 1 (the same speed everywhere, falling to 0 over "
        "the\n"
        "length reach, in mesh units, around fixed points). Fixed points and their indices stay.");
}

}  // namespace stormfield::bindings
