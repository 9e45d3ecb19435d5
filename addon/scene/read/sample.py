# SPDX-License-Identifier: GPL-3.0-or-later
"""The field of the λ sample nearest to a λ: what edits act on."""

import bpy
import numpy as np

from ... import native
from ...analysis.steps import field_steps
from ...model.mesh_data import MeshData
from ...work import Steps
from .current_field import cache_of, surface_in


class Sample:
    """On the surface in an object's mesh."""

    def __init__(self, obj: bpy.types.Object, mesh: MeshData, lam: float, attribute: str):
        cache = cache_of(obj, mesh)
        number = int(np.argmin(np.abs(cache.lambdas - lam)))
        self.mesh, self.surface = mesh, surface_in(obj, mesh)
        self.values = self.surface.to_surface(cache.sample(number)[attribute]).astype(np.float64)
        self.lam = float(cache.lambdas[number])

    def field(self) -> Steps["native.VectorField"]:
        _, field = yield from field_steps(self.surface.mesh, self.values)
        return field
