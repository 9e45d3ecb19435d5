#include "edit/entity_names.h"

#include <cmath>

#include "base/error.h"
#include "base/message.h"

namespace stormfield {

void requireFinite(const VectorField& field) {
  for (std::size_t v = 0; v < field.values.size(); ++v) {
    if (std::isfinite(field.values[v].real()) && std::isfinite(field.values[v].imag())) continue;
    throw InputError(message("the vector of vertex ", v, " is not finite; replace it first"));
  }
}

void requireEntity(const Topology& topology, const EntityRef& entity) {
  const std::size_t count = entity.kind == EntityKind::FixedPoint      ? topology.fixedPoints.size()
                            : entity.kind == EntityKind::PeriodicOrbit ? topology.periodicOrbits.size()
                                                                       : 0;
  if (entity.index < 0 || static_cast<std::size_t>(entity.index) >= count) {
    throw InputError(message("there is no entity ", entity.index,
                             " of this kind in the topology of the field; analyze ", "the field again"));
  }
}

Vec3 entityPlace(const Topology& topology, const TriangleMesh& mesh, const EntityRef& entity) {
  if (entity.kind == EntityKind::FixedPoint) return topology.fixedPoints[entity.index].position;
  return position(mesh, topology.periodicOrbits[entity.index].points.front());
}

std::string entityName(const Topology& topology, const TriangleMesh& mesh, const EntityRef& entity) {
  const Vec3 p = entityPlace(topology, mesh, entity);
  std::string what;
  if (entity.kind == EntityKind::FixedPoint) {
    const FixedPointKind kind = topology.fixedPoints[entity.index].kind;
    what = message(name(kind), kind == FixedPointKind::Degenerate ? " fixed point" : "");
  } else {
    what = message(name(topology.periodicOrbits[entity.index].kind), " orbit");
  }
  return message(what, " at (", p.x(), ", ", p.y(), ", ", p.z(), ")");
}

}  // namespace stormfield
