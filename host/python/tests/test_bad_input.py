"""Bad input: the program's words, as exceptions of one family."""

import threading

import numpy
import pytest

import pendulum_rig as pr


def test_a_missing_file_is_named(rig):
    with pytest.raises(pr.Failed, match="nowhere.csv"):
        pr.fit("nowhere.csv", rig)


def test_an_effect_that_is_none(rig, swing):
    with pytest.raises(pr.WrongUse, match="there is no effect called drag") as raised:
        pr.improve(swing, rig, add=["drag"])
    assert "host effects" in raised.value.next_step
    assert isinstance(raised.value, pr.Error) and isinstance(raised.value, ValueError)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda rig, swing: pr.fit(swing, rig, method="guess"), "no method called guess"),
        (lambda rig, swing: pr.fit(swing, rig, ranges={"Mw": (1.0, 0.0)}), "Mw"),
        (lambda rig, swing: pr.fit(swing, rig, effect="torque = "), "formula|expected"),
        (lambda rig, swing: pr.fit([swing, swing], rig), "count twice"),
        (lambda rig, swing: pr.fit([], rig), "no swing"),
        (lambda rig, swing: pr.fit([3], rig), "recording 1 is a int"),
        (lambda rig, swing: pr.fit(swing, 3), "the rig is a int"),
        (lambda rig, swing: pr.fit(swing, rig, reading=pr.Reading(start=3.0, end=2.0)), "not before"),
        (lambda rig, swing: pr.Recording([0.0, 1.0], [0.0]), r"\(2,\)"),
        (lambda rig, swing: pr.Recording(numpy.arange(20.0), numpy.full(20, numpy.nan)), "nan|finite|NaN"),
        (lambda rig, swing: pr.Rig(mass=-1.0, length=0.1, inertia=0.1), "mass"),
        (lambda rig, swing: rig.with_values(Mx=1.0), "no parameter Mx"),
        (lambda rig, swing: rig["Mx"], "no Mx"),
        (lambda rig, swing: pr.simulate(rig, seconds=-1.0), "seconds is -1"),
        (lambda rig, swing: pr.simulate(), "a rig or a scenario"),
        (lambda rig, swing: pr.simulate(scenario="moon"), "no scenario called moon"),
        (lambda rig, swing: pr.connect("sim:moon"), "moon"),
    ],
)
def test_each_is_told(rig, swing, call, words):
    with pytest.raises(pr.Error, match=words):
        call(rig, swing)


def test_a_file_of_several_runs_is_asked_for_one_of_them(rig, swing, tmp_path):
    times, readings = swing.times_s, swing.readings
    rows = [f"{run},{time:.6f},{reading:.7f}" for run in (1, 2) for time, reading in zip(times, run * readings / 2)]
    path = tmp_path / "both.csv"
    path.write_text("run,t,theta\n" + "\n".join(rows) + "\n")
    with pytest.raises(pr.Failed, match="holds 2 runs .*--run 2"):
        pr.read(path)
    assert numpy.allclose(pr.read(path, pr.Reading(run=2)).readings, readings, atol=1e-6)
    with pytest.raises(pr.Failed, match="no run 3"):
        pr.fit(path, rig, reading=pr.Reading(run=3))


def test_no_file_is_replaced_unasked(rig, swing, tmp_path):
    for thing in (rig, swing):
        path = tmp_path / type(thing).__name__
        thing.save(path)
        with pytest.raises(pr.Error, match="exists"):
            thing.save(path)
        thing.save(path, force=True)


def test_other_threads_run_while_a_fit_computes(rig, swing):
    computing, ran = threading.Event(), threading.Event()
    thread = threading.Thread(target=lambda: computing.wait() and ran.set())
    thread.start()
    pr.fit(swing, rig, method="least-squares", progress=lambda _: computing.set())
    thread.join()
    assert ran.is_set()


def test_an_exception_of_the_progress_callback_ends_the_fit(rig, swing):
    def stop(words):
        raise KeyboardInterrupt(words)

    with pytest.raises(KeyboardInterrupt):
        pr.fit(swing, rig, progress=stop)
