# SPDX-License-Identifier: GPL-3.0-or-later
"""What each type of design element is: the one place of the add-on where a type is declared.

    RULES["orbit"].kinds, RULES["orbit"].settings, RULES["orbit"].is_curve(points)

The core has its own list, native/design/element.h; labels, tooltips and colours are in properties/element.py.
"""

from dataclasses import dataclass
from typing import Literal, TypeGuard, get_args

ElementType = Literal[
    "singular", "regular", "streamline", "pathline", "attachment", "separation", "orbit", "bifurcation", "brush"
]
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
OrbitKind = Literal["attracting", "repelling"]
BifurcationKind = Literal["appear_sink", "appear_source", "vanish_sink", "vanish_source", "hopf_birth", "hopf_death"]
BrushMode = Literal["replace", "add", "strength", "smooth"]
BRUSH_MODES: tuple[BrushMode, ...] = get_args(BrushMode)
Kind = SingularKind | OrbitKind | BifurcationKind
KINDS: tuple[SingularKind, ...] = get_args(SingularKind)
ORBIT_KINDS: tuple[OrbitKind, ...] = get_args(OrbitKind)
BIFURCATION_KINDS: tuple[BifurcationKind, ...] = get_args(BifurcationKind)
#: The kind that each one that turns becomes in a mirror.
MIRRORED: dict[Kind, Kind] = {
    "vortex_ccw": "vortex_cw",
    "vortex_cw": "vortex_ccw",
    "spiral_in_ccw": "spiral_in_cw",
    "spiral_in_cw": "spiral_in_ccw",
    "spiral_out_ccw": "spiral_out_cw",
    "spiral_out_cw": "spiral_out_ccw",
}


@dataclass(frozen=True)
class TypeRules:
    """settings: those of Element that count for the type, besides its place, times, field and whether it is exact."""

    settings: tuple[str, ...]
    kinds: tuple[Kind, ...] = ()
    moves: bool = False  #: several points lie at different λ: something moves from the first to the last
    closed: bool = False  #: the points are a loop
    arrow: bool = False  #: one point, and a direction
    instant: bool = False  #: it happens at one λ


RULES: dict[ElementType, TypeRules] = {
    "singular": TypeRules(("strength", "radius", "angle"), kinds=KINDS, moves=True),
    "regular": TypeRules(("strength", "radius", "angle"), arrow=True),
    "streamline": TypeRules(("strength", "radius")),
    "pathline": TypeRules(("radius",), moves=True),
    "attachment": TypeRules(("strength", "rate", "radius", "angle")),
    "separation": TypeRules(("strength", "rate", "radius", "angle")),
    "orbit": TypeRules(("strength", "pull", "radius", "reverse"), kinds=ORBIT_KINDS, closed=True),
    "bifurcation": TypeRules(
        ("strength", "radius", "reach", "angle", "reverse"), kinds=BIFURCATION_KINDS, arrow=True, instant=True
    ),
    "brush": TypeRules(("mode", "strength", "radius", "falloff")),
}
#: Types whose points lie at different λ.
MOVING = frozenset(name for name, rules in RULES.items() if rules.moves)
#: Settings that may have one value for each λ.
OVER_LAMBDA = ("strength", "radius", "angle", "rate", "pull")


def is_singular(kind: str) -> TypeGuard[SingularKind]:
    return kind in KINDS


def is_bifurcation(kind: str) -> TypeGuard[BifurcationKind]:
    return kind in BIFURCATION_KINDS
