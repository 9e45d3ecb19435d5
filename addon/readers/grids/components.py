# SPDX-License-Identifier: GPL-3.0-or-later
"""Which two variables are one vector: found as pairs, by their meaning, unit, place and level, and never mixed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from ...model.errors import InputError
from ..field_data import NoFieldError
from .vocabulary import speed_of, standard_name, unit

#: Along what the components point: the parallels and meridians, the rows and columns of the grid, or nothing says it.
Frame = Literal["earth", "grid", "unsaid"]


@dataclass(frozen=True)
class Pair:
    """The variables that hold the first and the second component."""

    east: str
    north: str
    frame: Frame
    meaning: str  #: standard name of the first; or its long name, or empty
    rank: tuple[int, int]  #: what is taken by default: the lowest

    @property
    def names(self) -> str:
        return f"{self.east},{self.north}"


#: In standard names: the word of the first component, that of the second, and along what they point.
_STANDARD: tuple[tuple[str, str, Frame], ...] = (
    ("grid_eastward", "grid_northward", "grid"),
    ("eastward", "northward", "earth"),
    ("sea_water_x_velocity", "sea_water_y_velocity", "grid"),
    ("_x_", "_y_", "grid"),
    ("x_wind", "y_wind", "grid"),
    ("zonal", "meridional", "earth"),
)
#: In long names, lower case.
_LONG: tuple[tuple[str, str, Frame], ...] = (
    ("eastward", "northward", "earth"),
    ("zonal", "meridional", "earth"),
    ("west-east", "south-north", "earth"),
    ("x-wind", "y-wind", "grid"),
    ("u component", "v component", "unsaid"),
    ("u-component", "v-component", "unsaid"),
    ("u wind", "v wind", "unsaid"),
    ("u velocity", "v velocity", "unsaid"),
    ("u-velocity", "v-velocity", "unsaid"),
    ("u at", "v at", "unsaid"),
    ("x component", "y component", "grid"),
    ("x-component", "y-component", "grid"),
)
#: In names: a letter or word of the first component, that of the second. The first that leads to a variable counts.
_NAMES: tuple[tuple[str, str, Frame], ...] = (
    ("vozocrtx", "vomecrty", "grid"),
    ("sozocrtx", "somecrty", "grid"),
    ("eastward", "northward", "earth"),
    ("zonal", "meridional", "earth"),
    ("east", "north", "earth"),
    ("ugrd", "vgrd", "unsaid"),
    ("u", "v", "unsaid"),
    ("x", "y", "unsaid"),
)
#: Names in which u and v follow the grid by the convention of their model.
_GRID_RELATIVE = {"vozocrtx", "sozocrtx", "u_rho", "uvel"}


def find_pairs(variables: Mapping) -> list[Pair]:
    """Every pair of variables of the same dimensions and unit that are components of one vector, the likely first.

    variables: data arrays by name. Raises InputError where meanings leave open which belong together."""
    pairs: dict[tuple[str, str], Pair] = {}
    taken: set[str] = set()
    for name, partners in _by_meaning(variables):
        fitting = [partner for partner in partners if fits(variables[name], variables[partner])]
        if len(fitting) > 1:
            named = [partner for partner, _ in _name_partners(name, variables) if partner in fitting]
            fitting = named or [partner for partner in fitting if _level(variables[partner]) == _level(variables[name])]
        if len(fitting) > 1:
            raise InputError(
                f"{name} may belong to {' or '.join(fitting)}: all mean {standard_name(variables[fitting[0]])}; "
                "choose with --vector EAST,NORTH"
            )
        if fitting:
            pairs[name, fitting[0]] = _pair(variables, name, fitting[0])
            taken |= {name, fitting[0]}
    for name in variables:
        if name in taken:
            continue
        for partner, _ in _name_partners(name, variables):
            if (
                partner not in taken
                and fits(variables[name], variables[partner])
                and _may_pair(variables, name, partner)
            ):
                pairs[name, partner] = _pair(variables, name, partner)
                taken |= {name, partner}
                break
    return sorted(pairs.values(), key=lambda pair: pair.rank)


def choose_pair(variables: Mapping, vector: str | None, where: str) -> Pair:
    """The pair that `vector` names, "u,v" or one of both; the likely one for None. Raises InputError that lists what
    there is where that is nothing, or more than one."""
    if vector is not None:
        return _named(variables, vector, where)
    pairs = find_pairs(variables)
    if not pairs:
        speeds = [name for name, variable in variables.items() if _is_speed_or_direction(variable)]
        if len(speeds) > 1:
            raise InputError(
                f"{where}: has {' and '.join(speeds)}, a speed and a direction; write their components instead: where "
                "the direction is that from which it blows, u = -speed sin(direction) and v = -speed cos(direction)"
            )
        raise InputError(
            f"{where}: has no eastward and northward components of one vector; "
            f"name them with --vector EAST,NORTH from: {', '.join(map(str, variables)) or 'nothing'}"
        )
    best = [pair for pair in pairs if pair.rank == pairs[0].rank]
    if len(best) > 1:
        raise NoFieldError(
            f"{where}: {' and '.join(pair.names for pair in best)} are each a vector; choose one with --vector"
        )
    return best[0]


def fits(east, north) -> bool:
    """Whether both can be one vector: same unit and level, same dimensions but for what a staggered grid shifts."""
    if unit(east) != unit(north) and speed_of(unit(east)) != speed_of(unit(north)):
        return False
    if east.ndim != north.ndim or _level(east) != _level(north):
        return False
    other = [(a, b) for a, b in zip(east.dims, north.dims, strict=True) if a != b]
    return all(unstaggered(a) == unstaggered(b) for a, b in other) and (not other or _staggered(east, north))


def _named(variables: Mapping, vector: str, where: str) -> Pair:
    names = _split(variables, vector)
    if names is None:
        unknown = next((word.strip() for word in vector.split(",") if word.strip() not in variables), vector)
        raise InputError(f"{where}: has no variable '{unknown}'; choose from: {', '.join(map(str, variables))}")
    if len(names) == 1:
        for pair in find_pairs(variables):
            if names[0] in (pair.east, pair.north):
                return pair
    if len(names) != 2:
        raise InputError(f"{where}: {vector} names {len(names)} variables; name the eastward and the northward one")
    east, north = names
    pairs = {(pair.east, pair.north): pair.names for pair in find_pairs(variables)}
    if (north, east) in pairs:
        raise InputError(f"{where}: {east} is the northward component; write --vector {north},{east}")
    others = [name for pair, name in pairs.items() if east in pair or north in pair]
    if (east, north) not in pairs and len(others) > 1:
        raise InputError(f"{where}: {east} and {north} are of two vectors; choose one of: {'; '.join(others)}")
    if not fits(variables[east], variables[north]):
        raise InputError(
            f"{where}: {east} and {north} are not one vector: {_told(variables[east])} against "
            f"{_told(variables[north])}; name two of the same unit, level and grid"
        )
    return _pair(variables, east, north)


def _split(variables: Mapping, vector: str) -> list[str] | None:
    """The names in `vector`; they may hold commas themselves."""
    if vector.strip() in variables:
        return [vector.strip()]
    words = vector.split(",")
    for cut in range(1, len(words)):
        names = [",".join(words[:cut]).strip(), ",".join(words[cut:]).strip()]
        if all(name in variables for name in names):
            return names
    return None


def _by_meaning(variables: Mapping) -> Iterator[tuple[str, list[str]]]:
    """Each first component by its standard name, with all that have the meaning of the second."""
    for name, variable in variables.items():
        meaning = standard_name(variable)
        found = _replaced(meaning, _STANDARD)
        if found is not None:
            yield name, [other for other in variables if standard_name(variables[other]) == found[0]]


def _replaced(text: str, table) -> tuple[str, Frame] | None:
    for first, second, frame in table:
        if first in text:
            return text.replace(first, second), frame
    return None


def _name_partners(name: str, variables: Mapping) -> Iterator[tuple[str, Frame]]:
    """Variables whose name is this one's with the word of the other component."""
    for first, second, frame in _NAMES:
        for found in re.finditer(re.escape(first), name, re.IGNORECASE):
            word = found.group()
            other = second.upper() if word.isupper() else second.capitalize() if word[0].isupper() else second
            # 10m_u_component, ua, u10, VAR_10U: the letter stands at the border of a word, or beside digits.
            partner = name[: found.start()] + other + name[found.end() :]
            if partner in variables and partner != name:
                yield partner, frame


def _may_pair(variables: Mapping, east: str, north: str) -> bool:
    """Where meanings are said, they have to be those of two components; names alone need a unit of speed or none."""
    meanings = [standard_name(variables[name]) for name in (east, north)]
    if all(meanings):
        found = _replaced(meanings[0], _STANDARD)
        return found is not None and found[0] == meanings[1]
    texts = [_long(variables[name]) for name in (east, north)]
    replaced = _replaced(texts[0], _LONG)
    if replaced is not None and texts[1]:
        return replaced[0] == texts[1] or speed_of(unit(variables[east])) is not None
    of = unit(variables[east])
    return not of or speed_of(of) is not None or re.search(r"tau|stress|flux|transport", east.lower()) is not None


def _pair(variables: Mapping, east: str, north: str) -> Pair:
    first = variables[east]
    meaning = standard_name(first)
    said = _replaced(meaning, _STANDARD) or _replaced(_long(first), _LONG)
    frame: Frame = said[1] if said else "unsaid"
    if (
        "rotate to earth" in str(first.attrs.get("description", "")).lower()
        or str(first.attrs.get("GRIB_uvRelativeToGrid", 0)) == "1"
    ):
        frame = "grid"
    elif str(first.attrs.get("GRIB_uvRelativeToGrid", "")) == "0":
        frame = "earth"
    elif frame == "unsaid" and east.lower() in _GRID_RELATIVE:
        frame = "grid"
    return Pair(east, north, frame, meaning or _long(first), _rank(variables, east))


def _rank(variables: Mapping, name: str) -> tuple[int, int]:
    """Winds and currents before other speeds, before changes and fluxes; near the surface before aloft."""
    variable = variables[name]
    text = f"{standard_name(variable)} {_long(variable)} {name.lower()}"
    speed = speed_of(unit(variable)) is not None
    if re.search(
        r"anomal|stress|tau|flux|transport|tendency|gust|stokes|tide|tidal|error|std|deviation|shear|geosa|variance",
        text,
    ):
        kind = 2
    else:
        kind = 0 if speed else 1
    near = _level(variable) in (10.0, "heightAboveGround 10") or re.search(
        r"(^|[^0-9])10 ?(m|u|metre|meter)|u_?10m?($|[^0-9])", text
    )
    aloft = re.search(r"[0-9]", re.sub(r"10 ?(m|u|v)|[uv]_?10m?", "", name.lower())) or "bottom" in text
    return kind, 0 if near else 2 if aloft else 1


def _long(variable) -> str:
    return str(variable.attrs.get("long_name", variable.attrs.get("description", ""))).strip().lower()


def _level(variable) -> float | str | None:
    """The height or pressure that a scalar coordinate or an attribute gives."""
    for name in ("height", "heightAboveGround", "height_above_ground", "pressure", "plev", "depth", "isobaricInhPa"):
        if name in variable.coords and variable.coords[name].ndim == 0:
            return float(variable.coords[name])
    kind, level = variable.attrs.get("GRIB_typeOfLevel"), variable.attrs.get("level")
    return None if kind is None else f"{kind} {level:g}" if level is not None else str(kind)


def _told(variable) -> str:
    level = _level(variable)
    shape = " × ".join(f"{dim} {size}" for dim, size in variable.sizes.items())
    return f"{unit(variable) or 'no unit'}, {shape}{'' if level is None else f', level {level}'}"


def unstaggered(dim: object) -> str:
    return re.sub(r"_stag$|_(u|v|rho)$", "", str(dim))


def _staggered(east, north) -> bool:
    """Whether each component is shifted along one dimension of the horizontal grid."""
    return sum(a != b for a, b in zip(east.dims, north.dims, strict=True)) in (1, 2)


def _is_speed_or_direction(variable) -> bool:
    return standard_name(variable).endswith(("_speed", "_from_direction", "_to_direction"))
