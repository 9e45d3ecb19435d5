# SPDX-License-Identifier: GPL-3.0-or-later
"""One edit of the field at one λ."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from .. import native
from ..model.edits import Edit, EntityAt, Vector
from ..model.errors import InputError
from ..work import Step, Steps, result_of

#: An entity must be found within this part of the mesh's size from where an edit says that it is.
NEAR = 0.1
#: How the kinds of fixed points and of orbits differ.
ORBITS = ("attracting", "repelling")
Kind = Literal["fixed_point", "periodic_orbit"]


@dataclass(frozen=True, eq=False)
class SampleEdit:
    """The field after the edit, or as it was, and what is known of it."""

    field: native.VectorField
    applied: bool
    reason: str = ""
    index: tuple[int, int, int] | None = None  #: Conley index of the block
    left: tuple[EntityAt, ...] = ()
    faces: tuple[int, ...] = ()
    fill: str = "none"
    largest_angle: float = 0.0  #: radians
    largest_length: float = 0.0


def edit_sample(field: native.VectorField, edit: Edit) -> Steps[SampleEdit]:
    """Applies the edit, or says why not."""
    try:
        if edit.type == "smooth":
            yield Step(0.0, "Smoothing")
            return _smoothed(field, edit)
        topology = yield from result_of(native.start_topology(field), 0.0, "Following the flow", 0.3)
        if edit.type == "simplify":
            simplifying = native.start_simplify(field, topology, epsilon=edit.epsilon, keep=edit.keep)
            return _simplified((yield from result_of(simplifying, 0.3, "Simplifying")), edit)
        return _verified((yield from result_of(_start(field, topology, edit), 0.3, "Verifying the edit")))
    except (InputError, native.SolverError) as fault:
        return SampleEdit(field, False, str(fault))


def _start(field: native.VectorField, topology: native.Topology, edit: Edit) -> native.EditJob:
    """Cancelling or moving, in the core."""
    found = [find_entity(field.mesh, topology, entity) for entity in edit.entities]
    if edit.type == "cancel":
        return native.start_cancel_pair(field, topology, found[0], found[1])
    faces, barycentric, _ = field.mesh.closest_points(np.array([edit.to]))
    return native.start_move_point(field, topology, found[0][1], int(faces[0]), np.array(barycentric[0]))


def _verified(result: native.EditResult) -> SampleEdit:
    return SampleEdit(
        result.field,
        result.applied,
        result.reason,
        result.index,
        tuple(entity_at(result.topology, kind, number or 0) for kind, number in result.left),
        tuple(int(face) for face in result.faces),
        result.fill,
        result.largest_angle,
        result.largest_length,
    )


def find_entity(mesh: native.TriangleMesh, topology: native.Topology, wanted: EntityAt) -> tuple[Kind, int]:
    """The entity of a kind that is nearest to a place, as (kind, number). Raises InputError where none is near."""
    orbit = wanted.kind in ORBITS
    places = (
        {k: found.points for k, found in enumerate(topology.periodic_orbits) if found.kind == wanted.kind}
        if orbit
        else {k: found.position[None] for k, found in enumerate(topology.fixed_points) if found.kind == wanted.kind}
    )
    at = np.array(wanted.at)
    distances = {k: float(np.linalg.norm(np.asarray(points) - at, axis=1).min()) for k, points in places.items()}
    name = f"{wanted.kind} orbit" if orbit else wanted.kind
    if not distances:
        raise InputError(f"the field has no {name} here; analyze it again and choose what is there")
    nearest = min(distances, key=lambda k: distances[k])
    reach = NEAR * mesh.size
    if distances[nearest] > reach:
        place = ", ".join(f"{value:g}" for value in wanted.at)
        raise InputError(
            f"there is no {name} within {reach:.3g} of ({place}); the nearest is {distances[nearest]:.3g} away: "
            "analyze the field again and choose what is there"
        )
    return ("periodic_orbit" if orbit else "fixed_point"), nearest


def region_faces(mesh: native.TriangleMesh, edit: Edit) -> np.ndarray:
    """(k,) int32. Raises InputError for a region that holds no face."""
    region = edit.region
    if region.center is not None:
        faces = native.faces_in_disc(mesh, np.array(region.center), region.radius)
    elif region.loop:
        faces = native.faces_in_loop(mesh, np.array(region.loop))
    else:
        faces = list(region.faces)
    if not len(faces):
        raise InputError("the region holds no whole face of the mesh; make it larger")
    return np.array(faces, np.int32)


def _smoothed(field: native.VectorField, edit: Edit) -> SampleEdit:
    faces = region_faces(field.mesh, edit)
    smooth = native.smooth_region(field, faces)
    angle, length = change_between(np.asarray(field.values), np.asarray(smooth.values))
    return SampleEdit(
        smooth,
        True,
        faces=tuple(int(face) for face in faces),
        fill="harmonic",
        largest_angle=angle,
        largest_length=length,
    )


def change_between(before: np.ndarray, after: np.ndarray) -> tuple[float, float]:
    """Largest angle (radians) and relative length between complex vectors before and after."""
    both = (before != after) & (before != 0.0) & (after != 0.0)
    ratio = after[both] / before[both]
    angle = float(np.abs(np.angle(ratio)).max(initial=0.0))
    return angle, float(np.abs(np.abs(ratio) - 1.0).max(initial=0.0))


def _simplified(result: native.SimplifyResult, edit: Edit) -> SampleEdit:
    count = len(result.topology.fixed_points) + len(result.topology.periodic_orbits)
    applied = any(step.applied for step in result.steps)
    refused = [step for step in result.steps if not step.applied]
    reason = ""
    if edit.keep and count > edit.keep:
        reason = f"{count} fixed points and periodic orbits are left instead of {edit.keep}"
        reason += f": {refused[-1].reason}" if refused else ": no further pair is within epsilon, or can be cancelled"
    elif not applied and refused:
        reason = refused[-1].reason
    left = [entity_at(result.topology, "fixed_point", k) for k in range(len(result.topology.fixed_points))]
    left += [entity_at(result.topology, "periodic_orbit", k) for k in range(len(result.topology.periodic_orbits))]
    return SampleEdit(
        result.field,
        applied or not reason,
        reason,
        left=tuple(left),
        fill="directions" if applied else "none",
        largest_angle=result.largest_angle,
        largest_length=result.largest_length,
    )


def entity_at(topology: native.Topology, kind: str, number: int) -> EntityAt:
    """An entity of a topology, as edits name it."""
    if kind == "fixed_point":
        point = topology.fixed_points[number]
        return EntityAt(point.kind, _vector(point.position))
    orbit = topology.periodic_orbits[number]
    return EntityAt(orbit.kind, _vector(orbit.points[0]))


def _vector(place: np.ndarray) -> Vector:
    x, y, z = (float(value) for value in place)
    return x, y, z
