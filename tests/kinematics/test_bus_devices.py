"""Devices on the arm's bus and joint positions, and the page about them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import reference
from loops import each

import alpha5_model as a5
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.numbers.parameters import JointParameters

HOME = {5: 3.14, 4: 1.57, 3: 1.56, 2: 0.4}


def test_the_bus_counts_from_the_tip() -> None:
    np.testing.assert_array_equal(a5.q_from_devices(HOME), [3.14, 1.57, 1.56, 0.4])
    jaws = a5.q_from_devices({**HOME, 1: 6.0})
    np.testing.assert_allclose(jaws, [3.14, 1.57, 1.56, 0.4, 0.006], rtol=1e-15)
    assert jaws.shape == (len(a5.load(gripper="jaws").joint_names),)


def test_devices_and_back() -> None:
    rng = np.random.default_rng(0)
    lower = [*reference.LOWER, 0.0013]
    upper = [*reference.UPPER, 0.0133]
    for count in (4, 5):
        q = rng.uniform(lower[:count], upper[:count], (7, count))
        devices = a5.devices_from_q(q)
        assert [*devices] == [5, 4, 3, 2, 1][:count]
        np.testing.assert_allclose(a5.q_from_devices(devices), q, rtol=1e-15)
    assert devices[1] == pytest.approx(1e3 * q[:, 4])


@each(
    ("change", "said"),
    [
        (
            {5: 180.0},
            "devices[5]: expected axis_e in its range of 0.01745 to 6.143 rad, got 180",
        ),
        (
            {1: 0.006},
            "devices[1]: expected axis_a in its range of 1.3 to 13.3 mm, got 0.006",
        ),
        ({4: -0.6}, "devices[4]: expected axis_d"),
        ({6: 1.0}, "devices 5, 4, 3, 2 and perhaps 1"),
        ({"5": 1.0}, "devices 5, 4, 3, 2 and perhaps 1"),
        ({3: math.nan}, "devices[3]"),
        ({3: "1.5 rad"}, "devices[3]"),
    ],
)
def test_what_no_arm_reports_is_refused(change: dict, said: str) -> None:
    with pytest.raises(InputError) as caught:
        a5.q_from_devices({**HOME, **change})
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("joint", a5.parameters().joints)
def test_a_zero_may_be_off_by_a_tenth_of_the_range(joint: JointParameters) -> None:
    width = joint.upper - joint.lower
    per_si = 1e3 if joint.name == "axis_a" else 1.0
    for end, outwards in ((joint.lower, -1.0), (joint.upper, 1.0)):
        inside = per_si * (end + outwards * 0.0999 * width)
        beyond = per_si * (end + outwards * 0.1001 * width)
        q = a5.q_from_devices({**HOME, joint.device_id: inside})
        assert q[5 - joint.device_id] == inside / per_si
        with pytest.raises(InputError, match=f"expected {joint.name} in its range"):
            a5.q_from_devices({**HOME, joint.device_id: beyond})


def test_the_first_of_several_samples_out_of_range_is_named() -> None:
    devices = {device: np.full(5, value) for device, value in HOME.items()}
    devices[4] = np.array([1.0, 7.0, 1.0, 8.0, 9.0])
    with pytest.raises(InputError, match=r"axis_d in its range of .*, got 7"):
        a5.q_from_devices(devices)


def test_other_wrong_inputs() -> None:
    with pytest.raises(InputError, match="devices 5, 4, 3, 2"):
        a5.q_from_devices({5: 1.0, 4: 1.0, 3: 1.0})
    with pytest.raises(InputError, match="a mapping"):
        a5.q_from_devices([1.0, 1.0, 1.0, 1.0])
    with pytest.raises(ShapeError, match="same number of samples"):
        a5.q_from_devices({**HOME, 2: [0.1, 0.2]})
    for q in (1.0, np.zeros(3), np.zeros((4, 6))):
        with pytest.raises(ShapeError, match="with the jaw rod"):
            a5.devices_from_q(q)


@each("q", [[180.0, 90, 90, 0], [3.1, 1.6, 1.6, 0, 5.86], [3.1, -0.6, 1.6, 0]])
def test_positions_that_the_arm_cannot_take_are_not_sent(q: list[float]) -> None:
    with pytest.raises(
        InputError, match=r"q\[\.\.\., \d\]: expected axis_. in its range"
    ):
        a5.devices_from_q(q)


def test_what_the_poses_show() -> None:
    """Directions of upper arm and forearm, left and right."""
    turn = math.pi / 2
    one, two, three = (
        reference.dh_frames(np.array(q))
        for q in (
            [2 * turn, turn, turn, 0],
            [2 * turn, turn, 2 * turn, 0],
            [3 * turn, turn, turn, turn],
        )
    )
    forearm = [frames[-1][:3, 3] - frames[-3][:3, 3] for frames in (one, two)]
    np.testing.assert_allclose(
        forearm[0] / np.linalg.norm(forearm[0]), [0, 0, 1], atol=1e-12
    )
    np.testing.assert_allclose(
        forearm[1] / np.linalg.norm(forearm[1]), [1, 0, 0], atol=1e-12
    )
    assert three[-1][1, 3] > 0.18  # +y, on the left of somebody who looks along x
