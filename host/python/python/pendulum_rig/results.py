"""What the commands find: the fields of ``--json``, with names, units, tables and pictures."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy

from . import _native
from .extras import axes_of, extra
from .numbers import Number, html_rows, html_table, listing, with_spread
from .rig import Rig


@dataclass(frozen=True)
class Curve:
    """One swing, measured and modelled.

    Attributes:
        name: of the recording.
        times_s: seconds since the first sample, shape (n,).
        measured: shape (n,), rad, or rad/s where rates were measured.
        modelled: shape (n,), the same.
    """

    name: str
    times_s: numpy.ndarray
    measured: numpy.ndarray
    modelled: numpy.ndarray

    @property
    def residuals(self) -> numpy.ndarray:
        """Measured minus modelled, shape (n,)."""
        return self.measured - self.modelled


class Result:
    """A result of a command.

    Attributes:
        notes: what was noticed in the recordings, in words: what was cut, gaps, doubts.
    """

    def __init__(self, text: str, notes: Sequence[str] = ()) -> None:
        self.notes = list(notes)
        self._text = text
        self._fields: dict[str, Any] = json.loads(text)

    def to_dict(self) -> dict[str, Any]:
        """Every field of ``--json``, to the bit."""
        return json.loads(self._text)

    def to_json(self) -> str:
        """The text that the program prints with ``--json``."""
        return self._text

    @property
    def _unit(self) -> str:
        """Of a reading and of what a model leaves of it."""
        return "rad/s" if self._fields.get("measured") == "rate" else "rad"

    def _rows(self) -> list[dict[str, Any]]:
        raise NotImplementedError

    def to_dataframe(self) -> Any:
        """A pandas table of what the result is about."""
        return extra("pandas", "tables").DataFrame(self._rows())


class Curved(Result):
    """A result with curves of every swing."""

    def __init__(self, text: str, curves: _native.Curves, notes: Sequence[str] = ()) -> None:
        super().__init__(text, notes)
        self._curves = curves

    @property
    def curves(self) -> list[Curve]:
        """Each swing, measured and modelled; the model runs when they are asked for."""
        return [Curve(*self._curves.of(index)) for index in range(len(self._curves))]

    def plot(self, axes: Any = None, swing: int = 0) -> Any:
        """Draws measured against modelled and what is left, by matplotlib; gives both axes.

        Args:
            axes: two axes to draw on.
            swing: which one, from 0.
        """
        above, below = axes_of(axes, 2, 2.4)
        curve = Curve(*self._curves.of(swing))
        above.plot(curve.times_s, curve.measured, color="0.6", linewidth=1.6, label="measured")
        above.plot(curve.times_s, curve.modelled, color="C3", linewidth=0.7, label="model")
        above.set(title=os.path.basename(curve.name), ylabel=f"reading ({self._unit})")
        above.legend(loc="upper right")
        below.plot(curve.times_s, 1e3 * curve.residuals, color="C0", linewidth=0.5)
        below.set(xlabel="time (s)", ylabel=f"left (m{self._unit})")
        for each in (above, below):
            each.grid(alpha=0.3)
        return above, below


class Fit(Curved):
    """The numbers of a pendulum, found from its swings."""

    def __init__(self, text: str, rig: _native.Rig, curves: _native.Curves, notes: Sequence[str] = ()) -> None:
        super().__init__(text, curves, notes)
        self._rig = rig

    @property
    def parameters(self) -> tuple[Number, ...]:
        """The numbers that were found, in SI units."""
        return tuple(Number(**number) for number in self._fields["parameters"])

    @property
    def symbols(self) -> tuple[str, ...]:
        """The order of rows and columns of :attr:`covariance` and :attr:`correlations`."""
        return tuple(self._fields["covariance"]["symbols"])

    @property
    def covariance(self) -> numpy.ndarray:
        """Covariance matrix, shape (k, k), in the products of the numbers' units; NaN where the swings give none."""
        return numpy.array(self._fields["covariance"]["matrix"], dtype=float)

    @property
    def correlations(self) -> numpy.ndarray:
        """Correlations, shape (k, k); NaN where the swings give none."""
        return numpy.array(self._fields["correlations"], dtype=float)

    @property
    def measured(self) -> str:
        """What the recordings hold: ``angle``, or ``rate``, of which errors are in rad/s."""
        return self._fields["measured"]

    @property
    def rmse(self) -> float:
        """Root mean square error, rad (rad/s of rates)."""
        return self._fields["rmse"]

    @property
    def noise(self) -> float:
        """Noise of the readings, rad (rad/s of rates)."""
        return self._fields["noise"]

    @property
    def left(self) -> str:
        """What the model leaves: ``noise``, ``nearly`` or ``missing`` where physics is missing."""
        return self._fields["left"]

    @property
    def held_out_rmse(self) -> float | None:
        """The error on what was held out."""
        return self._fields["held_out_rmse"]

    @property
    def warnings(self) -> list[str]:
        """What should be known of the numbers."""
        return self._fields["warnings"]

    @property
    def discovery(self) -> dict[str, Any] | None:
        """What was missing, if it was looked for and found; the fields of ``diagnose --json``."""
        return self._fields["discovery"]

    @property
    def seconds(self) -> float:
        """How long it took, s."""
        return self._fields["seconds"]

    @property
    def rig(self) -> Rig:
        """The model with the found values."""
        return Rig._of(self._rig)

    def _rows(self) -> list[dict[str, Any]]:
        return self._fields["parameters"]

    def __getitem__(self, symbol: str) -> Number:
        for number in self.parameters:
            if number.symbol == symbol:
                return number
        raise KeyError(f"there is no {symbol}; found were {', '.join(self.symbols)}")

    def _sentence(self) -> str:
        unit = f"m{self._unit}"
        return f"error {1e3 * self.rmse:.3f} {unit} rms, noise {1e3 * self.noise:.3f} {unit} rms; left: {self.left}"

    def __repr__(self) -> str:
        notes = "".join(f"\n  note: {note}" for note in self.warnings)
        return f"<Fit: {self._sentence()}\n{listing(self.parameters)}{notes}>"

    def _repr_html_(self) -> str:
        notes = html_rows(["note"], [[note] for note in self.warnings]) if self.warnings else ""
        return f"{html_table(self.parameters)}<p>{self._sentence()}</p>{notes}"


class Comparison(Curved):
    """How well a model follows recordings, and where it fails."""

    @property
    def verdict(self) -> list[str]:
        """What it comes to, a sentence an entry."""
        return self._fields["verdict"]

    @property
    def totals(self) -> dict[str, float]:
        """``explained``, ``nrmse_fit``, ``residual_rad``, ``noise_rad``, ``ratio`` over all recordings."""
        return self._fields["totals"]

    def _rows(self) -> list[dict[str, Any]]:
        flat = ("name", "duration_s", "motion_rad", "residual_rad", "explained", "more_than_noise")
        return [{key: recording[key] for key in flat} for recording in self._fields["recordings"]]

    def __repr__(self) -> str:
        return "<Comparison: " + "\n  ".join(self.verdict) + ">"

    def _repr_html_(self) -> str:
        rows = self._rows()
        table = html_rows(list(rows[0]), [[_short(value) for value in row.values()] for row in rows])
        return f"<p>{'<br>'.join(self.verdict)}</p>{table}"


class Diagnosis(Result):
    """Which physical effect is missing from a model."""

    @property
    def missing(self) -> list[str]:
        """The effects that are claimed to be missing; empty if none is."""
        return self._fields["verdict"]

    @property
    def undecided(self) -> list[str]:
        """Effects that these swings can't tell from those."""
        return self._fields["undecided"]

    @property
    def ranked(self) -> list[str]:
        """All that were tried, the likeliest first."""
        return self._fields["ranked"]

    @property
    def values(self) -> tuple[Number, ...]:
        """The numbers of the model with what is missing in it."""
        fields = self._fields["values"]
        return tuple(Number(name=each.pop("effect"), **each) for each in map(dict, fields))

    @property
    def rmse_before(self) -> float:
        """Error of the base model, rad (rad/s of rates)."""
        return self._fields["rmse_before"]

    @property
    def rmse_after(self) -> float:
        """Error with what is missing in it, rad (rad/s of rates)."""
        return self._fields["rmse_after"]

    @property
    def noise(self) -> float:
        """Noise of the readings, rad (rad/s of rates)."""
        return self._fields["noise"]

    def _rows(self) -> list[dict[str, Any]]:
        return self._fields["values"]

    def _sentence(self) -> str:
        tied = f", which can't be told from {', '.join(self.undecided)}" if self.missing and self.undecided else ""
        unit = f"m{self._unit}"
        errors = f"{1e3 * self.rmse_before:.3f} → {1e3 * self.rmse_after:.3f} {unit} rms"
        return f"{self._finding()}{tied}; error {errors}, noise {1e3 * self.noise:.3f} {unit}"

    def _finding(self) -> str:
        if self.missing:
            return f"missing is {' + '.join(self.missing)}"
        if self._fields["suspect"]:
            return f"likely missing, but not proven, is {self._fields['suspect']}"
        if self._fields["unexplained"]:
            return "more than noise is left, and no effect can be named"
        return "nothing is missing"

    def plot(self, axes: Any = None) -> Any:
        """Draws the error before and after beside the noise, by matplotlib; gives the axes."""
        axes = axes_of(axes)
        errors = [1e3 * self.rmse_before, 1e3 * self.rmse_after]
        axes.bar(["base model", " + ".join(["base", *self.missing])], errors, width=0.5, color=["0.6", "C3"])
        axes.axhline(1e3 * self.noise, color="C0", linestyle="--", label="noise")
        axes.set(ylabel=f"error (m{self._unit} rms)")
        axes.legend()
        return axes

    def __repr__(self) -> str:
        return f"<Diagnosis: {self._sentence()}\n{listing(self.values)}>"

    def _repr_html_(self) -> str:
        return f"<p>{self._sentence()}</p>{html_table(self.values)}"


class Improvement(Result):
    """A larger model, and how the error fell."""

    def __init__(self, text: str, rig: _native.Rig, notes: Sequence[str] = ()) -> None:
        super().__init__(text, notes)
        self._rig = rig

    @property
    def rig(self) -> Rig:
        """The larger model, refitted."""
        return Rig._of(self._rig)

    @property
    def measured(self) -> str:
        """What the recordings hold: ``angle``, or ``rate``, of which errors are in rad/s."""
        return self._fields["measured"]

    @property
    def steps(self) -> list[dict[str, Any]]:
        """After each change, or after each effect that a diagnosis added, the base model first: ``words``, ``rmse``
        (rad; rad/s of rates) and more."""
        if "steps" in self._fields:
            return self._fields["steps"]
        return [{"words": step["added"], **step} for step in self._fields["staircase"]]

    @property
    def added(self) -> list[str]:
        """The effects that a diagnosis added; empty where changes were made by hand."""
        return self._fields.get("verdict", [])

    def _rows(self) -> list[dict[str, Any]]:
        return [{"words": step["words"], "rmse": step["rmse"]} for step in self.steps]

    def plot(self, axes: Any = None) -> Any:
        """Draws the error after each step, by matplotlib; gives the axes."""
        axes = axes_of(axes)
        rows = self._rows()
        axes.step(range(len(rows)), [1e3 * row["rmse"] for row in rows], where="mid", marker="o", color="C3")
        axes.set_xticks(range(len(rows)), [row["words"] for row in rows])
        axes.set(ylabel=f"error (m{self._unit} rms)", ylim=(0.0, None))
        return axes

    def __repr__(self) -> str:
        lines = [f"  {row['words']:<32} {1e3 * row['rmse']:9.3f} m{self._unit}" for row in self._rows()]
        return "<Improvement: error after each step\n" + "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        rows = [[row["words"], f"{1e3 * row['rmse']:.3f}"] for row in self._rows()]
        return html_rows(["step", f"error (m{self._unit} rms)"], rows) + self.rig._repr_html_()


class Plan(Result):
    """Which experiment would tell the leading explanations apart."""

    @property
    def models(self) -> list[str]:
        """The leading explanations, the best first."""
        return self._fields["models"]

    @property
    def experiments(self) -> list[dict[str, Any]]:
        """The best first: ``experiment``, ``separations``, ``worst`` (Δχ²)."""
        return self._fields["experiments"]

    def _rows(self) -> list[dict[str, Any]]:
        return [each["experiment"] | {"worst": each["worst"]} for each in self.experiments]

    def __repr__(self) -> str:
        best = f"; best: {self._rows()[0]}" if self.experiments else ""
        return f"<Plan: {' or '.join(self.models) or 'nothing to separate'}{best}>"

    def _repr_html_(self) -> str:
        rows = [[_short(value) for value in row.values()] for row in self._rows()]
        return html_rows(["release (rad)", "mass", "length", "Δχ²"], rows)


class Look(Result):
    """What a rig's model lacks, said while the pendulum swung."""

    @property
    def named(self) -> list[str]:
        """What is missing; empty with a :attr:`reason`."""
        return self._fields["named"]

    @property
    def reason(self) -> str | None:
        """Why nothing is named."""
        return self._fields["reason"]

    def _rows(self) -> list[dict[str, Any]]:
        keys = ("name", "f", "p", "windows", "tied")
        return [{key: each[key] for key in keys} for each in self._fields["candidates"]]

    def __repr__(self) -> str:
        return f"<Look: {' + '.join(self.named) or self.reason}>"

    def _repr_html_(self) -> str:
        rows = [[_short(value) for value in row.values()] for row in self._rows()]
        table = html_rows(["effect", "F", "p", "windows", "tied"], rows)
        return f"<p>{' + '.join(self.named) or self.reason}</p>{table}"


class Effect(Result):
    """A physical effect, as the program has it."""

    def __init__(self, fields: dict[str, Any]) -> None:
        super().__init__(json.dumps(fields))

    def __getattr__(self, name: str) -> Any:
        fields = self.__dict__.get("_fields", {})
        if name in fields:
            return fields[name]
        raise AttributeError(name)

    def _rows(self) -> list[dict[str, Any]]:
        return self._fields["parameters"]

    def __repr__(self) -> str:
        return f"<Effect {self.name}: {self.formula}>"

    def _repr_html_(self) -> str:
        rows = [[n["symbol"], n["unit"], f"{n['low']} … {n['high']}", n["meaning"]] for n in self._fields["parameters"]]
        head = f"<p><b>{self.name}</b>: {self.summary}</p><pre>{self.formula}</pre>"
        return head + html_rows(["", "unit", "range", "meaning"], rows)


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


__all__ = ["Comparison", "Curve", "Diagnosis", "Effect", "Fit", "Improvement", "Look", "Plan", "with_spread"]
