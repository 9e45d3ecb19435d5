# SPDX-License-Identifier: GPL-3.0-or-later
"""What matters to an artist: how far entities and events stand above the accuracy of a solve, and which are storms.

A weight of 1 is the accuracy: what weighs less may come from the solve alone and not from the design. No Blender here.

    orbit_weight(multiplier), path_weight(path, strongest), event_weight(event, paths, strongest)
    is_storm(jacobian); storm_event(event, tracking)    # "storms merge", "storm splits", or ""
"""

import math
from collections.abc import Sequence

import numpy as np

from .tracking import Bifurcation, TrackedPath, Tracking

#: Weight of what is never hidden.
ALWAYS = 1e30
#: Relative error of the vectors of a solved field.
ACCURACY = 0.005
#: Life (fraction of λ) times relative strength of what weighs 1: at the accuracy for its whole life, or short-lived.
FAINT = 2 * ACCURACY
#: The flow turns around a fixed point whose rotation is more than twice its trace.
TURNING = 0.5
#: A saddle is between two storms when the way over it is at most this much longer; looked at so long before they meet.
BETWEEN, BEFORE = 1.5, 0.1


def orbit_weight(multiplier: float) -> float:
    """How clearly neighbours approach or leave an orbit.

    Between an orbit and the next one in its nest neighbours drift by at most about |log multiplier| / (8 π) of the
    speed; an error of the field of that size removes the orbit or makes another."""
    return abs(math.log(max(multiplier, 1e-300))) / (8.0 * math.pi * ACCURACY)


def path_weight(path: TrackedPath, strongest: float) -> float:
    """How long and how strongly a fixed point lives; strongest: of all paths, 1/s."""
    return path.life * path.strength / max(strongest, 1e-300) / FAINT


def event_weight(event: Bifurcation, paths: Sequence[TrackedPath], strongest: float) -> float:
    """Of the weaker of the fixed points that appear or vanish together; ALWAYS where they are not known."""
    return min((path_weight(paths[i], strongest) for i in event.paths), default=ALWAYS)


def is_storm(jacobian: np.ndarray) -> bool:
    """Whether the flow turns around a fixed point more than it leaves or enters it."""
    trace, rotation = jacobian[0, 0] + jacobian[1, 1], jacobian[1, 0] - jacobian[0, 1]
    return bool(np.linalg.det(jacobian) > 0 and abs(trace) < TURNING * abs(rotation))


def is_storm_path(path: TrackedPath) -> bool:
    """The same for most of a path's life: pure rotation turns twice as fast as its strength."""
    return path.index > 0 and abs(path.rotation) > 1.6 * path.strength


def storm_event(event: Bifurcation, tracking: Tracking) -> str:
    """What happens to storms; empty for everything else.

    Storms merge where one vanishes with the saddle between it and another that turns alike; one splits where the same
    happens backwards."""
    if event.kind not in {"creation", "annihilation"} or len(event.paths) != 2:
        return ""
    storm, saddle = (tracking.paths[i] for i in event.paths)
    strongest = max(path.strength for path in tracking.paths)
    if not is_storm_path(storm) or path_weight(storm, strongest) < 1.0:
        return ""
    merges = event.kind == "annihilation"
    for other in tracking.paths:
        alike = other.id != storm.id and is_storm_path(other) and other.rotation * storm.rotation > 0
        if alike and other.first <= event.lam <= other.last and _is_between(saddle, storm, other, merges):
            return "storms merge" if merges else "storm splits"
    return ""


def _is_between(saddle: TrackedPath, storm: TrackedPath, other: TrackedPath, merges: bool) -> bool:
    """Shortly before two storms merge, or after they split."""
    three = (saddle, storm, other)
    if merges:
        lam = max(storm.last - BEFORE, *(path.first for path in three))
    else:
        lam = min(storm.first + BEFORE, *(path.last for path in three))
    middle, one, two = (path.at(lam) for path in three)
    if middle is None or one is None or two is None:
        return False
    over = np.linalg.norm(middle - one) + np.linalg.norm(middle - two)
    return bool(over <= BETWEEN * np.linalg.norm(one - two))
