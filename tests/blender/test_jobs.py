# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in slices: progress, cancel, faults. Without a window the modal loop is driven by hand."""

from types import SimpleNamespace

import bpy
import pytest


@pytest.fixture
def runner(ball):
    """The modal operator's own code, on a stand-in that needs no window."""
    from stormfield.operators import job_operator
    from stormfield.session import running
    from stormfield.work import Step

    class Runner(job_operator.JobOperator):
        job_title = "Working"

        def __init__(self, steps):
            self._steps, self._timer = steps, None
            self.reports, self.results = [], []
            self._job = running.begin("Working", ball)

        def report(self, kind, text):
            self.reports.append((kind, text))

        def finish(self, _context, obj, result):
            self.results.append((obj.name, result))

    yield Runner, Step
    running.end()


def context():
    manager = SimpleNamespace(
        progress_update=lambda _: None, progress_end=lambda: None, event_timer_remove=lambda _: None, windows=[]
    )
    return SimpleNamespace(window_manager=manager, workspace=SimpleNamespace(status_text_set=lambda _: None))


TIMER, ESC = SimpleNamespace(type="TIMER", value="NOTHING"), SimpleNamespace(type="ESC", value="PRESS")


def test_work_is_done_in_slices_and_given_to_finish(runner):
    from stormfield.session import running

    work, step = runner

    def steps():
        for number in range(3):
            yield step(number / 3, f"part {number}", waiting=True)
        return "folder"

    job = work(steps())
    for fraction in (0.0, 1 / 3, 2 / 3):
        assert job.modal(context(), TIMER) == {"PASS_THROUGH"}
        assert running.current().fraction == fraction
    assert job.modal(context(), TIMER) == {"FINISHED"}
    assert job.results == [("Ball", "folder")] and running.current() is None


@pytest.mark.parametrize("how", ["key", "panel"])
def test_work_that_keeps_what_it_has_ends_early(runner, how):
    from stormfield.session import running
    from stormfield.work import Stop

    work, step = runner
    work.keeps_when_stopped = True

    def steps():
        done = 0
        try:
            while True:
                yield step(0.1, "endless", waiting=True)
                done += 1
        except Stop:
            for _ in range(2):
                yield step(0.9, "ending", waiting=True)
            return done

    def press():
        if how == "panel":
            bpy.ops.stormfield.cancel_job()
        return job.modal(context(), ESC if how == "key" else TIMER)

    job = work(steps())
    for _ in range(3):
        job.modal(context(), TIMER)
    assert press() == {"PASS_THROUGH"} and running.current().message == "ending"
    assert job.modal(context(), TIMER) == {"FINISHED"}
    assert job.results == [("Ball", 2)] and running.current() is None

    job = work(steps())
    job.modal(context(), TIMER)
    press()
    assert press() == {"CANCELLED"} and not job.results  # twice: at once

    def nothing_yet():
        while True:
            yield step(0.1, "reading")

    job = work(nothing_yet())
    job.modal(context(), TIMER)
    assert press() == {"CANCELLED"} and not job.results and running.current() is None


@pytest.mark.parametrize("how", ["key", "panel"])
def test_escape_closes_the_work_at_once(runner, how):
    from stormfield.session import running

    work, step = runner
    closed = []

    def steps():
        try:
            while True:
                yield step(0.1, "endless", waiting=True)
        finally:
            closed.append(True)

    job = work(steps())
    job.modal(context(), TIMER)
    if how == "panel":
        assert bpy.ops.stormfield.cancel_job() == {"FINISHED"}
    assert job.modal(context(), ESC if how == "key" else TIMER) == {"CANCELLED"}
    assert closed and running.current() is None and not job.results
    assert "stopped" in job.reports[0][1]


def test_a_fault_is_told_and_nothing_stays_behind(runner):
    from stormfield.model.errors import InputError
    from stormfield.session import running

    work, step = runner

    def steps():
        yield step(0.0, "begin", waiting=True)
        raise InputError("element 'Eye' lies off the surface; move it closer")

    job = work(steps())
    job.modal(context(), TIMER)
    assert job.modal(context(), TIMER) == {"CANCELLED"}
    assert job.reports == [({"ERROR"}, "element 'Eye' lies off the surface; move it closer")]
    assert running.current() is None


def test_our_own_mistakes_are_not_swallowed(runner):
    from stormfield.session import running

    work, _step = runner

    def steps():
        raise KeyError("mistake")
        yield

    job = work(steps())
    with pytest.raises(KeyError):
        job.modal(context(), TIMER)
    assert running.current() is None


def test_an_object_deleted_meanwhile_is_no_crash(runner, ball):
    work, _step = runner

    def steps():
        return "folder"
        yield

    job = work(steps())
    bpy.data.objects.remove(ball)
    assert job.modal(context(), TIMER) == {"CANCELLED"}
    assert "deleted" in job.reports[0][1]


def test_an_object_renamed_meanwhile_gets_the_result(runner, ball):
    work, step = runner

    def steps():
        yield step(0.0, "begin", waiting=True)
        return "folder"

    job = work(steps())
    job.modal(context(), TIMER)
    ball.name = "Planet"
    assert job.modal(context(), TIMER) == {"FINISHED"}
    assert job.results == [("Planet", "folder")]


def test_one_job_at_a_time(runner, storms):
    work, step = runner

    def steps():
        yield step(0.0, "begin")

    work(steps())
    with pytest.raises(RuntimeError, match="press Esc"):
        bpy.ops.stormfield.solve()
