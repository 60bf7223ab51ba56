"""The frame between the finger tips, from the URDF's fingers and by Pinocchio."""

from __future__ import annotations

import dataclasses

import numpy as np
import own_arm_dynamics as own
import pinocchio as pin
import pytest
from own_arm import random_arm, within

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters


def finger_ends(arm: a5.Arm, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ends of both fingers in base_link, (3,) each.

    A finger's box of `split_link_4` begins at the hinge; its centre of mass is half way
    to the end, along it and across.
    """
    ends = []
    for name in ("finger_1", "finger_2"):
        joint = arm.model.getJointId(f"{name}_joint")
        end = 2 * arm.model.inertias[joint].lever
        ends.append(arm.forward_kinematics(q, name).act(end))
    return ends[0], ends[1]


def states(arm: a5.Arm, count: int) -> np.ndarray:
    limits = arm.limits
    rng = np.random.default_rng(4)
    return rng.uniform(limits.lower, limits.upper, (count, len(limits.lower)))


#: The catalogue's arm; one with a spacer, of which attached bodies move the wrist's
#: centre of mass and not the fingers'.
RECORDS = ("catalogue", "with a spacer", "own lengths")


def record_of(name: str) -> Alpha5Parameters:
    made = {
        "catalogue": a5.parameters,
        "with a spacer": lambda: own.random_record(1),
        "own lengths": lambda: random_arm(np.random.default_rng(8), off_axis=True),
    }
    return made[name]()


@pytest.mark.parametrize("name", RECORDS)
def test_the_tip_is_midway_between_the_ends_of_the_fingers(name: str) -> None:
    record = record_of(name)
    moving = a5.load(arm=record, gripper="jaws")
    locked = a5.load(arm=record)
    for q in states(moving, 30):
        one, other = finger_ends(moving, q)
        tip = moving.forward_kinematics(q, "tip")
        assert tip.translation == pytest.approx((one + other) / 2, abs=1e-12)
        tcp = moving.forward_kinematics(q, "tcp")
        assert tip.rotation == pytest.approx(tcp.rotation, abs=1e-14)

        closed = np.append(q[:4], moving.limits.lower[4])
        one, other = finger_ends(moving, closed)
        assert one == pytest.approx(other, abs=1e-12)
        tip = locked.forward_kinematics(q[:4], "tip")
        assert tip.translation == pytest.approx(one, abs=1e-12)
    # A tip that forgot axis_a would be seen.
    opened = np.append(q[:4], moving.limits.upper[4])
    tips = [moving.forward_kinematics(x, "tip").translation for x in (closed, opened)]
    assert np.linalg.norm(tips[1] - tips[0]) > 1e-3


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
@pytest.mark.parametrize("floating", [False, True])
def test_its_jacobian_is_the_change_of_its_pose(gripper: str, floating: bool) -> None:
    arm = a5.load(gripper=gripper, floating_base=floating)
    rng = np.random.default_rng(5)
    joints = states(arm, 6)
    step = 1e-6
    for angles in joints:
        q = angles
        if floating:
            turn = rng.normal(size=4)
            q = np.concatenate([rng.normal(size=3), turn / np.linalg.norm(turn), q])
        here = arm.forward_kinematics(q, "tip")
        local = arm.jacobian(q, "tip", pin.LOCAL)
        for column, unit in zip(local.T, np.eye(arm.model.nv), strict=True):
            ahead = arm.forward_kinematics(
                pin.integrate(arm.model, q, step * unit), "tip"
            )
            behind = arm.forward_kinematics(
                pin.integrate(arm.model, q, -step * unit), "tip"
            )
            twist = pin.log6(behind.inverse() * ahead).vector / (2 * step)
            assert column == pytest.approx(twist, abs=1e-6)
        aligned = pin.SE3(here.rotation, np.zeros(3)).action @ local
        assert arm.jacobian(q, "tip") == pytest.approx(aligned, abs=1e-12)
        world = arm.jacobian(q, "tip", pin.WORLD)
        assert world == pytest.approx(here.action @ local, abs=1e-12)


@pytest.mark.parametrize("name", ["catalogue", "own lengths", "with a spacer"])
@pytest.mark.parametrize("opening", [None, 0.6])
def test_inverse_kinematics_puts_the_tip_at_a_point(
    name: str, opening: float | None
) -> None:
    record = record_of(name)
    low, high = record.joints[4].lower, record.joints[4].upper
    jaw = None if opening is None else low + opening * (high - low)
    gripping = dataclasses.replace(record, tool=a5.tool_at_tip(record, jaw=jaw))
    arm = a5.load(arm=record, gripper="jaws")
    for q in within(record, 40, seed=6):
        whole = np.append(q, low if jaw is None else jaw)
        target = arm.forward_kinematics(whole, "tip").translation
        solutions = a5.inverse_kinematics(target, q[3], arm=gripping)
        near = np.abs(solutions.q - q).max(axis=-1)
        assert np.nanmin(near) < 1e-7


@pytest.mark.parametrize("jaw", [0.0, 0.014, float("nan"), "open"])
def test_jaws_beyond_their_range_are_refused(jaw: object) -> None:
    with pytest.raises(InputError) as caught:
        a5.tool_at_tip(jaw=jaw)  # type: ignore[arg-type]
    assert caught.value.name == "jaw"
