# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress where there is no terminal: lines that farms understand."""

import pytest
from stormfield.cli import progress
from stormfield.work import Step


def lines(capsys, steps):
    with progress.progress("Baking 'Ball'") as show:
        for step in steps:
            show(step)
    return capsys.readouterr().err.splitlines()


def test_farms_are_told_now_and_then(capsys, monkeypatch):
    steps = [Step(0.25, "Carrying texture to frame 7"), Step(1.0, "Joining the samples", notes=("one note",))]
    assert lines(capsys, steps) == ["note: one note"]  # it has been quick
    monkeypatch.setattr(progress, "QUIET", 0.0)
    assert lines(capsys, steps) == [
        "openjd_progress: 25.0",
        "openjd_status: Baking 'Ball': 25% Carrying texture to frame 7",
        "note: one note",
        "openjd_progress: 100.0",
        "openjd_status: Baking 'Ball': 100% Joining the samples",
    ]


def test_open_job_description_understands_them(capsys, monkeypatch):
    filters = pytest.importorskip("openjd.sessions._action_filter")
    monkeypatch.setattr(progress, "QUIET", 0.0)
    found = [filters.filter_matcher.match(line) for line in lines(capsys, [Step(0.5, "Writing")])]
    kinds = [[name for name, text in match.groupdict().items() if text is not None] for match in found]
    assert kinds == [["progress"], ["status"]]
