# SPDX-License-Identifier: GPL-3.0-or-later
"""Sizes and speeds of data in a scene: globes of 6371 km are too large to look at, their storms too slow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .field_data import FieldData

#: Radii that the mean speed of a globe crosses in a second where its times are not known.
USUAL_SPEED = 0.1


@dataclass(frozen=True)
class SceneScale:
    """lengths: mesh units of one unit of the data. speeds: mesh units per second of the scene of one unit of the data.
    words: what that means."""

    lengths: float
    speeds: float
    words: str

    @classmethod
    def of(cls, data: FieldData, radius: float, seconds: float) -> SceneScale:
        """Globes get a radius, and the speeds of a time lapse in which the data take the scene's seconds; other
        surfaces stay as they are."""
        geography = data.geography
        if geography is None or not geography.spherical:
            return cls(1.0, 1.0, "size and speeds are those of the data")
        lengths = radius / float(np.linalg.norm(data.mesh.vertices[0]))
        lapse = geography.seconds
        if lapse is not None and lapse > 0.0:
            words = f"a second of the scene is {lapse / seconds / 3600.0:.3g} hours"
            return cls(lengths, lengths * lapse / seconds, words)
        mean = float(np.linalg.norm(data.vectors[0], axis=1).mean())
        speeds = USUAL_SPEED * radius / mean if mean > 0.0 else lengths
        return cls(
            lengths, speeds, "the data have no span of time: the mean speed crosses a tenth of the radius a second"
        )
