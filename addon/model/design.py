# SPDX-License-Identifier: GPL-3.0-or-later
"""A design: the elements an artist placed and the settings of the solve, as plain data that never changes.

    design = Design(elements=(Element("eye", "singular", ((0, 0, 1),), kind="vortex_ccw"),))
    design.check()                      # InputError: what, where, cure
    Design.from_json(json.load(file))   # the form of design.schema.json

Checks that need the surface (points off it, elements that contradict each other) belong to the native module.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Literal, get_args

from . import schemas
from .edits import SCHEMA as EDITS_SCHEMA
from .edits import Edit, edits_from_json
from .errors import InputError
from .words import Json

SCHEMA = "stormfield.design/1"
ElementType = Literal["singular", "regular", "streamline", "pathline"]
TYPES: tuple[ElementType, ...] = get_args(ElementType)
SingularKind = Literal[
    "source",
    "sink",
    "saddle",
    "vortex_ccw",
    "vortex_cw",
    "spiral_in_ccw",
    "spiral_in_cw",
    "spiral_out_ccw",
    "spiral_out_cw",
]
KINDS: tuple[SingularKind, ...] = get_args(SingularKind)
#: The kind that each one that turns becomes in a mirror.
_MIRRORED: dict[SingularKind, SingularKind] = {
    "vortex_ccw": "vortex_cw",
    "vortex_cw": "vortex_ccw",
    "spiral_in_ccw": "spiral_in_cw",
    "spiral_in_cw": "spiral_in_ccw",
    "spiral_out_ccw": "spiral_out_cw",
    "spiral_out_cw": "spiral_out_ccw",
}
#: The two fields of one mesh (thesis 9.2): what turns the texture, and what moves it.
FieldName = Literal["orientation", "advection"]
FIELDS: tuple[FieldName, FieldName] = ("orientation", "advection")

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Element:
    """One design element; design.schema.json says what each value means."""

    name: str
    type: ElementType
    points: tuple[Vector, ...]
    lam: tuple[float, ...] = (0.0, 1.0)
    kind: SingularKind = "source"
    field: FieldName | Literal["both"] = "both"
    strength: float = 0.2
    radius: float = 0.1
    hard: bool = False
    angle: float = 0.0
    direction: Vector | None = None
    enabled: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", tuple(_vector(point) for point in self.points))
        object.__setattr__(self, "lam", tuple(float(value) for value in self.lam))
        if self.direction is not None:
            object.__setattr__(self, "direction", _vector(self.direction))

    def acts_on(self, name: FieldName) -> bool:
        return self.field in (name, "both")

    def mirrored(self) -> "Element":
        """The same element as it must act on a mesh that is shown mirrored: left and right exchanged."""
        kind = _MIRRORED.get(self.kind, self.kind)
        return replace(self, kind=kind, angle=-self.angle)

    def check(self) -> None:
        """Raises InputError on the first fault that can be seen without the surface."""
        where = f"element '{self.name}'"
        _check_word(self.type, TYPES, where, "type")
        _check_word(self.field, (*FIELDS, "both"), where, "field")
        if self.type == "singular":
            _check_word(self.kind, KINDS, where, "kind")
        for what in ("strength", "radius"):
            value = getattr(self, what)
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"{where} has {what} {value:g}: give a number above 0")
        if not math.isfinite(self.angle):
            raise InputError(f"{where} has an angle that is not finite: give radians")
        if not self.points:
            raise InputError(f"{where} has no points: draw it on the surface")
        for number, point in enumerate(self.points):
            if not all(map(math.isfinite, point)):
                raise InputError(f"{where} point {number} is not finite: give three finite numbers")
        self._check_lam(where)

    def _check_lam(self, where: str) -> None:
        if not self.lam:
            raise InputError(f"{where} has no λ: give start and end, or one value per point")
        if len(self.lam) > 2 and len(self.lam) != len(self.points):
            raise InputError(
                f"{where} has {len(self.lam)} λ values for {len(self.points)} points: "
                "give start and end, or one per point"
            )
        for value in self.lam:
            if not 0.0 <= value <= 1.0:  # also refuses nan
                raise InputError(f"{where} has λ {value:g}, outside 0..1: move it into the range")
        for before, after in zip(self.lam, self.lam[1:], strict=False):
            if after < before:
                raise InputError(f"{where} has λ {after:g} after {before:g}: let λ grow along it")


@dataclass(frozen=True)
class SolveSettings:
    """How the field is solved; the same for both fields."""

    samples: int = 100
    lambda_weight: float = 10.0
    even_speed: float = 0.0
    tolerance: float = 1e-4
    lambda_per_second: float = 1.0
    weld: float = 1e-5
    edge: float = 0.0

    def check(self) -> None:
        if self.samples < 1:
            raise InputError(f"settings: samples is {self.samples}: give at least 1")
        for what in ("lambda_weight", "tolerance", "lambda_per_second"):
            value = getattr(self, what)
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"settings: {what} is {value:g}: give a number above 0")
        if not (math.isfinite(self.edge) and self.edge >= 0.0):
            raise InputError(f"settings: edge is {self.edge:g}: give a length, or 0 for the mesh itself")
        if not 0.0 <= self.weld <= 0.1:
            raise InputError(f"settings: weld is {self.weld:g}: give a part of the mesh's size from 0 to 0.1")
        if not 0.0 <= self.even_speed <= 1.0:
            raise InputError(f"settings: even_speed is {self.even_speed:g}: give a number from 0 to 1")


@dataclass(frozen=True)
class Design:
    """Elements and settings, and the edits of what was solved from them."""

    elements: tuple[Element, ...] = ()
    settings: SolveSettings = field(default_factory=SolveSettings)
    edits: tuple[Edit, ...] = ()

    def elements_of(self, name: FieldName) -> tuple[Element, ...]:
        """The enabled elements that act on the field `name`."""
        return tuple(element for element in self.elements if element.enabled and element.acts_on(name))

    def check(self) -> None:
        """Raises InputError on the first fault that can be seen without the surface."""
        self.settings.check()
        names: set[str] = set()
        enabled = [element for element in self.elements if element.enabled]
        if not enabled:
            raise InputError("the design has no element that is turned on: add one, or enable one")
        for element in enabled:
            if element.name in names:
                raise InputError(f"two elements are named '{element.name}': give each its own name")
            names.add(element.name)
            element.check()

    @classmethod
    def from_json(cls, data: Json) -> "Design":
        """From the form of design.schema.json (its mesh is left to the reader of the file). Raises InputError."""
        check_schema(data)
        design = cls(
            elements=tuple(Element(**element) for element in data["elements"]),
            settings=SolveSettings(**data.get("settings", {})),
            edits=edits_from_json({"schema": EDITS_SCHEMA, "edits": data.get("edits", [])}),
        )
        design.check()
        return design

    def to_json(self, mesh: Mapping[str, Json] | None = None) -> dict[str, Json]:
        """The form of design.schema.json, with the mesh when it is given; values that are the default are left out."""
        return {
            "schema": SCHEMA,
            **({"mesh": dict(mesh)} if mesh else {}),
            "settings": _non_defaults(self.settings),
            "elements": [_non_defaults(element) for element in self.elements],
            **({"edits": [edit.to_json() for edit in self.edits]} if self.edits else {}),
        }


def check_schema(data: Json) -> None:
    """Raises InputError with one line that says where in the JSON, what is wrong, and the cure."""
    schemas.check(data, SCHEMA, "design", _element_name)


def _element_name(data: Json, path: Sequence[str | int]) -> str:
    """(element 'NAME'), because a name is easier to find than a number; empty for other places."""
    path = list(path)
    if len(path) < 2 or path[0] != "elements":
        return ""
    element = data["elements"][path[1]]
    name = element.get("name") if isinstance(element, dict) else None
    return f" (element '{name}')" if isinstance(name, str) else ""


def _non_defaults(value: Element | SolveSettings) -> dict[str, Json]:
    """Fields of a dataclass whose value is not the default, as JSON knows them."""
    # A reader of the file needs λ, the kind and the samples, even where they have their defaults.
    always = {"lam", "kind", "samples"}
    result = {}
    for each in fields(value):
        content = getattr(value, each.name)
        if content == each.default and each.name not in always:
            continue
        if each.name == "kind" and isinstance(value, Element) and value.type != "singular":
            continue
        result[each.name] = _listed(content)
    return result


def _listed(content: object) -> Json:
    return [_listed(item) for item in content] if isinstance(content, tuple) else content


def _vector(values: Sequence[float]) -> Vector:
    vector = tuple(float(value) for value in values)
    if len(vector) != 3:
        raise InputError(f"a point has {len(vector)} coordinates: give x, y and z")
    return vector


def _check_word(word: str, known: Sequence[str], where: str, what: str) -> None:
    if word not in known:
        raise InputError(f"{where} has {what} '{word}': use one of {', '.join(known)}")
