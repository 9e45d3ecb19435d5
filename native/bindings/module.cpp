// The Python module stormfield_native.
#include "bindings/bindings.h"

PYBIND11_MODULE(stormfield_native, m) {
  using namespace stormfield::bindings;
  m.doc() = "The compiled core of Stormfield. Lengths are mesh units, angles radians, vectors mesh units per second.";
  m.attr("__version__") = STORMFIELD_VERSION;
  bind_base(m);
  bind_mesh(m);
  bind_mesh_job(m);
  bind_field(m);
  bind_tracing(m);
  bind_topology(m);
  bind_edit(m);
  bind_transform(m);
  bind_tracking(m);
  bind_morse(m);
  bind_morse_maps(m);
  bind_streamlines(m);
  bind_solver(m);
  bind_design(m);
  bind_texture(m);
  bind_io(m);
}
