#include <mutex>
#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "base/error.h"
#include "base/message.h"
#include "bindings/bindings.h"
#include "bindings/job.h"
#include "design/design_solve.h"

namespace stormfield::bindings {
namespace {

using MeshPointer = std::shared_ptr<MeshHandle>;
using ElementLists = std::vector<std::vector<DesignElement>>;

/// What Python gets of one solved field.
struct SolvedField {
  ParameterizedFieldHandle field;
  int iterations = 0;
  double residual = 0.0, error = 0.0;
  std::vector<Index> componentsWithoutConstraint;
};

/// A number, or one for each lambda of the element.
using Numbers = std::vector<double>;

DesignElement makeElement(const std::string& name, ElementType type, const ArrayArgument<double>& points,
                          const std::vector<double>& lam, SingularKind kind, const Numbers& strength,
                          const Numbers& radius, const Numbers& angle,
                          const std::optional<std::array<double, 3>>& direction, bool hard, const Numbers& rate,
                          OrbitStability stability, bool reverse, double fadeIn, double fadeOut, BifurcationEvent event,
                          double reach, BrushMode mode, double falloff) {
  DesignElement element;
  element.name = name;
  element.type = type;
  element.kind = kind;
  const auto array = inputArray<double>(points, "points", {kAny, 3});
  for (py::ssize_t i = 0; i < array.shape(0); ++i)
    element.points.emplace_back(array.at(i, 0), array.at(i, 1), array.at(i, 2));
  element.lambdas = lam;
  for (const Numbers* numbers : {&strength, &radius, &angle, &rate})
    if (numbers->empty()) throw InputError(message("\"", name, "\" has an empty list of numbers: give at least one"));
  element.strength = strength;
  element.radius = radius;
  element.angle = angle;
  if (direction) element.direction = Vec3((*direction)[0], (*direction)[1], (*direction)[2]);
  element.hard = hard;
  element.rate = rate;
  element.stability = stability;
  element.reverse = reverse;
  element.fadeIn = fadeIn;
  element.fadeOut = fadeOut;
  element.event = event;
  element.reach = reach;
  element.mode = mode;
  element.falloff = falloff;
  return element;
}

using SolvedFields = std::vector<std::shared_ptr<SolvedField>>;

/// A solver that outlives its solve. One job at a time has it; others find nothing and start anew.
class SolverState {
 public:
  struct Content {
    MeshPointer mesh;
    std::optional<DesignSolver> solver;
  };
  Content take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(content_, {});
  }
  void put(Content content) {
    const std::lock_guard lock(mutex_);
    content_ = std::move(content);
  }

 private:
  std::mutex mutex_;
  Content content_;
};

SolvedFields solveAll(const MeshPointer& mesh, const ElementLists& lists, const DesignOptions& options,
                      SolverState& state, Progress& progress) {
  SolverState::Content content = state.take();
  if (content.solver && content.mesh == mesh) {
    content.solver->setOptions(options, progress);
  } else {
    content = {mesh, std::nullopt};
    content.solver.emplace(mesh->charts(), options, progress);
  }
  // What is left after a fault or an interrupt is kept as well.
  const std::shared_ptr<void> back(nullptr, [&](void*) { state.put(std::move(content)); });
  SolvedFields solved;
  const int fields = static_cast<int>(lists.size());
  for (int i = 0; i < fields; ++i) {
    SpaceTimeResult result = content.solver->solve(lists[i], progress, i, fields);
    solved.push_back(std::make_shared<SolvedField>(SolvedField{{mesh, std::move(result.field)},
                                                               result.iterations,
                                                               result.residual,
                                                               result.error,
                                                               std::move(result.componentsWithoutConstraint)}));
  }
  return solved;
}

Work<SolvedFields> prepareSolveDesign(const MeshPointer& mesh, const ElementLists& lists, Index samples,
                                      double lambdaWeight, double tolerance, double evenSpeed, double lambdaPerSecond,
                                      Border border, const std::shared_ptr<SolverState>& state) {
  const DesignOptions options{samples, lambdaWeight, tolerance, evenSpeed, lambdaPerSecond, border};
  auto kept = state ? state : std::make_shared<SolverState>();
  return [=](Progress& progress) { return solveAll(mesh, lists, options, *kept, progress); };
}

ConstraintSet constraintsOf(const MeshPointer& mesh, const std::vector<DesignElement>& elements, Index samples,
                            double lambdaPerSecond) {
  ElementOptions options;
  options.samples = samples;
  options.lambdaPerSecond = lambdaPerSecond;
  const py::gil_scoped_release release;
  return elementConstraints(mesh->charts(), elements, options);
}

}  // namespace

void bind_design(py::module_& m) {
  const DesignElement element;
  py::class_<DesignElement>(m, "DesignElement", py::module_local(), "What an artist places (thesis 5.2). Immutable.")
      .def(
          py::init(&makeElement), py::arg("name"), py::arg("type"), py::arg("points"), py::arg("lam") = element.lambdas,
          py::arg("kind") = element.kind, py::arg("strength") = element.strength.values(),
          py::arg("radius") = element.radius.values(), py::arg("angle") = element.angle.values(),
          py::arg("direction") = py::none(), py::arg("hard") = element.hard, py::arg("rate") = element.rate.values(),
          py::arg("stability") = element.stability, py::arg("reverse") = element.reverse,
          py::arg("fade_in") = element.fadeIn, py::arg("fade_out") = element.fadeOut, py::arg("event") = element.event,
          py::arg("reach") = element.reach, py::arg("mode") = element.mode, py::arg("falloff") = element.falloff,
          "points: (k, 3) float64, object space. lam: one lambda per point, or start and end. kind: of singular\n"
          "elements. strength: mesh sizes per second. radius: mesh units. angle: radians, of a saddle's outflow or an\n"
          "arrow from direction (3 numbers). hard: whether the inner third of the region is met exactly. rate: 1/s, "
          "of\n"
          "attachment, separation and orbits. stability, reverse: of orbits. fade_in, fade_out: lengths of lambda.\n"
          "event: what a bifurcation makes happen, reach: lambda from it until its pair or orbit has its full size.\n"
          "mode: of a brush, falloff: part of its radius over which it fades.\n"
          "strength, radius, angle and rate hold one number, or one for each lam. Raises InputError for an unknown\n"
          "word and for points of another shape.")
      .def_readonly("name", &DesignElement::name, "Unique in its design; messages speak of it.");

  m.def(
      "check_elements", [](const std::vector<DesignElement>& elements) { checkElements(elements); },
      py::arg("elements"), "Raises InputError on the first fault that needs no mesh.");

  m.def("element_constraints", &constraintsOf, py::arg("mesh"), py::arg("elements"),
        py::arg("samples") = ElementOptions().samples, py::arg("lambda_per_second") = ElementOptions().lambdaPerSecond,
        "The ConstraintSet of a list of DesignElement (thesis 5.2.2, 11.1.3). samples: of lambda in [0, 1]. "
        "lambda_per_second: "
        "of\n"
        "pathlines. Raises InputError.");

  py::class_<SolvedField, std::shared_ptr<SolvedField>>(m, "SolvedField", py::module_local(),
                                                        "A solved field and how the solve went.")
      .def_property_readonly(
          "field",
          [](const std::shared_ptr<SolvedField>& solved) {
            return std::shared_ptr<ParameterizedFieldHandle>(solved, &solved->field);
          },
          "ParameterizedField.")
      .def_readonly("iterations", &SolvedField::iterations, "Of the Krylov method.")
      .def_readonly("residual", &SolvedField::residual, "True relative residual.")
      .def_readonly("error", &SolvedField::error,
                    "Estimated difference to the exact field, relative, in the mean square.")
      .def_readonly("components_without_constraint", &SolvedField::componentsWithoutConstraint,
                    "Components of the mesh that no element reaches: their field is zero.");

  py::class_<SolverState, std::shared_ptr<SolverState>>(
      m, "SolverState", py::module_local(),
      "What solve_design leaves for the next solve on the same mesh object: edits are solved faster.")
      .def(py::init<>())
      .def(
          "clear", [](SolverState& state) { state.put({}); }, "Give its memory back; the next solve starts anew.");

  const DesignOptions defaults;
  bindJob<SolvedFields>(m, "SolveDesignJob", "A solve of designs on a thread of its own.",
                        [](const SolvedFields& solved) { return solved; })
      .def(
          m, "solve_design", &prepareSolveDesign,
          "One field per list of DesignElement, one after the other -> list of SolvedField.\n\n"
          "samples: of lambda in [0, 1]. lambda_weight: omega of thesis eq. 11.3. tolerance: relative residual.\n"
          "even_speed: 0 (as solved) to 1 (one speed, falling to 0 at fixed points). lambda_per_second: of pathlines.\n"
          "border: what the flow does at the border of the surface.\n"
          "state: a SolverState; with one that solved on this mesh object before, solves start from their last\n"
          "solution and agree with those that do not to the tolerance, not to the bit. Raises InputError,\n"
          "SolverError, Cancelled.",
          py::arg("mesh"), py::arg("elements"), py::kw_only(), py::arg("samples") = defaults.samples,
          py::arg("lambda_weight") = defaults.lambdaWeight, py::arg("tolerance") = defaults.tolerance,
          py::arg("even_speed") = defaults.evenSpeed, py::arg("lambda_per_second") = defaults.lambdaPerSecond,
          py::arg("border") = defaults.border, py::arg("state") = std::shared_ptr<SolverState>());
}

}  // namespace stormfield::bindings
