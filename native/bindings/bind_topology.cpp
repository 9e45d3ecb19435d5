#include "bindings/bindings.h"

namespace stormfield::bindings {

void bind_topology(py::module_&) {}

}  // namespace stormfield::bindings
