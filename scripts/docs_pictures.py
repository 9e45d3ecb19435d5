"""One picture of the documentation from Blender's window, as an artist sees it: default theme, default shading.

    STORMFIELD_PICTURE=solve STORMFIELD_OUT=out/pictures blender --factory-startup -P scripts/docs_pictures.py

Writes NAME.png, the whole window, and NAME.crop, what to cut out of it (WIDTHxHEIGHT+X+Y); docs_pictures.sh runs this
for every picture and does the cutting. The core and Blender's missing parts are found as window_shot.py says.
"""

import os
import subprocess
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import bpy
from mathutils import Euler, Vector

sys.path.insert(0, str(Path(__file__).parent))
import window_shot
from window_shot import view_area, view_override

NAME = os.environ["STORMFIELD_PICTURE"]
OUT = Path(os.environ["STORMFIELD_OUT"])
#: Seconds for the window to draw what was made.
SETTLE = 5.0


@dataclass(frozen=True)
class Picture:
    """What is made, which of our panels are there, and whether the view beside them is shown."""

    make: Callable[[], None]
    panels: frozenset[str]
    view: bool = False
    stroke: tuple[tuple[int, int], ...] = ()  #: places on the screen that the mouse is dragged over


# Scenes ---------------------------------------------------------------------------------------------------------------


def monkey() -> bpy.types.Object:
    clear()
    bpy.ops.mesh.primitive_monkey_add()
    bpy.ops.object.shade_smooth()
    bpy.ops.object.modifier_add(type="SUBSURF")
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    bpy.ops.stormfield.add_field()
    return bpy.context.object


def storms() -> bpy.types.Object:
    """The planet of Add → Stormfield → Storm Merge, solved."""
    clear()
    from stormfield.presets import storm_merge

    planet = storm_merge.build(bpy.context, subdivisions=5, frames=96)
    planet.select_set(True)
    for obj in bpy.context.scene.objects:
        if obj.type in {"LIGHT", "CAMERA"}:
            obj.hide_set(True)
    planet.stormfield.active_element = planet.stormfield.elements.find("Storm West")
    planet.stormfield.solve.samples = 30
    bpy.context.view_layer.update()
    look_at(bpy.context.scene.camera.matrix_world.to_quaternion(), 3.0)
    with view_override():
        bpy.ops.stormfield.solve("EXEC_DEFAULT")
    bpy.context.scene.frame_set(30)
    return planet


def world() -> bpy.types.Object:
    """A ball with sources, sinks and spirals, solved and analyzed."""
    clear()
    window_shot.SUBDIVISIONS = 5
    ball = window_shot.weather()
    look_at(Euler((1.35, 0.0, 0.0)).to_quaternion(), 3.6)
    ball.stormfield.look.opacity = 0.45
    with view_override():
        bpy.ops.stormfield.analyze("EXEC_DEFAULT")
    return ball


def select_facing(ball: bpy.types.Object, kind: str) -> None:
    """The entity of that kind that faces the viewer most."""
    entities = ball.stormfield.analysis.list(ball.stormfield.analysis.shown)
    towards = view_area().spaces.active.region_3d.view_rotation @ Vector((0.0, 0.2, 1.0))
    ones = [i for i, item in enumerate(entities.items) if item.kind == kind]
    if ones:
        entities.active = max(ones, key=lambda i: towards.dot(Vector(entities.items[i].position)))


def clear() -> None:
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)


def look_at(rotation, distance: float) -> None:
    view = view_area().spaces.active.region_3d
    view.view_perspective, view.view_rotation, view.view_distance = "PERSP", rotation, distance
    view.view_location = (0.0, 0.0, 0.0)


def empty_background(space: bpy.types.SpaceView3D) -> None:
    """One colour behind the sidebar, so that its empty end can be cut off."""
    overlay = space.overlay
    overlay.show_floor = overlay.show_axis_x = overlay.show_axis_y = overlay.show_axis_z = False
    space.region_3d.view_distance = 1000.0


# Pictures -------------------------------------------------------------------------------------------------------------


def field() -> None:
    monkey()


def elements() -> None:
    storms()


def baking() -> None:
    planet = storms()
    planet.data.uv_layers.new()
    bake = planet.stormfield.bake
    bake.use_exr = bake.use_vdb = True


def shading() -> None:
    storms()


def drawing() -> None:
    monkey()
    look_at(Euler((1.35, 0.0, 0.35)).to_quaternion(), 5.0)
    with view_override():
        bpy.ops.stormfield.draw_element("EXEC_DEFAULT", type="singular")


def analysis() -> None:
    select_facing(world(), "saddle")


def morse() -> None:
    ball = world()
    ball.stormfield.morse.eps = 12.0
    ball.stormfield.analysis.show_separatrices = False
    with view_override():
        bpy.ops.stormfield.morse_sets("EXEC_DEFAULT")
    select_facing(ball, "sink")


#: A curve over the monkey's forehead.
FOREHEAD = tuple((590 + 9 * step, 430 - step * (20 - step)) for step in range(21))

PICTURES = {
    "field": Picture(field, frozenset({"field"})),
    "elements": Picture(elements, frozenset({"elements"})),
    "solve": Picture(elements, frozenset({"solve"})),
    "solved": Picture(elements, frozenset({"field", "solve"}), view=True),
    "bake": Picture(baking, frozenset({"bake"})),
    "shading": Picture(shading, frozenset({"shading"})),
    "look": Picture(elements, frozenset({"look", "look_analysis"})),
    "drawing": Picture(drawing, frozenset({"elements"}), view=True, stroke=FOREHEAD),
    "analysis": Picture(analysis, frozenset({"analysis"}), view=True),
    "curves": Picture(analysis, frozenset({"curves"})),
    "morse": Picture(morse, frozenset({"morse"}), view=True),
}


# The window -----------------------------------------------------------------------------------------------------------


def our_panels() -> list[type]:
    """In the order of the sidebar, subpanels last."""
    from stormfield.ui import analysis_panels, edit_panels, morse_panels, panels

    analysis = (*analysis_panels.CLASSES, *analysis_panels.LATER)
    classes = (*panels.CLASSES, *analysis, *edit_panels.CLASSES, *morse_panels.CLASSES)
    return [cls for cls in classes if getattr(cls, "bl_category", "") == "Stormfield"]


def open_panels(names: frozenset[str]) -> None:
    """Panels that a picture shows are open, and the others away."""
    for panel in our_panels():
        bpy.utils.unregister_class(panel)
    for panel in our_panels():
        if panel.bl_idname.removeprefix("STORMFIELD_PT_") in names:
            panel.bl_options = set()
            if getattr(panel, "bl_parent_id", "").removeprefix("STORMFIELD_PT_") not in names | {""}:
                del panel.bl_parent_id  # a subpanel by itself
            bpy.utils.register_class(panel)


def rectangle(picture: Picture) -> tuple[int, int, int, int]:
    """What to cut out: x, y from the upper left, width, height."""
    area = view_area()
    sidebar = next(region for region in area.regions if region.type == "UI")
    top = bpy.context.window.height - (sidebar.y + sidebar.height)
    if not picture.view:
        return sidebar.x, top, sidebar.width - 4, sidebar.height - 12  # without the rounded corner
    return area.x, bpy.context.window.height - (area.y + area.height), area.width, area.height


def take() -> None:
    picture = PICTURES[NAME]
    x, y, width, height = rectangle(picture)
    OUT.mkdir(parents=True, exist_ok=True)
    # Blender's own screenshot is black with software OpenGL.
    subprocess.run(["import", "-window", "root", str(OUT / f"{NAME}.png")], check=True)
    (OUT / f"{NAME}.crop").write_text(f"{width}x{height}+{x}+{y}\n")


def prepare() -> None:
    try:
        window_shot.show_only_our_tab()
        space = view_area().spaces.active
        space.show_region_ui = True
        PICTURES[NAME].make()
        if not PICTURES[NAME].view:
            empty_background(space)
        open_panels(PICTURES[NAME].panels)
        for area in bpy.context.window.screen.areas:
            area.tag_redraw()
    except Exception:
        traceback.print_exc()
        leave(1)
    bpy.app.timers.register(choose_tab, first_interval=SETTLE / 2)


def choose_tab() -> None:
    """A region that was never drawn has no tabs to choose from."""
    for region in view_area().regions:
        if region.type == "UI":
            region.active_panel_category = "Stormfield"
    drag(PICTURES[NAME].stroke)
    bpy.app.timers.register(finish, first_interval=SETTLE)


def drag(places: tuple[tuple[int, int], ...]) -> None:
    """In a process of its own: Blender must go on to see the mouse."""
    if places:
        first, *others = [f"xdotool mousemove {x} {y}" for x, y in places]
        script = "; ".join(["sleep 1", first, "xdotool mousedown 1", *(f"{each}; sleep 0.05" for each in others)])
        subprocess.Popen(["bash", "-c", f"{script}; xdotool mouseup 1; xdotool mousemove 500 800"])


def finish() -> None:
    try:
        take()
    except Exception:
        traceback.print_exc()
        leave(1)
    leave(0)


def leave(status: int) -> None:
    sys.stdout.flush()
    os._exit(status)


if __name__ == "__main__":
    try:
        window_shot.load_addon()
    except Exception:
        traceback.print_exc()
        leave(1)
    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(prepare, first_interval=1.5)
