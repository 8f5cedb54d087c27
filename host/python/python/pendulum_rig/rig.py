"""A rig's model: geometry, effects, and how certain their numbers are."""

from __future__ import annotations

import os
from typing import Any

from . import _native
from .errors import WrongUse
from .numbers import Number, html_table, listing
from .extras import extra

Model = _native.Model
State = _native.State


class Rig:
    """The model of one rig, as ``rig.toml`` holds it. Nothing changes one: what fits gives a new one.

    Args:
        mass: kg.
        length: from the pivot to the centre of mass, m.
        inertia: about the centre of mass, kg·m².
        gravity: m/s².
        mass_std: how surely the mass is known, kg; without one it is exact.
        length_std: the same of the length, m.
        inertia_std: the same of the inertia, kg·m²; without one any inertia may be found.

    Friction is a guess from the pendulum's size until a fit.
    """

    def __init__(
        self,
        mass: float,
        length: float,
        inertia: float,
        gravity: float = 9.81,
        *,
        mass_std: float | None = None,
        length_std: float | None = None,
        inertia_std: float | None = None,
    ) -> None:
        self._native = _native.Rig(mass, length, inertia, gravity, (mass_std, length_std, inertia_std))

    @classmethod
    def _of(cls, native: _native.Rig) -> Rig:
        made = cls.__new__(cls)
        made._native = native
        return made

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Rig:
        """Reads a model file."""
        return cls._of(_native.Rig.load(os.fspath(path)))

    @classmethod
    def parse(cls, text: str) -> Rig:
        """Reads the text of a model file."""
        return cls._of(_native.Rig.parse(text))

    @classmethod
    def of_unknown_geometry(cls, gravity: float = 9.81) -> Rig:
        """A rig of which only the motion is known: every torque and inertia is per m·g·l."""
        return cls._of(_native.Rig.of_unknown_geometry(gravity))

    def save(self, path: str | os.PathLike[str], force: bool = False) -> None:
        """Writes the model file; replaces one with ``force`` only."""
        self._native.save(os.fspath(path), force)

    @property
    def toml(self) -> str:
        """The text of the model file."""
        return self._native.toml

    @property
    def parameters(self) -> tuple[Number, ...]:
        """Every number of the model, in SI units."""
        return tuple(Number(*number) for number in self._native.numbers())

    @property
    def values(self) -> dict[str, float]:
        """Symbol → value, in SI units."""
        return {number.symbol: number.value for number in self.parameters}

    @property
    def is_normalised(self) -> bool:
        """Is the geometry unknown, so that torques and inertias are per m·g·l?"""
        return self._native.is_normalised

    def with_values(self, effect: str | None = None, **values: float) -> Rig:
        """The same with other numbers, such as ``rig.with_values(Cq=1e-4)``; their effects are added if need be.

        Args:
            effect: a torque of your own, such as ``"torque = -k*omega^3; k in 0..1e-4"``.
            values: by symbol, in SI units.

        Raises:
            WrongUse: no such symbol, or a value outside its range.
        """
        return Rig._of(self._native.changed(list(values.items()), effect))

    def model(self) -> Model:
        """The model that runs: ``release``, ``step``, ``read``, ``run``."""
        return self._native.model()

    def to_dict(self) -> dict[str, Any]:
        """The fields of ``parameters`` in ``host init --json``."""
        fields = ("symbol", "name", "value", "std", "unit")
        return {"parameters": [{name: getattr(number, name) for name in fields} for number in self.parameters]}

    def to_dataframe(self) -> Any:
        """A pandas table, a row a number."""
        return extra("pandas", "tables").DataFrame(self.to_dict()["parameters"]).set_index("symbol")

    def __getitem__(self, symbol: str) -> Number:
        for number in self.parameters:
            if number.symbol == symbol:
                return number
        raise WrongUse(f"there is no {symbol} in this model", f"known are {', '.join(self.values)}")

    def __repr__(self) -> str:
        return f"<Rig\n{listing(self.parameters)}>"

    def _repr_html_(self) -> str:
        return html_table(self.parameters)


def rig_of(rig: Any) -> _native.Rig:
    """A rig, or the file of one, as the native part takes it."""
    if isinstance(rig, Rig):
        return rig._native
    if isinstance(rig, (str, os.PathLike)):
        return _native.Rig.load(os.fspath(rig))
    raise WrongUse(f"the rig is a {type(rig).__name__}", "give a Rig or the path of a model file")
