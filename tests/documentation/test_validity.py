"""Each row of the page on validity, tried over the whole range that it names.

A check receives the numbers of its row in the order in which they are printed, and
returns the largest error that it found. The page is the specification: a wider range
or a smaller error there is what is tested here.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import ik_reference
import numpy as np
import pytest
import reference
from coal_reference import CoalReference
from fk import fk, sample, tip
from ik_targets import at_edge
from newton_euler import newton_euler
from pages import REPOSITORY
from reach_by_minimising import numerical_distance

import alpha5_model as a5

PAGE = (REPOSITORY / "docs" / "validity.md").read_text("utf-8")
#: A number as the page prints it: 20 000, −3, 2e-15, 9.8.
NUMBER = r"([-−]?\d+(?: \d{3})*(?:\.\d+)?(?:e-?\d+)?)"
#: An error that is this much smaller than its bound would mean that the bound, or the
#: check, is wrong.
LOOSE = 1e-4


@dataclass(frozen=True)
class Row:
    """One row of the page.

    Attributes:
        function: Its name.
        inputs: The numbers in the column of inputs.
        bound: The number in the column of errors.
    """

    function: str
    inputs: tuple[float, ...]
    bound: float


def number(text: str) -> float:
    """A printed number."""
    return float(text.replace("−", "-").replace(" ", ""))


def rows() -> list[Row]:
    """All rows of the page, from top to bottom."""
    found = []
    for line in PAGE.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) != 4 or not cells[0].startswith("`"):
            continue
        function, inputs, bound, _ = cells
        numbers = [number(text) for text in re.findall(NUMBER, inputs)]
        most = re.match(NUMBER, bound)
        assert most, f"{function}: no number in {bound!r}"
        found.append(
            Row(
                function=function.strip("`"),
                inputs=tuple(numbers),
                bound=number(most[0]),
            )
        )
    return found


CHECKS: dict[str, Callable[..., float]] = {}


def check(function: str) -> Callable[[Any], Any]:
    """Register what tries the row of a function."""

    def register(tried: Callable[..., float]) -> Callable[..., float]:
        CHECKS[function] = tried
        return tried

    return register


@pytest.mark.slow
@pytest.mark.parametrize("row", rows(), ids=lambda row: row.function)
def test_the_row_holds_over_its_range(row: Row) -> None:
    worst = CHECKS[row.function](*row.inputs)
    assert worst <= row.bound
    assert worst >= LOOSE * row.bound


def test_each_row_has_a_check_and_each_check_a_row() -> None:
    assert sorted(row.function for row in rows()) == sorted(CHECKS)


# --- inputs --------------------------------------------------------------------------


def within(bound: float, count: int, seed: int) -> np.ndarray:
    """Random rows (count, 4) in a range, the first on its corners."""
    rng = np.random.default_rng(seed)
    drawn = rng.uniform(-bound, bound, (count, 4))
    corners = np.array(np.meshgrid(*[[-bound, bound]] * 4)).reshape(4, -1).T
    drawn[: len(corners)] = corners
    return drawn


@cache
def surroundings() -> tuple[tuple[float, tuple[float, ...]], ...]:
    """Densities and gravities: the ends of the range on the page, and between."""
    words = rf"Gravity of up to {NUMBER} m/s² .*? a fluid of {NUMBER} to {NUMBER} kg/m³"
    found = re.search(words, PAGE)
    assert found
    strongest, lightest, heaviest = map(number, found.groups())
    directions = np.random.default_rng(8).normal(size=(2, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return (
        (lightest, tuple(strongest * directions[0])),
        (heaviest, tuple(strongest * directions[1])),
        (a5.SEA_WATER, (0.0, 0.0, -9.81)),
    )


def arms() -> list[tuple[a5.Arm, float, tuple[float, ...]]]:
    """An arm in each of the surroundings."""
    made = []
    for density, gravity in surroundings():
        arm = a5.load(fluid_density=density, gravity=gravity)
        made.append((arm, density, gravity))
    return made


def motion(
    angles: float, speeds: float, accelerations: float, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, velocities and accelerations over the whole range, (count, 4) each."""
    return (
        within(angles, count, seed=1),
        within(speeds, count, seed=2)[::-1],
        within(accelerations, count, seed=3),
    )


# --- kinematics ----------------------------------------------------------------------


@check("Arm.forward_kinematics")
def forward_kinematics(angles: float) -> float:
    q = within(angles, 500, seed=4)
    frames = fk(q)
    arm = a5.load()
    ours = np.array([arm.forward_kinematics(row).homogeneous for row in q])
    return float(np.abs(ours - frames).max())


@check("Arm.jacobian")
def jacobian(angles: float) -> float:
    """In the axes of the base, at the tcp: linear before angular velocity."""
    import pinocchio as pin

    arm = a5.load()
    worst = 0.0
    for q in within(angles, 200, seed=5):
        frames = reference.dh_frames(q)
        columns = []
        for joint in range(4):
            axis = frames[joint][:3, 2]
            arm_of_axis = frames[-1][:3, 3] - frames[joint][:3, 3]
            columns.append(np.concatenate([np.cross(axis, arm_of_axis), axis]))
        ours = arm.jacobian(q, reference_frame=pin.LOCAL_WORLD_ALIGNED)
        worst = max(worst, float(np.abs(ours - np.column_stack(columns)).max()))
    return worst


@check("inverse_kinematics")
def tip_of_solutions(distance: float) -> float:
    rng = np.random.default_rng(6)
    anywhere = rng.normal(size=(20_000, 3))
    anywhere /= np.linalg.norm(anywhere, axis=1, keepdims=True)
    anywhere *= distance * rng.uniform(0.0, 1.0, (len(anywhere), 1))
    target = np.concatenate([anywhere, tip(sample(20_000, seed=7))])
    solutions = a5.inverse_kinematics(target)
    wanted = np.broadcast_to(target[:, None], (len(target), 4, 3))[solutions.exists]
    return float(np.abs(tip(solutions.q[solutions.exists]) - wanted).max())


def beside_edges(gap: float, both_sides: bool = False) -> tuple[np.ndarray, ...]:
    """Targets and wrists this far from each edge, and ordinary ones."""
    targets, wrists = [], []
    for seed, edge in enumerate(("axis", "stretched", "folded")):
        for sign in (-1.0, 1.0) if both_sides or edge == "axis" else (-1.0,):
            gaps = np.full(1500, sign * gap)
            target, wrist = at_edge(edge, 1500, seed, gaps)
            targets.append(target)
            wrists.append(wrist)
    q = sample(3000, seed=9)
    return np.concatenate([*targets, tip(q)]), np.concatenate([*wrists, q[:, 3]])


@check("Solutions.q")
def angles_of_solutions(gap: float) -> float:
    target, wrist = beside_edges(gap)
    ours = a5.inverse_kinematics(target, wrist)
    exact = ik_reference.solved(target, wrist)[0]
    off = np.abs(ours.q - exact.astype(float))
    return float(np.nanmax(np.minimum(off, np.abs(off - 2 * np.pi))))


@check("Solutions.exists")
def existence(gap: float) -> float:
    target, wrist = beside_edges(gap, both_sides=True)
    ours = a5.inverse_kinematics(target, wrist)
    exact = ik_reference.solved(target, wrist)[1]
    assert 0 < exact.sum() < exact.size
    return float((ours.exists != exact).sum())


@check("Solutions.within_limits")
def limits(gap: float) -> float:
    wrong = 0
    for joint in range(4):
        for sign in (-1.0, 1.0):
            gaps = np.full(1000, sign * gap)
            target, wrist = at_edge(f"limit_{joint}", 1000, joint, gaps)
            ours = a5.inverse_kinematics(target, wrist)
            _, _, within_limits, singular = ik_reference.solved(target, wrist)
            assert 0 < within_limits.sum() < within_limits.size
            differ = ours.within_limits != within_limits
            wrong += int(differ[~singular].sum())
    return float(wrong)


@check("distance_to_reach")
def distance_to_reach(distance: float) -> float:
    rng = np.random.default_rng(12)
    targets = rng.uniform(-1.0, 1.0, (120, 3)) * distance / np.sqrt(3)
    targets = targets[~a5.reachable(targets)]
    assert len(targets) > 60
    numerical = [numerical_distance(target) for target in targets]
    return float(np.abs(a5.distance_to_reach(targets) - numerical).max())


# --- dynamics ------------------------------------------------------------------------


@check("Arm.mass_matrix")
def mass_matrix(angles: float) -> float:
    """Column by column: the torque of one unit of acceleration, without gravity."""
    q = within(angles, 100, seed=13)
    still = np.zeros_like(q)
    columns = []
    for joint in range(4):
        unit = np.broadcast_to(np.eye(4)[joint], q.shape)
        columns.append(newton_euler(q, still, unit, 0.0, np.zeros(3))[0])
    exact = np.stack(columns, axis=-1)
    arm = a5.load()
    ours = np.array([arm.mass_matrix(row) for row in q])
    return float(np.abs(ours - exact).max())


@check("Arm.hydrostatic_torque")
def hydrostatic_torque(angles: float) -> float:
    q = within(angles, 200, seed=14)
    still = np.zeros_like(q)
    worst = 0.0
    for arm, density, gravity in arms():
        exact = newton_euler(q, still, still, density, gravity)[0]
        ours = np.array([arm.hydrostatic_torque(row) for row in q])
        worst = max(worst, float(np.abs(ours - exact).max()))
    return worst


@check("Arm.inverse_dynamics")
def inverse_dynamics(speeds: float, accelerations: float) -> float:
    q, v, a = motion(10.0, speeds, accelerations, 200)
    worst = 0.0
    for arm, density, gravity in arms():
        exact = newton_euler(q, v, a, density, gravity)[0]
        ours = [arm.inverse_dynamics(*state) for state in zip(q, v, a, strict=True)]
        worst = max(worst, float(np.abs(ours - exact).max()))
    return worst


@check("Arm.inverse_dynamics_batch")
def inverse_dynamics_batch(speeds: float, accelerations: float) -> float:
    q, v, a = motion(10.0, speeds, accelerations, 3000)
    worst = 0.0
    for arm, density, gravity in arms():
        exact = newton_euler(q, v, a, density, gravity)[0]
        ours = arm.inverse_dynamics_batch(q, v, a)
        worst = max(worst, float(np.abs(ours - exact).max()))
    return worst


@check("Arm.base_wrench")
def base_wrench(speeds: float, accelerations: float) -> float:
    q, v, a = motion(10.0, speeds, accelerations, 200)
    worst = 0.0
    for arm, density, gravity in arms():
        _, force, moment = newton_euler(q, v, a, density, gravity)
        for k in range(len(q)):
            ours = arm.base_wrench(q[k], v[k], a[k])
            worst = max(worst, float(np.abs(ours.linear - force[k]).max()))
            worst = max(worst, float(np.abs(ours.angular - moment[k]).max()))
    return worst


@check("Arm.forward_dynamics")
def forward_dynamics(speeds: float, accelerations: float) -> float:
    q, v, a = motion(10.0, speeds, accelerations, 200)
    worst = 0.0
    for arm, density, gravity in arms():
        torque = newton_euler(q, v, a, density, gravity)[0]
        states = zip(q, v, torque, strict=True)
        ours = [arm.forward_dynamics(*state) for state in states]
        worst = max(worst, float(np.abs(ours - a).max()))
    return worst


@check("Arm.forward_dynamics_batch")
def forward_dynamics_batch(speeds: float, accelerations: float) -> float:
    q, v, a = motion(10.0, speeds, accelerations, 3000)
    worst = 0.0
    for arm, density, gravity in arms():
        torque = newton_euler(q, v, a, density, gravity)[0]
        ours = arm.forward_dynamics_batch(q, v, torque)
        worst = max(worst, float(np.abs(ours - a).max()))
    return worst


@check("Arm.inverse_dynamics_derivatives")
def inverse_dynamics_derivatives(speeds: float, accelerations: float) -> float:
    """The derivative with respect to q, by central differences of order 6."""
    q, v, a = motion(10.0, speeds, accelerations, 20)
    step = 4e-3
    worst = 0.0
    for arm, density, gravity in arms():
        columns = []
        for joint in range(4):
            shift = step * np.eye(4)[joint]
            torque = {
                k: newton_euler(q + k * shift, v, a, density, gravity)[0]
                for k in (-3, -2, -1, 1, 2, 3)
            }
            first = 45 * (torque[1] - torque[-1])
            slope = first - 9 * (torque[2] - torque[-2]) + (torque[3] - torque[-3])
            columns.append(slope / (60 * step))
        exact = np.stack(columns, axis=-1)
        for k in range(len(q)):
            ours, _, _ = arm.inverse_dynamics_derivatives(q[k], v[k], a[k])
            off = np.abs(ours - exact[k]).max() / np.abs(exact[k]).max()
            worst = max(worst, float(off))
    return worst


@check("HydrodynamicArm.forward_dynamics")
def forward_dynamics_in_a_current(strongest: float, speeds: float) -> float:
    direction = np.array([0.6, -0.64, 0.48])
    worst = 0.0
    arm = a5.load().with_hydrodynamics(strongest * direction)
    q, v, a = motion(10.0, speeds, 100.0, 100)
    for state in zip(q, v, a, strict=True):
        torque = arm.inverse_dynamics(*state)
        again = arm.forward_dynamics(state[0], state[1], torque)
        worst = max(worst, float(np.abs(again - state[2]).max()))
    return worst


# --- collision -----------------------------------------------------------------------


@cache
def distances(angles: float) -> tuple[np.ndarray, np.ndarray]:
    """Random positions (N, 4), and the least distance of the links by coal, (N,)."""
    q = np.concatenate([within(angles, 300, seed=15), sample(300, seed=16)])
    locked = CoalReference()
    return q, np.array([locked.distance(row) for row in q])


@check("Arm.collision_distance")
def collision_distance(angles: float) -> float:
    q, exact = distances(angles)
    return float(np.abs(a5.load().collision_distance(q) - exact).max())


@check("Arm.in_collision")
def in_collision(least: float) -> float:
    q, exact = distances(10.0)
    clear = np.abs(exact) >= least
    verdict = a5.load().in_collision(q)
    assert 0 < verdict.sum() < len(q)
    return float((verdict != (exact < 0.0))[clear].sum())


# --- lecture notes -------------------------------------------------------------------


def printed_matrix(theta: float, d: float, a: float, alpha: float) -> np.ndarray:
    """The notes' matrix of one row, in 80-bit numbers."""
    turn, twist = np.longdouble(theta), np.longdouble(alpha)
    c, s = np.cos(turn), np.sin(turn)
    ca, sa = np.cos(twist), np.sin(twist)
    return np.array(
        [
            [c, -s * ca, s * sa, a * c],
            [s, c * ca, -c * sa, a * s],
            [0, sa, ca, d],
            [0, 0, 0, 1],
        ]
    )


@check("DHChain.forward_kinematics")
def chains(joints: float, lengths: float, angles: float) -> float:
    rng = np.random.default_rng(17)
    worst = 0.0
    for _ in range(100):
        table = rng.uniform(-lengths, lengths, (int(joints), 4))
        table[:, [0, 3]] = rng.uniform(-angles, angles, (len(table), 2))
        q = rng.uniform(-angles, angles, len(table))
        exact = np.eye(4, dtype=np.longdouble)
        for (_, d, a, alpha), turned in zip(table, q, strict=True):
            exact = exact @ printed_matrix(turned, d, a, alpha)
        chain = a5.dh.DHChain.from_table(np.column_stack([table, np.zeros(len(q))]))
        ours = chain.forward_kinematics(q)
        worst = max(worst, float(np.abs(ours - exact).max()))
    return worst
