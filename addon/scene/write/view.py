# SPDX-License-Identifier: GPL-3.0-or-later
"""The artist's 3D view: turned to what was made, shaded so that it shows, playing. Nothing of the scene changes."""

import bpy
from mathutils import Vector


def view_area(context: bpy.types.Context) -> bpy.types.Area | None:
    """The 3D view that the artist works in, or the largest one; none in background mode."""
    if bpy.app.background or context.screen is None:
        return None
    if context.area is not None and context.area.type == "VIEW_3D":
        return context.area
    views = [area for area in context.screen.areas if area.type == "VIEW_3D"]
    return max(views, key=lambda area: area.width * area.height, default=None)


def look_at(context: bpy.types.Context, place: Vector, direction: Vector, distance: float) -> None:
    """Look at a place of the world from that direction and distance (world units), in perspective."""
    area = view_area(context)
    if area is None:
        return
    region = area.spaces.active.region_3d
    region.view_perspective = "PERSP"
    region.view_rotation = direction.to_track_quat("Z", "Y")
    region.view_location, region.view_distance = place, distance
    area.tag_redraw()


def show_materials(context: bpy.types.Context) -> None:
    """Material Preview, unless the view renders already."""
    area = view_area(context)
    if area is not None and area.spaces.active.shading.type != "RENDERED":
        area.spaces.active.shading.type = "MATERIAL"


def play(context: bpy.types.Context) -> None:
    """Play the scene from its first frame, as the space bar does."""
    context.scene.frame_set(context.scene.frame_start)
    if view_area(context) is not None and not context.screen.is_animation_playing:
        bpy.ops.screen.animation_play()
