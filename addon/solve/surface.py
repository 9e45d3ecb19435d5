# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a mesh is solved on. Each step is made when it is asked for first, and once.

surface = SolveSurface(mesh, design.settings)
surface.manifold, surface.refined, surface.solved
"""

from __future__ import annotations

from functools import cached_property

from .. import native
from ..model.design import SolveSettings
from ..model.manifold import Manifold, manifold
from ..model.mesh_data import MeshData
from ..model.refinement import refined


class SolveSurface:
    """The surface in a mesh, joined and refined as the settings ask for. Its members raise InputError where the mesh
    is no surface, or would have too many faces."""

    def __init__(self, mesh: MeshData, settings: SolveSettings) -> None:
        self.mesh, self.weld, self.edge = mesh, settings.weld, settings.edge

    @cached_property
    def manifold(self) -> Manifold:
        """The surface, with the vertices of the mesh alone."""
        return manifold(self.mesh, self.weld)

    @cached_property
    def refined(self) -> MeshData:
        """The surface that is solved on."""
        return refined(self.manifold.mesh, self.edge)

    @cached_property
    def solved(self) -> native.TriangleMesh:
        """The same in the core."""
        return native.TriangleMesh(self.refined.vertices, self.refined.triangles)

    @cached_property
    def coarse(self) -> native.TriangleMesh:
        """The surface in the core, with the vertices of the mesh alone."""
        if self.refined is self.manifold.mesh:
            return self.solved
        return native.TriangleMesh(self.manifold.mesh.vertices, self.manifold.mesh.triangles)

    def is_of(self, mesh: MeshData) -> bool:
        """Whether it was made from this mesh, or an equal one."""
        return self.mesh is mesh or self.mesh.fingerprint() == mesh.fingerprint()

    def is_made(self, mesh: MeshData, settings: SolveSettings) -> bool:
        """Whether it is what the mesh gives with these settings."""
        return (self.weld, self.edge) == (settings.weld, settings.edge) and self.is_of(mesh)

    def is_same(self, other: SolveSurface) -> bool:
        """Whether the same is solved on, on equal meshes."""
        if self is other:
            return True
        return self.is_of(other.mesh) and self.refined.fingerprint() == other.refined.fingerprint()
