// Points of curves on the surface as arrays: positions, faces and coordinates in them, the same for every kind of
// curve.
#pragma once

#include <cstdint>
#include <vector>

#include "bindings/bindings.h"
#include "mesh/surface_point.h"

namespace stormfield::bindings {

py::array_t<double> positionsOf(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points);
py::array_t<Index> facesOf(const std::vector<SurfacePoint>& points);
py::array_t<double> barycentricOf(const std::vector<SurfacePoint>& points);

/// The properties offsets, points, faces and barycentric of a handle that holds its mesh and, in the given member,
/// lines that follow each other in one list of points.
template <typename Class, typename Lines>
void bindLinePoints(Class& handles, Lines Class::type::*lines) {
  using Handle = typename Class::type;
  handles
      .def_property_readonly(
          "offsets",
          [=](const Handle& h) {
            const auto& offsets = (h.*lines).offsets;
            return copied(std::vector<std::int64_t>(offsets.begin(), offsets.end()));
          },
          "(k + 1,) int64.")
      .def_property_readonly(
          "points", [=](const Handle& h) { return positionsOf(h.mesh->mesh(), (h.*lines).points); },
          "(p, 3) float64, positions in mesh units.")
      .def_property_readonly(
          "faces", [=](const Handle& h) { return facesOf((h.*lines).points); }, "(p,) int32.")
      .def_property_readonly(
          "barycentric", [=](const Handle& h) { return barycentricOf((h.*lines).points); },
          "(p, 3) float64, coordinates in the faces.");
}

}  // namespace stormfield::bindings
