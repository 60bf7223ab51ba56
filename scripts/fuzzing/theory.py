"""Calls of chains after Denavit and Hartenberg, and of planar arms."""

from __future__ import annotations

from typing import Any

import numpy as np
from fuzzing.calls import Draw, of_function, of_method
from fuzzing.cases import Case
from fuzzing.good_values import Draws, always, normal, one_of, uniform
from fuzzing.values import Rng, angles, number, pick, transform

import alpha5_model as a5
from alpha5_model.theory.dh import arm_types, orientations, tasks

CHAIN_METHODS = (
    "frames",
    "forward_kinematics",
    "jacobian",
    "joint_axes",
    "to_urdf",
)
CHAIN_FUNCTIONS = (
    arm_types.classify,
    tasks.task_capability,
    orientations.orientation_freedom,
    orientations.spatial_dexterity,
)
PLANAR_METHODS = ("poses", "forward_kinematics", "jacobian", "part")
PLANAR_FUNCTIONS = (
    "dexterous_area",
    "dexterous_radii",
    "necessary_conditions",
    "turns_fully",
    "workspace",
)


def draws() -> dict[str, Draw]:
    """Denavit and Hartenberg, planar arms and curves."""
    return _chains() | _planar_arms() | _curves("Arc", _arc) | _curves("Segment", _line)


def _chains() -> dict[str, Draw]:
    found: dict[str, Draw] = {}
    for method in CHAIN_METHODS:
        found[f"a5.dh.DHChain.{method}"] = of_method(_chain, method)
    found["a5.dh.DHChain.from_axes"] = _from_axes
    found["a5.dh.DHChain"] = of_function(
        _chain_of, links=_links, base=transform, tool=transform
    )
    found["a5.dh.DHLink.transform"] = of_method(
        lambda rng: _links(rng)[0], "transform", q=number(-3, 3)
    )
    for function in CHAIN_FUNCTIONS:
        found[f"dh.{function.__name__}"] = of_function(function, chain=_chain)
    return found


def _planar_arms() -> dict[str, Draw]:
    found: dict[str, Draw] = {}
    for method in PLANAR_METHODS:
        found[f"a5.planar.PlanarArm.{method}"] = of_method(
            _planar_arm, method, q=_planar_angles
        )
    found["a5.planar.Workspace.contains"] = of_method(
        lambda rng: _planar_arm(rng).workspace(), "contains", points=plane_points
    )
    found["a5.planar.dexterity"] = of_function(
        a5.planar.dexterity, arm=_planar_arm, points=plane_points
    )
    for name in PLANAR_FUNCTIONS:
        function = getattr(a5.planar, name)
        found[f"a5.planar.{name}"] = of_function(function, arm=_planar_arm)
    found["a5.planar.dexterity_map"] = of_function(
        a5.planar.dexterity_map, arm=_planar_arm, resolution=always(5)
    )
    return found


def _curves(name: str, curve: Draws) -> dict[str, Draw]:
    """Methods of a curve in the plane."""
    return {
        f"a5.planar.{name}.point": of_method(curve, "point", t=numbers),
        f"a5.planar.{name}.left": of_method(curve, "left", t=number(-3, 3)),
        f"a5.planar.{name}.parameter": of_method(
            curve, "parameter", points=plane_points, tolerance=number(0, 0.1)
        ),
    }


def _chain(rng: Rng) -> Any:
    if rng.integers(2):
        return a5.dh.DHChain.alpha5()
    joints = int(rng.integers(1, 6))
    return a5.dh.DHChain.from_table(rng.normal(0, 1, (joints, 4)))


def _chain_of(links: Any, base: Any, tool: Any) -> Any:
    return a5.dh.DHChain(links, base, tool)


def _links(rng: Rng) -> list[a5.dh.DHLink]:
    links = int(rng.integers(1, 4))
    return [a5.dh.DHLink(*rng.uniform(-1, 1, 4)) for _ in range(links)]


def _from_axes(rng: Rng, spoiled: bool) -> Case:
    """A chain from the axes of its joints."""
    n = int(rng.integers(1, 6))
    limits = np.sort(rng.uniform(-3, 3, (n, 2)))
    draw = of_function(
        a5.dh.DHChain.from_axes,
        points=normal(1, n, 3),
        directions=normal(1, n, 3),
        sigma=lambda rng: [int(x) for x in rng.integers(0, 2, n)],
        end_effector=transform,
        q=uniform(-1, 1, n),
        limits=always(limits),
        tolerance=number(0, 1e-6),
    )
    return draw(rng, spoiled)


def _planar_arm(rng: Rng) -> a5.planar.PlanarArm:
    n = int(rng.integers(1, 4))
    limits = []
    for _ in range(n):
        limited = rng.integers(2)
        limits.append((-1.0, float(rng.uniform(0, 3))) if limited else None)
    lengths = rng.uniform(0.2, 3, n)
    return a5.planar.PlanarArm(lengths, limits if rng.integers(2) else None)


def _planar_angles(rng: Rng) -> np.ndarray:
    joints = int(rng.integers(1, 4))
    return angles(joints)(rng)


planar_limits = one_of(
    None,
    [(-1.0, 1.0)] * 3,
    [None, (0.0, 2.0)],
    [(1.0, -1.0)],
    "none",
    [(0.0, np.inf)],
)


def _point(rng: Rng) -> tuple[float, float]:
    x = float(rng.normal())
    y = float(rng.normal())
    return x, y


def _arc(rng: Rng) -> a5.planar.Arc:
    center = _point(rng)
    radius = float(rng.uniform(0.1, 3))
    start = float(rng.uniform(-3, 3))
    return a5.planar.Arc(center, radius, start, 2.0)


def _line(rng: Rng) -> a5.planar.Segment:
    start = _point(rng)
    direction = float(rng.uniform(-3, 3))
    length = float(rng.uniform(0.1, 3))
    return a5.planar.Segment(start, direction, length)


def plane_points(rng: Rng) -> np.ndarray:
    """One point in the plane, or three."""
    return rng.normal(0, 2, pick(rng, ((2,), (3, 2))))


def numbers(rng: Rng) -> np.ndarray:
    """A number, or an array of some."""
    return rng.uniform(-0.5, 0.5, pick(rng, ((), (3,), (2, 3))))
