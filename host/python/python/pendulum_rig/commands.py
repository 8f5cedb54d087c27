"""The commands as functions. Each computes what the command of that name computes, without the interpreter's lock."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, Union

from . import _native
from .errors import WrongUse
from .recordings import Reading, Recording, RecordingLike, given
from .results import Comparison, Diagnosis, Effect, Fit, Improvement, Plan
from .rig import Rig, rig_of

RigLike = Union[Rig, str, "os.PathLike[str]"]
Recordings = Union[RecordingLike, Sequence[RecordingLike]]
Progress = Callable[[str], Any]
Method = Literal["rsm", "least-squares", "both"]


def fit(
    recordings: Recordings,
    rig: RigLike,
    *,
    method: Method = "both",
    ranges: Mapping[str, tuple[float, float]] | None = None,
    hold_out: Recordings = (),
    effect: str | None = None,
    discover: bool = False,
    reading: Reading = Reading(),
    progress: Progress | None = None,
) -> Fit:
    """Finds friction and inertia from swings, as ``host fit``.

    Args:
        recordings: one or several, fitted all at once: files, :class:`Recording`, pandas tables with the columns ``t``
            (s) and ``theta`` (rad) or ``omega`` (rad/s), or pairs (times, angles) of arrays of shape (n,).
        rig: the model to begin with, or its file.
        method: response surfaces, least squares, or one after the other.
        ranges: symbol → (low, high) in SI units, searched instead of a range found from the recordings.
        hold_out: recordings that take no part and show how well the model predicts.
        effect: a torque of your own with parameters to be found, ``"torque = -k*omega^3; k in 0..1e-4"``.
        discover: if physics is missing, find out which, add it, and go on with the enlarged model.
        reading: how files of others are read.
        progress: called with a sentence when a step begins.

    Raises:
        WrongUse, Failed: with the program's words. Ctrl-C ends it at once.
    """
    chosen = [(symbol, float(low), float(high)) for symbol, (low, high) in (ranges or {}).items()]
    asked = (given(recordings), given(hold_out), rig_of(rig), reading)
    text, fitted, curves, notes = _native.fit(*asked, method, chosen, effect, discover, progress)
    return Fit(text, fitted, curves, notes)


def compare(
    recordings: Recordings,
    rig: RigLike,
    *,
    hold_out: Recordings = (),
    reading: Reading = Reading(),
    progress: Progress | None = None,
) -> Comparison:
    """Shows how well a model follows recordings, and where it fails, as ``host compare``. Arguments as :func:`fit`."""
    text, curves, notes = _native.compare(given(recordings), given(hold_out), rig_of(rig), reading, progress)
    return Comparison(text, curves, notes)


def diagnose(
    recordings: Recordings,
    rig: RigLike,
    *,
    hold_out: Recordings = (),
    effect: str | None = None,
    formulas: bool = False,
    reading: Reading = Reading(),
    progress: Progress | None = None,
) -> Diagnosis:
    """Finds out which physical effect is missing, as ``host diagnose``. Arguments as :func:`fit`.

    Args:
        effect: a torque of your own that is tried too.
        formulas: search small formulas for what no effect explains; up to a minute.
    """
    asked = (given(recordings), given(hold_out), rig_of(rig), reading)
    text, notes = _native.diagnose(*asked, effect, formulas, progress)
    return Diagnosis(text, notes)


def improve(
    recordings: Recordings,
    rig: RigLike,
    *,
    hold_out: Recordings = (),
    effect: str | None = None,
    add: Sequence[str] = (),
    remove: Sequence[str] = (),
    reading: Reading = Reading(),
    progress: Progress | None = None,
) -> Improvement:
    """Adds what is missing and refits, as ``host improve``. Arguments as :func:`fit`.

    Args:
        add: effects that are added by hand instead of asking the diagnosis.
        remove: effects that are taken out by hand.
    """
    asked = (given(recordings), given(hold_out), rig_of(rig), reading)
    text, rig_after, notes = _native.improve(*asked, effect, list(add), list(remove), progress)
    return Improvement(text, rig_after, notes)


def plan(
    recordings: Recordings, rig: RigLike, *, reading: Reading = Reading(), progress: Progress | None = None
) -> Plan:
    """Finds the experiment that would best separate the leading explanations, as ``host plan``."""
    text, notes = _native.plan(given(recordings), rig_of(rig), reading, progress)
    return Plan(text, notes)


def simulate(
    rig: RigLike | None = None,
    *,
    scenario: str | None = None,
    start: float = 1.5,
    seconds: float = 46.0,
    noise: float = 1e-3,
    seed: int = 1,
    rate: float = 1000.0,
    exact: bool = False,
) -> Recording:
    """A swing of a model as a sensor would record it, held still for 0.5 s before the release, as ``host simulate``.

    Args:
        rig: the model; see :meth:`Rig.with_values` for other numbers and effects.
        scenario: a hidden pendulum instead, such as ``"mystery-1"``.
        start: release angle, rad.
        seconds: length of the swing, s.
        noise: standard deviation of white noise on the angle, rad.
        seed: equal seeds give equal noise.
        rate: samples per second, Hz.
        exact: the angle as it is, not through a 12-bit converter.
    """
    if (rig is None) == (scenario is None):
        raise WrongUse("what to simulate is not clear", "give a rig or a scenario, one of them")
    model = None if rig is None else rig_of(rig)
    numbers = (float(start), float(seconds), float(noise), seed, float(rate))
    return Recording._of(_native.simulate(model, scenario, *numbers, exact))


def effects(name: str | None = None) -> dict[str, Effect]:
    """The physical effects by name, or one of them, as ``host effects``."""
    return {each["name"]: Effect(each) for each in json.loads(_native.effects(name))["effects"]}

