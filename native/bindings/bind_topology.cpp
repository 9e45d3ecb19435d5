#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "bindings/surface_points.h"
#include "topology/fixed_points.h"
#include "topology/topology.h"

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

/// Python's orbits and separatrices, which share the result.
struct OrbitHandle {
  std::shared_ptr<MeshHandle> mesh;
  std::shared_ptr<const Topology> topology;
  const PeriodicOrbit* orbit;
};
struct SeparatrixHandle {
  std::shared_ptr<MeshHandle> mesh;
  std::shared_ptr<const Topology> topology;
  const Separatrix* separatrix;
};

Work<TopologyHandle> prepareTopology(const FieldHandle& field, double relativeTolerance, double tolerance,
                                     double bandTolerance, Index maxSteps) {
  TopologyOptions options;
  options.fixedPoints.relativeTolerance = relativeTolerance;
  options.tolerance = tolerance;
  options.bandTolerance = bandTolerance;
  options.maxSteps = maxSteps;
  // The work outlives the arguments, so it has a copy.
  return [mesh = field.mesh, own = std::make_shared<const VectorField>(field.field), options](Progress& p) {
    auto topology = std::make_shared<const Topology>(findTopology(*mesh->flatFaces(), *own, options, &p));
    return TopologyHandle{mesh, topology};
  };
}

template <typename Handle, typename Item>
py::typing::List<Handle> handles(const TopologyHandle& self, const std::vector<Item>& items) {
  py::typing::List<Handle> result;
  for (const Item& item : items) result.append(Handle{self.mesh, self.topology, &item});
  return result;
}

void bindCurves(py::module_& m) {
  py::class_<BoundaryPoint>(m, "BoundaryPoint", py::module_local(),
                            "Where the flow along the boundary changes between entering and leaving. Immutable.")
      .def_property_readonly(
          "position", [](const BoundaryPoint& p) { return vectorArray(p.position); }, "(3,) float64, mesh units.")
      .def_property_readonly(
          "face", [](const BoundaryPoint& p) { return p.point.face; }, "Face that holds the point.")
      .def_property_readonly(
          "index", [](const BoundaryPoint& p) { return 0.5 * p.halfIndex; },
          "+0.5 where a trajectory touches the boundary from outside, -0.5 from inside (others at vertices only). "
          "With\n"
          "the fixed points' indices these add up to the Euler characteristic.");
  py::class_<OrbitHandle>(m, "PeriodicOrbit", py::module_local(), "A closed streamline. Immutable.")
      .def_property_readonly(
          "kind", [](const OrbitHandle& o) { return o.orbit->kind; },
          "attracting, repelling, center (one of a band of closed streamlines) or degenerate (attracting on one side).")
      .def_property_readonly(
          "points", [](const OrbitHandle& o) { return positionsOf(o.mesh->mesh(), o.orbit->points); },
          "(k, 3) float64 along the flow, mesh units; the first is repeated at the end.")
      .def_property_readonly(
          "faces", [](const OrbitHandle& o) { return facesOf(o.orbit->points); }, "(k,) int32.")
      .def_property_readonly(
          "barycentric", [](const OrbitHandle& o) { return barycentricOf(o.orbit->points); }, "(k, 3) float64.")
      .def_property_readonly(
          "times", [](const OrbitHandle& o) { return copied(o.orbit->times); }, "(k,) float64, seconds.")
      .def_property_readonly(
          "length", [](const OrbitHandle& o) { return o.orbit->length; }, "Mesh units.")
      .def_property_readonly(
          "period", [](const OrbitHandle& o) { return o.orbit->period; }, "Seconds.")
      .def_property_readonly(
          "multiplier", [](const OrbitHandle& o) { return o.orbit->multiplier; },
          "Derivative of the return map: < 1 attracting, > 1 repelling.")
      .def_property_readonly(
          "band", [](const OrbitHandle& o) { return o.orbit->kind == OrbitKind::Center; },
          "Whether it stands for a whole band of closed streamlines.")
      .def("__repr__", [](const OrbitHandle& o) {
        return message("<PeriodicOrbit ", name(o.orbit->kind), " length ", o.orbit->length, ">");
      });
  py::class_<SeparatrixHandle>(m, "Separatrix", py::module_local(),
                               "Curve from a saddle to what it comes from or goes to. Immutable.")
      .def_property_readonly(
          "saddle", [](const SeparatrixHandle& s) { return s.separatrix->saddle; }, "In Topology.fixed_points.")
      .def_property_readonly(
          "outgoing", [](const SeparatrixHandle& s) { return s.separatrix->outgoing; },
          "Whether the flow goes away from the saddle.")
      .def_property_readonly(
          "end", [](const SeparatrixHandle& s) { return entityTuple(s.separatrix->end); },
          "(kind, number): fixed_point or periodic_orbit with its number, or boundary or none with None.")
      .def_property_readonly(
          "points", [](const SeparatrixHandle& s) { return positionsOf(s.mesh->mesh(), s.separatrix->points); },
          "(k, 3) float64 from the saddle, mesh units.")
      .def_property_readonly(
          "faces", [](const SeparatrixHandle& s) { return facesOf(s.separatrix->points); }, "(k,) int32.")
      .def_property_readonly(
          "barycentric", [](const SeparatrixHandle& s) { return barycentricOf(s.separatrix->points); },
          "(k, 3) float64.")
      .def_property_readonly(
          "times", [](const SeparatrixHandle& s) { return copied(s.separatrix->times); },
          "(k,) float64, seconds from the second point.")
      .def_property_readonly(
          "length", [](const SeparatrixHandle& s) { return s.separatrix->length; }, "Mesh units.");
}

void bindResult(py::module_& m) {
  py::class_<TopologyHandle>(
      m, "Topology", py::module_local(),
      "The topology of a field: its entities, and the entity connection graph that links them. Immutable.")
      .def_property_readonly(
          "fixed_points", [](const TopologyHandle& self) { return self.topology->fixedPoints; },
          "list of FixedPoint, in face order.")
      .def_property_readonly(
          "boundary_points", [](const TopologyHandle& self) { return self.topology->boundaryPoints; },
          "list of BoundaryPoint, loop by loop.")
      .def_property_readonly(
          "periodic_orbits",
          [](const TopologyHandle& self) { return handles<OrbitHandle>(self, self.topology->periodicOrbits); },
          "list of PeriodicOrbit.")
      .def_property_readonly(
          "separatrices",
          [](const TopologyHandle& self) { return handles<SeparatrixHandle>(self, self.topology->separatrices); },
          "list of Separatrix, by saddle.")
      .def_property_readonly(
          "links",
          [](const TopologyHandle& self) {
            py::typing::List<py::typing::Tuple<EntityTuple, EntityTuple, std::vector<Index>>> result;
            for (const EntityLink& link : self.topology->links) {
              result.append(py::make_tuple(entityTuple(link.source), entityTuple(link.target), link.separatrices));
            }
            return result;
          },
          "list of (source, target, separatrices): entities as (kind, number), kind fixed_point or periodic_orbit; "
          "the\n"
          "numbers of the separatrices that make the link, none where a whole basin does. With the flow.")
      .def_property_readonly(
          "zero_faces", [](const TopologyHandle& self) { return self.topology->zeros.faces; },
          "Number of faces with three zero vectors.")
      .def_property_readonly(
          "zero_vertices", [](const TopologyHandle& self) { return self.topology->zeros.vertices; },
          "Number of vertices with a zero vector.")
      .def_property_readonly(
          "seconds", [](const TopologyHandle& self) { return self.topology->seconds; }, "dict, seconds by phase.");
  const TopologyOptions defaults;
  bindJob<TopologyHandle>(m, "TopologyJob", "The search for a field's topology.",
                          [](const TopologyHandle& result) { return result; })
      .def(
          m, "topology", &prepareTopology,
          "The whole topology of a VectorField (thesis 2.2, 3.1, 3.2) -> Topology.\n\n"
          "relative_tolerance: as in fixed_points. tolerance: of one step of a streamline, in mean edge lengths.\n"
          "band_tolerance: a closed streamline whose neighbours, half an edge away, return to within this fraction of\n"
          "that distance stands for a band. max_steps: integration steps, as a rule one for each face, after which a\n"
          "streamline ends in nothing known. The same result for any number of threads. Memory: about 500 bytes per "
          "face, the\n"
          "mesh included (2.5 GB for 5 million faces). Raises InputError and Cancelled.",
          py::arg("field"), py::kw_only(), py::arg("relative_tolerance") = defaults.fixedPoints.relativeTolerance,
          py::arg("tolerance") = defaults.tolerance, py::arg("band_tolerance") = defaults.bandTolerance,
          py::arg("max_steps") = defaults.maxSteps);
}

}  // namespace

EntityTuple entityTuple(const EntityRef& entity) {
  return py::make_tuple(entity.kind, entity.index == kNone ? std::nullopt : std::optional<Index>(entity.index));
}

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
          "kind", [](const FixedPoint& p) { return p.kind; }, "source, sink, saddle, center or degenerate.")
      .def_property_readonly("jacobian", &jacobianArray, "(2, 2) float64 in the flat frame of the face, 1/s.")
      .def_readonly("rotation", &FixedPoint::rotation, "Curl, 1/s: > 0 is counter-clockwise seen from outside.")
      .def_property_readonly(
          "eigenvalues", [](const FixedPoint& p) { return py::make_tuple(p.eigenvalues[0], p.eigenvalues[1]); },
          "2 complex, 1/s: by falling real part, or a conjugate pair.")
      .def_property_readonly(
          "eigenvectors",
          [](const FixedPoint& p) {
            return py::make_tuple(vectorArray(p.eigenvectors[0]), vectorArray(p.eigenvectors[1]));
          },
          "2 of (3,) float64, unit vectors; zero where the eigenvalues are not real.")
      .def_property_readonly(
          "separatrix_directions",
          [](const FixedPoint& p) {
            py::typing::List<py::typing::Tuple<py::array_t<double>, bool>> result;
            for (const SeparatrixDirection& d : p.separatrices) {
              result.append(py::make_tuple(vectorArray(d.inSpace), d.outgoing));
            }
            return result;
          },
          "list of ((3,) float64 unit vector, outgoing): where separatrices leave and enter a saddle.")
      .def("__repr__", [](const FixedPoint& p) {
        return message("<FixedPoint ", name(p.kind), " index ", p.index, " in face ", p.point.face, ">");
      });

  m.def("fixed_points", &fixedPoints, py::arg("field"),
        py::arg("relative_tolerance") = FixedPointOptions().relativeTolerance,
        "Fixed points of a VectorField, in face order. relative_tolerance: |trace| below this fraction of the rotation "
        "counts\n"
        "as a center, |det| below its square (relative to the Jacobian) as degenerate.");
  bindCurves(m);
  bindResult(m);
}

}  // namespace stormfield::bindings
