#include <pybind11/stl.h>

#include "bindings/bindings.h"
#include "bindings/job.h"
#include "texture/advected_coordinates.h"
#include "texture/flow_attributes.h"
#include "texture/stagger.h"
#include "texture/stream_function.h"

namespace stormfield::bindings {
namespace {

using Coordinates = std::shared_ptr<const AdvectedCoordinates>;
using ProgressPointer = std::shared_ptr<Progress>;

using FrameArrays = py::typing::Tuple<py::array_t<float>, py::array_t<float>, py::array_t<float>>;

/// Python's AdvectedCoordinates; it shares what it needs with the jobs it starts.
struct CoordinatesHandle {
  Coordinates coordinates;
};

using FieldPointer = std::shared_ptr<ParameterizedFieldHandle>;

struct StreamFunctions {
  py::ssize_t samples, vertices;
  std::vector<double> values;
};

/// What Python gets of some samples of both fields. orientation: empty where both are one field.
struct FieldAttributes {
  py::ssize_t samples, vertices;
  FlowAttributes flow;
  std::vector<float> orientation;
};
using AttributesPointer = std::shared_ptr<const FieldAttributes>;

CoordinatesHandle makeCoordinates(const ParameterizedFieldHandle& field, const ArrayArgument<double>& frames,
                                  const ArrayArgument<double>& lambdas, double framesPerSecond, double period,
                                  double speed, double deadZone, double renewal, double tolerance, std::uint64_t seed,
                                  double staggerCycles, double staggerFrequency,
                                  const std::optional<ArrayArgument<double>>& offsets) {
  const auto f = inputArray<double>(frames, "frames", {kAny});
  const auto l = inputArray<double>(lambdas, "lambdas", {f.shape(0)});
  const TriangleMesh& mesh = field.mesh->mesh();
  std::vector<double> o;
  if (offsets) o = toVector(inputArray(*offsets, "offsets", {mesh.vertexCount()}));
  const AdvectionOptions options{framesPerSecond, period, speed, deadZone, renewal, tolerance, seed};
  const std::vector<double> frameNumbers = toVector(f), lambdaValues = toVector(l);
  const bool noise = !offsets;
  const py::gil_scoped_release release;
  if (noise) o = stagger(mesh, {staggerCycles, staggerFrequency, seed}, deadZone);
  return {std::make_shared<const AdvectedCoordinates>(field.mesh->flatFaces(),
                                                      std::make_shared<const ParameterizedField>(field.field),
                                                      frameNumbers, lambdaValues, options, std::move(o))};
}

FrameArrays toPython(const AdvectedFrame& frame) {
  const auto n = static_cast<py::ssize_t>(frame.blend.size());
  const auto coordinates = [&](const std::vector<float>& values) {
    return py::array_t<float>({n, py::ssize_t{3}}, values.data());
  };
  return py::make_tuple(coordinates(frame.phaseA), coordinates(frame.phaseB), copied(frame.blend));
}

FrameArrays oneFrame(const CoordinatesHandle& self, double frame, const ProgressPointer& progress) {
  AdvectedFrame result;
  {
    const py::gil_scoped_release release;
    result = self.coordinates->frame(frame, progress.get());
  }
  return toPython(result);
}

Work<std::vector<AdvectedFrame>> prepareFrames(const CoordinatesHandle& self, const std::vector<double>& frames) {
  return [coordinates = self.coordinates, frames](Progress& progress) {
    std::vector<AdvectedFrame> result;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      progress.check();
      // One frame reports for itself; of several, each is a step.
      result.push_back(coordinates->frame(frames[i], frames.size() == 1 ? &progress : nullptr));
      progress.report(static_cast<double>(i + 1) / static_cast<double>(frames.size()));
    }
    return result;
  };
}

py::typing::Dict<std::string, double> carriedError(const CoordinatesHandle& self, double frame, Index samples) {
  CarriedError error;
  {
    const py::gil_scoped_release release;
    error = self.coordinates->error(frame, samples);
  }
  py::typing::Dict<std::string, double> result;
  result["mean"] = error.mean;
  result["largest"] = error.largest;
  result["mean_between"] = error.meanBetween;
  return result;
}

Work<StreamFunctions> prepareStreamFunctions(const FieldPointer& handle) {
  return [handle](Progress& progress) {
    const ParameterizedField& field = handle->field;
    return StreamFunctions{field.sampleCount(), field.vertexCount(),
                           streamFunctions(field, handle->mesh->streamFunctions(), &progress)};
  };
}

Work<bool> prepareFactor(const std::shared_ptr<MeshHandle>& mesh) {
  return [mesh](Progress&) {
    mesh->streamFunctions();
    return true;
  };
}

Work<AttributesPointer> prepareAttributes(const FieldPointer& orientation, const FieldPointer& advection, Index first,
                                          Index count) {
  const Index samples = advection->field.sampleCount();
  if (orientation->field.sampleCount() != samples ||
      orientation->field.vertexCount() != advection->field.vertexCount()) {
    throw InputError("the two fields have other samples or lie on other meshes; give two of one solve");
  }
  if (first < 0 || count < 1 || count > samples - first) {
    throw InputError(message("samples ", first, " to ", first + count - 1, " do not exist; the field has samples 0 to ",
                             samples - 1));
  }
  return [=](Progress& progress) {
    FieldAttributes result{count, advection->field.vertexCount(), {}, {}};
    result.flow = flowAttributes(advection->field, first, count, advection->mesh->streamFunctions(), &progress);
    if (orientation != advection) {
      result.orientation = vectorsInSpace(orientation->field, first, count, &progress);
    }
    return std::make_shared<const FieldAttributes>(std::move(result));
  };
}

py::array_t<double> toArray(const StreamFunctions& psi) {
  return py::array_t<double>({psi.samples, psi.vertices}, psi.values.data());
}

void bindCoordinates(py::module_& m) {
  const AdvectionOptions defaults;
  const StaggerOptions noise;
  py::class_<CoordinatesHandle> handles(
      m, "AdvectedCoordinates", py::module_local(),
      "Texture coordinates that flow with an advection field: two phases per vertex, each the place where the "
      "material\n"
      "of the vertex was when its cycle began, plus a random vector per cycle. Every frame is computed from scratch, "
      "so\n"
      "any part of an animation gives the same bytes. Shaders blend the texture T (mean m) of both phases as\n"
      "m + (w_a (T(a) - m) + w_b (T(b) - m)) / sqrt(w_a^2 + w_b^2) with w_b = blend, w_a = 1 - blend.");
  handles
      .def(
          py::init(&makeCoordinates), py::arg("field"), py::arg("frames"), py::arg("lambdas"), py::kw_only(),
          py::arg("frames_per_second") = defaults.framesPerSecond, py::arg("period") = defaults.period,
          py::arg("speed") = defaults.speed, py::arg("dead_zone") = defaults.deadZone,
          py::arg("renewal") = defaults.renewal, py::arg("tolerance") = defaults.tolerance,
          py::arg("seed") = defaults.seed, py::arg("stagger_cycles") = noise.cycles,
          py::arg("stagger_frequency") = noise.frequency, py::arg("offsets") = py::none(),
          "field: ParameterizedField, mesh units per second. frames (s,) float64: increasing frame numbers "
          "(sub-frames\n"
          "allowed), lambdas (s,) float64 there; linear between, constant outside. period: frames until a phase "
          "starts\n"
          "anew. speed: factor on the field. dead_zone: part of a period before and after a start that is invisible.\n"
          "renewal: range of the random vectors in sizes of the object, 0 for plain positions. tolerance: of the "
          "tracer,\n"
          "mean edge lengths per step. stagger_cycles, stagger_frequency: how far phases differ over the object, and "
          "in\n"
          "how many lumps per size; or give offsets (n,) float64 in periods. Raises InputError, naming the edge where\n"
          "offsets are too steep for the dead zone.")
      .def("frame", &oneFrame, py::arg("frame"), py::arg("progress") = ProgressPointer(),
           "(phase_a (n, 3) float32, phase_b (n, 3) float32, blend (n,) float32) of one frame. Raises Cancelled.")
      .def("error", &carriedError, py::arg("frame"), py::arg("samples") = 1000,
           "Distance to much finer traces in mean edge lengths: mean and largest at vertices, and mean_between, the "
           "mean\n"
           "at face centers, where coordinates are interpolated.")
      .def_property_readonly(
          "offsets", [](const CoordinatesHandle& self) { return copied(self.coordinates->offsets()); },
          "(n,) float64, phase offset of each vertex in periods.");
  bindJob<std::vector<AdvectedFrame>>(m, "AdvectionJob", "Frames of AdvectedCoordinates that are being made.",
                                      [](const std::vector<AdvectedFrame>& frames) {
                                        py::typing::List<FrameArrays> result;
                                        for (const AdvectedFrame& frame : frames) result.append(toPython(frame));
                                        return result;
                                      })
      .def(handles, "frames", &prepareFrames,
           "A list of (phase_a (n, 3) float32, phase_b (n, 3) float32, blend (n,) float32), one per frame. Raises "
           "Cancelled.",
           py::arg("frames"));
}

/// A property of FieldAttributes: a view of these numbers, `width` for each vertex.
template <typename Member>
auto viewOf(const Member& member, py::ssize_t width) {
  return [member, width](const py::object& self) {
    const auto& attributes = self.cast<const FieldAttributes&>();
    Shape shape{attributes.samples, attributes.vertices};
    if (width > 1) shape.push_back(width);
    return readOnlyView(member(attributes).data(), shape, self);
  };
}

void bindAttributes(py::module_& m) {
  using A = FieldAttributes;
  py::class_<A, std::shared_ptr<A>>(
      m, "FieldAttributes", py::module_local(),
      "What a cache holds of some samples of two fields, float32, mesh units and seconds.")
      .def_property_readonly(
          "orientation",
          viewOf(
              [](const A& a) -> const auto& { return a.orientation.empty() ? a.flow.vectors : a.orientation; }, 3),
          "(k, n, 3): vectors in space.")
      .def_property_readonly("advection",
                             viewOf(
                                 [](const A& a) -> const auto& { return a.flow.vectors; }, 3),
                             "(k, n, 3): vectors in space.")
      .def_property_readonly("speed",
                             viewOf(
                                 [](const A& a) -> const auto& { return a.flow.speed; }, 1),
                             "(k, n): of the advection field.")
      .def_property_readonly("stream",
                             viewOf(
                                 [](const A& a) -> const auto& { return a.flow.stream; }, 1),
                             "(k, n): stream function of the advection field.")
      .def_property_readonly(
          "rotation",
          viewOf(
              [](const A& a) -> const auto& { return a.flow.rotation; }, 1),
          "(k, n): n . curl V of the advection field, twice the angular speed of the surface, radians "
          "per second, positive\n"
          "counter-clockwise seen from outside; 0 at vertices without faces.");
  bindJob<AttributesPointer>(
      m, "FieldAttributesJob", "Attributes of samples that are being computed.",
      [](const AttributesPointer& found) { return std::const_pointer_cast<FieldAttributes>(found); })
      .def(
          m, "field_attributes", &prepareAttributes,
          "FieldAttributes of `count` samples, from sample `first` on, of two ParameterizedFields on one mesh. Raises\n"
          "InputError for samples that do not exist, SolverError where the stream function cannot be found, Cancelled.",
          py::arg("orientation"), py::arg("advection"), py::arg("first"), py::arg("count"));
  bindJob<bool>(m, "StreamFactorJob", "A factor for stream functions that is being made.",
                [](bool) { return py::none(); })
      .def(m, "stream_factor", &prepareFactor,
           "Factorizes what the stream functions of all fields on a mesh share; the mesh keeps it. Raises SolverError.",
           py::arg("mesh"));
}

}  // namespace

void bind_texture(py::module_& m) {
  bindCoordinates(m);
  bindAttributes(m);
  bindJob<StreamFunctions>(m, "StreamFunctionsJob", "Stream functions that are being solved for.",
                           [](const StreamFunctions& psi) { return toArray(psi); })
      .def(m, "stream_functions", &prepareStreamFunctions,
           "Stream function of every sample of a ParameterizedField, (s, n) float64, squared mesh units per second.\n\n"
           "The flow's rotational part follows its level curves and has larger values on its left. Mean zero on each\n"
           "component, and continuous in lambda. Raises Cancelled.",
           py::arg("field"));
}

}  // namespace stormfield::bindings
