"""Which link is base_link, which is the tool, and how odd a guess of them is."""

from __future__ import annotations

import itertools
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import alpha5_model as a5
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.base_link import (
    _candidate,
    com_errors_by_link,
    distance_from_base,
    with_base_link,
)
from alpha5_model.proofs.comparison.oddity import Judge
from alpha5_model.proofs.comparison.own_arm import DIMENSIONS, own_arm_of
from alpha5_model.proofs.comparison.own_base import own_base_links
from alpha5_model.proofs.comparison.placement import _on_z_axis
from alpha5_model.proofs.comparison.poses import tilt_of
from alpha5_model.proofs.comparison.tool_words import tool_link

OURS = own_arm_of(a5.parameters())


def frame(*xyz: float, tilt: float = 0.0, yaw: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = pin.rpy.rpyToMatrix(tilt, 0.0, yaw)
    pose[:3, 3] = xyz
    return pose


@pytest.mark.parametrize("tilt", [0.0, 1e-9, 0.3, math.pi / 2, 3.0, math.pi])
def test_a_radian_of_tilt_counts_as_100_mm(tilt: float) -> None:
    pose = frame(0.03, -0.04, 0.0, tilt=tilt, yaw=0.8)
    assert distance_from_base(pose) == pytest.approx(0.05 + 0.1 * tilt, abs=1e-8)
    assert tilt_of(pose) == pytest.approx(tilt, abs=1e-15)
    if tilt == 0.0:
        assert _on_z_axis(pose, np.array([0.0, 0.0, 1.0]))[:3, :3] == pytest.approx(
            pose[:3, :3]
        )


def judged(pose: np.ndarray, name: str, com_error: float | None) -> Any:
    theirs: Any = SimpleNamespace(link_poses={name: pose})
    return _candidate(theirs, com_error, Alignment(), name)


@pytest.mark.parametrize(
    ("pose", "name", "com_error", "same", "distance"),
    [
        (frame(0.049, 0, 0), "foot", None, True, 0.049),
        (frame(0.051, 0, 0), "foot", None, False, 0.051),
        (frame(0, 0, 0, tilt=0.49), "foot", None, True, 0.049),
        (frame(0, 0, 0, tilt=0.51), "foot", None, False, 0.051),
        # A link with the right name may be tilted, and one with the right COM be off.
        (frame(0.049, 0, 0, tilt=3.0), "arm_base", None, True, 0.349),
        (frame(0.049, 0, 0, tilt=3.0), "Arm_Base_Link", None, True, 0.349),
        (frame(0.051, 0, 0), "arm_base", None, False, 0.051),
        (frame(0.3, 0, 0), "foot", 0.019, True, 0.069),
        (frame(0.06, 0, 0), "foot", 0.019, True, 0.06),
        (frame(0.3, 0, 0), "foot", 0.021, False, 0.3),
    ],
)
def test_a_link_is_meant_to_be_base_link_by_frame_name_or_com(
    pose: np.ndarray, name: str, com_error: float | None, same: bool, distance: float
) -> None:
    found = judged(pose, name, com_error)
    assert found.same == same
    assert found.distance == pytest.approx(distance)


def test_the_likeliest_base_link_comes_first() -> None:
    """By its name if it could be it, then by its distance, then by its direction."""
    likeliest_first = [
        judged(frame(0.04, 0, 0), "arm_base", None),
        judged(frame(0.01, 0, 0), "foot", None),
        judged(frame(0.01, 0, 0, yaw=1.5), "foot", None),
        judged(frame(0.01, 0, 0, yaw=3.0), "foot", None),
        judged(frame(0.02, 0, 0), "foot", None),
        judged(frame(0.3, 0, 0), "vehicle_base", None),
    ]
    for one, other in itertools.pairwise(likeliest_first):
        assert one.unlikeliness < other.unlikeliness


def test_the_com_of_link_0_is_seen_from_each_link() -> None:
    com = np.array([*OURS.reduced.com[0]])
    poses = {"root": frame(0, 0, 0), "foot": frame(0.3, 0, 0, yaw=0.5)}
    seen = poses["foot"][:3, :3] @ com + poses["foot"][:3, 3]
    theirs: Any = SimpleNamespace(
        mass=np.array([0.2, 9.0]),
        com=np.array([seen, [9.0, 9.0, 9.0]]),
        link_poses=poses,
        base_path=("root", "foot"),
    )
    errors = com_errors_by_link(OURS, theirs)
    assert errors == pytest.approx(
        {"root": float(np.linalg.norm(seen - com)), "foot": 0.0}, abs=1e-12
    )
    placed = with_base_link(theirs, errors, Alignment())
    assert (placed.base_link, placed.same_base) == ("root", True)
    assert placed.stands == pytest.approx(np.eye(4))
    theirs.mass = np.array([0.0, 9.0])
    assert com_errors_by_link(OURS, theirs) == {}


# --- how odd an alignment is


def changed(**changes: float) -> np.ndarray:
    return np.array([changes.get(name, 0.0) for name in DIMENSIONS])


@pytest.mark.parametrize(
    ("changes", "score"),
    [
        ({}, 0.0),
        ({"a_1": 0.001}, 0.0),
        ({"a_1": 0.0011}, 4.0),
        ({"alpha_0": 0.0021, "beta_1": -0.0021}, 8.0),
        ({"alpha_0": 0.0019, "d_1": -0.0009}, 0.0),
        # On the other side: minus twice the length, to 5 mm.
        ({"a_0": -0.04}, 2.0),
        ({"a_2": -0.0351}, 2.0),
        ({"a_2": -0.0449}, 2.0),
        ({"a_2": -0.0349}, 4.0),
        ({"a_2": 0.04}, 4.0),
        ({"a_1": -2 * math.hypot(0.04, 0.1453), "a_0": -0.04, "d_1": 0.5}, 8.0),
    ],
)
def test_wrong_dimensions_are_odd(changes: dict[str, float], score: float) -> None:
    tolerances = np.repeat([0.001, 0.002], 4)
    judge = Judge(ours=OURS, theirs=OURS.reduced, tolerances=tolerances)
    alignment = Alignment(dimensions=changed(**changes))
    assert judge._changed_dimensions(alignment) == pytest.approx(score)


@pytest.mark.parametrize(
    ("stands", "score"),
    [
        (frame(0.1, 0, 0), 3.0),
        (frame(0.19, 0, 0), 5.7),
        (frame(0.21, 0, 0), 6.0),
        (frame(0, 0, 0, tilt=1.0), 3.0),
        (frame(0, 0, 0, tilt=math.pi), 6.0),
        (frame(0, 0, 0, yaw=2.0), 0.0),
    ],
)
def test_a_displaced_base_is_odd(stands: np.ndarray, score: float) -> None:
    judge = Judge(ours=OURS, theirs=OURS.reduced, tolerances=np.full(8, 1e-6))
    alignment = Alignment(stands=stands, base_link="base_link")
    assert judge.oddity(alignment) == pytest.approx(score, abs=1e-6)


# --- the tool, and the base on a vehicle


def joint(parent: str, child: str, kind: str = "fixed") -> Any:
    return SimpleNamespace(name=child, parent=parent, child=child, kind=kind)


def robot(*joints: Any, **masses: float | None) -> Any:
    names = dict.fromkeys([name for j in joints for name in (j.parent, j.child)])
    links = {name: SimpleNamespace(mass=masses.get(name)) for name in names}
    return SimpleNamespace(
        root=joints[0].parent, joints={j.name: j for j in joints}, links=links
    )


@pytest.mark.parametrize(
    ("names", "tool"),
    [
        (("palm", "lamp"), ""),
        (("gripper_tool", "a_tool"), "a_tool"),
        (("a_tool", "gripper_tool"), "gripper_tool"),
        (("tcp", "a_tool"), "tcp"),
        (("tip_link", "eeLink", "toolFrame"), "toolFrame"),
        (("tool_base_link", "tipster"), ""),
        (("end_effector", "ee"), "end_effector"),
        (("EELink",), ""),
    ],
)
def test_the_tool_has_the_likeliest_word_then_is_the_outermost(
    names: tuple[str, ...], tool: str
) -> None:
    chain = [joint(a, b) for a, b in itertools.pairwise(("tcp_wrist", *names))]
    assert tool_link(robot(*chain), "tcp_wrist") == tool


WHOLE_ARM = sum(link.mass for link in a5.parameters().links)


@pytest.mark.parametrize(
    ("masses", "own"),
    [
        # The base begins where link_0's mass is nearest, behind more than 20 g.
        ({"hull": 9.0, "foot": 0.2}, {"foot", "lamp", "shell"}),
        ({"hull": 0.021, "foot": 0.23}, {"foot", "lamp", "shell"}),
        ({"hull": 0.019, "foot": 0.23}, {"hull", "foot", "lamp", "shell", "aside"}),
        ({"foot": 0.2}, {"hull", "foot", "lamp", "shell", "aside"}),
        ({"hull": 9.0, "foot": 0.05, "shell": 0.2}, {"foot", "lamp", "shell"}),
        ({"hull": 9.0, "foot": 0.2, "lamp": WHOLE_ARM + 0.01}, {"shell"}),
        ({"foot": 0.2, "aside": WHOLE_ARM + 0.01}, {"foot", "lamp", "shell"}),
        # axis_e turns in a vehicle.
        ({"shell": WHOLE_ARM + 0.01}, set()),
    ],
)
def test_the_base_of_an_arm_on_a_vehicle(
    masses: dict[str, float], own: set[str]
) -> None:
    model = robot(
        joint("hull", "aside"),
        joint("hull", "foot"),
        joint("foot", "lamp"),
        joint("foot", "shell"),
        **masses,
    )
    path = ("hull", "foot", "shell")
    found = own_base_links(model, path, set(model.links), a5.parameters())
    assert found == own
