"""The least distance of a point to what the arm reaches, by minimisation."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from fk import STRETCHED, tip
from reference import LOWER, UPPER

#: Upper arm and forearm, from Table 1 [m].
L_1 = math.hypot(0.040, 0.1453)
L_2 = math.hypot(0.020, 0.180)


@cache
def starts() -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """A grid of configurations, where their tcp is, and its rows by pose and elbow."""
    axes = [
        np.linspace(a, b, n)
        for a, b, n in zip(LOWER, UPPER, (37, 41, 41, 1), strict=False)
    ]
    q = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=-1)
    place = tip(q)
    x, y, _ = place.T
    facing = x * np.cos(q[:, 0]) + y * np.sin(q[:, 0])
    kinds = [
        np.flatnonzero(((facing < 0) == front) & ((q[:, 2] < STRETCHED) == bent))
        for front in (True, False)
        for bent in (True, False)
    ]
    return q[:, :3], place, kinds


def squared(q: np.ndarray, target: list[float]) -> tuple[float, np.ndarray]:
    """Squared distance of the tcp to a target and its gradient; floats are fast."""
    t_0, t_1, t_2 = q.tolist()
    phi = t_1 + math.atan2(0.040, 0.1453) - math.pi / 2
    psi = phi + STRETCHED - t_2
    c_0 = -math.cos(t_0)
    s_0 = -math.sin(t_0)
    r = 0.020 + L_1 * math.cos(phi) + L_2 * math.cos(psi)
    dx = r * c_0 - target[0]
    dy = r * s_0 - target[1]
    dz = 0.0462 + L_1 * math.sin(phi) + L_2 * math.sin(psi) - target[2]
    along = dx * c_0 + dy * s_0
    across = dy * c_0 - dx * s_0
    second = L_2 * (dz * math.cos(psi) - along * math.sin(psi))
    first = L_1 * (dz * math.cos(phi) - along * math.sin(phi)) + second
    return dx * dx + dy * dy + dz * dz, 2 * np.array([r * across, first, -second])


def numerical_distance(target: np.ndarray) -> float:
    """The least distance within the joint limits, by minimisation from many starts."""
    from scipy.optimize import minimize

    grid, place, kinds = starts()
    gap = ((place - target) ** 2).sum(axis=-1)
    bounds = list(zip(LOWER[:3], UPPER[:3], strict=True))
    goal = target.tolist()
    best = math.inf

    def scaled(q: np.ndarray) -> tuple[float, np.ndarray]:
        value, slope = squared(q, goal)
        return 1e4 * value, 1e4 * slope

    for kind in kinds:
        chosen: list[np.ndarray] = []
        for i in kind[np.argsort(gap[kind])[:60]]:
            if all(np.abs(grid[i] - c).max() > 0.3 for c in chosen):
                chosen.append(grid[i])
        for start in chosen[:3]:
            options = {"ftol": 1e-18, "gtol": 1e-13, "maxiter": 300}
            found = minimize(
                scaled,
                start,
                jac=True,
                bounds=bounds,
                method="L-BFGS-B",
                options=options,
            )
            best = min(best, math.sqrt(found.fun) / 100)
    return best
