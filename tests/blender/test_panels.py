# SPDX-License-Identifier: GPL-3.0-or-later
"""Every panel draws, with and without a field, and names only properties, operators and menus that exist."""

from types import SimpleNamespace

import bpy
import pytest

pytestmark = pytest.mark.usefixtures("native")


class Layout:
    """Stands in for UILayout, which needs a window: checks the names it is given."""

    def __init__(self, drawn):
        self.__dict__["drawn"] = drawn

    def __getattr__(self, _name):
        return lambda *_arguments, **_options: Layout(self.drawn)

    def prop(self, data, name, **_options):
        assert name in data.bl_rna.properties, f"{data} has no {name}"
        self.drawn.append(name)

    prop_enum = prop_search = lambda self, data, name, *rest, **options: self.prop(data, name)

    def operator(self, name, **_options):
        module, word = name.split(".")
        assert word in dir(getattr(bpy.ops, module)), f"there is no operator {name}"
        self.drawn.append(name)
        return SimpleNamespace()

    def operator_menu_enum(self, name, _property, **_options):
        self.operator(name)

    def menu(self, name, **_options):
        assert hasattr(bpy.types, name), f"there is no menu {name}"
        self.drawn.append(name)

    def template_list(self, kind, _id, data, items, active_data, active, **_options):
        assert hasattr(bpy.types, kind)
        self.prop(data, items)
        self.prop(active_data, active)

    def panel(self, _name, **_options):
        return Layout(self.drawn), Layout(self.drawn)


def stand_in(context):
    """A context with a sidebar."""
    own = {name: getattr(context, name) for name in ("object", "mode", "scene", "view_layer", "window_manager")}
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))  # 0 without a window
    return SimpleNamespace(**own, preferences=preferences, region=SimpleNamespace(width=300))


def draw_all() -> list[str]:
    """Draws all panels that poll; what they drew."""
    from stormfield.ui import analysis_panels, edit_panels, morse_panels, panel_parts, panels

    drawn: list[str] = []
    panel_classes = [*panels.CLASSES[1:], *analysis_panels.CLASSES[:2], *edit_panels.CLASSES]
    panel_classes += [*analysis_panels.LATER, *morse_panels.CLASSES]
    for cls in panel_classes:
        if hasattr(cls, "poll") and not cls.poll(bpy.context):
            continue
        own = {name: getattr(cls, name) for name in dir(cls) if name.startswith("_draw") or name == "_suggestion"}
        panel = SimpleNamespace(layout=Layout(drawn), **own)
        panel.settings_layout = lambda panel=panel: panel_parts.SidebarPanel.settings_layout(panel)
        if hasattr(cls, "draw_header"):
            cls.draw_header(panel, stand_in(bpy.context))
        cls.draw(panel, stand_in(bpy.context))
    return drawn


def test_without_a_field_there_is_a_button_to_add_one(scene):
    assert draw_all() == ["stormfield.add_field"]


def test_all_panels_of_a_field_draw(storms):
    drawn = draw_all()
    assert {"stormfield.solve", "stormfield.bake", "stormfield.analyze", "stormfield.morse_sets"} <= set(drawn)
    assert {"lam", "samples", "period", "shown_field", "method", "show_separatrices"} <= set(drawn)


def test_edits_are_drawn_with_their_reason_and_what_can_be_set(storms):
    from stormfield.model.edits import Edit, EntityAt
    from stormfield.scene.write.edits import add_edit
    from stormfield.ui.lists import STORMFIELD_UL_edits

    assert "edits" not in draw_all()
    pair = EntityAt("sink", (1.0, 0.0, 0.0)), EntityAt("saddle", (0.0, 1.0, 0.0))
    add_edit(storms, Edit("cancel", entities=pair), "A1 and S2")
    drawn = draw_all()
    assert {"stormfield.cancel_pair", "edits", "stormfield.move_edit", "lam", "reach"} <= set(drawn)
    assert drawn.count("keep") == 1  # that of Simplify
    add_edit(storms, Edit("simplify", keep=4), "Keep 4")
    storms.stormfield.edits[1].status, storms.stormfield.edits[1].reason = "refused", "it has no reason"
    assert draw_all().count("keep") == 2
    for kind, settings in (
        ("move", {"to"}),
        ("smooth", {"region", "center", "radius", "lam_end"}),
        ("transform", {"angle", "scale", "stretch", "frozen"}),
    ):
        add_edit(storms, Edit(kind), kind)
        assert settings <= set(draw_all())
    for item in storms.stormfield.edits:
        row: list[str] = []
        STORMFIELD_UL_edits.draw_item(None, None, Layout(row), None, item, 0, None, "")
        assert row == ["name", "enabled"]


def test_every_setting_of_solve_is_in_its_panel(storms):
    settings = storms.stormfield.solve
    settings.solve_on = "DENSITY"
    assert set(type(settings).__annotations__) - {"solved"} <= set(draw_all())


@pytest.mark.parametrize("method", ["geometry", "tau", "spatial"])
def test_the_morse_panel_draws_for_each_method(rings, method):
    pytest.importorskip("igraph", reason="igraph is not installed")
    bpy.ops.stormfield.morse_sets()
    rings.stormfield.morse.method = method
    drawn = draw_all()
    assert {"geometry": "simplify", "tau": "tau", "spatial": "length"}[method] in drawn


def test_lists_and_their_filters_draw(rings):
    pytest.importorskip("igraph", reason="igraph is not installed")
    bpy.ops.stormfield.analyze()
    bpy.ops.stormfield.select_entity(which="ecg", index=0)
    assert {"items", "kinds", "min_strength"} <= set(draw_all())


def test_a_running_job_shows_its_progress(ball):
    from stormfield.session import running

    running.begin("Solving", ball)
    try:
        assert "stormfield.cancel_job" in draw_all()
    finally:
        running.end()


def test_the_stand_in_refuses_unknown_names(ball):
    layout = Layout([])
    for wrong in (
        lambda: layout.prop(ball.stormfield, "lambda"),
        lambda: layout.operator("stormfield.nothing"),
        lambda: layout.menu("STORMFIELD_MT_nothing"),
    ):
        with pytest.raises(AssertionError):
            wrong()
