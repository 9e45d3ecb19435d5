# SPDX-License-Identifier: GPL-3.0-or-later
"""Add → Stormfield → Storm Merge in files with work in them: it stands free, changes nothing else, and flows."""

from itertools import pairwise

import bpy
import numpy as np
import pytest
from mathutils import Vector


@pytest.fixture
def default_scene(addon):
    """Blender's default scene: cube, light and camera."""
    bpy.ops.wm.read_factory_settings()
    return bpy.context.scene


def settings_of(struct, depth=2) -> dict[str, object]:
    """All settings of a struct and, to that depth, of what belongs to it."""
    found: dict[str, object] = {}
    for prop in struct.bl_rna.properties:
        if prop.type == "COLLECTION" or prop.identifier in {"rna_type", "users"}:
            continue
        if prop.identifier == "use_nodes":  # says nothing any more
            continue
        value = getattr(struct, prop.identifier)
        if prop.type != "POINTER":
            found[prop.identifier] = value[:] if getattr(prop, "is_array", False) else value
        elif isinstance(value, bpy.types.ID) or value is None:
            found[prop.identifier] = value and value.name
        elif depth > 0:
            found |= {f"{prop.identifier}.{k}": v for k, v in settings_of(value, depth - 1).items()}
    return found


def test_it_changes_no_setting_of_the_scene(default_scene, native):
    default_scene.frame_start, default_scene.frame_end = 7, 90
    before = settings_of(default_scene)
    assert {"render.engine", "frame_end", "view_settings.view_transform", "world", "camera"} <= before.keys()
    others = [obj.name for obj in bpy.data.objects]
    worlds, cameras = bpy.data.worlds[:], bpy.data.cameras[:]
    assert bpy.ops.stormfield.storm_merge() == {"FINISHED"}
    after = settings_of(default_scene)
    changed = {key for key, value in before.items() if after[key] != value}
    assert changed <= {"frame_current", "frame_float", "frame_current_final"}
    assert bpy.data.worlds[:] == worlds and bpy.data.cameras[:] == cameras
    assert all(name in bpy.data.objects for name in others)


def bounds(obj):
    corners = np.array([obj.matrix_world @ Vector(corner) for corner in obj.bound_box])
    return corners.min(axis=0), corners.max(axis=0)


@pytest.mark.parametrize("cursor", [(0.0, 0.0, 0.0), (0.0, 0.0, 9.0)])
def test_it_stands_free_and_its_storms_are_on_it(default_scene, native, cursor):
    default_scene.cursor.location = cursor
    assert bpy.ops.stormfield.storm_merge() == {"FINISHED"}
    planet = bpy.context.object
    bpy.context.view_layer.update()
    low, high = bounds(planet)
    cube_low, cube_high = bounds(bpy.data.objects["Cube"])
    assert not np.all((low < cube_high) & (high > cube_low))
    for element in planet.stormfield.elements:  # the curves came along
        lowest, highest = bounds(element.source)
        assert np.all(lowest > low - 0.01) and np.all(highest < high + 0.01)


def test_a_row_of_things_is_passed_whole(default_scene):
    from stormfield.presets.free_place import free_place

    for x in (3.0, 6.0, 9.0):
        bpy.ops.mesh.primitive_cube_add(location=(x, 0.0, 0.0))
    place = free_place(bpy.context, 1.0)
    assert place.x == pytest.approx(10.0 + 1.25) and tuple(place.yz) == (0.0, 0.0)


def test_a_free_cursor_is_taken_as_it_is(scene):
    from stormfield.presets.free_place import free_place

    scene.cursor.location = (1.0, 2.0, 3.0)
    assert tuple(free_place(bpy.context, 1.0)) == (1.0, 2.0, 3.0)


def test_it_is_solved_and_moves_with_the_frames(default_scene, native, attribute):
    assert bpy.ops.stormfield.storm_merge() == {"FINISHED"}
    planet = bpy.context.object
    fields = []
    for frame in (1, 125, 250):
        default_scene.frame_set(frame)
        fields.append(attribute(planet, "sf_advection"))
        assert planet.stormfield.lam == pytest.approx((frame - 1) / 249)
    speed = np.linalg.norm(fields[0], axis=1)
    assert speed.max() > 0.05
    assert all(np.abs(a - b).max() > 0.2 * speed.max() for a, b in pairwise(fields))


def test_two_storms_become_one(default_scene, native):
    """Of the two strong vortices near the meeting place one is left after the merge, as the analysis sees the field."""
    from stormfield.presets import storm_merge

    assert bpy.ops.stormfield.storm_merge() == {"FINISHED"}
    planet = bpy.context.object
    meeting = np.array(storm_merge.on_sphere(*storm_merge.MEETING))

    def vortices(frame):
        default_scene.frame_set(frame)
        assert bpy.ops.stormfield.analyze() == {"FINISHED"}
        found = planet.stormfield.analysis.ecg
        near = [i for i in found.items if np.linalg.norm(np.array(i.position) - meeting) < 0.4]
        cores = {"source", "sink", "center"}
        return sum(item.kind in cores and item.strength > 0.5 * found.strongest for item in near)

    assert (vortices(25), vortices(240)) == (2, 1)


def test_a_scene_of_its_own_is_ready_to_render_and_leaves_the_other(default_scene, native):
    before = settings_of(default_scene)
    assert bpy.ops.stormfield.storm_merge(where="SCENE") == {"FINISHED"}
    own = bpy.context.scene
    assert own != default_scene and own.camera is not None and own.world is not None
    assert own.render.engine == "CYCLES" and (own.frame_start, own.frame_end) == (1, 84)
    assert bpy.context.object.name in own.objects and bpy.context.object.name not in default_scene.objects
    assert settings_of(default_scene) == before
    assert bpy.context.object.modifiers.get("Stormfield λ") is not None


def test_a_stopped_solve_leaves_the_planet_as_a_step_to_undo(default_scene, native):
    from stormfield.operators.storm_merge import STORMFIELD_OT_storm_merge

    said = []

    class Stopped:
        report = staticmethod(lambda _kind, text: said.append(text))

    assert STORMFIELD_OT_storm_merge.was_stopped(Stopped(), "Gas Giant") == {"FINISHED"}
    assert "press Solve" in said[0]
