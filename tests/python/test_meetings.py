# SPDX-License-Identifier: GPL-3.0-or-later
"""Where paths meet, and how ends that nearly meet are joined."""

import numpy as np
import pytest
from stormfield.model.design import Design, Element
from stormfield.model.meetings import joined, meetings


def path(name, start, end, lam, **settings):
    points = [tuple(row) for row in np.linspace(start, end, 6)]
    return Element(name, "singular", tuple(points), lam=lam, kind="vortex_ccw", **{"radius": 0.2} | settings)


def merge(gap=0.0, late=0.0):
    return [
        path("West", (-1, 0, 0), (0, gap, 0), (0.0, 0.6)),
        path("East", (1, 0, 0), (0, -gap, 0), (0.0, 0.6 + late)),
        path("One", (0, 0, 0), (0, 1, 0), (0.6, 1.0)),
    ]


def test_two_that_end_where_one_begins_merge():
    (found,) = meetings(merge())
    assert (found.words, found.lam) == ("merge", 0.6)
    assert found.ending == ("West", "East") and found.beginning == ("One",)
    assert np.allclose(found.position, 0.0)


def test_the_same_backwards_is_a_split():
    one, *two = (
        path("One", (0, 1, 0), (0, 0, 0), (0.0, 0.4)),
        path("West", (0, 0, 0), (-1, 0, 0), (0.4, 1.0)),
        path("East", (0, 0, 0), (1, 0, 0), (0.4, 1.0)),
    )
    (found,) = meetings([one, *two])
    assert (found.words, found.ending, found.beginning) == ("split", ("One",), ("West", "East"))


@pytest.mark.parametrize(
    ("changes", "words"),
    [({"lam": (0.6, 1.0)}, "goes on"), ({"lam": (0.0, 0.6)}, "end together"), ({"lam": (0.7, 1.0)}, None)],
)
def test_two_ends(changes, words):
    first = path("A", (-1, 0, 0), (0, 0, 0), (0.0, 0.6))
    second = path("B", (0, 0, 0), (1, 0, 0), changes["lam"])
    if changes["lam"][0] == 0.0:
        second = path("B", (1, 0, 0), (0, 0, 0), changes["lam"])
    found = meetings([first, second])
    assert [meeting.words for meeting in found] == ([words] if words else [])


def test_ends_that_meet_are_left_as_they_are_to_the_bit():
    design = Design(tuple(merge()))
    same, notes = joined(design)
    assert same == design and notes == ()


def test_ends_that_nearly_meet_are_joined_and_it_is_said():
    design, notes = joined(Design(tuple(merge(gap=0.03, late=0.01))))
    assert len(notes) == 1
    assert "'West' and 'East' and 'One'" in notes[0] and "λ 0.60" in notes[0]
    west, east, one = design.elements
    assert west.points[-1] == east.points[-1] == one.points[0]
    assert west.lam[-1] == east.lam[-1] == one.lam[0] == 0.6
    assert west.points[0] == (-1.0, 0.0, 0.0)  # far points stay
    assert joined(design) == (design, ())  # once is enough


def test_what_begins_gathers_ends_that_are_far_from_each_other():
    (found,) = meetings(merge(gap=0.05))  # 0.1 apart: half a radius
    assert found.ending == ("West", "East") and found.beginning == ("One",)


def test_ends_that_are_far_apart_stay():
    design = Design(tuple(merge(gap=0.1)))  # 0.5 radii
    assert joined(design) == (design, ())
    late = Design(tuple(merge(late=0.1)))
    assert [meeting.ending for meeting in meetings(late.elements)] == [("West",)]


def test_a_path_does_not_meet_itself_nor_others_at_the_ends_of_lambda():
    angles = np.linspace(0, 2 * np.pi, 20)
    circle = [(float(np.cos(a)), float(np.sin(a)), 0.0) for a in angles]
    assert meetings([Element("Round", "singular", tuple(circle), lam=(0.2, 0.21), radius=0.3)]) == []
    assert meetings([path("A", (0, 0, 0), (1, 0, 0), (0, 1)), path("B", (0, 0, 0), (0, 1, 0), (0, 1))]) == []


def test_lambda_of_every_point_still_grows_after_joining():
    late = path("A", (-1, 0, 0), (0, 0.02, 0), (0.0, 0.55, 0.58, 0.6, 0.612, 0.615))
    design, notes = joined(Design((late, path("B", (0, 0, 0), (1, 0, 0), (0.6, 1.0)))))
    assert notes
    design.check()
