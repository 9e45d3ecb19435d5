# SPDX-License-Identifier: GPL-3.0-or-later
"""Turning, scaling and stretching a field over λ, everywhere or in a region (thesis 11.1.3.4)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .. import native
from ..model.edits import Edit
from ..model.errors import InputError
from ..model.transform import Transform
from .single import SampleEdit, change_between, region_faces


def transformed(
    field: native.ParameterizedField, edit: Edit, orientation: native.ParameterizedField
) -> tuple[native.ParameterizedField, SampleEdit]:
    """The field after the edit, or as it was, and what is known of it. orientation: along which it may stretch."""
    turn = edit.transform or Transform()
    try:
        faces = region_faces(field.mesh, edit) if edit.has_region else np.zeros(0, np.int32)
        weights = native.falloff_weights(field.mesh, faces, turn.falloff) if edit.has_region else None
        after = native.transform_field(
            field,
            turn.keys(),
            source="frozen" if turn.frozen else "as_it_is",
            weights=weights,
            axes=_axes(field, turn, orientation) if turn.stretch else None,
        )
    except InputError as fault:
        return field, SampleEdit(field.sample(0), False, str(fault))
    angle, length = change_between(np.asarray(field.values), np.asarray(after.values))
    done = SampleEdit(after.sample(0), True, faces=tuple(int(face) for face in faces), fill="none")
    return after, replace(done, largest_angle=angle, largest_length=length)


def _axes(field: native.ParameterizedField, turn: Transform, orientation: native.ParameterizedField) -> np.ndarray:
    """(s, n) complex128: unit vectors of the orientation field, or a direction laid into the surface."""
    shape = np.asarray(field.values).shape
    if turn.axis != "orientation":
        direction = np.array(turn.axis) / np.linalg.norm(turn.axis)
        along = field.mesh.to_tangent(np.tile(direction, (shape[1], 1)))
        return np.broadcast_to(along, shape).copy()
    values = np.asarray(orientation.at(turn.begin).values if turn.frozen else orientation.values)
    length = np.abs(values)
    unit = np.divide(values, length, out=np.zeros_like(values), where=length > 0.0)
    return np.broadcast_to(unit, shape).copy()
