# SPDX-License-Identifier: GPL-3.0-or-later
"""The first ten minutes of a newcomer, walked in Blender's window from the factory scene, with mouse and keys.

    scripts/walk_window.sh                      all walks; pictures and numbers in out/walk
    scripts/walk_window.sh --out FOLDER merge   one of them

Each step takes a picture, and each claim is checked: that something moved, that the field is seen, that nothing of the
artist's scene changed, that Blender wrote no traceback. Ends with 1 and says which claim failed. Actions are counted as
an artist counts them: a click, a drag, a key, a word that is typed.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from walk_screen import ROOT, WalkError, Window


def difference(one: Path, other: Path) -> float:
    """The share of pixels (0..1) that differ by more than a tenth."""
    done = subprocess.run(
        ["compare", "-metric", "AE", "-fuzz", "10%", str(one), str(other), "null:"],
        capture_output=True,
        text=True,
        check=False,
    )
    size = subprocess.run(["identify", "-format", "%w %h", str(one)], capture_output=True, text=True, check=True)
    width, height = map(int, size.stdout.split())
    return float(done.stderr.split()[0]) / (width * height)


def colours(picture: Path) -> list[str]:
    told = subprocess.run(
        ["convert", str(picture), "-unique-colors", "txt:-"], capture_output=True, text=True, check=True
    )
    return told.stdout.splitlines()[1:]


def claim(holds: bool, what: str) -> None:
    print(f"  {'holds ' if holds else 'FAILED'}  {what}", flush=True)
    if not holds:
        raise WalkError(what)


SETTINGS = """
scene = bpy.context.scene
answer = [scene.render.engine, scene.render.resolution_x, scene.render.fps, scene.frame_start, scene.frame_end,
          scene.view_settings.view_transform, scene.world.name, scene.camera.name, "Cube" in scene.objects]
"""
SOLVED = "not any(j for j in [sys.modules['stormfield.session.running'].current()] if j)"
FIELD = "next(o for o in bpy.context.scene.objects if o.stormfield.enabled)"


def merge(window: Window) -> dict[str, float]:
    """From the default scene to two storms that merge: Add → Stormfield → Storm Merge."""
    before = window.ask(SETTINGS)
    window.over_view()
    window.picture("default-scene")
    began = time.monotonic()
    window.key("shift+a")
    window.type("storm")
    window.picture("add-storm-merge")
    window.key("Return")
    window.wait_until("playing() and bpy.context.scene.frame_current > 1")  # drawn once with the field
    window.wait_until("not busy()")  # clouds at preview quality, as the view shows them
    first = window.view_picture()
    window.drawn_again(4)
    moved = difference(first, window.view_picture())
    seconds = time.monotonic() - began
    claim(moved > 0.001, f"the storms move: {moved:.2%} of the view's pixels changed in 4 pictures")
    window.picture("moving")
    window.key("space")
    window.ask("bpy.context.scene.frame_set(100)")
    window.handled()
    shown = window.view_picture()
    window.ask("view()[1].spaces.active.overlay.show_overlays = False")
    window.handled()
    seen = difference(shown, window.view_picture())
    window.ask("view()[1].spaces.active.overlay.show_overlays = True")
    window.settled()
    claim(seen > 0.01, f"the field is seen: {seen:.2%} of the view's pixels are of the overlay")
    window.picture("clouds")
    claim(window.ask(SETTINGS) == before, "no setting of the scene has changed, and the cube is there")
    window.no_traceback()
    actions = window.actions - 1  # without the space bar that stopped it
    claim(actions <= 6, f"{actions} actions")
    return {"actions": actions, "seconds": round(seconds, 1), "load": os.getloadavg()[0], "moved": moved, "seen": seen}


def own(window: Window) -> dict[str, float]:
    """A merge of one's own on Suzanne: two strokes, Solve, play."""
    window.over_view()
    began = time.monotonic()
    window.key("Delete")
    window.key("shift+a")
    window.type("monkey")
    window.key("Return")
    claim(window.ask("answer = bpy.context.object.name") == "Suzanne", "Suzanne is there")
    window.open_tab("Stormfield")
    window.press("stormfield.add_field")
    window.picture("field")
    window.over_view()
    window.key("KP_1")  # from the front
    window.key("KP_Decimal")  # as large as the view
    window.press("preset='MERGE'")
    claim(window.ask("answer = bpy.context.mode") == "EDIT_CURVE", "the Draw tool is ready")
    for name, side in (("first-stroke", -1.0), ("second-stroke", 1.0)):
        window.drag(stroke(window, side))
        window.picture(name)
    strokes = window.ask("answer = len(bpy.context.object.data.splines)")
    claim(strokes == 2, f"{strokes} strokes were drawn")
    window.press("stormfield.finish_drawing")
    claim(window.ask(f"answer = len({FIELD}.stormfield.elements)") == 3, "they are two storms and one that goes on")
    window.press("stormfield.solve")
    window.wait_until(SOLVED)
    window.picture("solved")
    window.over_view()
    window.key("space")
    window.wait_until("playing()")
    first = window.view_picture()
    window.drawn_again(4)
    moved = difference(first, window.view_picture())
    seconds = time.monotonic() - began - window.spent
    window.picture("playing")
    claim(moved > 0.0005, f"the flow moves: {moved:.2%} of the view's pixels changed in 4 pictures")
    window.no_traceback()
    claim(window.actions <= 15, f"{window.actions} actions")
    return {"actions": window.actions, "seconds": round(seconds, 1), "load": os.getloadavg()[0], "moved": moved}


def finish(window: Window) -> dict[str, float]:
    """From two storms that merge to a rendered picture: Add → Storm Merge, Bake, Shading, F12."""
    window.over_view()
    window.key("shift+a")
    window.type("storm")
    window.key("Return")
    window.wait_until("playing()")
    window.key("space")
    window.ask("view()[1].spaces.active.shading.type = 'SOLID'")  # each picture of clouds takes seconds without a GPU
    window.ask(f"bake = {FIELD}.stormfield.bake; bake.use_scene_frames = False; bake.frame_end = 6")
    window.open_tab("Stormfield")
    began = time.monotonic()
    window.open_panel("stormfield.bake")
    window.picture("bake-panel")
    window.press("stormfield.bake")
    window.wait_until(SOLVED)
    window.handled()
    baked = window.ask(f"answer = [modifier.name for modifier in {FIELD}.modifiers]")
    window.picture("baked")
    window.no_traceback()
    claim(bool(baked), f"the flowing texture is baked: {baked}")
    window.ask("bpy.ops.stormfield.apply_material(material='lava')")  # a menu: its button has no name to find it by
    material = window.ask(f"answer = {FIELD}.active_material.name")
    window.ask("view()[1].spaces.active.shading.type = 'MATERIAL'")
    window.settled()
    window.picture("material")
    claim(material != "Storm Clouds", f"the planet has another material: {material}")
    # For a machine that draws without a GPU.
    window.ask("scene = bpy.context.scene; scene.render.resolution_percentage = 25; scene.eevee.taa_render_samples = 4")
    window.over_view()
    window.key("96")  # F12 by its keycode: for its name xdotool holds Alt, which renders the sequencer
    window.wait_until("rendered() and not bpy.app.is_job_running('RENDER')")
    saved = window.out / "rendered.png"
    window.ask(f"bpy.data.images['Render Result'].save_render({str(saved)!r})")
    window.picture("rendered")
    window.no_traceback()
    claim(len(colours(saved)) > 100, f"a picture is rendered, of {len(colours(saved))} colours")
    seconds = time.monotonic() - began - window.spent
    return {"actions": window.actions, "seconds": round(seconds, 1)}


def drag(window: Window) -> dict[str, float]:
    """From the Asset Browser onto a mesh: a material."""
    window.ask(
        """
area = next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == "PROPERTIES")
area.ui_type = "ASSETS"
area.spaces.active.show_region_toolbar = False
"""
    )
    window.handled()
    window.ask(
        """
area = next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.ui_type == "ASSETS")
area.spaces.active.params.asset_library_reference = "Stormfield"
"""
    )
    window.handled()
    began = time.monotonic()
    left, top, _right, _bottom = window.ask("answer = area_box('ASSETS')")
    cube = window.ask("answer = on_screen(bpy.data.objects['Cube'].location)")
    window.picture("asset-browser")
    drag_over(window, (left + ELEMENT[0], top + ELEMENT[1]), cube)
    claim(window.ask("answer = bpy.context.object.type") == "CURVE", "the curve of an element is in the scene")
    window.picture("element-dropped")
    materials = "answer = [m.name for m in bpy.data.objects['Cube'].data.materials if m]"
    before = window.ask(materials)
    drag_over(window, (left + MATERIAL[0], top + MATERIAL[1]), (cube[0], cube[1] - 30))
    after = window.ask(materials)
    claim(after not in ([], before), f"the cube has the material {after} in place of {before}")
    window.picture("material-dropped")
    window.no_traceback()
    return {"actions": window.actions, "seconds": round(time.monotonic() - began, 1)}


#: Where the Asset Browser shows the first element and the first material, pixels from its upper left corner.
ELEMENT, MATERIAL = (55, 55), (55, 755)


def drag_over(window: Window, start: tuple[float, float], end: tuple[float, float]) -> None:
    shares = [i / 20 for i in range(21)]
    window.drag([(start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1])) for t in shares])


def plain(window: Window) -> dict[str, float]:
    """A Blender without USD says what it lacks, in the window, and breaks nothing."""
    if window.ask("answer = bpy.app.build_options.usd"):
        print("  this Blender has USD")
        return {}
    window.over_view()
    window.open_tab("Stormfield")
    window.press("stormfield.add_field")
    window.picture("panel")
    reason = window.ask("answer = sys.modules['stormfield.operators.requirements'].problem()")
    claim("USD" in reason and "blender.org" in reason, f"the panel says: {reason}")
    window.over_view()
    window.key("shift+a")
    window.type("storm")
    window.picture("menu")
    window.key("Return")
    claim(window.ask("answer = len(bpy.data.objects)") == 3, "Storm Merge is greyed out and adds nothing")
    window.no_traceback()
    return {"actions": window.actions}


def stroke(window: Window, side: float) -> list[tuple[float, float]]:
    """Over Suzanne's forehead, from one side to the middle, as the view shows it."""
    places = [(side * (0.55 - 0.5 * i / 12), -0.75, 0.62) for i in range(13)]
    on_face = f"""
obj = {FIELD}
answer = []
for place in {places!r}:
    near = obj.matrix_world @ obj.closest_point_on_mesh(place)[1]
    answer.append(on_screen(near))
"""
    return [(x, y) for x, y in window.ask(on_face)]


WALKS: dict[str, Callable[[Window], dict[str, float]]] = {
    "merge": merge,
    "own": own,
    "finish": finish,
    "drag": drag,
    "plain": plain,
}
#: What Blender is told besides.
ENVIRONMENT = {"plain": {"STORMFIELD_PLAIN": "1"}}


#: Picture of the documentation → walk and step that it shows.
PICTURES = {"walk_merge": ("merge", "clouds"), "walk_own": ("own", "playing")}
DOCS = ROOT / "docs" / "pictures"


def keep_pictures(out: Path) -> None:
    """Take over into the documentation what its pages show."""
    for name, (walk, step) in PICTURES.items():
        for taken in sorted((out / walk).glob(f"*-{step}.png"))[-1:]:
            reduced = ["-resize", "1200x", "-dither", "None", "-colors", "200"]
            subprocess.run(["convert", str(taken), *reduced, str(DOCS / f"{name}.png")], check=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("walks", nargs="*", choices=[*WALKS, []], help="which walks; all when none is named")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "walk", help="folder of pictures and numbers")
    parser.add_argument("--docs", action="store_true", help="take pictures over into docs/pictures")
    arguments = parser.parse_args()
    numbers, failed = {}, []
    for name in arguments.walks or WALKS:
        print(f"{name}: {WALKS[name].__doc__}", flush=True)
        window = Window(arguments.out.resolve() / name, **ENVIRONMENT.get(name, {}))
        try:
            numbers[name] = WALKS[name](window)
            print(f"  {numbers[name]}", flush=True)
        except WalkError as fault:
            failed.append(name)
            window.picture("failed")
            print(f"  {fault}", flush=True)
        finally:
            window.close()
    (arguments.out / "numbers.json").write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")
    if arguments.docs:
        keep_pictures(arguments.out)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
