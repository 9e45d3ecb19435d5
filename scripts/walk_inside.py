# SPDX-License-Identifier: GPL-3.0-or-later
"""The inner half of walk_window.py: loads the add-on into a Blender with its window, and answers questions about it.

    STORMFIELD_WALK=FOLDER blender --factory-startup -P scripts/walk_inside.py

Each file FOLDER/N.py is run once; what it leaves in `answer` is written to FOLDER/N.json. Mouse and keyboard are not
touched here: walk_window.py moves them, as an artist does.
"""

import json
import os
import sys
import traceback
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
FOLDER = Path(os.environ["STORMFIELD_WALK"])
#: Seconds between two looks for a question.
TICK = 0.03
_asked = _drawn = _rendered = 0


def view():
    """The largest 3D view with its regions by type."""
    window = bpy.context.window_manager.windows[0]
    areas = [area for area in window.screen.areas if area.type == "VIEW_3D"]
    area = max(areas, key=lambda area: area.width * area.height)
    return window, area, {region.type: region for region in area.regions}


def box(kind="WINDOW"):
    """[left, top, right, bottom] of a region of the 3D view, in pixels of the screen from its upper left corner."""
    window, _area, regions = view()
    region = regions[kind]
    top = window.height - region.y - region.height
    return [region.x, top, region.x + region.width, top + region.height]


def area_box(kind):
    """[left, top, right, bottom] of the main region of an editor, by its type."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.ui_type == kind)
    region = next(region for region in area.regions if region.type == "WINDOW")
    top = window.height - region.y - region.height
    return [region.x, top, region.x + region.width, top + region.height]


def under_pointer(kind):
    """The Python command or data path of the button under the pointer in a region of the 3D view; "" for none."""
    window, area, regions = view()
    for copy in (bpy.ops.ui.copy_python_command_button, bpy.ops.ui.copy_data_path_button):
        with bpy.context.temp_override(window=window, area=area, region=regions[kind]):
            if copy.poll():
                copy()
                return bpy.context.window_manager.clipboard
    return ""


def on_screen(place):
    """Pixels of a place of the world, from the screen's upper left corner."""
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    window, area, regions = view()
    region = regions["WINDOW"]
    x, y = location_3d_to_region_2d(region, area.spaces.active.region_3d, place)
    return [region.x + x, window.height - region.y - y]


def drawn():
    """How often the 3D views were drawn."""
    return _drawn


def count_drawing():
    global _drawn
    _drawn += 1


def rendered():
    """How many renders have ended."""
    return _rendered


def count_rendering(*_):
    global _rendered
    _rendered += 1


def busy():
    """Whether shaders are compiled."""
    return bpy.app.is_job_running("SHADER_COMPILATION")


def playing():
    return bpy.context.window_manager.windows[0].screen.is_animation_playing


def answer_questions():
    global _asked
    question = FOLDER / f"{_asked}.py"
    if not question.is_file():
        return TICK
    helpers = (view, box, area_box, under_pointer, on_screen, drawn, rendered, busy, playing)
    known = {"bpy": bpy, "sys": sys, **{helper.__name__: helper for helper in helpers}}
    try:
        exec(compile(question.read_text(encoding="utf-8"), question.name, "exec"), known)
        told = {"answer": known.get("answer")}
    except Exception:
        told = {"fault": traceback.format_exc()}
    written = FOLDER / f"{_asked}.part"
    written.write_text(json.dumps(told), encoding="utf-8")
    written.rename(FOLDER / f"{_asked}.json")
    _asked += 1
    return TICK


def main():
    for folder in filter(None, os.environ.get("STORMFIELD_PACKAGES", "").split(os.pathsep)):
        sys.path.insert(0, folder)
    import window_shot

    window_shot.load_addon()
    bpy.app.handlers.render_complete.append(count_rendering)
    bpy.types.SpaceView3D.draw_handler_add(count_drawing, (), "WINDOW", "POST_PIXEL")
    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(answer_questions, first_interval=1.0, persistent=True)


main()
