# SPDX-License-Identifier: GPL-3.0-or-later
"""What Stormfield does when files are saved and loaded or the scene changes. Nothing here serves renders."""

import bpy
from bpy.app.handlers import persistent

from .scene.write import cache_folders, mirror
from .session import (
    found_caches,
    freshness,
    mesh_edits,
    morse_preview,
    morse_state,
    running,
    solver_state,
    view_selection,
)
from .ui import overlay


@persistent
def move_caches_to_file(blend: str, *_):
    cache_folders.move_temporary_caches(blend)


@persistent
def keep_lambda_without_addon(*_):
    mirror.mirror_all()


@persistent
def stop_job(*_):
    running.request_cancel()


@persistent
def forget_drawings(*_):
    overlay.forget()
    freshness.forget()


@persistent
def forget_solver(*_):
    solver_state.forget()


@persistent
def forget_morse(*_):
    morse_preview.forget()
    morse_state.forget()


@persistent
def look_for_baked_caches(*_):
    found_caches.look_soon()


@persistent
def mark_changed(_scene, depsgraph):
    overlay.mark_changed(depsgraph)
    freshness.mark_changed(depsgraph)


@persistent
def follow_mesh_edits(_scene, depsgraph):
    mesh_edits.follow_updates(depsgraph)


@persistent
def follow_all_meshes(*_):
    mesh_edits.follow_all()


@persistent
def follow_surfaces(scene, *_):
    if not bpy.app.is_job_running("RENDER"):
        mesh_edits.follow_surfaces(scene)


@persistent
def follow_view(scene, *_):
    view_selection.follow(scene)


@persistent
def preview_morse_sets(scene, *_):
    """Live previews follow λ; without a window none is drawn."""
    if bpy.app.background:
        return
    for obj in scene.objects:
        if obj.type == "MESH" and obj.stormfield.enabled and obj.stormfield.morse.live:
            morse_preview.follow(obj)


HANDLERS = (
    ("save_pre", follow_all_meshes),
    ("save_pre", move_caches_to_file),
    ("save_pre", keep_lambda_without_addon),
    ("load_pre", stop_job),
    ("load_post", forget_drawings),
    ("load_post", forget_morse),
    ("load_post", forget_solver),
    ("load_post", look_for_baked_caches),
    ("undo_post", forget_drawings),
    ("redo_post", forget_drawings),
    ("load_post", follow_all_meshes),
    ("undo_post", follow_all_meshes),
    ("redo_post", follow_all_meshes),
    ("depsgraph_update_post", follow_mesh_edits),
    ("depsgraph_update_post", mark_changed),
    ("depsgraph_update_post", follow_view),
    ("depsgraph_update_post", preview_morse_sets),
    ("frame_change_post", follow_surfaces),
    ("frame_change_post", preview_morse_sets),
)


def register() -> None:
    for name, function in HANDLERS:
        getattr(bpy.app.handlers, name).append(function)


def unregister() -> None:
    found_caches.stop()
    solver_state.forget()
    for name, function in HANDLERS:
        functions = getattr(bpy.app.handlers, name)
        if function in functions:
            functions.remove(function)
