# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of a field are followed: in one piece, in windows of this process or by Dask, or as one part for stitch."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from ..model.errors import InputError
from .field_input import FieldInput
from .memory import shown, size_of, windows_that_fit
from .progress import progress
from .window import window_of

if TYPE_CHECKING:
    from .. import native
    from ..analysis.stitching import Joined


def followed_whole(given: FieldInput, windows: int | None, scheduler: str | None, limit: float) -> Joined:
    """In one piece where memory holds it, else in windows. Windows on other machines are not judged."""
    from .dask_windows import has_dask, windows_of

    samples, vertices = len(given.data.lambdas), given.mesh.vertex_count
    if scheduler is not None:
        return _by_dask(given, windows_of(samples, windows or 1), scheduler, None)
    needed = windows_that_fit(samples, vertices, limit, given.name)
    chosen = windows_of(samples, windows or needed)
    size = max(size_of(last - first + 1, vertices) for first, last in chosen)
    if size > limit:
        raise InputError(
            f"{given.name}: {len(chosen)} windows of {samples} samples need {shown(size)} of memory each, and "
            f"{shown(limit)} may be used; give --windows {needed}, or --memory"
        )
    if windows is None and needed > 1:
        given.note(
            f"{samples} samples of {vertices} vertices need {shown(size_of(samples, vertices))} of memory, and "
            f"{shown(limit)} may be used: followed in {len(chosen)} windows, one after another"
        )
        return _one_after_another(given, chosen)
    if len(chosen) == 1:
        return _in_one_piece(given)
    if not has_dask():
        given.note("Dask is not installed: windows are followed one after another; pip install distributed")
        return _one_after_another(given, chosen)
    return _by_dask(given, chosen, None, int(limit / size) if np.isfinite(limit) else None)


def _in_one_piece(given: FieldInput) -> Joined:
    from ..analysis.no_field import region_without_field
    from ..analysis.stitching import Joined

    data = given.data
    followed, tangents = _followed(given, data.lambdas, data.vectors)
    zeros = int((tangents == 0.0).sum())
    return Joined(followed, region_without_field(given.mesh, tangents), [float(lam) for lam in data.lambdas], zeros)


def _one_after_another(given: FieldInput, windows: list[tuple[int, int]]) -> Joined:
    from ..analysis.stitching import joined
    from ..analysis.windows import window_part

    parts = []
    for k, (first, last) in enumerate(windows):
        lambdas = given.data.lambdas[first : last + 1]
        vectors = given.data.vectors[first : last + 1]
        followed, tangents = _followed(given, lambdas, vectors, f"Tracking window {k + 1} of {len(windows)}")
        parts.append((f"samples {first} to {last}", window_part(followed, given.mesh, lambdas, tangents)))
    with given.phases("stitch"):
        return joined(parts)


def _by_dask(given: FieldInput, windows: list[tuple[int, int]], scheduler: str | None, at_once: int | None) -> Joined:
    from ..analysis.stitching import joined
    from ..work import run
    from .dask_windows import follow

    with given.phases("track"), progress("Tracking") as show:
        parts = run(follow(given.data, windows, scheduler, at_once), show)
    with given.phases("stitch"):
        return joined(parts)


def write_part(given: FieldInput, start: str | None, to: str | None, limit: float) -> None:
    """A window, for stormfield stitch."""
    from ..analysis.windows import SCHEMA, part_to_json, window_part

    window = window_of(given.data, start, to, given.name)
    size = size_of(len(window.lambdas), given.mesh.vertex_count)
    if size > limit:
        raise InputError(
            f"{given.name}: the {len(window.lambdas)} samples of the window need {shown(size)} of memory, and "
            f"{shown(limit)} may be used; choose a shorter window, or give --memory"
        )
    followed, tangents = _followed(given, window.lambdas, window.vectors)
    part = window_part(followed, given.mesh, window.lambdas, tangents)
    given.write_part(SCHEMA, window.read, part_to_json(part))


def _followed(
    given: FieldInput, lambdas: np.ndarray, vectors: Iterable[np.ndarray], title: str = "Tracking"
) -> tuple[native.Tracking, np.ndarray]:
    """The tracking of some samples, and their tangents."""
    from .. import native
    from ..analysis import tracking
    from ..work import result_of, run

    with given.phases("track"), progress(title) as show:
        tangents = np.stack([native.VectorField.from_space(given.mesh, sample).values for sample in vectors])
        job = tracking.start(native.ParameterizedField(given.mesh, np.asarray(lambdas, np.float64), tangents))
        return run(result_of(job, 0.0, "following fixed points"), show), tangents
