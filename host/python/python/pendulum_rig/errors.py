"""What can go wrong, in the program's words."""

from __future__ import annotations


class Error(Exception):
    """Something could not be done.

    Attributes:
        what: what happened, with the thing and its value.
        next_step: what to do next, if the program knows.
    """

    def __init__(self, what: str, next_step: str | None = None) -> None:
        super().__init__(what if next_step is None else f"{what}\nnext: {next_step}")
        self.what = what
        self.next_step = next_step

    def __reduce__(self):
        return type(self), (self.what, self.next_step)


class WrongUse(Error, ValueError):
    """It can't be meant like this (exit code 2 of the program)."""


class Failed(Error, RuntimeError):
    """It was meant well and did not work (exit code 1 of the program)."""


class MissingExtra(Error, ImportError):
    """A package is needed that is not installed."""
