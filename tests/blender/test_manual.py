# SPDX-License-Identifier: GPL-3.0-or-later
"""F1 and Online Manual: every operator and every setting that a panel shows leads to a place that exists."""

import sys
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

bpy = pytest.importorskip("bpy", reason="the bpy wheel is not installed")
sys.path.insert(0, str(Path(__file__).parents[2] / "docs" / "extension"))
from stormfield_docs import addon as described  # noqa: E402
from stormfield_docs.pages import anchors, written_pages  # noqa: E402


def place_of(name: str) -> str | None:
    """As Blender looks it up: the first pattern that fits, in lower case."""
    for site, patterns in bpy.utils.manual_map():
        for pattern, place in patterns:
            if fnmatchcase(name.lower(), pattern):
                return site + place
    return None


def exists(url: str | None) -> bool:
    from stormfield import manual

    if url is None or not url.startswith(manual.SITE):
        return False
    page, _, anchor = url.removeprefix(manual.SITE).partition("#")
    text = written_pages().get(f"docs/{page.removesuffix('.html')}.md")
    return text is not None and (not anchor or anchor in anchors(text))


def our_operators() -> list[str]:
    return [f"bpy.ops.stormfield.{name}" for name in dir(bpy.ops.stormfield)]


def test_every_operator_has_a_place():
    assert our_operators()
    assert [name for name in our_operators() if not exists(place_of(name))] == []


def test_settings_of_operators_lead_to_their_operator():
    assert place_of("bpy.types.STORMFIELD_OT_pathlines.kind") == place_of("bpy.ops.stormfield.pathlines")


def test_every_setting_that_a_panel_shows_has_a_place():
    shown = [
        setting for group in described.settings().values() for setting in group.values() if described.shown(setting)
    ]
    assert shown
    lost = [s.anchor for s in shown if not exists(place_of(f"bpy.types.{s.group}.{s.name}"))]
    assert lost == []


def test_names_are_those_of_blender():
    # Blender asks for the name of the class that it registered, and of the property in it.
    from stormfield import properties

    groups = {cls.bl_rna.identifier: set(cls.bl_rna.properties.keys()) for cls in properties.CLASSES}
    assert groups.keys() == described.settings().keys()
    assert all(set(settings) <= groups[group] for group, settings in described.settings().items())


def test_the_lookup_can_fail():
    assert not exists(place_of("bpy.ops.stormfield.no_such_operator"))
    assert not exists(place_of("bpy.ops.mesh.primitive_cube_add"))


def test_unregistering_takes_the_map_away(addon):
    addon.unregister()
    try:
        assert not exists(place_of("bpy.ops.stormfield.solve"))
    finally:
        addon.register()
