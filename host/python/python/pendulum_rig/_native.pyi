"""The part in Rust; see the modules beside it for what each does."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy
from numpy.typing import NDArray

__version__: str

_Array = NDArray[numpy.float64]
_Progress = Callable[[str], Any] | None

class Recording:
    name: str
    times_s: _Array
    readings: _Array
    codes: NDArray[numpy.uint16] | None
    unit: str
    rate_hz: float
    duration_s: float
    started: str | None
    comment: str | None
    notes: list[str]
    gaps: list[tuple[float, float]]
    @staticmethod
    def read(path: str, reading: Any) -> Recording: ...
    @staticmethod
    def of_arrays(name: str, times_s: _Array, readings: _Array, rates: bool) -> Recording: ...
    def save(self, path: str, force: bool) -> None: ...
    def __len__(self) -> int: ...

class Rig:
    toml: str
    is_normalised: bool
    def __init__(
        self,
        mass_kg: float,
        length_m: float,
        inertia_kg_m2: float,
        gravity_m_s2: float,
        stds: tuple[float | None, float | None, float | None],
    ) -> None: ...
    @staticmethod
    def of_unknown_geometry(gravity_m_s2: float) -> Rig: ...
    @staticmethod
    def load(path: str) -> Rig: ...
    @staticmethod
    def parse(text: str) -> Rig: ...
    def save(self, path: str, force: bool) -> None: ...
    def numbers(self) -> list[tuple[str, str, float, float | None, str]]: ...
    def changed(self, numbers: list[tuple[str, float]], effect: str | None) -> Rig: ...
    def model(self) -> Model: ...

class Model:
    """A pendulum with everything that acts on it, ready to run: the physics of board and program."""

    def release(self, angle_rad: float, velocity_rad_s: float = 0.0) -> State:
        """Let go at an angle (rad) with a velocity (rad/s)."""
    def step(self, state: State, dt_s: float) -> None:
        """One step of dt_s seconds; a step in which sliding begins or ends is cut at that instant."""
    def read(self, state: State) -> float:
        """The sensor's reading, rad; a sensor that remembers does so in the state."""
    def run(self, state: State, dt_s: float, n_steps: int) -> tuple[_Array, _Array]:
        """Many steps: angles (rad) and velocities (rad/s) after each, shape (n_steps,)."""

class State:
    """What a running model remembers."""

    angle_rad: float
    velocity_rad_s: float
    time_s: float
    is_resting: bool

class Curves:
    def of(self, index: int) -> tuple[str, _Array, _Array, _Array]: ...
    def __len__(self) -> int: ...

class Connection:
    port: str
    firmware: str
    def __init__(self, port: str) -> None: ...
    def record(
        self, path: str, force: bool, rate: float | None, wait: float, limit: float, progress: _Progress
    ) -> str: ...
    def pull(self) -> Rig: ...
    def push(self, rig: Rig, calibration: bool, without_sensor: bool, progress: _Progress) -> str: ...
    def watch(self, swings: int | None, wait: float, limit: float, progress: _Progress) -> str | None: ...

def fit(
    recordings: Sequence[Any],
    hold_out: Sequence[Any],
    rig: Rig,
    reading: Any,
    method: str,
    ranges: Sequence[tuple[str, float, float]],
    effect: str | None,
    discover: bool,
    progress: _Progress,
) -> tuple[str, Rig, Curves, list[str]]: ...
def compare(
    recordings: Sequence[Any], hold_out: Sequence[Any], rig: Rig, reading: Any, progress: _Progress
) -> tuple[str, Curves, list[str]]: ...
def diagnose(
    recordings: Sequence[Any],
    hold_out: Sequence[Any],
    rig: Rig,
    reading: Any,
    effect: str | None,
    formulas: bool,
    progress: _Progress,
) -> tuple[str, list[str]]: ...
def improve(
    recordings: Sequence[Any],
    hold_out: Sequence[Any],
    rig: Rig,
    reading: Any,
    effect: str | None,
    add: Sequence[str],
    remove: Sequence[str],
    progress: _Progress,
) -> tuple[str, Rig, list[str]]: ...
def plan(recordings: Sequence[Any], rig: Rig, reading: Any, progress: _Progress) -> tuple[str, list[str]]: ...
def simulate(
    rig: Rig | None,
    scenario: str | None,
    start_rad: float,
    seconds: float,
    noise_rad: float,
    seed: int,
    rate_hz: float,
    exact: bool,
) -> Recording: ...
def effects(name: str | None) -> str: ...
