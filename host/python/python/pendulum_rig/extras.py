"""The packages that are only needed for tables and pictures."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .errors import MissingExtra


def extra(module: str, purpose: str) -> Any:
    """The module, or an error that says how to install it."""
    package = module.partition(".")[0]
    try:
        return import_module(module)
    except ImportError as error:
        raise MissingExtra(f"{package} is needed for {purpose}", f"pip install {package}") from error


def axes_of(axes: Any, n_rows: int = 1, height: float = 3.0) -> Any:
    """The given axes, or new ones one above the other."""
    if axes is not None:
        return axes if n_rows > 1 or not hasattr(axes, "__len__") else axes[0]
    pyplot = extra("matplotlib.pyplot", "pictures")
    return pyplot.subplots(n_rows, 1, sharex=True, figsize=(8.0, height * n_rows), layout="constrained")[1]
