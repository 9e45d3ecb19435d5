#include <pybind11/stl.h>

#include <utility>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "edit/cancel.h"
#include "edit/entity_names.h"
#include "edit/move.h"
#include "edit/region.h"
#include "edit/simplify.h"
#include "edit/smooth.h"

namespace stormfield::bindings {
namespace {

using Entity = std::pair<EntityKind, Index>;

EntityRef entityRef(const Entity& entity) {
  return {entity.first, entity.second};
}

/// Python's results of edits: with the mesh object that their fields live on.
struct EditHandle {
  std::shared_ptr<MeshHandle> mesh;
  std::shared_ptr<const EditResult> result;
};
struct SimplifyHandle {
  std::shared_ptr<MeshHandle> mesh;
  std::shared_ptr<const SimplifyResult> result;
};

/// What the work needs of its arguments, which it outlives.
struct Given {
  std::shared_ptr<MeshHandle> mesh;
  std::shared_ptr<const VectorField> field;
  std::shared_ptr<const Topology> topology;
};

Given given(const FieldHandle& field, const TopologyHandle& topology) {
  if (topology.mesh != field.mesh) {
    throw InputError("the topology is that of a field on another TriangleMesh; analyze this field");
  }
  return {field.mesh, std::make_shared<const VectorField>(field.field), topology.topology};
}

Work<EditHandle> prepareCancel(const FieldHandle& field, const TopologyHandle& topology, const Entity& a,
                               const Entity& b) {
  return [own = given(field, topology), a = entityRef(a), b = entityRef(b)](Progress& progress) {
    return EditHandle{own.mesh, std::make_shared<const EditResult>(cancelPair(*own.mesh->flatFaces(), *own.field,
                                                                              *own.topology, a, b, {}, &progress))};
  };
}

Work<EditHandle> prepareMove(const FieldHandle& field, const TopologyHandle& topology, Index point, Index face,
                             const ArrayArgument<double>& barycentric) {
  const auto b = inputArray<double>(barycentric, "barycentric", {3});
  const SurfacePoint target{face, {b.at(0), b.at(1), b.at(2)}};
  return [own = given(field, topology), point, target](Progress& progress) {
    return EditHandle{own.mesh, std::make_shared<const EditResult>(movePoint(
                                    *own.mesh->flatFaces(), *own.field, *own.topology, point, target, {}, &progress))};
  };
}

Work<SimplifyHandle> prepareSimplify(const FieldHandle& field, const TopologyHandle& topology,
                                     std::optional<double> epsilon, int keep) {
  SimplifyOptions options;
  if (epsilon) options.epsilon = *epsilon;
  options.keep = keep;
  return [own = given(field, topology), options](Progress& progress) {
    return SimplifyHandle{own.mesh, std::make_shared<const SimplifyResult>(simplifyField(
                                        *own.mesh->flatFaces(), *own.field, *own.topology, options, progress))};
  };
}

std::vector<Index> indexVector(const ArrayArgument<Index>& faces) {
  return toVector(inputArray<Index>(faces, "faces", {kAny}));
}

using IndexTuple = py::typing::Tuple<int, int, int>;

IndexTuple indexTuple(const ConleyIndex& index) {
  return py::make_tuple(index.b0, index.b1, index.b2);
}

void bindResults(py::module_& m) {
  py::class_<EditHandle>(m, "EditResult", py::module_local(),
                         "What cancelling a pair or moving a point gave. Immutable.")
      .def_property_readonly(
          "applied", [](const EditHandle& e) { return e.result->applied; },
          "Whether the field was changed, and the change verified.")
      .def_property_readonly(
          "reason", [](const EditHandle& e) { return e.result->reason; },
          "Why nothing was changed: one sentence; empty where the edit was applied.")
      .def_property_readonly(
          "field",
          [](const EditHandle& e) {
            return FieldHandle{e.mesh, e.result->field};
          },
          "The VectorField after the edit; as given, bit by bit, unless applied.")
      .def_property_readonly(
          "topology",
          [](const EditHandle& e) {
            return TopologyHandle{e.mesh, std::shared_ptr<const Topology>(e.result, &e.result->topology)};
          },
          "The Topology of that field.")
      .def_property_readonly(
          "index", [](const EditHandle& e) { return indexTuple(e.result->index); },
          "(b0, b1, b2): Conley index of the block.")
      .def_property_readonly(
          "left",
          [](const EditHandle& e) {
            py::typing::List<EntityTuple> result;
            for (const EntityRef& entity : e.result->left) result.append(entityTuple(entity));
            return result;
          },
          "list of (kind, number): entities of the topology that the edit left in its block.")
      .def_property_readonly(
          "faces", [](const EditHandle& e) { return copied(e.result->faces); }, "(k,) int32: the block.")
      .def_property_readonly(
          "vertices", [](const EditHandle& e) { return copied(e.result->vertices); },
          "(k,) int32: vertices whose vectors changed.")
      .def_property_readonly(
          "fill", [](const EditHandle& e) { return e.result->fill; }, "How the vectors were made.")
      .def_property_readonly(
          "largest_angle", [](const EditHandle& e) { return e.result->change.largestAngle; },
          "Between a vector before and after, radians.")
      .def_property_readonly(
          "largest_length", [](const EditHandle& e) { return e.result->change.largestLength; },
          "Of |after| / |before| - 1, in absolute value.")
      .def_property_readonly(
          "largest_change", [](const EditHandle& e) { return e.result->change.largest; },
          "Of |after - before|, mesh units per second.");
  py::class_<CancelPlan>(m, "CancelPlan", py::module_local(), "What cancelling a pair would do. Immutable.")
      .def_property_readonly(
          "index", [](const CancelPlan& p) { return indexTuple(p.index); }, "(b0, b1, b2): Conley index of the block.")
      .def_property_readonly(
          "left", [](const CancelPlan& p) { return describe(p.left); }, "What must remain, in words: one source.")
      .def_property_readonly(
          "faces", [](const CancelPlan& p) { return copied(p.faces); }, "(k,) int32: the first block to be tried.")
      .def_property_readonly(
          "saddles", [](const CancelPlan& p) { return copied(p.interval.saddles); },
          "(k,) int32, in Topology.fixed_points: saddles between the two, which are cancelled too.");
  py::class_<SimplifyStep>(m, "SimplifyStep", py::module_local(), "A pair that was tried. Immutable.")
      .def_readonly("pair", &SimplifyStep::pair, "Names and places.")
      .def_readonly("persistence", &SimplifyStep::persistence, "Mean speeds.")
      .def_readonly("applied", &SimplifyStep::applied, "Whether it was cancelled.")
      .def_readonly("reason", &SimplifyStep::reason, "Why not.");
  py::class_<SimplifyHandle>(m, "SimplifyResult", py::module_local(), "What simplifying a field gave. Immutable.")
      .def_property_readonly(
          "field",
          [](const SimplifyHandle& s) {
            return FieldHandle{s.mesh, s.result->field};
          },
          "The VectorField.")
      .def_property_readonly(
          "topology",
          [](const SimplifyHandle& s) {
            return TopologyHandle{s.mesh, std::shared_ptr<const Topology>(s.result, &s.result->topology)};
          },
          "The Topology of that field.")
      .def_property_readonly(
          "steps", [](const SimplifyHandle& s) { return s.result->steps; }, "list of SimplifyStep, in their order.")
      .def_property_readonly(
          "vertices", [](const SimplifyHandle& s) { return copied(s.result->vertices); },
          "(k,) int32: vertices whose vectors changed.")
      .def_property_readonly(
          "largest_angle", [](const SimplifyHandle& s) { return s.result->change.largestAngle; }, "Radians.")
      .def_property_readonly(
          "largest_length", [](const SimplifyHandle& s) { return s.result->change.largestLength; },
          "Of |after| / |before| - 1, in absolute value.")
      .def_property_readonly(
          "largest_change", [](const SimplifyHandle& s) { return s.result->change.largest; },
          "Of |after - before|, mesh units per second.");
}

void bindRegions(py::module_& m) {
  m.def(
      "faces_in_disc",
      [](const MeshHandle& mesh, const ArrayArgument<double>& center, double radius) {
        const auto c = inputArray<double>(center, "center", {3});
        const py::gil_scoped_release release;
        const Vec3 place(c.data()[0], c.data()[1], c.data()[2]);
        return facesInDisc(mesh.mesh(), mesh.closestPoints().closest(place).point, radius);
      },
      py::arg("mesh"), py::arg("center"), py::arg("radius"),
      "Faces within a radius (mesh units) of the point of the surface closest to center (3,) float64, as far as they\n"
      "hang together -> list of int, ascending. Raises InputError for a center of another shape.");
  m.def(
      "faces_in_loop",
      [](const MeshHandle& mesh, const ArrayArgument<double>& points) {
        const Points p = toPoints(inputArray<double>(points, "points", {kAny, 3}));
        const py::gil_scoped_release release;
        std::vector<Vec3> curve;
        for (Eigen::Index i = 0; i < p.rows(); ++i) curve.emplace_back(p.row(i));
        return facesInLoop(mesh.mesh(), mesh.closestPoints(), curve);
      },
      py::arg("mesh"), py::arg("points"),
      "Faces that a closed curve through points (k, 3) float64 crosses or cuts off -> list of int, ascending. Raises\n"
      "InputError for fewer than three points.");
}

}  // namespace

void bind_edit(py::module_& m) {
  bindResults(m);
  bindRegions(m);
  bindJob<EditHandle>(m, "EditJob", "A running edit.", [](const EditHandle& result) { return result; })
      .def(
          m, "cancel_pair", &prepareCancel,
          "Cancel a repeller and an attractor together with the saddles between them (thesis 4.3) -> EditResult.\n\n"
          "topology: of the field. a, b: (kind, number) as in Topology.links. What must remain follows from the "
          "Conley\n"
          "index. The new field is verified by its topology; where none is, the result says why, and nothing changed.\n"
          "Raises InputError for a topology of another mesh, and Cancelled.",
          py::arg("field"), py::arg("topology"), py::arg("a"), py::arg("b"))
      .def(m, "move_point", &prepareMove,
           "Move a fixed point along the surface, with the same graph (Zhang et al. 2006) -> EditResult.\n\n"
           "point: in Topology.fixed_points. face, barycentric (3,) float64: where it shall be.\n"
           "Raises InputError for a topology of another mesh, and Cancelled.",
           py::arg("field"), py::arg("topology"), py::arg("point"), py::arg("face"), py::arg("barycentric"));
  bindJob<SimplifyHandle>(m, "SimplifyJob", "A running simplification.", [](const SimplifyHandle& r) { return r; })
      .def(m, "simplify", &prepareSimplify,
           "Cancel linked pairs, the least persistent first, each verified -> SimplifyResult.\n\n"
           "epsilon: pairs up to this persistence, and the most that a vector may change, in mean speeds; None: any.\n"
           "keep: number of fixed points and periodic orbits at which to stop.\n"
           "Raises InputError for options below 0 and a topology of another mesh, and Cancelled.",
           py::arg("field"), py::arg("topology"), py::kw_only(), py::arg("epsilon") = py::none(), py::arg("keep") = 0);
  m.def(
      "plan_cancel",
      [](const FieldHandle& field, const TopologyHandle& topology, const Entity& a, const Entity& b) {
        const Given own = given(field, topology);
        const py::gil_scoped_release release;
        return planCancel(*own.field, *own.topology, entityRef(a), entityRef(b));
      },
      py::arg("field"), py::arg("topology"), py::arg("a"), py::arg("b"),
      "What cancel_pair would do, without doing it -> CancelPlan. Raises InputError where the two are no pair: the\n"
      "sentence says why, or which pair to cancel first.");
  m.def(
      "entity_name",
      [](const TopologyHandle& topology, const Entity& entity) {
        requireEntity(*topology.topology, entityRef(entity));
        return entityName(*topology.topology, topology.mesh->mesh(), entityRef(entity));
      },
      py::arg("topology"), py::arg("entity"), "What messages call an entity (kind, number): its kind and place.");
  m.def(
      "smooth_region",
      [](const FieldHandle& field, const ArrayArgument<Index>& faces) {
        const std::vector<Index> region = indexVector(faces);
        const py::gil_scoped_release release;
        return FieldHandle{field.mesh, smoothRegion(field.field, region).field};
      },
      py::arg("field"), py::arg("faces"),
      "Make the field inside a region of faces (k,) int32 the smoothest one that fits the vectors around (thesis 4.4) "
      "->\n"
      "VectorField; all other vectors keep their bits. Raises InputError for a region without a vertex inside or one "
      "that\n"
      "covers a surface, and SolverError.");
}

}  // namespace stormfield::bindings
