# SPDX-License-Identifier: GPL-3.0-or-later
"""The dimensions of a variable beside its place on the earth: time, level, member, and others; one value is taken of
each but time, and none is ever taken for another."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from ...model.errors import InputError
from ..field_data import NoFieldError
from .dataset import Variable
from .vocabulary import is_lead, is_level, is_member, is_time, unit

Role = Literal["time", "lead", "level", "member", "other"]


@dataclass(frozen=True)
class Selection:
    """fixed: index by dimension. over: the dimension that becomes λ, None for a single time. said: in words."""

    fixed: Mapping[str, int]
    over: str | None
    said: Mapping[str, float | str] = field(default_factory=dict)


def select(dataset, variable, horizontal: Collection[str], wanted: Mapping[str, str], where: str) -> Selection:
    """wanted: value by "level", "member" or the name of a dimension. Raises InputError that names every dimension of
    more than one value that is left over, and what there is to choose."""
    roles = {str(dim): role_of(dataset, str(dim)) for dim in variable.dims if dim not in horizontal}
    asked = {_dimension(name, roles, where): (name, value) for name, value in wanted.items()}
    fixed: dict[str, int] = {}
    said: dict[str, float | str] = {}
    for dim, (name, value) in asked.items():
        fixed[dim] = _index(dataset, dim, value, where, name)
        said[dim] = _value(dataset, dim, fixed[dim])
    open_dims = [dim for dim in roles if dim not in fixed]
    for dim in [dim for dim in open_dims if variable.sizes[dim] == 1]:
        fixed[dim] = 0
        if roles[dim] not in ("time", "lead"):
            said[dim] = _value(dataset, dim, 0)
    left = [dim for dim in open_dims if dim not in fixed]
    over = next((dim for role in ("time", "lead") for dim in left if roles[dim] == role), None)
    too_many = [dim for dim in left if dim != over]
    if too_many:
        raise NoFieldError(f"{where}: {' and '.join(_choices(dataset, dim, roles[dim]) for dim in too_many)}")
    if over is None:  # one time: the dimension of length 1 keeps its name, so that its time is known
        over_one = next((dim for role in ("time", "lead") for dim in open_dims if roles[dim] == role), None)
        return Selection({dim: i for dim, i in fixed.items() if dim != over_one}, over_one, said)
    return Selection(fixed, over, said)


def role_of(dataset, dim: str) -> Role:
    """What a dimension is, by the coordinate of its name, or by the coordinates along it."""
    own = [dim] if dim in dataset.variables else []
    along = [str(name) for name in dataset.coords if dataset[name].dims == (dim,) and name != dim]
    for name in own + along:
        found = _role(name, dataset[name])
        if found != "other":
            return found
    if own:
        return "other"
    return _role(dim, Variable.of(dim, (dim,), np.zeros(1)))  # no coordinate: the name alone has to say it


def _role(name: str, variable) -> Role:
    if is_lead(name, variable):
        return "lead"
    if is_time(name, variable):
        return "time"
    if is_member(name, variable):
        return "member"
    return "level" if is_level(name, variable) else "other"


def _dimension(name: str, roles: Mapping[str, Role], where: str) -> str:
    """The dimension that a choice means, by its role or its name."""
    if name in roles:
        return name
    found = [dim for dim, role in roles.items() if role == name]
    if len(found) == 1:
        return found[0]
    if found:
        raise InputError(f"{where}: {' and '.join(found)} are each a {name}; choose with --at {found[0]}=VALUE")
    option = f"--{name}" if name in ("level", "member") else f"--at {name}="
    raise InputError(f"{where}: has no {name} to choose by {option}; its dimensions are {', '.join(roles) or 'none'}")


def _index(dataset, dim: str, value: str, where: str, name: str) -> int:
    """Place of the value among those of the dimension; an index, from 0, where it has none."""
    values = _values(dataset, dim)
    texts = [_text(one) for one in values]
    if value in texts:
        return texts.index(value)
    try:
        number = float(value)
    except ValueError:
        number = np.nan
    for factor in (1.0, 100.0, 0.01) if _is_pressure(dataset, dim) else (1.0,):
        near = [
            i
            for i, one in enumerate(values)
            if _is_number(one) and np.isclose(float(one), number * factor, rtol=1e-5, atol=1e-9)
        ]
        if len(near) == 1:
            return near[0]
    raise InputError(f"{where}: {dim} has no {value}; choose from {_listed(dataset, dim)}")


def _choices(dataset, dim: str, role: Role) -> str:
    option = f"--{role} VALUE" if role in ("level", "member") else f"--at {dim}=VALUE"
    count = len(_values(dataset, dim))
    return f"the field has {count} values of {dim} ({_listed(dataset, dim)}); choose one with {option}"


def _listed(dataset, dim: str) -> str:
    texts = [_text(value) for value in _values(dataset, dim)]
    shown = texts if len(texts) <= 40 else [*texts[:20], "…", *texts[-5:]]
    of = f" {unit(dataset[dim])}" if dim in dataset.variables and unit(dataset[dim]) not in ("", "1") else ""
    return ", ".join(shown) + of


def _values(dataset, dim: str) -> np.ndarray:
    if dim in dataset.variables and dataset[dim].ndim == 1:
        return dataset[dim].values
    along = [
        name for name in dataset.coords if dataset[name].dims == (dim,) and _role(str(name), dataset[name]) != "other"
    ]
    return dataset[along[0]].values if along else np.arange(dataset.sizes[dim])


def _value(dataset, dim: str, index: int) -> float | str:
    value = _values(dataset, dim)[index]
    text = _text(value)
    of = unit(dataset[dim]) if dim in dataset.variables else ""
    return f"{text} {of}" if of not in ("", "1") else float(value) if _is_number(value) else text


def _is_number(value) -> bool:
    return np.issubdtype(np.asarray(value).dtype, np.number)


def _text(value) -> str:
    if isinstance(value, bytes):
        return value.decode(errors="replace").strip()
    return f"{float(value):.9g}" if _is_number(value) else str(value).strip()


def _is_pressure(dataset, dim: str) -> bool:
    return dim in dataset.variables and unit(dataset[dim]).lower() in {
        "hpa",
        "pa",
        "mb",
        "mbar",
        "millibar",
        "millibars",
    }
