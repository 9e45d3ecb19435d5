# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows of a tracking joined: the same paths and bifurcations as in one piece, however λ is cut.

A path that reaches the shared sample in one window goes on in the next: by Poincaré index and face, which both windows
get from the same numbers. What looks beyond a window is judged on whole paths: Hopf bifurcations here, persistence in
the core, and where there is no field.

    whole = joined([("a.json", part), ("b.json", next_part)])      # parts by window_part()
    tracking = from_native(whole.tracking, min_life, min_strength, whole.region)
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .. import native
from ..model.errors import InputError
from ..model.words import Json
from .no_field import Region
from .tracking import Begin, End
from .windows import COLUMNS, NONE, common_region, words_of

Named = tuple[str, Json]
Event = dict[str, Json]
#: Shorter lives are round-off of one event, as in the core.
INSTANT = 1e-12


@dataclass(frozen=True, eq=False)
class Joined:
    """The whole tracking, where there is no field, and λ of all samples."""

    tracking: native.Tracking
    region: Region
    lambdas: list[float]
    zero_vectors: int


def joined(windows: Sequence[Named]) -> Joined:
    """windows: (name, part) in any order. Raises InputError that names two that do not fit, or what is missing."""
    ordered = sorted(windows, key=lambda window: window[1]["lam"][0])
    for before, after in pairwise(ordered):
        _check_neighbours(before, after)
    parts = [part for _, part in ordered]
    paths, events = _chained(ordered)
    paths, events = _spliced(paths, events)
    events += _hopfs_at_cuts(paths)
    found = [_bifurcation(event) for event in sorted(events, key=lambda event: event["lam"])]
    tracking = native.Tracking([path.to_native() for path in paths], found)
    lambdas = parts[0]["lam"] + [lam for part in parts[1:] for lam in part["lam"][1:]]
    zeros = sum(parts[0]["zero_vectors"]) + sum(sum(part["zero_vectors"][1:]) for part in parts[1:])
    return Joined(tracking, common_region(parts), lambdas, zeros)


def _bifurcation(event: Event) -> native.Bifurcation:
    return native.Bifurcation(
        lam=float(event["lam"]),
        face=int(event["face"]),
        barycentric=np.asarray(event["barycentric"], np.float64),
        position=np.asarray(event["position"], np.float64),
        kind=event["kind"],
        node=event["node"],
        paths=event["paths"],
    )


def _check_neighbours(before: Named, after: Named) -> None:
    (first, a), (second, b) = before, after
    if a["lam"][-1] != b["lam"][0]:
        what = "overlap" if a["lam"][-1] > b["lam"][0] else "leave a gap"
        raise InputError(
            f"{first} ends at λ {a['lam'][-1]:.9g}, {second} begins at {b['lam'][0]:.9g}: they {what}; "
            "windows share exactly one sample"
        )
    if a["ends"][1] != b["ends"][0]:
        raise InputError(f"{first} and {second} have other meshes or fields at λ {b['lam'][0]:.9g}; track both anew")


@dataclass(eq=False)
class _Path:
    """A path of the whole while it is put together: its pieces, paths of windows, in the order of λ."""

    pieces: list[Json]
    begin: Begin
    end: End

    @property
    def life(self) -> float:
        return self.pieces[-1]["lambdas"][-1] - self.pieces[0]["lambdas"][0]

    @property
    def is_instant(self) -> bool:
        """Created and annihilated at once, at a cut: no path of its own."""
        return self.begin != "first" and self.end != "last" and self.life <= INSTANT

    def to_native(self) -> native.TrackedPath:
        lives = np.array([piece["lambdas"][-1] - piece["lambdas"][0] for piece in self.pieces])
        weights = lives / lives.sum() if lives.sum() > 0.0 else np.eye(len(self.pieces))[0]
        strength, rotation = (
            float(weights @ [piece[key] for piece in self.pieces]) for key in ("strength", "rotation")
        )
        samples = _samples(self.pieces)
        return native.TrackedPath(
            index=self.pieces[int(np.argmax(lives))]["index"],
            begin=self.begin,
            end=self.end,
            strength=strength,
            rotation=rotation,
            lambdas=samples["lambdas"],
            faces=samples["faces"],
            barycentric=samples["barycentric"],
            positions=samples["positions"],
            kinds=words_of(samples["kinds"]),
        )


def _samples(pieces: Sequence[Json]) -> dict[str, np.ndarray]:
    """Of all pieces. The sample at a cut is there once, or not at all where the path crosses an edge at that λ."""
    whole: dict[str, np.ndarray] = {key: pieces[0][key] for key in COLUMNS}
    for piece in pieces[1:]:
        before, after = whole["lambdas"], piece["lambdas"]
        crosses = (len(before) > 1 and before[-2] == before[-1]) or (len(after) > 1 and after[1] == after[0])
        kept = len(before) - 1 if crosses and len(before) > 1 else len(before)
        whole = {key: np.concatenate([whole[key][:kept], piece[key][1:]]) for key in COLUMNS}
    return whole


def _chained(windows: Sequence[Named]) -> tuple[list[_Path], list[Event]]:
    """Pieces that go on in the next window made one, in the order in which they begin; bifurcations of these paths."""
    paths: list[_Path] = []
    events: list[Event] = []
    reaching: list[_Path] = []
    for k, (name, part) in enumerate(windows):
        goes_on = _matched(windows[k - 1], (name, part)) if k else {}
        here = []
        for i, piece in enumerate(part["paths"]):
            if i in goes_on:
                path = reaching[goes_on[i]]
                path.pieces.append(piece)
                path.end = piece["end"]
            else:
                path = _Path([piece], piece["begin"], piece["end"])
                paths.append(path)
            here.append(path)
        number = {id(path): n for n, path in enumerate(paths)}
        events += [{**event, "paths": [number[id(here[i])] for i in event["paths"]]} for event in part["bifurcations"]]
        reaching = here
    return paths, events


def _matched(before: Named, after: Named) -> dict[int, int]:
    """Path of the later window → path of the earlier one that it continues. Charges of a face form a queue, as in the
    core: the one that came first is the first of the next window."""
    ends, starts = defaultdict(list), defaultdict(list)
    for i, path in enumerate(before[1]["paths"]):
        if path["end"] == "last":
            ends[path["index"], path["faces"][-1]].append((_entered(path), i))
    for i, path in enumerate(after[1]["paths"]):
        if path["begin"] == "first":
            starts[path["index"], path["faces"][0]].append(i)
    if {key: len(found) for key, found in ends.items()} != {key: len(found) for key, found in starts.items()}:
        raise InputError(f"{before[0]} and {after[0]} do not have the same fixed points at their common sample")
    return {i: j for key in ends for i, (_, j) in zip(starts[key], sorted(ends[key]), strict=True)}


def _entered(path: Json) -> float:
    """λ at which it came into its last face."""
    faces = path["faces"]
    other = np.flatnonzero(faces != faces[-1])
    return path["lambdas"][other[-1] + 1 if len(other) else 0]


def _spliced(paths: list[_Path], events: list[Event]) -> tuple[list[_Path], list[Event]]:
    """Without paths that are created and annihilated at one cut: the two that one of them connects become one, as in
    the core (PathSplicing in sweep.cpp)."""
    created = {i: e for e, event in enumerate(events) if event["kind"] == "creation" for i in event["paths"]}
    annihilated = {i: e for e, event in enumerate(events) if event["kind"] == "annihilation" for i in event["paths"]}
    becomes = list(range(len(paths)))
    gone: set[int] = set()

    def partner(event: int | None, path: int) -> int | None:
        if event is None:
            return None
        one, other = (becomes[i] for i in events[event]["paths"])
        return other if one == path else one

    for i, path in enumerate(paths):
        if i in gone or not path.is_instant:
            continue
        before, after = partner(annihilated.get(i), i), partner(created.get(i), i)
        gone.add(i)
        becomes[i] = -1
        if before is not None and before == after:
            gone.add(before)
            becomes[before] = -1
        elif before is not None and after is not None:
            kept, more = paths[before], paths[after]
            kept.pieces, kept.end = kept.pieces + _reversed(path.pieces) + more.pieces, more.end
            annihilated[before] = annihilated.get(after, -1)
            becomes = [before if number == after else number for number in becomes]
            gone.add(after)
        elif before is not None:
            paths[before].pieces += _reversed(path.pieces)
            paths[before].end = "boundary"
        elif after is not None:
            paths[after].pieces[:0] = _reversed(path.pieces)
            paths[after].begin = "boundary"
    left = [i for i in range(len(paths)) if i not in gone]
    number = {old: new for new, old in enumerate(left)}
    kept_events = [
        {**event, "paths": [number[becomes[i]] for i in event["paths"]]}
        for event in events
        if all(becomes[i] in number for i in event["paths"])
    ]
    return [paths[i] for i in left], kept_events


def _reversed(pieces: Sequence[Json]) -> list[Json]:
    """The way back along a path without life, of the opposite index, which says nothing of stability."""
    margins = {"first": 0, "last": 0, "first_certain": 0, "last_certain": 0, "before": NONE, "after": NONE}
    return [{**piece, **{key: piece[key][::-1] for key in COLUMNS}, "margins": margins} for piece in reversed(pieces)]


def _hopfs_at_cuts(paths: Sequence[_Path]) -> list[Event]:
    """Changes of stability that are certain only when both sides of a cut are known."""
    found: list[Event] = []
    for i, path in enumerate(paths):
        certain, trace, changes = 0, 0, []
        for piece in path.pieces:
            margins = piece["margins"]
            if trace and margins["first"] == -trace:
                changes.append(_change_at_start(piece))
            changes += _changes(margins["before"])
            if margins["first_certain"]:
                if certain == -margins["first_certain"]:
                    node = "source" if margins["first_certain"] > 0 else "sink"
                    found.append({**changes[len(changes) // 2], "kind": "hopf", "node": node, "paths": [i]})
                certain, changes = margins["last_certain"], _changes(margins["after"])
            trace = margins["last"] or trace
    return found


def _changes(given: Json) -> list[Event]:
    columns = (given["lambdas"], given["faces"], given["barycentric"], given["positions"])
    return [
        {"lam": lam, "face": face, "barycentric": weights, "position": position}
        for lam, face, weights, position in zip(*columns, strict=True)
    ]


def _change_at_start(piece: Json) -> Event:
    """Where the trace is zero at the cut itself."""
    keys = (("lam", "lambdas"), ("face", "faces"), ("barycentric", "barycentric"), ("position", "positions"))
    return {one: piece[all_of_them][0] for one, all_of_them in keys}
