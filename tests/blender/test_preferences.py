# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds for all files: read where it is needed, with defaults where the add-on is not in the preferences."""

from types import SimpleNamespace

import bpy
import pytest


@pytest.fixture
def chosen(monkeypatch):
    """Preferences as if the add-on were enabled under its name."""
    from stormfield.scene.read import user_preferences

    made = SimpleNamespace(palette="CLASSIC", cache_folder="", samples=33, units="SCENE")
    addons = {user_preferences.ADDON: SimpleNamespace(preferences=made)}
    stand_in = SimpleNamespace(context=SimpleNamespace(preferences=SimpleNamespace(addons=addons)), utils=bpy.utils)
    monkeypatch.setattr(user_preferences, "bpy", stand_in)
    return made


def test_defaults_are_those_of_the_panel():
    from stormfield.preferences import STORMFIELD_Preferences
    from stormfield.scene.read import user_preferences

    assert user_preferences.ADDON == "stormfield" == STORMFIELD_Preferences.bl_idname
    defaults = user_preferences.UserPreferences()
    for name in ("palette", "cache_folder", "samples", "units"):
        assert STORMFIELD_Preferences.bl_rna.properties[name].default == getattr(defaults, name)
    assert user_preferences.read() == defaults


def test_the_palettes_are_those_that_are_drawn():
    from stormfield.analysis.colours import PALETTES
    from stormfield.preferences import STORMFIELD_Preferences

    assert {item.identifier for item in STORMFIELD_Preferences.bl_rna.properties["palette"].enum_items} == set(PALETTES)


def test_a_new_field_has_the_samples_of_the_preferences(chosen):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
    bpy.ops.stormfield.add_field()
    assert bpy.context.object.stormfield.solve.samples == 33


def test_caches_of_all_files_lie_apart_in_one_folder(chosen, ball, tmp_path):
    from stormfield.scene.read.folders import cache_root

    chosen.cache_folder = str(tmp_path / "caches")
    one, other = (cache_root(ball, str(tmp_path / folder / "scene.blend")) for folder in ("a", "b"))
    assert one != other and one.name == other.name == "Ball"
    assert all((tmp_path / "caches") in root.parents for root in (one, other))
    assert one.parent.name.startswith("scene-")
    ball.stormfield.bake.folder = str(tmp_path / "own")  # an object's own folder goes first
    assert cache_root(ball, str(tmp_path / "scene.blend")) == tmp_path / "own" / "Ball"


def test_lengths_are_shown_in_the_scenes_units(chosen, scene):
    from stormfield.scene.read.user_preferences import length_text

    scene.unit_settings.system, scene.unit_settings.scale_length = "METRIC", 1.0
    assert length_text(bpy.context, 0.17, 2.0).replace(" ", "") in {"0.34m", "34cm"}
    scene.unit_settings.system = "NONE"
    assert length_text(bpy.context, 0.17, 2.0) == "0.34"
    chosen.units = "MESH"
    assert length_text(bpy.context, 0.17, 2.0) == ""
