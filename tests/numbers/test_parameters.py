"""The SI record and its corrections agree with numbers typed from the document."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS

#: Tables 2 and 3 in SI and URDF sign, typed from the document, not from the data file.
MASSES = [0.234, 0.161, 0.38, 0.142, 0.355]
COMS = [
    [-0.052425, -0.00712, -0.000037],
    [0.007746, 0.000112, 0.025038],
    [0.073563, -0.000091, -0.000734],
    [0.011188, -0.01666, 0.000148],
    [-0.00003, -0.001482, -0.100881],
]
#: xx, yy, zz, xy, xz, yz
INERTIAS = [
    [45.012e-6, 393.932e-6, 397.995e-6, -2.832e-6, 4.115e-6, 0.010e-6],
    [109.469e-6, 122.362e-6, 43.987e-6, -0.808e-6, -29.828e-6, -0.544e-6],
    [82.697e-6, 847.148e-6, 868.483e-6, 74.836e-6, 1.866e-6, -0.317e-6],
    [63.596e-6, 40.651e-6, 75.158e-6, 21.363e-6, 0.802e-6, -0.337e-6],
    [615.921e-6, 625.307e-6, 62.574e-6, -0.067e-6, 7.916e-6, 0.428e-6],
]
VOLUMES = [0.157e-3, 0.032e-3, 0.218e-3, 0.032e-3, 0.134e-3]
COBS = [
    [-0.053, -0.003, -0.001],
    [0.002, -0.004, 0.031],
    [0.076, 0.0, -0.001],
    [0.002, -0.004, 0.029],
    [0.0, 0.0, -0.097],
]


@pytest.mark.parametrize("i", range(5))
def test_links_to_the_last_bit(i: int) -> None:
    link = a5.parameters(()).links[i]
    xx, yy, zz, xy, xz, yz = INERTIAS[i]
    assert (link.name, link.mass, link.volume) == (f"link_{i}", MASSES[i], VOLUMES[i])
    np.testing.assert_array_equal(link.com, COMS[i])
    np.testing.assert_array_equal(link.cob, COBS[i])
    np.testing.assert_array_equal(
        link.inertia, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    )


def test_dh_table() -> None:
    p = a5.parameters()
    theta_c = math.atan(40 / 145.3)
    a_1 = math.sqrt(0.04**2 + 0.1453**2)
    expected = [
        (0.0462, math.pi, 0.02, math.pi / 2, "theta_0"),
        (0.0, theta_c - math.pi / 2, a_1, math.pi, "theta_1"),
        (0.0, theta_c - math.pi / 2, 0.02, -math.pi / 2, "theta_2"),
        (-0.18, math.pi / 2, 0.0, math.pi / 2, "theta_3"),
        (0.0, -math.pi / 2, 0.0, 0.0, None),
    ]
    assert p.theta_c == pytest.approx(theta_c, abs=1e-16)
    for row, (d, theta, a, alpha, variable) in zip(p.dh, expected, strict=True):
        assert (row.d, row.theta_offset, row.alpha, row.variable) == (
            d,
            theta,
            alpha,
            variable,
        )
        assert row.a == pytest.approx(a, abs=1e-17)


def test_joints() -> None:
    joints = a5.parameters().joints
    assert [j.name for j in joints] == [
        "axis_e",
        "axis_d",
        "axis_c",
        "axis_b",
        "axis_a",
    ]
    assert [j.dh_variable for j in joints[:4]] == [f"theta_{i}" for i in range(4)]
    assert [j.device_id for j in joints] == [5, 4, 3, 2, 1]
    assert [(j.lower, j.upper) for j in joints] == [
        (0.01745, 6.143),
        (0.01745, 3.40339),
        (0.01745, 3.40339),
        (0.0, 6.2),
        (0.0013, 0.0133),
    ]
    speeds = [math.radians(30)] * 3 + [math.radians(50), 0.003]
    np.testing.assert_allclose([j.velocity for j in joints], speeds, rtol=1e-15)
    assert [j.effort for j in joints] == [9.0] * 4 + [10.0]


def test_actuators() -> None:
    strong = (3.22, 231e-6, 3.752e-3, 0.10, 0.86, 0.0134, 0.0116, 1754.4)
    weak = (38.6, 1280e-6, 0.469e-3, 0.15, 0.77, 0.0271, 0.0545)
    rows = [dataclasses.astuple(a) for a in a5.parameters().actuators]
    assert rows == [strong, strong, strong, (*weak, 340.4), (*weak, 348.7)]


def test_the_record_is_frozen_and_shared() -> None:
    p = a5.parameters()
    assert p is a5.parameters(list(DEFAULT_CORRECTIONS))
    with pytest.raises(dataclasses.FrozenInstanceError):
        p.links[0].mass = 1.0  # type: ignore[misc]
    for link in p.links:
        for array in (link.com, link.inertia, link.cob, link.bounds):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 0.0


def test_base_frame_turns_link_0_and_nothing_else() -> None:
    assert a5.parameters().corrections == ("base_frame",)
    assert a5.parameters().base_yaw == 0.0
    letter = a5.parameters(())
    assert letter.base_yaw == math.pi
    for ours, theirs in zip(a5.parameters().links, letter.links, strict=True):
        np.testing.assert_array_equal(ours.com, theirs.com)
        np.testing.assert_array_equal(ours.cob, theirs.cob)


def test_link3_cob_is_link_1s_frame_carried_to_link_3() -> None:
    """The correction lays link 1's part onto link 3's, axis for axis."""
    printed = np.array([2.0, -4.0, 29.0])
    # In {1}, the part's own axis is z through the origin. The other axis is along -y
    # through (a_0, ., d_0) = (20, ., 46.2).
    # In {3}, that other axis is z through the origin. The own axis is along y through
    # x = a_2 = 20.
    along_own = printed[2] - 46.2
    along_other = printed[1]
    across = 20 - printed[0]
    corrected = a5.parameters(("link3_cob",)).links[3].cob
    expected = [across, along_own, along_other]
    np.testing.assert_allclose(corrected * 1e3, expected, atol=1e-12)
    bounds = a5.parameters().links[3].bounds
    assert (bounds[:, 0] <= corrected).all()
    assert (corrected <= bounds[:, 1]).all()


def test_wrong_corrections_are_refused() -> None:
    with pytest.raises(
        UnknownNameError, match="'base'; choose from base_frame, link3_cob"
    ):
        a5.parameters(("base",))
    for wrong in ("base_frame", None, 3):
        with pytest.raises(InputError, match="corrections: expected a tuple of names"):
            a5.parameters(wrong)  # type: ignore[arg-type]
