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
from .element_types import BRUSH_MODES, MIRRORED, OVER_LAMBDA, RULES, TYPES, BrushMode, ElementType, Kind
from .errors import InputError
from .words import Json

SCHEMA = "stormfield.design/2"
#: Earlier forms that are read: everything in them means the same.
READABLE = ("stormfield.design/1",)
#: The two fields of one mesh (thesis 9.2): what turns the texture, and what moves it.
FieldName = Literal["orientation", "advection"]
FIELDS: tuple[FieldName, FieldName] = ("orientation", "advection")

#: What the flow does at the border of the surface.
Border = Literal["open", "wall", "inflow"]
BORDERS: tuple[Border, ...] = get_args(Border)

Vector = tuple[float, float, float]
#: One number, or one for each entry of the element's λ.
Number = float | tuple[float, ...]


@dataclass(frozen=True)
class Element:
    """One design element; design.schema.json says what each value means."""

    name: str
    type: ElementType
    points: tuple[Vector, ...]
    lam: tuple[float, ...] = (0.0, 1.0)
    kind: Kind = "source"
    field: FieldName | Literal["both"] = "both"
    strength: Number = 0.2
    radius: Number = 0.1
    hard: bool = False
    angle: Number = 0.0
    direction: Vector | None = None
    enabled: bool = True
    rate: Number = 4.0
    pull: Number = 4.0
    reverse: bool = False
    fade_in: float = 0.0
    fade_out: float = 0.0
    reach: float = 0.2
    mode: BrushMode = "replace"
    falloff: float = 0.5

    def __post_init__(self) -> None:
        for name in OVER_LAMBDA:
            if isinstance(getattr(self, name), Sequence):
                object.__setattr__(self, name, tuple(float(value) for value in getattr(self, name)))
        object.__setattr__(self, "points", tuple(_vector(point) for point in self.points))
        object.__setattr__(self, "lam", tuple(float(value) for value in self.lam))
        if self.direction is not None:
            object.__setattr__(self, "direction", _vector(self.direction))

    def acts_on(self, name: FieldName) -> bool:
        return self.field in (name, "both")

    def mirrored(self) -> "Element":
        """The same element as it must act on a mesh that is shown mirrored: left and right exchanged."""
        kind = MIRRORED.get(self.kind, self.kind)
        angle = tuple(-value for value in self.angle) if isinstance(self.angle, tuple) else -self.angle
        return replace(self, kind=kind, angle=angle)

    def values(self, name: str) -> tuple[float, ...]:
        """Of a setting that may change over λ: one number, or one for each λ."""
        value = getattr(self, name)
        return value if isinstance(value, tuple) else (value,)

    @property
    def least_radius(self) -> float:
        return min(self.values("radius"))

    def check(self) -> None:
        """Raises InputError on the first fault that can be seen without the surface."""
        where = f"element '{self.name}'"
        _check_word(self.type, TYPES, where, "type")
        _check_word(self.field, (*FIELDS, "both"), where, "field")
        if kinds := RULES[self.type].kinds:
            _check_word(self.kind, kinds, where, "kind")
        self._check_numbers(where)
        if RULES[self.type].instant:
            self._check_instant(where)
        if not self.points:
            raise InputError(f"{where} has no points: draw it on the surface")
        for number, point in enumerate(self.points):
            if not all(map(math.isfinite, point)):
                raise InputError(f"{where} point {number} is not finite: give three finite numbers")
        self._check_lam(where)

    def _check_numbers(self, where: str) -> None:
        for name in OVER_LAMBDA:
            values = self.values(name)
            if len(values) not in {1, len(self.lam)} or not values:
                raise InputError(
                    f"{where} has {len(values)} values of {name} for {len(self.lam)} λ: "
                    "give one number, or one for each λ"
                )
            for value in values:
                _check_number(value, name, len(values) > 1, where)
            if name == "strength" and max(values) <= 0:
                raise InputError(f"{where} has strength 0 at every λ: give a number above 0 somewhere")
        _check_word(self.mode, BRUSH_MODES, where, "mode")
        if not 0.0 <= self.falloff <= 1.0:
            raise InputError(f"{where} has falloff {self.falloff:g}: give 0 to 1")
        for name in ("fade_in", "fade_out"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"{where} has {name} {getattr(self, name):g}: give a length of λ from 0 to 1")

    def _check_instant(self, where: str) -> None:
        if len(self.points) != 1 or len(self.lam) != 1:
            raise InputError(
                f"{where} has {len(self.points)} points and {len(self.lam)} λ: it happens at one point and one λ"
            )
        if not 0.0 < self.lam[0] < 1.0:
            raise InputError(
                f"{where} is at λ {self.lam[0]:g}, the end of the range: move it inside, so that there is a before "
                "and an after"
            )
        if not 0.0 < self.reach <= 1.0:
            raise InputError(f"{where} has reach {self.reach:g}: give a length of λ above 0, and at most 1")

    def _check_lam(self, where: str) -> None:
        if not self.lam:
            raise InputError(f"{where} has no λ: give start and end, or one value per point")
        still = len(self.points) == 1 or not RULES[self.type].moves
        changing = still and any(isinstance(getattr(self, name), tuple) for name in OVER_LAMBDA)
        if len(self.lam) > 2 and len(self.lam) != len(self.points) and not changing:
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
    border: Border = "open"

    def check(self) -> None:
        _check_word(self.border, BORDERS, "settings", "border")
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
    schemas.check(data, SCHEMA, "design", _element_name, READABLE)


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
        if each.name == "kind" and isinstance(value, Element) and not RULES[value.type].kinds:
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


def _check_number(value: float, name: str, is_list: bool, where: str) -> None:
    if name == "angle":
        if not math.isfinite(value):
            raise InputError(f"{where} has an angle that is not finite: give radians")
        return
    if is_list and name == "strength" and value < 0:
        raise InputError(
            f"{where} has strength {value:g}: a strength never falls below 0; "
            "end the element where it is 0 and begin its opposite there"
        )
    lowest_counts = name == "rate" or (is_list and name == "strength")
    if not (math.isfinite(value) and (value > 0 or (lowest_counts and value == 0))):
        cure = "give 0 or more" if lowest_counts else "give a number above 0"
        raise InputError(f"{where} has {name} {value:g}: {cure}")


def _check_word(word: str, known: Sequence[str], where: str, what: str) -> None:
    if word not in known:
        raise InputError(f"{where} has {what} '{word}': use one of {', '.join(known)}")
