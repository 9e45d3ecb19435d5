# SPDX-License-Identifier: GPL-3.0-or-later
"""Dashes move with the frames at playback and by the clock under the pointer, and rest otherwise."""

from types import SimpleNamespace

import bpy
import pytest


@pytest.fixture
def view():
    """A view of a window that plays or not."""

    def make(plays, number=7):
        return SimpleNamespace(
            screen=SimpleNamespace(is_animation_playing=plays),
            scene=bpy.context.scene,
            region=SimpleNamespace(as_pointer=lambda: number),
        )

    from stormfield.ui import motion

    motion.forget()
    yield make
    motion.forget()


def test_dashes_rest_without_playback_and_pointer(view):
    from stormfield.ui import motion

    assert motion.phase(view(False)) is None


def test_at_playback_the_phase_follows_the_frame(view, scene):
    from stormfield.ui import motion

    scene.render.fps = 24
    scene.frame_set(0)
    assert motion.phase(view(True)) == 0.0
    scene.frame_set(12)
    assert motion.phase(view(True)) == pytest.approx(0.5 * motion.SPEED % 1.0)


def test_under_the_pointer_it_follows_the_clock_in_that_view_alone(view, monkeypatch):
    from stormfield.ui import motion

    now = [100.0]
    monkeypatch.setattr(motion.time, "monotonic", lambda: now[0])
    motion.pointer_moved(view(False))
    first = motion.phase(view(False))
    assert first is not None and motion.phase(view(False, number=8)) is None
    now[0] += 0.5
    assert motion.phase(view(False)) == pytest.approx((first + 0.5 * motion.SPEED) % 1.0)
    now[0] += motion.REST
    motion._tick()
    assert motion.phase(view(False)) is None and motion._tick() is None
