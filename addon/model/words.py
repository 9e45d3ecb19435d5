# SPDX-License-Identifier: GPL-3.0-or-later
"""Words that the add-on shares with the compiled core, as types; its stubs have the same."""

from typing import Any, Literal, TypedDict

import numpy as np

#: What json.load gives, and json.dump takes.
Json = Any

MorseMethod = Literal["geometry", "tau", "spatial"]
FlowMapBasis = Literal["uv", "object"]
FixedPointKind = Literal["source", "sink", "saddle", "center", "degenerate"]
OrbitKind = Literal["attracting", "repelling", "center", "degenerate"]
MorseKind = Literal["source", "sink", "saddle", "attracting", "repelling", "trivial", "other"]


class MorseOptions(TypedDict, total=False):
    """Options of native.morse, which explains them."""

    method: MorseMethod
    tau: float | None
    eps: float
    relative: bool
    weights: np.ndarray | None
    refine: bool
    tau_max: float | None
    max_seconds: float | None
    persistence: bool | None
    keep_empty: bool
    keep_trivial: bool
