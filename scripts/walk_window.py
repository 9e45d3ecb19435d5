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
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
BLENDER = os.environ.get("BLENDER", "blender")
WIDTH, HEIGHT = 1920, 1080
#: Seconds until Blender must have answered, and for its window to settle after an action.
PATIENCE, SETTLE = 240.0, 0.35


class WalkError(Exception):
    """A claim that does not hold, or a button that is not there."""


class Window:
    """Blender in its window: what an artist does to it, and what it says when asked."""

    def __init__(self, out: Path):
        self.out = out
        self.asked = self.actions = self.pictures = 0
        self.spent = 0.0  # seconds that searching for buttons took, which an artist sees at a glance
        shutil.rmtree(out, ignore_errors=True)
        (out / "asked").mkdir(parents=True)
        self.log = (out / "blender.log").open("w", encoding="utf-8")
        self.process = subprocess.Popen(
            [
                *(BLENDER, "--factory-startup", "--gpu-backend", "opengl"),
                *("--window-geometry", "0", "0", str(WIDTH), str(HEIGHT)),
                *("-P", str(ROOT / "scripts" / "walk_inside.py")),
            ],
            env={**os.environ, "STORMFIELD_WALK": str(out / "asked")},
            stdout=self.log,
            stderr=subprocess.STDOUT,
        )
        self.ask("answer = bpy.app.version_string")

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        self.log.close()

    # Questions --------------------------------------------------------------------------------------------------------

    def ask(self, code: str) -> Any:
        """What Python code in Blender leaves in `answer`."""
        folder = self.out / "asked"
        question = folder / f"{self.asked}.part.py"
        question.write_text(code, encoding="utf-8")
        question.rename(folder / f"{self.asked}.py")
        answer = folder / f"{self.asked}.json"
        end = time.monotonic() + PATIENCE
        while not answer.is_file():
            if self.process.poll() is not None:
                raise WalkError(f"Blender ended with {self.process.returncode}; see {self.log.name}")
            if time.monotonic() > end:
                raise WalkError(f"Blender did not answer for {PATIENCE:.0f} s: {code}")
            time.sleep(0.02)
        self.asked += 1
        told = json.loads(answer.read_text(encoding="utf-8"))
        if "fault" in told:
            raise WalkError(told["fault"])
        return told["answer"]

    def wait_until(self, expression: str, seconds: float = PATIENCE) -> None:
        end = time.monotonic() + seconds
        while not self.ask(f"answer = bool({expression})"):
            if time.monotonic() > end:
                raise WalkError(f"still not so after {seconds:.0f} s: {expression}")
            time.sleep(0.1)

    def box(self, region: str = "WINDOW") -> tuple[int, int, int, int]:
        return tuple(self.ask(f"answer = box({region!r})"))

    # Hands ------------------------------------------------------------------------------------------------------------

    def move(self, x: float, y: float) -> None:
        xdotool("mousemove", str(round(x)), str(round(y)))

    def click(self, x: float, y: float, button: int = 1) -> None:
        self.actions += 1
        self.move(x, y)
        time.sleep(0.1)
        xdotool("click", str(button))
        time.sleep(SETTLE)

    def key(self, name: str) -> None:
        """One key with its modifiers, as xdotool names them: "shift+a", "Return"."""
        self.actions += 1
        xdotool("key", name)
        time.sleep(SETTLE)

    def type(self, word: str) -> None:
        self.actions += 1
        for letter in word:
            xdotool("key", "space" if letter == " " else letter)
            time.sleep(0.15)
        time.sleep(4 * SETTLE)

    def drag(self, places: Sequence[tuple[float, float]]) -> None:
        self.actions += 1
        self.move(*places[0])
        time.sleep(0.1)
        xdotool("mousedown", "1")
        for place in places:
            self.move(*place)
            time.sleep(0.03)
        xdotool("mouseup", "1")
        time.sleep(SETTLE)

    def over_view(self) -> None:
        """Rest the pointer in the middle of the 3D view, which costs no action."""
        left, top, right, bottom = self.box()
        self.move((left + right) / 2, (top + bottom) / 2)
        time.sleep(SETTLE)

    def find(self, name: str, region: str = "UI") -> tuple[float, float]:
        """Where the button of that operator or setting is in a region, found by moving the pointer down over it."""
        began = time.monotonic()
        left, top, right, bottom = self.box(region)
        try:
            for x in (0.3, 0.6, 0.82):
                for y in range(top + 30, bottom - 8, 11):
                    place = left + x * (right - left), float(y)
                    self.move(*place)
                    time.sleep(0.03)
                    if name in self.ask(f"answer = under_pointer({region!r})"):
                        return place
        finally:
            self.spent += time.monotonic() - began
        raise WalkError(f"there is no button {name} in the region {region}")

    def press(self, name: str, region: str = "UI") -> None:
        self.click(*self.find(name, region))

    def open_tab(self, name: str) -> None:
        """The sidebar with that tab in front, by N and a click on the tab."""
        if not self.ask("answer = view()[1].spaces.active.show_region_ui"):
            self.over_view()
            self.key("n")
        began, actions = time.monotonic(), self.actions
        _left, top, right, bottom = self.box("UI")
        for y in range(top + 20, bottom - 10, 18):
            self.click(right - 8, y)
            if self.ask("answer = view()[2]['UI'].active_panel_category") == name:
                break
        else:
            raise WalkError(f"the sidebar has no tab {name}")
        self.actions = actions + 1
        self.spent += time.monotonic() - began

    # Pictures and claims ----------------------------------------------------------------------------------------------

    def picture(self, name: str) -> Path:
        self.pictures += 1
        path = self.out / f"{self.pictures:02d}-{name}.png"
        subprocess.run(["import", "-window", "root", str(path)], check=True)
        return path

    def view_picture(self) -> Path:
        """The 3D view alone."""
        left, top, right, bottom = self.box()
        path = self.out / "asked" / f"view-{time.monotonic_ns()}.png"
        crop = f"{right - left}x{bottom - top}+{left}+{top}"
        subprocess.run(["import", "-window", "root", "-crop", crop, "+repage", str(path)], check=True)
        return path

    def no_traceback(self) -> None:
        self.log.flush()
        text = Path(self.log.name).read_text(encoding="utf-8")
        if "Traceback" in text:
            raise WalkError(text[text.index("Traceback") :][:2000])


def xdotool(*arguments: str) -> None:
    subprocess.run(["xdotool", *arguments], check=True)


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


def claim(holds: bool, what: str) -> None:
    print(f"  {'holds ' if holds else 'FAILED'}  {what}", flush=True)
    if not holds:
        raise WalkError(what)


PLAYING = "bpy.context.window_manager.windows[0].screen.is_animation_playing"
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
    window.wait_until(PLAYING)
    window.wait_until("bpy.context.scene.frame_current > 1")  # drawn once with the field
    first = window.view_picture()
    frame = window.ask("answer = bpy.context.scene.frame_current")
    window.picture("moving")
    window.wait_until(f"bpy.context.scene.frame_current > {frame} + 3")
    moved = difference(first, window.view_picture())
    seconds = time.monotonic() - began
    claim(moved > 0.001, f"the storms move: {moved:.2%} of the view's pixels changed in 4 frames")
    window.key("space")
    shown = window.view_picture()
    window.ask("view()[1].spaces.active.overlay.show_overlays = False")
    time.sleep(2.0)
    seen = difference(shown, window.view_picture())
    window.ask("view()[1].spaces.active.overlay.show_overlays = True")
    claim(seen > 0.01, f"the field is seen: {seen:.2%} of the view's pixels are of the overlay")
    time.sleep(SHADERS)
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
    window.wait_until(PLAYING)
    time.sleep(1.0)
    first, frame = window.view_picture(), window.ask("answer = bpy.context.scene.frame_current")
    window.wait_until(f"bpy.context.scene.frame_current > {frame} + 3")
    moved = difference(first, window.view_picture())
    seconds = time.monotonic() - began - window.spent
    window.picture("playing")
    claim(moved > 0.0005, f"the flow moves: {moved:.2%} of the view's pixels changed in 4 frames")
    window.no_traceback()
    claim(window.actions <= 15, f"{window.actions} actions")
    return {"actions": window.actions, "seconds": round(seconds, 1), "load": os.getloadavg()[0], "moved": moved}


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


WALKS: dict[str, Callable[[Window], dict[str, float]]] = {"merge": merge, "own": own}


#: Seconds that the window may take for the shaders of the clouds.
SHADERS = 12.0
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
        window = Window(arguments.out.resolve() / name)
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
