"""Gazebo's controllers: the gains hold the arm in water, by gz-sim's own rule."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.description.sdf import SdfOptions, sdf, sdf_world
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.errors import InputError

POSITION = "gz::sim::systems::JointPositionController"
STATES = "gz::sim::systems::JointStatePublisher"
#: What JointPositionController.cc of gz-sim reads, besides topics and modes.
READ = {
    "joint_name",
    "p_gain",
    "i_gain",
    "d_gain",
    "i_max",
    "i_min",
    "cmd_max",
    "cmd_min",
    "cmd_offset",
    "initial_position",
}


def controllers(gripper: str, text: str | None = None) -> dict[str, dict[str, float]]:
    """Joint -> the elements of its controller, in the order of the file."""
    options = SdfOptions(gripper=gripper, controllers=True)
    found = {}
    for plugin in ET.fromstring(text or sdf(options)).iter("plugin"):
        if plugin.get("name") == POSITION:
            assert plugin.get("filename") == "gz-sim-joint-position-controller-system"
            values = {child.tag: child.text for child in plugin}
            assert set(values) <= READ
            joint = values.pop("joint_name")
            found[joint] = {name: float(value) for name, value in values.items()}
    return found


def held(gripper: str, scale: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Error and speed after 2 s: PID of gz-math over steps of 1 ms, our dynamics.

    Args:
        gripper: ``locked`` or ``jaws``.
        scale: Of the derivative gains.
    """
    arm = a5.load(gripper=gripper)
    settings = list(controllers(gripper).values())[: arm.model.nv]
    p, d, most, target = (
        np.array([one[name] for one in settings])
        for name in ("p_gain", "d_gain", "cmd_max", "initial_position")
    )
    step = 1e-3
    q = target.copy()
    q[:4] = NAMED_POSES["reach"]
    v = np.zeros(q.size)
    before = q - target
    for _ in range(2000):
        error = q - target
        slope = (error - before) / step
        before = error
        force = np.clip(-p * error - scale * d * slope, -most, most)
        v = v + step * arm.forward_dynamics(q, v, force)
        q = q + step * v
    return q - target, v


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_the_gains_hold_home_in_water(gripper):
    error, speed = held(gripper)
    assert np.abs(error).max() < 0.01
    assert np.abs(speed).max() < 1e-4


def test_gains_that_are_unstable_at_a_step_of_1_ms_are_seen():
    _, speed = held("locked", scale=2.0)
    assert np.abs(speed).max() > 0.1


@pytest.mark.parametrize(("gripper", "count"), [("locked", 4), ("jaws", 5)])
def test_each_driven_joint_has_one_within_its_effort(gripper, count):
    found = controllers(gripper)
    joints = a5.parameters().joints[:count]
    assert list(found) == [joint.name for joint in joints]
    for joint in joints:
        assert found[joint.name]["cmd_max"] == joint.effort
        assert found[joint.name]["cmd_min"] == -joint.effort
        assert joint.lower <= found[joint.name]["initial_position"] <= joint.upper


def test_joint_states_are_published_and_nothing_is_there_without_the_option():
    text = sdf(SdfOptions(controllers=True))
    (states,) = (
        p for p in ET.fromstring(text).iter("plugin") if p.get("name") == STATES
    )
    assert states.get("filename") == "gz-sim-joint-state-publisher-system"
    world = sdf_world(SdfOptions(gripper="jaws", controllers=True))
    assert len(controllers("jaws", world)) == 5
    assert POSITION not in sdf()
    assert STATES not in sdf_world()
    with pytest.raises(InputError):
        SdfOptions(controllers="yes")
