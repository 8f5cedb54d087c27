"""Identify a pendulum's friction from a free swing, and find the missing physics.

    import pendulum_rig as pr

    rig = pr.Rig(mass=0.1466, length=0.1562, inertia=0.002843)
    fit = pr.fit("swing.csv", rig)
    fit.parameters, fit.covariance, fit.plot()

Everything is in SI units and radians; 0 = hanging, counter-clockwise positive. The numbers are those of the program's
``--json``, to the bit.
"""

from ._native import __version__
from .commands import compare, diagnose, effects, fit, improve, plan, simulate
from .connection import Connection, connect
from .errors import Error, Failed, MissingExtra, WrongUse
from .numbers import Number
from .recordings import Reading, Recording, read
from .results import Comparison, Curve, Diagnosis, Effect, Fit, Improvement, Look, Plan
from .rig import Model, Rig, State

__all__ = [
    "Comparison",
    "Connection",
    "Curve",
    "Diagnosis",
    "Effect",
    "Error",
    "Failed",
    "Fit",
    "Improvement",
    "Look",
    "MissingExtra",
    "Model",
    "Number",
    "Plan",
    "Reading",
    "Recording",
    "Rig",
    "State",
    "WrongUse",
    "__version__",
    "compare",
    "connect",
    "diagnose",
    "effects",
    "fit",
    "improve",
    "plan",
    "read",
    "simulate",
]
