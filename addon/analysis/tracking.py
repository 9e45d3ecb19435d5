# SPDX-License-Identifier: GPL-3.0-or-later
"""The history of a field's fixed points over λ as plain data: paths and bifurcations (thesis 10.1.4, 11.2.2).

    job = start(field)                                     # native.ParameterizedField; job: fraction, done, cancel()
    tracking = from_native(job.result(), min_life=0.005)   # or at once: tracking = track(field, min_life=0.005)
    for path in tracking.paths: path.positions, path.lambdas, path.kinds
    for event in tracking.bifurcations: event.lam, event.position, event.title

A path never breaks: it begins at the first λ, at the mesh boundary or by a creation, and ends at the last λ, at the
boundary or by an annihilation. No Blender here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from .. import native
from ..model.words import FixedPointKind, Json
from .no_field import Region

Begin = Literal["first", "boundary", "creation"]
End = Literal["last", "boundary", "annihilation"]

#: Shortest life shown by default: shorter paths come and go within half a percent of λ.
MIN_LIFE = 0.005
#: First letters of names, as in the entity connection graph.
LETTERS: dict[FixedPointKind, str] = {"source": "R", "sink": "A", "saddle": "S", "center": "C", "degenerate": "D"}


@dataclass(frozen=True, eq=False)
class TrackedPath:
    """One fixed point over λ; k samples with λ increasing. Lengths in mesh units, positions in object space."""

    id: int  #: place in Tracking.paths
    name: str  #: short and unique: "S3" saddle, "R1" source, "A2" sink, "C4" center; numbered from 1 over all paths
    kind: FixedPointKind  #: what it is for the longest part of its life
    index: int  #: Poincaré index, +1 or -1, the same all along
    lambdas: np.ndarray  #: (k,) float64
    positions: np.ndarray  #: (k, 3) float64
    faces: np.ndarray  #: (k,) int32, triangle that holds the sample
    barycentric: np.ndarray  #: (k, 3) float64
    kinds: tuple[FixedPointKind, ...]  #: (k,) kind at each sample
    begin: Begin
    end: End
    strength: float  #: mean of sqrt|det J| over its life, 1/s
    rotation: float  #: mean of the curl over its life, 1/s: > 0 turns counter-clockwise seen from outside

    @property
    def first(self) -> float:
        """λ where it begins."""
        return float(self.lambdas[0])

    @property
    def last(self) -> float:
        """λ where it ends."""
        return float(self.lambdas[-1])

    @property
    def life(self) -> float:
        """Fraction of λ it lives through: its persistence."""
        return self.last - self.first

    @property
    def samples(self) -> np.ndarray:
        """(k, 4) float64: λ, x, y, z."""
        return np.column_stack([self.lambdas, self.positions])

    def at(self, lam: float) -> np.ndarray | None:
        """Position (3,) at λ, between samples on the chord; None outside its life."""
        if not self.first <= lam <= self.last:
            return None
        return np.array([np.interp(lam, self.lambdas, self.positions[:, k]) for k in range(3)])


@dataclass(frozen=True, eq=False)
class Bifurcation:
    """Where the topology changes."""

    id: int  #: place in Tracking.bifurcations
    lam: float
    position: np.ndarray  #: (3,) float64
    kind: Literal["creation", "annihilation", "hopf"]
    node: FixedPointKind  #: creation, annihilation: source or sink that meets the saddle; hopf: what the path becomes
    paths: tuple[int, ...]  #: creation, annihilation: node's path, saddle's path; hopf: one

    @property
    def title(self) -> str:
        """What happens, for a list or a timeline marker."""
        if self.kind == "hopf":
            return f"becomes {self.node}"
        return f"saddle and {self.node} {'appear' if self.kind == 'creation' else 'vanish'}"


@dataclass(frozen=True, eq=False)
class Tracking:
    """All paths, in the order they begin, and all bifurcations, in the order of λ."""

    paths: tuple[TrackedPath, ...]
    bifurcations: tuple[Bifurcation, ...]

    def alive(self, lam: float) -> tuple[TrackedPath, ...]:
        """The paths that live at λ."""
        return tuple(path for path in self.paths if path.first <= lam <= path.last)


def track(field: native.ParameterizedField, min_life: float = 0.0, min_strength: float = 0.0) -> Tracking:
    """Follows every fixed point of a native ParameterizedField; waits for it. See from_native for the filter."""
    return from_native(start(field).result(), min_life, min_strength)


def start(field: native.ParameterizedField) -> native.TrackingJob:
    """The same on a thread of its own: a native TrackingJob (fraction, done, wait, cancel, result)."""
    return native.start_tracking(field)


def from_native(
    tracking: native.Tracking, min_life: float = 0.0, min_strength: float = 0.0, region: Region | None = None
) -> Tracking:
    """A native Tracking as plain data, without what lives shorter than min_life (fraction of λ) or is weaker (1/s).

    Short paths go in pairs, and folds become one path: the sum of indices stays, and every end is still classified.
    Weak ones are left out; a bifurcation stays while one of its paths does, and names those that do. The native object
    is not changed: keep it to filter again. region: without a field at any λ; paths in it are left out.
    """
    if min_life > 0.0 or min_strength > 0.0:
        tracking = tracking.persistent(min_life, min_strength)
    paths = [path for path in enumerate(tracking.paths) if region is None or not _lies_in(path[1], region)]
    number = {old: new for new, (old, _) in enumerate(paths)}
    events = [
        (event, tuple(number[path] for path in event.paths if path in number))
        for event in tracking.bifurcations
        if not event.paths or any(path in number for path in event.paths)
    ]
    return Tracking(
        tuple(_path(i, path) for i, (_, path) in enumerate(paths)),
        tuple(
            Bifurcation(i, event.lam, np.asarray(event.position), event.kind, event.node, left)
            for i, (event, left) in enumerate(events)
        ),
    )


def _lies_in(path: native.TrackedPath, region: Region) -> bool:
    """Whether all of a path lies where there is no field."""
    if not region.vertices.any():
        return False
    return all(region.holds(face, weights) for face, weights in zip(path.faces, path.barycentric, strict=True))


def _path(i: int, path: native.TrackedPath) -> TrackedPath:
    return TrackedPath(
        id=i,
        name=f"{LETTERS[path.kind]}{i + 1}",
        kind=path.kind,
        index=path.index,
        lambdas=path.lambdas,
        positions=path.positions,
        faces=path.faces,
        barycentric=path.barycentric,
        kinds=tuple(path.kinds),
        begin=path.begin,
        end=path.end,
        strength=path.strength,
        rotation=path.rotation,
    )


def to_json(tracking: Tracking) -> dict[str, Json]:
    """The paths and bifurcations of `stormfield track` as plain JSON values (docs/formats.md)."""
    return {
        "paths": [
            {
                "name": path.name,
                "kind": path.kind,
                "index": path.index,
                "life": path.life,
                "strength": path.strength,
                "rotation": path.rotation,
                "ends": [path.begin, path.end],
                "samples": path.samples.tolist(),
                "kinds": list(path.kinds),
            }
            for path in tracking.paths
        ],
        "bifurcations": [
            {
                "lam": event.lam,
                "position": event.position.tolist(),
                "kind": event.kind,
                "node": event.node,
                "paths": list(event.paths),
            }
            for event in tracking.bifurcations
        ],
    }
