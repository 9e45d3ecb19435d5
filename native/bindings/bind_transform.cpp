#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "edit/transform.h"

namespace stormfield::bindings {
namespace {

constexpr py::ssize_t kKeyMembers = 4;

std::vector<TransformKey> inputKeys(const ArrayArgument<double>& keys) {
  const auto k = inputArray<double>(keys, "keys", {kAny, kKeyMembers});
  std::vector<TransformKey> result;
  for (py::ssize_t i = 0; i < k.shape(0); ++i) result.push_back({k.at(i, 0), k.at(i, 1), k.at(i, 2), k.at(i, 3)});
  return result;
}

ParameterizedFieldHandle transform(const ParameterizedFieldHandle& field, const ArrayArgument<double>& keys,
                                   TransformOf source, const std::optional<ArrayArgument<double>>& weights,
                                   const std::optional<ArrayArgument<Complex>>& axes) {
  TransformOptions options{inputKeys(keys), source, {}, {}};
  if (weights) options.weights = toVector(inputArray<double>(*weights, "weights", {kAny}));
  if (axes) {
    const Shape shape{field.field.sampleCount(), field.field.vertexCount()};
    options.axes = toVector(inputArray<Complex>(*axes, "axes", shape));
  }
  const py::gil_scoped_release release;
  return {field.mesh, transformField(field.field, options)};
}

}  // namespace

void bind_transform(py::module_& m) {
  m.def("transform_field", &transform, py::arg("field"), py::arg("keys"), py::kw_only(),
        py::arg("source") = TransformOf::FieldAsItIs, py::arg("weights") = py::none(), py::arg("axes") = py::none(),
        "Turn, scale and stretch a ParameterizedField over lambda (thesis 11.1.3.4) -> ParameterizedField.\n\n"
        "keys: (k, 4) float64, lambda, angle (radians, counter-clockwise), scale and stretch (factors above 0). In "
        "between the\n"
        "angle is linear and the factors are geometric; before the first key nothing changes, after the last one it "
        "stays.\n"
        "source: of the field as it is, or as it is at the first key. weights: (n,) float64, 0 to 1, how much of it a\n"
        "vertex gets; None: all. axes: (s, n) complex128, no longer than 1, along what is stretched.\n"
        "Raises InputError for keys, weights and axes that do not fit, and for a stretch without axes.");
  m.def(
      "falloff_weights",
      [](const MeshHandle& mesh, const ArrayArgument<Index>& faces, double falloff) {
        const std::vector<Index> region = toVector(inputArray<Index>(faces, "faces", {kAny}));
        std::vector<double> weights;
        {
          const py::gil_scoped_release release;
          weights = falloffWeights(mesh.mesh(), region, falloff);
        }
        return copied(weights);
      },
      py::arg("mesh"), py::arg("faces"), py::arg("falloff"),
      "(n,) float64: 1 at vertices of these faces (k,) int32, falling smoothly to 0 at a distance from them (mesh "
      "units,\n"
      "along edges). Raises InputError for a face that does not exist and a negative distance.");
}

}  // namespace stormfield::bindings
