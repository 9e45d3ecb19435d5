// What a message calls an entity of a topology: its kind and its place.
//
//   const std::string name = entityName(topology, mesh, {EntityKind::FixedPoint, 3});   // "sink at (0.1, 0.25, 0)"
#pragma once

#include <string>

#include "topology/topology.h"

namespace stormfield {

/// Throws InputError for a vector that is not finite.
void requireFinite(const VectorField& field);
/// Throws InputError where the topology has no such fixed point or periodic orbit.
void requireEntity(const Topology& topology, const EntityRef& entity);
/// A fixed point's position, or that of the first point of an orbit.
Vec3 entityPlace(const Topology& topology, const TriangleMesh& mesh, const EntityRef& entity);
/// Precondition: the entity is a fixed point or a periodic orbit of the topology.
std::string entityName(const Topology& topology, const TriangleMesh& mesh, const EntityRef& entity);

}  // namespace stormfield
