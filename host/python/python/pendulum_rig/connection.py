"""A rig on a port."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any

from . import _native
from .recordings import Recording, read
from .results import Look
from .rig import Rig, rig_of


class Connection:
    """An open rig. Made by :func:`connect`; closes at the end of a ``with``, or when it is forgotten."""

    def __init__(self, native: _native.Connection) -> None:
        self._native: _native.Connection | None = native

    @property
    def port(self) -> str:
        """As it was named."""
        return self._open.port

    @property
    def firmware(self) -> str:
        """Who is there."""
        return self._open.firmware

    def record(
        self,
        path: str | os.PathLike[str],
        *,
        force: bool = False,
        rate: float | None = None,
        wait: float = 120.0,
        limit: float = 300.0,
        progress: Callable[[str], Any] | None = None,
    ) -> Recording:
        """Records a swing into a file, as ``host record``: waits for stillness, release and rest.

        Args:
            path: the file; replaced with ``force`` only.
            rate: sample at this rate meanwhile, 50 to 10000 Hz.
            wait: give up if the pendulum was not let go within so many seconds.
            limit: end the recording so many seconds after the release.
            progress: called with a sentence when a stage begins.

        Ctrl-C ends a recording early, keeps the file, and is then raised.
        """
        self._open.record(os.fspath(path), force, rate, wait, limit, progress)
        return read(path)

    def pull(self) -> Rig:
        """The model that the rig has, with its calibration."""
        return Rig._of(self._open.pull())

    def push(
        self,
        rig: Any,
        *,
        calibration: bool = False,
        without_sensor: bool = False,
        progress: Callable[[str], Any] | None = None,
    ) -> dict[str, Any]:
        """Sends a model, saves it to flash, reads it back and compares; gives the fields of ``host push --json``.

        Args:
            calibration: send the file's sensor calibration too, over the one the rig has.
            without_sensor: leave out the effects of a sensor that the rig does not have.
        """
        return json.loads(self._open.push(rig_of(rig), calibration, without_sensor, progress))

    def watch(
        self,
        swings: int | None = None,
        *,
        wait: float = 120.0,
        limit: float = 300.0,
        progress: Callable[[str], Any] | None = None,
    ) -> Look | None:
        """Says which effect the rig's model lacks while the pendulum swings, as ``host watch``."""
        text = self._open.watch(swings, wait, limit, progress)
        return None if text is None else Look(text)

    def close(self) -> None:
        """Lets the port go."""
        self._native = None

    @property
    def _open(self) -> _native.Connection:
        if self._native is None:
            raise ValueError("the connection is closed; connect again")
        return self._native

    def __enter__(self) -> Connection:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return "<Connection, closed>" if self._native is None else f"<Connection to {self.firmware} on {self.port}>"


def connect(port: str) -> Connection:
    """Opens a rig: a serial device such as ``/dev/ttyACM0``, its serial number, ``sim``, or ``sim:NAME``."""
    return Connection(_native.Connection(port))
