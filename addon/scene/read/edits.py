# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of edits of a field → plain data."""

from collections.abc import Iterator

import bpy

from ... import compat
from ...model.edits import SCHEMA, Edit, edits_from_json
from ...model.errors import InputError
from ...model.transform import IDENTITY
from ...model.words import Json
from .facts import keys_of, values_of
from .lambda_seen import lambda_at_frames, lambda_frames, time_stretch
from .regions import facts_of, line_of, region_json

#: The object's own axes.
DIRECTIONS = {"X": [1.0, 0.0, 0.0], "Y": [0.0, 1.0, 0.0], "Z": [0.0, 0.0, 1.0]}


def read_edits(context: bpy.types.Context, obj: bpy.types.Object) -> tuple[Edit, ...]:
    """Those that are turned on, in the order of the list. Raises InputError for one that cannot be."""
    enabled = [edit_json(context, obj, number) for number, edit in enumerate(obj.stormfield.edits) if edit.enabled]
    return edits_from_json({"schema": SCHEMA, "edits": enabled})


def edit_json(context: bpy.types.Context, obj: bpy.types.Object, number: int) -> dict[str, Json]:
    """One edit of the list as edits.schema.json has it. Raises InputError for what it needs and is not there."""
    edit = obj.stormfield.edits[number]
    content: dict[str, Json] = {"type": edit.type, "lam": edit.lam, "reach": edit.reach, "field": edit.field}
    first = {"kind": edit.first_kind, "at": list(edit.first_at)}
    match edit.type:
        case "simplify":
            return {**content, "keep": edit.keep}
        case "move":
            return {**content, "entity": first, "to": list(edit.to)}
        case "smooth":
            if edit.region == "ALL":
                raise InputError(f"Edit '{edit.name}': what is smoothed needs something around it; choose a region")
            lam = [edit.lam, edit.lam_end] if edit.lam_end > edit.lam else edit.lam
            return {**content, "lam": lam, "region": region_json(context, obj, edit)}
        case "transform":
            del content["reach"]
            return {**content, **_transform(context, obj, number)}
        case _:
            second = {"kind": edit.second_kind, "at": list(edit.second_at)}
            return {**content, "entities": [first, second]}


def animated(obj: bpy.types.Object, number: int) -> dict[str, bpy.types.FCurve]:
    """The values of a transform that have keyframes."""
    curves = {name: compat.find_fcurve(obj, f"stormfield.edits[{number}].{name}") for name in IDENTITY}
    return {name: curve for name, curve in curves.items() if curve is not None and len(curve.keyframe_points)}


def facts(obj: bpy.types.Object, number: int) -> Iterator[object]:
    """All that an edit says, to know when it says something else; what is animated by its keys, not by the frame."""
    edit = obj.stormfield.edits[number]
    keyed = animated(obj, number)
    kept = {name: getattr(edit, name) for name in keyed}
    yield values_of(edit, without=frozenset(kept))
    if edit.type in {"smooth", "transform"}:
        yield from facts_of(obj, edit)
    if keyed:
        yield from keys_of(obj)


def _transform(context: bpy.types.Context, obj: bpy.types.Object, number: int) -> dict[str, Json]:
    edit = obj.stormfield.edits[number]
    keyed = animated(obj, number)
    content: dict[str, Json] = {
        name: _course(context, obj, keyed[name]) if name in keyed else getattr(edit, name)
        for name, identity in IDENTITY.items()
        if name in keyed or getattr(edit, name) != identity
    }
    if not content:
        raise InputError(f"Edit '{edit.name}' changes nothing: give an angle, a scale or a stretch, or turn it off")
    content["lam"] = [edit.lam, edit.lam_end] if edit.lam_end > edit.lam else edit.lam
    if edit.frozen:
        content["frozen"] = True
    if edit.region != "ALL":
        content |= {"region": region_json(context, obj, edit), "falloff": edit.falloff}
    if "stretch" in content and edit.axis != "FIELD":
        content["axis"] = DIRECTIONS.get(edit.axis) or _drawn(context, obj, edit)
    return content


def _drawn(context: bpy.types.Context, obj: bpy.types.Object, edit) -> list[float]:
    line = line_of(context, obj, edit.axis_curve, f"The axis of edit '{edit.name}'")
    return (line[-1] - line[0]).tolist()


def _course(context: bpy.types.Context, obj: bpy.types.Object, curve: bpy.types.FCurve) -> list[list[float]]:
    """[[λ, value], …] at the frames over which λ grows. Raises InputError where λ has no keyframes."""
    frames = lambda_frames(context, obj)
    course: list[list[float]] = []
    for frame, lam in zip(frames, lambda_at_frames(context, obj, frames), strict=True):
        if not course or lam > course[-1][0]:
            course.append([lam, curve.evaluate(frame * time_stretch(context.scene))])
    return course
