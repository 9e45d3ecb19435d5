#include "edit/entity_names.h"

#include "base/message.h"

namespace stormfield {

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
