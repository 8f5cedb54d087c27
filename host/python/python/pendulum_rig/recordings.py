"""Recordings: read from files, or made of arrays."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy

from . import _native
from .errors import WrongUse
from .extras import axes_of, extra


@dataclass(frozen=True)
class Reading:
    """How recordings of others are to be read; what is left out is found.

    Attributes:
        columns: columns by number from 0 or by name, such as ``"t=0,theta=2"`` or ``"t=0:ms,theta=angle:deg"``.
        degrees: the angles are in degrees, rates in degrees a second.
        radians: they are in radians, however large they are.
        rate: samples per second, Hz, for files without a time column.
        zero: what the sensor reads while the pendulum hangs, in the file's unit.
        pivot: the pivot in the file's x and y, for a point that was followed in a video.
        mirror: the sensor counts the other way, clockwise positive.
        run: of a file that holds several runs this one, by name or by number from 1.
        start: the free swing begins here, s.
        end: the free swing ends here, s.
    """

    columns: str | None = None
    degrees: bool = False
    radians: bool = False
    rate: float | None = None
    zero: float | None = None
    pivot: Sequence[float] | None = None
    mirror: bool = False
    run: str | int | None = None
    start: float | None = None
    end: float | None = None


class Recording:
    """A recording of a swinging pendulum: times and raw readings.

    Made by :func:`read`, :func:`simulate`, or of arrays:

    Args:
        times_s: seconds, shape (n,), strictly increasing.
        readings: shape (n,): angles in rad, 0 = hanging, counter-clockwise positive; or rates in rad/s.
        name: what results call it.
        rates: the readings are angular velocities.

    Raises:
        Failed: fewer than 16 samples, or values that are not finite, or times that do not increase.
    """

    def __init__(self, times_s: Any, readings: Any, name: str = "recording", rates: bool = False) -> None:
        times, values = (numpy.asarray(array, dtype=float) for array in (times_s, readings))
        if times.ndim != 1 or times.shape != values.shape:
            raise WrongUse(
                f"{name}: times have the shape {times.shape} and readings {values.shape}; expected (n,) for both",
                "give one reading for each time",
            )
        self._native = _native.Recording.of_arrays(name, times, values, rates)

    @classmethod
    def _of(cls, native: _native.Recording) -> Recording:
        made = cls.__new__(cls)
        made._native = native
        return made

    @property
    def name(self) -> str:
        """What results call it: the file's name."""
        return self._native.name

    @property
    def times_s(self) -> numpy.ndarray:
        """Seconds, shape (n,), strictly increasing. Read-only and shared: no copy is made."""
        return self._native.times_s

    @property
    def readings(self) -> numpy.ndarray:
        """Raw readings, shape (n,), in :attr:`unit`. Read-only and shared: no copy is made."""
        return self._native.readings

    @property
    def codes(self) -> numpy.ndarray | None:
        """Converter codes, shape (n,), where they were recorded."""
        return self._native.codes

    @property
    def unit(self) -> str:
        """Of the readings: ``rad`` or ``rad/s``."""
        return self._native.unit

    @property
    def rate_hz(self) -> float:
        """Samples per second."""
        return self._native.rate_hz

    @property
    def duration_s(self) -> float:
        """From the first to the last sample, s."""
        return self._native.duration_s

    @property
    def notes(self) -> list[str]:
        """What was noticed while reading."""
        return self._native.notes

    @property
    def gaps(self) -> list[tuple[float, float]]:
        """Places where samples are missing: from, to, in s."""
        return self._native.gaps

    def save(self, path: str | os.PathLike[str], force: bool = False) -> None:
        """Writes it as a file of ours; replaces one with ``force`` only."""
        self._native.save(os.fspath(path), force)

    def to_dict(self) -> dict[str, Any]:
        """What is known of it, and its samples as arrays."""
        facts = {name: getattr(self, name) for name in ("name", "unit", "rate_hz", "duration_s", "notes", "gaps")}
        return facts | {"times_s": self.times_s, "readings": self.readings, "codes": self.codes}

    def to_dataframe(self) -> Any:
        """A pandas table with the columns ``t`` (s) and ``theta`` (rad) or ``omega`` (rad/s)."""
        pandas = extra("pandas", "tables")
        return pandas.DataFrame({"t": self.times_s, "theta" if self.unit == "rad" else "omega": self.readings})

    def plot(self, axes: Any = None) -> Any:
        """Draws the readings over time by matplotlib; gives the axes."""
        axes = axes_of(axes)
        axes.plot(self.times_s, self.readings, linewidth=0.8)
        axes.set(title=os.path.basename(self.name), xlabel="time (s)", ylabel=f"reading ({self.unit})")
        axes.grid(alpha=0.3)
        return axes

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        return f"<Recording {self.name}: {len(self)} samples, {self.duration_s:.1f} s at {self.rate_hz:.6g} Hz>"


RecordingLike = Union[str, "os.PathLike[str]", Recording, Any]


def read(path: str | os.PathLike[str], reading: Reading = Reading()) -> Recording:
    """Reads a recording: ours, or anybody's table.

    Args:
        path: the file: CSV and its kin, MATLAB, LabVIEW, phyphox archives and others.
        reading: how, if the file does not say.

    Raises:
        Failed: the file can't be a recording; the message names line and column. Or it holds several runs, and
            ``reading`` does not choose one by its ``run``.
    """
    return Recording._of(_native.Recording.read(os.fspath(path), reading))


def given(recordings: Any) -> list[Any]:
    """One recording or several, as files, recordings, tables or (times, readings), as the native part takes them."""
    if _is_named(recordings) or _is_pair(recordings):
        recordings = [recordings]
    return [_one(recording, index) for index, recording in enumerate(recordings)]


def _is_named(recording: Any) -> bool:
    return isinstance(recording, (str, os.PathLike, Recording)) or hasattr(recording, "columns")


def _is_pair(recording: Any) -> bool:
    """Times and readings, and not two recordings?"""
    return isinstance(recording, tuple) and len(recording) == 2 and not any(map(_is_named, recording))


def _one(recording: RecordingLike, index: int) -> Any:
    if isinstance(recording, Recording):
        return recording._native
    if isinstance(recording, (str, os.PathLike)):
        return os.fspath(recording)
    if hasattr(recording, "columns"):
        return _of_table(recording, index)._native
    if _is_pair(recording):
        return Recording(*recording, name=f"recording {index + 1}")._native
    raise WrongUse(
        f"recording {index + 1} is a {type(recording).__name__}",
        "give a file, a Recording, a pandas table with t and theta, or (times, readings)",
    )


def _of_table(table: Any, index: int) -> Recording:
    for readings, rates in (("theta", False), ("omega", True)):
        if "t" in table.columns and readings in table.columns:
            name = f"table {index + 1}"
            return Recording(table["t"].to_numpy(dtype=float), table[readings].to_numpy(dtype=float), name, rates)
    raise WrongUse(
        f"table {index + 1} has the columns {', '.join(map(str, table.columns))}",
        "name the times t (s), and the readings theta (rad) or omega (rad/s)",
    )
