# SPDX-License-Identifier: GPL-3.0-or-later
"""What Stormfield does when files are saved and loaded or the scene changes. Nothing here serves renders."""

from pathlib import Path

import bpy
from bpy.app.handlers import persistent

from .scene.write import cache_files, cache_folders, mirror, sequence_folders
from .session import (
    coarse_mesh,
    edit_preview,
    found_caches,
    freshness,
    made_caches,
    mesh_edits,
    morse_preview,
    morse_state,
    running,
    saves,
    shared_caches,
    solver_state,
    view_selection,
)
from .ui import overlay


@persistent
def bring_caches_along(blend: str, *_):
    if blend:
        saves.begin(cache_folders.bring_along(blend))


@persistent
def name_sequences(*_):
    sequence_folders.name_sequences()


@persistent
def end_saving(blend: str, *_):
    if Path(blend) == Path(bpy.data.filepath):
        saves.end()
    else:
        saves.end_as_copy()
    made_caches.are_saved()


@persistent
def forget_caches(*_):
    made_caches.forget()
    saves.forget()


@persistent
def find_moved_caches(*_):
    cache_folders.find_moved()
    cache_files.part_copies()


@persistent
def part_copied_objects(*_):
    if not bpy.app.is_job_running("RENDER"):
        shared_caches.part_new_copies()


@persistent
def keep_lambda_without_addon(*_):
    saves.keep_lambda(mirror.mirror_all(bpy.context))


@persistent
def stop_job(*_):
    running.request_cancel()


@persistent
def forget_drawings(*_):
    overlay.forget()
    freshness.forget()
    coarse_mesh.forget()


@persistent
def forget_solver(*_):
    solver_state.forget()


@persistent
def forget_morse(*_):
    edit_preview.forget()
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
    ("save_pre", part_copied_objects),
    ("save_pre", bring_caches_along),
    ("save_pre", name_sequences),
    ("save_pre", keep_lambda_without_addon),
    ("save_post", end_saving),
    ("save_post_fail", end_saving),
    ("load_pre", stop_job),
    ("load_post", forget_caches),
    ("load_post", find_moved_caches),
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
    ("depsgraph_update_post", part_copied_objects),
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
