"""The same fit by general tools, as one would write it with them: a simulation in SciPy, a regression in PySINDy.

Both know the pendulum's m·g·l; both find viscous torque Mw (N·m·s), Coulomb torque Mc (N·m) and the moment of inertia
about the pivot J (kg·m²), in J·dω/dt = −mgl·sin θ − Mw·ω − Mc·sign ω.
"""

import time
import warnings

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

# Friction that jumps stops every adaptive integrator; this many rad/s is the usual compromise.
SOFT = 0.02


def swing(parameters, times, gravity_torque):
    """Angles (rad) at the times (s) by SciPy. Parameters: Mw, Mc, J, start angle, start velocity."""
    mw, mc, j, angle, velocity = parameters

    def slope(_, state):
        theta, omega = state
        return omega, -(gravity_torque * np.sin(theta) + mw * omega + mc * np.tanh(omega / SOFT)) / j

    span, began = (times[0], times[-1]), (angle, velocity)
    solved = solve_ivp(slope, span, began, t_eval=times, method="LSODA", rtol=1e-8, atol=1e-10)
    return solved.y[0] if solved.success else np.full(len(times), 1e3)


def by_scipy(times, angles, gravity_torque, start, windows):
    """Least squares over windows (s) that grow, from a start (Mw, Mc, J): values, spreads, curve, seconds."""
    began = time.perf_counter()
    guess = np.array([*start, angles[0], 0.0])
    for window in windows:
        inside = times - times[0] <= window
        scale = np.abs(guess) + [1e-5, 1e-5, 1e-4, 1e-2, 1e-2]
        left = lambda p: swing(p * scale, times[inside], gravity_torque) - angles[inside]  # noqa: E731
        low = np.array([0.0, 0.0, 1e-9, -np.inf, -np.inf]) / scale
        found = least_squares(left, guess / scale, bounds=(low, np.inf), diff_step=1e-4)
        guess = found.x * scale
    freedom = inside.sum() - len(guess)
    covariance = np.linalg.pinv(found.jac.T @ found.jac) * 2.0 * found.cost / freedom
    spread = np.sqrt(np.diag(covariance)) * scale
    return guess[:3], spread[:3], swing(guess, times, gravity_torque), time.perf_counter() - began


def by_pysindy(times, angles, gravity_torque, extra=None):
    """A sparse regression of dω/dt on sin θ, ω, sign ω: values of Mw, Mc, J, the equation, seconds.

    `extra` names one more candidate: a function of θ and ω, and its text.
    """
    import pysindy
    from scipy.signal import savgol_filter

    began = time.perf_counter()
    step = np.median(np.diff(times))
    even = np.arange(times[0], times[-1], step)
    window = 2 * int(round(0.05 / step)) + 1
    even_angles = np.interp(even, times, angles)
    theta, omega, slope = (savgol_filter(even_angles, window, 3, deriv=order, delta=step) for order in range(3))
    moving = np.abs(omega) > 0.1
    sine, friction = (lambda th, _: np.sin(th), "sin θ"), (lambda _, om: np.sign(om), "sign ω")
    candidates = [sine, (lambda _, om: om, "ω"), friction, *([extra] if extra else [])]
    library = np.column_stack([function(theta, omega)[moving] for function, _ in candidates])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        optimizer = pysindy.STLSQ(threshold=1e-3, alpha=1e-9).fit(library, slope[moving])
    factors = np.ravel(optimizer.coef_)
    inertia = -gravity_torque / factors[0]
    equation = "dω/dt = " + " ".join(f"{factor:+.4g}·{text}" for factor, (_, text) in zip(factors, candidates))
    values = np.array([-factors[1] * inertia, -factors[2] * inertia, inertia])
    return values, equation, time.perf_counter() - began
