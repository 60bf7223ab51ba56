"""The jaws as a tool, by Pinocchio's frames, coal, trimesh and Table 4 by hand."""

from __future__ import annotations

import dataclasses
import warnings
from functools import cache
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin
import pytest
from drawn_bodies import MESHES
from scipy.optimize import brentq

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.errors import ImplausibleWarning, InputError
from alpha5_model.geometry.collision_shapes import collision_primitives

JAWS = a5.jaws()
CLOSED, OPEN = 0.0013, 0.0133
#: From hinge to tip in the frame of finger_1, and of the hinges along -z of link_4 [m].
PIVOT, LENGTH = 0.0155, 0.085
HINGE = 0.13275 + 0.0069
TCP = 0.18


@cache
def arm() -> a5.Arm:
    return a5.load(gripper="jaws")


def in_link_4(name: str, rod: float) -> pin.SE3:
    """Pose of a frame in link_4, by Pinocchio."""
    q = [1.0, 1.0, 1.0, 1.0, rod]
    link_4 = arm().forward_kinematics(q, "link_4")
    return link_4.actInv(arm().forward_kinematics(q, name))


def tips(rod: float) -> np.ndarray:
    """The tips of both fingers in link_4, (2, 3)."""
    one = in_link_4("finger_1", rod).act(np.array([PIVOT, LENGTH, 0.0]))
    other = in_link_4("finger_2", rod).act(np.array([-PIVOT, -LENGTH, 0.0]))
    return np.array([one, other])


def test_the_opening_is_that_of_pinocchios_tips() -> None:
    rods = np.linspace(CLOSED, OPEN, 13)
    apart = [np.linalg.norm(np.subtract(*tips(rod))) for rod in rods]
    assert JAWS.opening(rods) == pytest.approx(apart, abs=1e-12)
    assert JAWS.opening(CLOSED) == pytest.approx(0.0, abs=1e-15)
    # By bisection on Pinocchio's frames.
    for wanted in (0.01, 0.04, 0.1):
        rod = brentq(lambda x: tips(x)[1, 0] - tips(x)[0, 0] - wanted, CLOSED, OPEN)  # noqa: B023
        assert float(JAWS.rod(wanted)) == pytest.approx(rod, abs=1e-9)
    assert JAWS.rod(JAWS.opening(rods)) == pytest.approx(rods, abs=1e-12)


def inside_fingers(points: np.ndarray, rod: float) -> np.ndarray:
    """Which of points (N, 3) of link_4 are in a shape of finger_1 or finger_2."""
    shapes = collision_primitives("jaws")
    inside = np.zeros(len(points), bool)
    for name in ("finger_1", "finger_2"):
        to_finger = in_link_4(name, rod).inverse()
        there = points @ to_finger.rotation.T + to_finger.translation
        for shape in shapes[name]:
            local = (there - shape.xyz) @ rotation_from_rpy(shape.rpy)
            if shape.kind == "box":
                inside |= (np.abs(local) <= np.array(shape.size) / 2).all(axis=1)
                continue
            radius, length = shape.size
            inside |= (np.hypot(*local.T[:2]) <= radius) & (
                np.abs(local[:, 2]) <= length / 2
            )
    return inside


@pytest.mark.parametrize("rod", [CLOSED, 0.004, 0.0071, OPEN])
def test_the_gap_by_brute_force(rod: float) -> None:
    """What is clear for all lines across the blades, in steps of 0.2 mm."""
    x = np.arange(-0.06, 0.06, 2e-4)
    y = np.linspace(-0.0159, 0.0159, 13)
    for at in np.linspace(JAWS.throat, JAWS.end(rod) - 5e-4, 6):
        grid = np.stack(np.meshgrid(x, y, -TCP - at), axis=-1).reshape(-1, 3)
        hits = inside_fingers(grid, rod).reshape(len(y), len(x)).any(axis=0)
        before = x[hits & (x < 0.0)].max(initial=-np.inf)
        after = x[hits & (x > 0.0)].min(initial=np.inf)
        clear = 0.0 if hits[np.abs(x).argmin()] else after - before
        assert float(JAWS.gap(rod, at)) == pytest.approx(clear, abs=4.5e-4)


@pytest.mark.parametrize("rod", [0.004, OPEN])
def test_the_gap_is_at_most_the_drawn_one_and_6_mm_less_at_most(rod: float) -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.load_mesh(Path(MESHES) / "finger_1.obj", process=True)
    mesh.apply_transform(in_link_4("finger_1", rod).homogeneous)
    for at in np.linspace(JAWS.throat + 1e-3, JAWS.end(rod) - 2e-3, 9):
        section = mesh.section([0.0, 0.0, 1.0], [0.0, 0.0, -TCP - at])
        drawn = -2.0 * section.vertices[:, 0].max()
        ours = float(JAWS.gap(rod, at))
        assert drawn - 6.2e-3 <= ours <= drawn + 1e-6


def touches(diameter: float, rod: float, at: float, across: float) -> bool:
    """Whether a pipe along the hinges touches fingers or wrist, by coal."""
    pipe = coal.Cylinder(diameter / 2, 0.2)
    # coal's cylinders lie along z.
    turned = rotation_from_rpy((np.pi / 2, 0.0, 0.0))
    of_pipe = coal.Transform3s(turned, np.array([across, 0.0, -TCP - at]))
    for name, shapes in collision_primitives("jaws").items():
        if name not in ("link_4", "finger_1", "finger_2"):
            continue
        frame = in_link_4(name, rod)
        for shape in shapes:
            kind = coal.Box if shape.kind == "box" else coal.Cylinder
            placed = frame * pin.SE3(rotation_from_rpy(shape.rpy), np.array(shape.xyz))
            pose = coal.Transform3s(placed.rotation, placed.translation)
            result = coal.CollisionResult()
            request = coal.CollisionRequest()
            if coal.collide(pipe, of_pipe, kind(*shape.size), pose, request, result):
                return True
    return False


def test_the_widest_pipe_by_coal() -> None:
    rng = np.random.default_rng(3)
    limited = 0
    for _ in range(12):
        rod = rng.uniform(0.003, OPEN)
        at = rng.uniform(JAWS.throat + 0.005, 0.03)
        across = rng.uniform(-0.006, 0.006)
        widest = JAWS.widest(rod, at, across)
        assert widest > 0.0
        assert not touches(widest - 1e-4, rod, at, across)
        assert touches(widest + 1e-4, rod, at, across)
        limited += widest < 2 * (at - JAWS.throat) - 1e-6
    assert 0 < limited < 12, "by fingers, and by the collar"
    assert JAWS.widest(CLOSED, 0.04) < 0.005
    # Beside or outside the fingers nothing is between them.
    for rod, across in ((CLOSED, 0.02), (CLOSED, 0.05), (OPEN, 0.06), (OPEN, -10.0)):
        assert JAWS.widest(rod, 0.0, across) == 0.0


def test_the_force_by_virtual_work_and_table_4() -> None:
    current, lead = 0.1, 2e-3
    at = 0.012
    turns = 348.7 * 2 * np.pi / lead
    least = (0.0271 * current - 1.15 * 0.469e-3) * turns * 0.77
    greatest = (0.0545 * current - 0.85 * 0.469e-3) * turns
    # Travel of the places of both fingers that touch, per travel of the rod.
    step = 1e-7
    local = np.array([PIVOT, TCP + at - HINGE, 0.0])
    moved = [
        in_link_4(name, rod).act(sign * local)[0]
        for rod in (CLOSED, CLOSED + step)
        for name, sign in (("finger_1", 1.0), ("finger_2", -1.0))
    ]
    travel = ((moved[3] - moved[2]) - (moved[1] - moved[0])) / step
    found = JAWS.force(current, lead, at, screw_efficiency=(0.3, 0.9))
    assert found.lower == pytest.approx(0.3 * least / travel, rel=1e-4)
    assert found.upper == pytest.approx(0.9 * greatest / travel, rel=1e-4)
    wide = JAWS.force(current, lead, at)
    assert wide.lower < found.lower < found.upper < wide.upper
    weak = JAWS.force([0.0, 0.01], lead)
    assert weak.lower.tolist() == [0.0, 0.0]
    assert weak.upper[0] == 0.0 < weak.upper[1]
    # One motor constant, if the record has chosen one.
    motors = dataclasses.replace(a5.parameters().motors, constants="torque")
    chosen = a5.jaws(dataclasses.replace(a5.parameters(), motors=motors))
    assert chosen.force(current, lead).lower == JAWS.force(current, lead).lower
    assert chosen.force(current, lead).upper < 0.6 * JAWS.force(current, lead).upper


def test_other_units_warn_once() -> None:
    for current, lead, remedy in ((50, 1e-3, "write 0.05"), (0.05, 1, "write 0.001")):
        with pytest.warns(ImplausibleWarning, match=remedy) as said:
            JAWS.force(current, lead)
        assert len(said) == 1
    with pytest.warns(ImplausibleWarning, match="at: .*write 0.02"):
        JAWS.gap(0.006, [10.0, 20.0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        JAWS.force([0.0, 24.0 / 38.6], 1e-3)


def test_a_spacer_moves_jaws_and_tcp(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text(
        'format = 1\n[[attached]]\nname = "sensor"\nlink = "link_4"\n'
        'spacer = {value = 22, unit = "mm"}\n'
        'at = {value = [0, 0, -75], unit = "mm"}\nmass = {value = 120, unit = "g"}\n'
        'volume = {value = 0.045, unit = "L"}\n',
        "utf-8",
    )
    own = a5.jaws(a5.arm_file(path))
    assert own.throat == pytest.approx(JAWS.throat, abs=1e-12)
    assert own.gap(0.006, 0.0) == pytest.approx(JAWS.gap(0.006, 0.0), abs=1e-12)
    assert own.widest(0.006) == pytest.approx(JAWS.widest(0.006), abs=1e-12)


def test_mistakes() -> None:
    """What is possible stands in the error, in m."""
    for call, name in (
        (lambda: JAWS.opening(7.0), "rod"),
        (lambda: JAWS.gap(0.02, 0.0), "rod"),
        (lambda: JAWS.gap([0.005, 0.006], 0.0), "rod"),
        (lambda: JAWS.end([0.005, 0.006]), "rod"),
        (lambda: JAWS.widest([0.005, 0.006]), "rod"),
        (lambda: JAWS.force(0.1, 1e-3, rod=[0.005, 0.006]), "rod"),
        (lambda: JAWS.gap(0.005, np.nan), "at"),
        (lambda: JAWS.rod(40.0), "opening"),
        (lambda: JAWS.rod(-1e-3), "opening"),
        (lambda: JAWS.widest(0.005, 0.06), "at"),
        (lambda: JAWS.widest(0.005, 0.0, np.inf), "across"),
        (lambda: JAWS.force(0.1, 1e-3, -0.04), "at"),
        (lambda: JAWS.force(0.1, 0.0), "screw_lead"),
        (lambda: JAWS.force("a", 1e-3), "current"),
        (lambda: JAWS.force(0.1, 1e-3, screw_efficiency=(0.5, 1.2)), "screw_efficien"),
        (lambda: JAWS.force(0.1, 1e-3, screw_efficiency=0.5), "screw_efficiency"),
    ):
        with pytest.raises(InputError) as caught:
            call()
        assert caught.value.name.startswith(name)
