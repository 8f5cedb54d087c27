"""The base model fitted to one swing by SciPy's least squares, its Runge-Kutta steps compiled by Numba.

What a careful user would write without this project: the same windows that grow, the same steps of 10 ms, turning
points cut where the velocity is zero, Ms equal to Mc and no velocity band. Usage: scipy_numba.py FILE; prints JSON.
"""

import json
import sys
import time

import numba
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

MASS_KG, LENGTH_M, INERTIA_KG_M2, GRAVITY = 0.1466084, 0.1562177, 0.00284252, 9.81
GRAVITY_NM = MASS_KG * LENGTH_M * GRAVITY
WINDOWS_S = (1.2, 2.5, 5.0, 10.0, 20.0, 40.0, np.inf)
# Mw (N·m·s/rad), Mc (N·m), I (kg·m²), start (rad, rad/s), zero (rad): what a change of one matters.
SCALES = np.array([1e-4, 1e-4, 1e-4, 1e-2, 1e-2, 1e-3])


@numba.njit(fastmath=False)
def step(angle, velocity, side, dt, viscous, coulomb, pivot):
    half = 0.5 * dt
    a1 = (-GRAVITY_NM * np.sin(angle) - viscous * velocity - side * coulomb) / pivot
    v2 = velocity + half * a1
    a2 = (-GRAVITY_NM * np.sin(angle + half * velocity) - viscous * v2 - side * coulomb) / pivot
    v3 = velocity + half * a2
    a3 = (-GRAVITY_NM * np.sin(angle + half * v2) - viscous * v3 - side * coulomb) / pivot
    v4 = velocity + dt * a3
    a4 = (-GRAVITY_NM * np.sin(angle + dt * v3) - viscous * v4 - side * coulomb) / pivot
    sixth = dt / 6.0
    return angle + sixth * (velocity + 2.0 * (v2 + v3) + v4), velocity + sixth * (a1 + 2.0 * (a2 + a3) + a4)


@numba.njit(fastmath=False)
def settled(angle, velocity, coulomb):
    """The side to which friction does not act: that of the velocity, or of gravity where it breaks away; 0 at rest."""
    if velocity != 0.0:
        return np.sign(velocity)
    drive = -GRAVITY_NM * np.sin(angle)
    return np.sign(drive) if abs(drive) > coulomb else 0.0


@numba.njit(fastmath=False)
def swing(times, viscous, coulomb, inertia, angle, velocity):
    pivot = MASS_KG * LENGTH_M**2 + inertia
    angles = np.empty(times.size)
    angles[0] = angle
    side = settled(angle, velocity, coulomb)
    for k in range(1, times.size):
        left = times[k] - times[k - 1]
        for _ in range(4):
            if side == 0.0 or left <= 0.0:
                break
            after, speed = step(angle, velocity, side, left, viscous, coulomb, pivot)
            if side * speed >= 0.0:
                angle, velocity = after, speed
                break
            share = velocity / (velocity - speed)
            for _ in range(3):
                _, here = step(angle, velocity, side, share * left, viscous, coulomb, pivot)
                share = min(max(share - here / (speed - velocity), 0.0), 1.0)
            angle, _ = step(angle, velocity, side, share * left, viscous, coulomb, pivot)
            velocity, left = 0.0, (1.0 - share) * left
            side = settled(angle, velocity, coulomb)
        angles[k] = angle
    return angles


def fit(times, measured):
    guess = np.array([1e-4, 1e-4, INERTIA_KG_M2, measured[0], 0.0, 0.0])
    for window in WINDOWS_S:
        n = np.searchsorted(times, window, side="right")
        residuals = lambda x: swing(times[:n], *x[:5]) + x[5] - measured[:n]
        bounds = ([0, 0, 1e-5, -4, -9, -0.1], [5e-3, 2e-2, 3e-2, 4, 9, 0.1])
        found = least_squares(residuals, guess, x_scale=SCALES, bounds=bounds, ftol=1e-9, xtol=1e-10)
        guess = found.x
    return found.x, float(np.sqrt(np.mean(found.fun**2)))


def seconds_of_solve_ivp(times, x):
    """One swing by SciPy's adaptive integrator, its turning points as events: for how long a fit would take with it."""
    viscous, coulomb, inertia, angle, velocity, _ = x
    pivot = MASS_KG * LENGTH_M**2 + inertia
    turns = lambda t, y, side: y[1]
    turns.terminal = True
    began, now, end = time.perf_counter(), times[0], times[-1]
    state, side = np.array([angle, velocity]), settled(angle, velocity, coulomb)
    while now < end and side != 0.0:
        law = lambda t, y, side: [y[1], (-GRAVITY_NM * np.sin(y[0]) - viscous * y[1] - side * coulomb) / pivot]
        turns.direction = -side
        part = solve_ivp(law, (now, end), state, args=(side,), events=turns, rtol=1e-8, atol=1e-10)
        now = part.t[-1]
        state = np.array([part.y[0, -1], 0.0])
        side = settled(state[0], 0.0, coulomb)
    return time.perf_counter() - began


def main():
    times, measured = np.loadtxt(sys.argv[1], delimiter=",", skiprows=1, unpack=True)
    fit(times[:200], measured[:200])  # compiled once, which is not counted
    began, used = time.perf_counter(), time.process_time()
    x, rms = fit(times, measured)
    took, used = time.perf_counter() - began, time.process_time() - used
    began = time.perf_counter()
    swing(times, *x[:5])
    one = time.perf_counter() - began
    print(json.dumps({
        "seconds": took, "cpu_seconds": used, "rmse": rms, "swing_seconds": one,
        "solve_ivp_swing_seconds": seconds_of_solve_ivp(times, x), "values": list(x[:3]),
    }))


if __name__ == "__main__":
    main()
