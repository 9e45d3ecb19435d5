# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of a field as plain data: what edits.schema.json says, in order.

edits = edits_from_json(json.load(file))        # InputError: what, where, cure
edits[0].type, edits[0].entities, edits[0].lam

An edit names its entities by kind and place, so that it survives another solve of the design.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from . import schemas
from .errors import InputError
from .transform import Transform, transform_from_json
from .words import Json

SCHEMA = "stormfield.edits/1"
EditType = Literal["cancel", "move", "smooth", "simplify", "transform", "remove_bifurcation", "move_bifurcation"]
#: Those that act over λ, on what fixed points do there.
BIFURCATION_TYPES: tuple[EditType, ...] = ("remove_bifurcation", "move_bifurcation")
TYPES: tuple[EditType, ...] = get_args(EditType)
Vector = tuple[float, float, float]
#: What an edit of each type must say, and what besides.
NEEDS: Mapping[EditType, tuple[str, ...]] = {
    "cancel": ("entities",),
    "move": ("entity", "to"),
    "smooth": ("region",),
    "simplify": (),
    "transform": (),
    "remove_bifurcation": ("at", "lam"),
    "move_bifurcation": ("at", "lam"),
}
MAY: Mapping[EditType, tuple[str, ...]] = {
    "cancel": ("reach",),
    "move": ("reach",),
    "smooth": ("reach",),
    "simplify": ("reach", "epsilon", "keep"),
    "transform": ("angle", "scale", "stretch", "axis", "frozen", "region", "falloff"),
    "remove_bifurcation": ("reach", "until"),
    "move_bifurcation": ("reach", "to", "to_lam"),
}
ALL = ("type", "enabled", "field", "lam")


@dataclass(frozen=True)
class EntityAt:
    """kind: that of a fixed point, or attracting and repelling of an orbit. at: a place near it."""

    kind: str
    at: Vector


@dataclass(frozen=True)
class Region:
    """One of the three; a disc has a center and a radius, mesh units."""

    center: Vector | None = None
    radius: float = 0.0
    loop: tuple[Vector, ...] = ()
    faces: tuple[int, ...] = ()


@dataclass(frozen=True)
class BifurcationAt:
    at: Vector
    lam: float


@dataclass(frozen=True)
class Edit:
    """edits.schema.json says what each value means; what does not belong to the type has its default."""

    type: EditType
    lam: tuple[float, float] = (0.0, 0.0)  #: first and last, equal for one λ
    reach: float = 0.0
    entities: tuple[EntityAt, ...] = ()  #: two of cancel, one of move
    to: Vector = (0.0, 0.0, 0.0)
    at: Vector = (0.0, 0.0, 0.0)  #: of a bifurcation
    until: BifurcationAt | None = None  #: remove_bifurcation: where the pair that vanished appears again
    to_lam: float | None = None
    region: Region = Region()
    epsilon: float | None = None
    keep: int = 0
    transform: Transform | None = None
    field: Literal["orientation", "advection", "both"] = "both"
    enabled: bool = True
    given: tuple[tuple[str, Json], ...] = ()  #: the JSON that it came from

    @property
    def has_region(self) -> bool:
        return self.region != Region()

    @property
    def has_to(self) -> bool:
        return "to" in dict(self.given)

    def to_json(self) -> dict[str, Json]:
        return dict(self.given)


def edits_from_json(data: Json) -> tuple[Edit, ...]:
    """From the form of edits.schema.json. Raises InputError."""
    schemas.check(data, SCHEMA, "edits")
    return tuple(_edit(edit, f"edit {number}") for number, edit in enumerate(data["edits"], 1))


def _edit(data: Mapping[str, Json], where: str) -> Edit:
    kind = data["type"]
    wrong = next((name for name, value in data.items() if not _finite(value)), None)
    if wrong is not None:
        raise InputError(f"{where}: {wrong} has a number that is not finite: give finite numbers")
    missing = next((name for name in NEEDS[kind] if name not in data), None)
    if missing is not None:
        raise InputError(f"{where}: {kind} needs {missing}: add it")
    known = (*ALL, *NEEDS[kind], *MAY[kind])
    unknown = next((name for name in data if name not in known), None)
    if unknown is not None:
        raise InputError(f"{where}: {unknown} does not belong to {kind}: remove it, or use one of {', '.join(known)}")
    if kind == "simplify" and "epsilon" not in data and "keep" not in data:
        raise InputError(f"{where}: simplify needs epsilon or keep: add one")
    if kind == "cancel" and data["entities"][0] == data["entities"][1]:
        raise InputError(f"{where}: the {data['entities'][0]['kind']} is given twice: choose two entities")
    if kind == "move_bifurcation" and "to" not in data and "to_lam" not in data:
        raise InputError(f"{where}: move_bifurcation needs to or to_lam: add one")
    entities = data.get("entities", [data["entity"]] if "entity" in data else [])
    lam = _range(data.get("lam", [0.0, 1.0] if kind == "transform" else 0.0), kind, where)
    return Edit(
        type=kind,
        lam=lam,
        reach=float(data.get("reach", 0.0)),
        entities=tuple(EntityAt(entity["kind"], _vector(entity["at"])) for entity in entities),
        to=_vector(data.get("to", (0.0, 0.0, 0.0))),
        at=_vector(data.get("at", (0.0, 0.0, 0.0))),
        until=_bifurcation(data["until"]) if "until" in data else None,
        to_lam=data.get("to_lam"),
        region=_region(data["region"], where) if "region" in data else Region(),
        epsilon=data.get("epsilon"),
        keep=data.get("keep", 0),
        transform=transform_from_json(data, lam, where) if kind == "transform" else None,
        field=data.get("field", "both"),
        enabled=data.get("enabled", True),
        given=tuple(data.items()),
    )


def _finite(value: Json) -> bool:
    """Whether all numbers in a value are finite; JSON as Python reads it may hold NaN."""
    if isinstance(value, dict):
        return all(map(_finite, value.values()))
    if isinstance(value, list):
        return all(map(_finite, value))
    return not isinstance(value, float) or math.isfinite(value)


def _range(lam: Json, kind: EditType, where: str) -> tuple[float, float]:
    if not isinstance(lam, list):
        return float(lam), float(lam)
    if kind in ("cancel", "move", *BIFURCATION_TYPES):
        raise InputError(f"{where}: {kind} acts at one λ: give a number")
    if lam[1] < lam[0]:
        raise InputError(f"{where}: λ runs from {lam[0]:g} back to {lam[1]:g}: give the smaller one first")
    return float(lam[0]), float(lam[1])


def _region(data: Mapping[str, Json], where: str) -> Region:
    ways = [name for name in ("center", "loop", "faces") if name in data]
    if len(ways) != 1 or ("center" in data) != ("radius" in data):
        raise InputError(f"{where}: the region is not one of center with radius, loop, or faces: give one of them")
    return Region(
        center=_vector(data["center"]) if "center" in data else None,
        radius=float(data.get("radius", 0.0)),
        loop=tuple(_vector(point) for point in data.get("loop", ())),
        faces=tuple(data.get("faces", ())),
    )


def _bifurcation(data: Mapping[str, Json]) -> BifurcationAt:
    return BifurcationAt(_vector(data["at"]), float(data["lam"]))


def _vector(values: Sequence[float]) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
