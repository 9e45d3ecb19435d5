# SPDX-License-Identifier: GPL-3.0-or-later
"""Where objects are, also those that the window does not show.

Blender evaluates what a view layer shows. Objects in collections that are unchecked, disabled or hidden, of other
scenes or of none, keep the matrix they had, which is the identity after a file is opened. Copies of such objects are
evaluated in a scene of their own, where parents, constraints, drivers and keys count as for the objects themselves.

    with Places(context) as places:
        places.matrix_world(obj)
        places.at_frame(12, 0.0)
"""

from dataclasses import dataclass
from typing import Any

import bpy
from mathutils import Matrix

from ...model.errors import InputError


@dataclass(frozen=True)
class Placed:
    """An object that its dependency graph evaluates."""

    object: bpy.types.Object
    depsgraph: bpy.types.Depsgraph

    @property
    def evaluated(self) -> bpy.types.Object:
        return self.object.evaluated_get(self.depsgraph)


class Places:
    """Objects at one frame of the context's scene; a context manager, which removes what it made."""

    def __init__(self, context: bpy.types.Context):
        self._context = context
        self._scene: Any = None
        self._copies: dict[bpy.types.Object, bpy.types.Object] = {}
        self._frame = (context.scene.frame_current, context.scene.frame_subframe)

    def __enter__(self) -> "Places":
        return self

    def __exit__(self, *_exception) -> None:
        for copy in self._copies.values():
            bpy.data.objects.remove(copy)
        self._copies.clear()
        if self._scene is not None:
            bpy.data.scenes.remove(self._scene)
            self._scene = None

    def at_frame(self, frame: int, subframe: float = 0.0) -> None:
        """Go to a frame of the context's scene; whoever calls goes back."""
        self._frame = (frame, subframe)
        self._context.scene.frame_set(frame, subframe=subframe)
        if self._scene is not None:
            self._scene.frame_set(frame, subframe=subframe)

    def matrix_world(self, obj: bpy.types.Object) -> Matrix:
        return self.of(obj).evaluated.matrix_world

    def of(self, obj: bpy.types.Object) -> Placed:
        """The object, or its copy where the window does not show it. Raises InputError where no scene can place it."""
        if obj.visible_get(view_layer=self._context.view_layer):
            return Placed(obj, self._context.evaluated_depsgraph_get())
        if obj not in self._copies:
            self._copies[obj] = self._copy(obj)
        placed = Placed(self._copies[obj], self._scene.view_layers[0].depsgraph)
        if not placed.evaluated.is_evaluated or placed.evaluated.hide_viewport:
            raise InputError(f"'{obj.name}' is hidden by an animation, so it has no place; show it and solve again")
        return placed

    def with_rest_positions(self, obj: bpy.types.Object) -> bpy.types.Mesh:
        """The evaluated mesh of a copy that carries Blender's attribute `rest_position` through all modifiers."""
        if obj not in self._copies:
            self._copies[obj] = self._copy(obj)
        copy: Any = self._copies[obj]
        if not copy.add_rest_position_attribute:
            copy.add_rest_position_attribute = True
            self._scene.view_layers[0].update()
        return copy.evaluated_get(self._scene.view_layers[0].depsgraph).data

    def _copy(self, obj: bpy.types.Object) -> bpy.types.Object:
        if obj.mode == "EDIT":
            obj.update_from_editmode()
        scene = self._scene or self._new_scene()
        copy: Any = obj.copy()
        copy.hide_viewport = False
        copy.stormfield.enabled = False  # no field of its own: it may share the caches of the other
        scene.collection.objects.link(copy)
        scene.frame_set(self._frame[0], subframe=self._frame[1])
        return copy

    def _new_scene(self) -> bpy.types.Scene:
        shown = self._context.scene
        self._scene = scene = bpy.data.scenes.new("Stormfield Places")
        scene.render.fps, scene.render.fps_base = shown.render.fps, shown.render.fps_base
        scene.render.frame_map_old, scene.render.frame_map_new = shown.render.frame_map_old, shown.render.frame_map_new
        scene.frame_start, scene.frame_end = shown.frame_start, shown.frame_end
        return scene
