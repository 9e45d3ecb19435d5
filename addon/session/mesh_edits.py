# SPDX-License-Identifier: GPL-3.0-or-later
"""Which meshes with a field Blender reports as changed, so that caches of other meshes are turned off at once, and
fields turn with surfaces that something begins to move.

A mesh is looked at when Blender reports a change of the mesh itself, and an object when it has got another mesh; moving
λ costs a look-up.
"""

import bpy

from ..scene.write.mesh_edits import follow_mesh
from ..scene.write.turning import follow_surface

_meshes: dict[int, int] = {}  #: session uid of the mesh of each object, by the object's


def follow_updates(depsgraph: bpy.types.Depsgraph) -> None:
    """Called after Blender has evaluated changes, which it does once more where this changes something."""
    changed: set[int] = set()
    objects: list[bpy.types.Object] = []
    for update in depsgraph.updates:
        if not update.is_updated_geometry:
            continue
        original = update.id.original
        if isinstance(original, bpy.types.Mesh):
            changed.add(original.session_uid)
        elif isinstance(original, bpy.types.Object) and original.type == "MESH":
            objects.append(original)
    for obj in objects:
        if not _has_field(obj):
            continue
        if obj.data.session_uid in changed or _has_new_mesh(obj):
            _meshes[obj.session_uid] = obj.data.session_uid
            follow_mesh(obj)
        follow_surface(obj)


def follow_all() -> None:
    """Look at every mesh with a field: another file, another step of undo, or a file that is to be written."""
    for obj in bpy.data.objects:
        if obj.type == "MESH" and _has_field(obj):
            follow_mesh(obj)
            follow_surface(obj)


def follow_surfaces(scene: bpy.types.Scene) -> None:
    """Called at another frame, of which Blender reports no changes."""
    for obj in scene.objects:
        if obj.type == "MESH" and _has_field(obj):
            follow_surface(obj)


def _has_field(obj: bpy.types.Object) -> bool:
    return obj.stormfield.enabled and obj.is_editable


def _has_new_mesh(obj: bpy.types.Object) -> bool:
    return _meshes.get(obj.session_uid) != obj.data.session_uid
