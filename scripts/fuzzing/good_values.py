"""A good value for each parameter of the package's functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from fuzzing.values import (
    TEXTS,
    Rng,
    angles,
    number,
    pick,
    points,
    rotation,
    tensor,
    transform,
)

#: Draws a value.
Draws = Callable[[Rng], Any]


def always(value: Any) -> Draws:
    """The same value each time."""
    return lambda rng: value


def one_of(*choices: Any) -> Draws:
    """One of several values."""
    return lambda rng: pick(rng, choices)


def flag(rng: Rng) -> bool:
    """True or False."""
    return bool(rng.integers(2))


def count(low: int, high: int) -> Draws:
    """A whole number from ``low``, below ``high``."""
    return lambda rng: int(rng.integers(low, high))


def normal(scale: float, *shape: int) -> Draws:
    """An array of normal numbers about 0."""
    return lambda rng: rng.normal(0, scale, shape)


def uniform(low: float, high: float, *shape: int) -> Draws:
    """An array of numbers in a range."""
    return lambda rng: rng.uniform(low, high, shape)


def _one_state(rng: Rng) -> np.ndarray:
    """Joint positions of one state, (4,)."""
    return angles(4)(rng).reshape(-1, 4)[0]


def _two_inertias(rng: Rng) -> np.ndarray:
    """The inertia of one body, twice, (2, 3, 3)."""
    inertia = tensor(rng).reshape(-1, 3, 3)[0]
    return np.stack([inertia, inertia])


def _dh_rows(rng: Rng) -> np.ndarray:
    """A Denavit-Hartenberg table of one to five joints."""
    joints = int(rng.integers(1, 6))
    return rng.normal(0, 1, (joints, 4))


def _lengths(rng: Rng) -> np.ndarray:
    """Lengths of one to four links."""
    links = int(rng.integers(1, 5))
    return rng.uniform(0.1, 5, links)


_ARM: dict[str, Draws] = {
    "gravity": normal(9.81, 3),
    "corrections": one_of((), ("base_frame",), ("base_frame", "link3_cob")),
    "fluid_density": number(0, 2e4),
    "gripper": one_of("locked", "jaws"),
    "floating_base": flag,
    "backend": one_of("pinocchio", "kernels"),
    "level": one_of("low", "nominal", "high"),
    "numbers": one_of("estimated", "supplementary"),
    "alternatives": one_of((), ("link3_cob",)),
    "frame": one_of("tcp", "link_2", "base_link", "tool", 2),
    "name": one_of(*TEXTS),
}
_KINEMATICS: dict[str, Draws] = {
    "positions": points,
    "position": points,
    "points": points,
    "transform": transform,
    "rotation": rotation,
    "limits": flag,
    "q_reference": _one_state,
    "q_start": _one_state,
    "wrist": number(-3, 3),
    "max_step": number(0.01, 2),
    "margin": number(0, 0.05),
    "allow_collision": flag,
    "q": angles(4),
    "side": one_of("both", "front", "back"),
    "bounds": always(np.array([[-1.0, 1.0]] * 3)),
    "tolerance": number(0, 1e-6),
    "vertical": normal(1.0, 3),
    "tool_axis": normal(1.0, 3),
    "threads": one_of(None, 1, 2),
    "angle": number(0, 1),
    "distance": number(0, 1),
}
_BODIES: dict[str, Draws] = {
    "mass": number(0, 2),
    "masses": uniform(0.1, 2, 2),
    "com": normal(0.1, 3),
    "cob": normal(0.1, 3),
    "coms": normal(0.1, 2, 3),
    "inertias": _two_inertias,
    "inertia": tensor,
    "inertia_com": tensor,
    "inertia_origin": tensor,
    "rotation_a_to_b": rotation,
    "volume": number(0, 5e-3),
}
_CHAINS: dict[str, Draws] = {
    "theta": number(-4, 4),
    "d": number(-1, 1),
    "a": number(-1, 1),
    "alpha": number(-4, 4),
    "sigma": count(0, 2),
    "offset": number(-1, 1),
    "lower": number(-3, 0),
    "upper": number(0, 3),
    "rows": _dh_rows,
    "orientations": count(1, 9),
    "starts": always(2),
    "steps": always(3),
    "start": always(0),
    "stop": always(1),
}
_PLANAR: dict[str, Draws] = {
    "lengths": _lengths,
    "joints": one_of(None, "R", "RR", "RRR", "RPR", "PP", ""),
    "radius": number(0, 5),
    "number": count(1, 40),
    "samples": count(1, 9),
    "l_1": number(0.1, 5),
    "l_2": number(0.1, 5),
    "l_3": number(0.1, 5),
    "l_4": number(0, 9),
}
_ACTUATORS: dict[str, Draws] = {
    "joint": one_of("axis_a", "axis_b", "axis_c", "axis_d", "axis_e"),
    "constants": one_of("printed", "torque", "voltage"),
    "rotor_inertia": number(0, 1e-5),
    "screw_lead": number(1e-4, 1e-2),
    "torque": normal(5, 3),
    "velocity": normal(1, 3),
    "acceleration": normal(1, 3),
    "current": normal(1, 3),
    "voltage": normal(12, 3),
    "current_rate": normal(1, 3),
    "supply_voltage": number(1, 48),
    "current_limit": number(0.1, 3),
}
_RECORDINGS: dict[str, Draws] = {
    "time": always(np.arange(6) * 0.1),
    "path": one_of(*TEXTS),
    "method": one_of("spline", "savgol", "interpolate"),
    "bandwidth": number(0.1, 4),
}
#: Parameter -> a good value, unless a target has its own.
GOOD: dict[str, Draws] = {
    **_ARM,
    **_KINEMATICS,
    **_BODIES,
    **_CHAINS,
    **_PLANAR,
    **_ACTUATORS,
    **_RECORDINGS,
}
