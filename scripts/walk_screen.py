# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's window as an artist has it before them: mouse, keys, what is seen; and answers to questions about it.

For walk_window.py. Needs xdotool and ImageMagick. Nothing waits for a fixed time: an action is over when Blender has
handled it and drawn what it changed.
"""

import json
import os
import shutil
import subprocess
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
BLENDER = os.environ.get("BLENDER", "blender")
WIDTH, HEIGHT = 1920, 1080
#: Seconds until Blender must have answered.
PATIENCE = 240.0
#: Times that a view is drawn after an action until it shows it, at the latest.
ENOUGH = 3
#: Rows of pixels between two places at which a button is looked for; grey of letters, 0 to 255.
ROW, INK = 11, 150


class WalkError(Exception):
    """A claim that does not hold, or a button that is not there."""


class Window:
    """Blender in its window: what an artist does to it, and what it says when asked."""

    def __init__(self, out: Path, **environment: str):
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
            env={**os.environ, **environment, "STORMFIELD_WALK": str(out / "asked")},
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

    def handled(self) -> None:
        """Wait until Blender has handled what was done and shows it: it draws no more, or has drawn again."""
        self._wait_for_drawing(ENOUGH)

    def settled(self) -> None:
        """Wait until Blender draws no more: what it draws in several passes is done."""
        self._wait_for_drawing(None)

    def _wait_for_drawing(self, enough: int | None) -> None:
        end = time.monotonic() + PATIENCE
        first = before = self.ask("answer = drawn()")
        still = 0
        while still < 3:
            drawn, busy = self.ask("answer = [drawn(), busy()]")
            if enough is not None and drawn - first >= enough:
                return
            still = still + 1 if drawn == before and not busy else 0
            before = drawn
            if time.monotonic() > end:
                raise WalkError(f"Blender has drawn for {PATIENCE:.0f} s without an end")

    def drawn_again(self, times: int = 1) -> None:
        """Wait until the 3D view was drawn so many times more."""
        before = self.ask("answer = drawn()")
        self.wait_until(f"drawn() >= {before + times}")

    def box(self, region: str = "WINDOW") -> tuple[int, int, int, int]:
        return tuple(self.ask(f"answer = box({region!r})"))

    # Hands ------------------------------------------------------------------------------------------------------------

    def move(self, x: float, y: float) -> None:
        xdotool("mousemove", str(round(x)), str(round(y)))

    def click(self, x: float, y: float, button: int = 1) -> None:
        self.actions += 1
        self.move(x, y)
        self.handled()
        xdotool("click", str(button))
        self.handled()

    def key(self, name: str) -> None:
        """One key with its modifiers, as xdotool names them: "shift+a", "Return"."""
        self.actions += 1
        xdotool("key", name)
        self.handled()

    def type(self, word: str) -> None:
        self.actions += 1
        for letter in word:
            xdotool("key", "space" if letter == " " else letter)
            self.handled()

    def drag(self, places: Sequence[tuple[float, float]]) -> None:
        self.actions += 1
        self.move(*places[0])
        self.handled()
        xdotool("mousedown", "1")
        for place in places:
            self.move(*place)
            time.sleep(0.03)  # as a hand draws
        self.ask("answer = drawn()")
        xdotool("mouseup", "1")
        self.handled()

    def over_view(self) -> None:
        """Rest the pointer in the middle of the 3D view, which costs no action."""
        left, top, right, bottom = self.box()
        self.move((left + right) / 2, (top + bottom) / 2)
        self.handled()

    def find(self, name: str, region: str = "UI") -> tuple[float, float]:
        """Where the button of that operator or setting is in a region, found by moving the pointer down over it."""
        began = time.monotonic()
        left, top, right, bottom = self.box(region)
        try:
            for x in (0.3, 0.6, 0.82):
                for y in range(top + 30, bottom - 8, ROW):
                    place = left + x * (right - left), float(y)
                    if name in self.button_at(*place, region):
                        return place
        finally:
            self.spent += time.monotonic() - began
        raise WalkError(f"there is no button {name} in the region {region}")

    def button_at(self, x: float, y: float, region: str = "UI") -> str:
        self.move(x, y)
        time.sleep(0.03)
        return str(self.ask(f"answer = under_pointer({region!r})"))

    def open_panel(self, button: str) -> None:
        """Open the closed panel that has that button below its header: one click, on the header that does it."""
        began, actions = time.monotonic(), self.actions
        left, _top, right, _bottom = self.box("UI")
        x = left + 0.3 * (right - left)
        for y in self.lines_of_text():
            if self.button_at(x, y):
                continue
            self.click(x, y)
            if any(button in self.button_at(x, y + below) for below in (26, 36)):
                break
            self.click(x, y)  # another panel, or none
        else:
            raise WalkError(f"no panel opens to the button {button}")
        self.actions = actions + 1
        self.spent += time.monotonic() - began

    def lines_of_text(self) -> list[float]:
        """Middles of what is written in the sidebar, from the bottom up."""
        left, top, right, bottom = self.box("UI")
        width = int(0.4 * (right - left))
        crop = f"{width}x{bottom - top}+{left + 30}+{top}"
        command = ["import", "-window", "root", "-crop", crop, "-depth", "8", "gray:-"]
        pixels = subprocess.run(command, capture_output=True, check=True).stdout
        written = [max(pixels[i : i + width]) > INK for i in range(0, len(pixels), width)]
        lines, start = [], 0
        for y in range(1, len(written)):
            if written[y] and not written[y - 1]:
                start = y
            elif written[y - 1] and not written[y]:
                lines.append(top + 0.5 * (start + y))
        return lines[::-1]

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
