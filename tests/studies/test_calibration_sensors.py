"""Sensors at the edges of what they may be, and the unknowns of their sessions."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.studies.calibration.equations import Equations, across
from alpha5_model.studies.calibration.loads import Motion, load_slopes
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.sensors import plane
from alpha5_model.studies.calibration.unknowns import NAMES, arm_unknowns

calibrate = a5.calibrate
Q = np.random.default_rng(5).uniform(0.3, 2.5, (3, 4))
VEHICLE = {
    "mass": 11.5,
    "com": [0.0, 0.0, -0.02],
    "volume": 0.0115,
    "cob": [0.0, 0.0, 0.03],
}


def tilt(**changes: Any) -> calibrate.Sensor:
    return calibrate.vehicle_tilt(VEHICLE, **changes)


def test_the_usual_triangle_is_regular() -> None:
    """Its corners are 0.18 m from the middle, on one table."""
    corners = calibrate.scales().positions
    assert corners is not None
    assert np.hypot(*corners[:, :2].T) == pytest.approx([0.18] * 3, rel=1e-3)
    assert corners.mean(axis=0)[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert np.ptp(corners[:, 2]) == 0.0
    assert -0.1 < corners[0, 2] < 0.0


def test_the_normal_points_to_base_link() -> None:
    rng = np.random.default_rng(6)
    for _ in range(20):
        corners = rng.normal(size=(3, 3))
        for order in permutations(range(3)):
            along, beside, normal = plane(corners[list(order)])
            assert normal @ -corners[0] > 0
            assert np.array([along, beside, normal]) @ np.transpose(
                [along, beside, normal]
            ) == pytest.approx(np.eye(3), abs=1e-12)
            assert np.cross(along, beside) == pytest.approx(normal)
            assert (corners - corners[0]) @ normal == pytest.approx(
                [0, 0, 0], abs=1e-12
            )


def test_the_normal_points_up_from_a_plane_through_base_link() -> None:
    corners = np.array([[0.2, 0.0, 0.0], [-0.1, 0.2, 0.0], [-0.1, -0.2, 0.0]])
    for order in permutations(range(3)):
        assert plane(corners[list(order)])[2] == pytest.approx([0, 0, 1])
        below = corners[list(order)] + [0.0, 0.0, 1e-9]
        assert plane(below)[2] == pytest.approx([0, 0, -1])


def test_scales_are_2_cm_off_one_line() -> None:
    """Measured from the longest side, however far apart they are."""
    for length in (0.3, 0.03):
        for height, good in ((0.0201, True), (0.0199, False)):
            corners = [[0.0, 0, 0], [length, 0, 0], [length / 3, height, 0]]
            if good:
                calibrate.scales(corners)
                continue
            with pytest.raises(InputError, match=r"three points at least 0\.02 m off"):
                calibrate.scales(corners)
    with pytest.raises(InputError, match="three points at least"):
        calibrate.scales(np.zeros((3, 3)))


MAKERS: list[tuple[Callable[..., calibrate.Sensor], str, bool]] = [
    (calibrate.scales, "noise", True),
    (calibrate.scales, "gain", False),
    (calibrate.scales, "placement", False),
    (calibrate.weight, "noise", True),
    (calibrate.weight, "gain", False),
    (calibrate.force_torque, "force_noise", True),
    (calibrate.force_torque, "torque_noise", True),
    (calibrate.force_torque, "gain", False),
    (calibrate.efforts, "noise", True),
    (calibrate.efforts, "gain", False),
    (calibrate.efforts, "offset", False),
    (tilt, "noise", True),
    (tilt, "gain", False),
    (tilt, "offset", False),
    (tilt, "yaw", False),
]


@pytest.mark.parametrize(("make", "name", "above"), MAKERS)
def test_deviations_are_not_negative(
    make: Callable[..., calibrate.Sensor], name: str, above: bool
) -> None:
    """That of noise is above 0."""
    for value in (-0.5, -1e-9, *([0.0] if above else [])):
        with pytest.raises(InputError, match=f"{name}: expected"):
            make(**{name: value})
    make(**{name: 1e-12 if above else 0.0})


def test_offsets_that_are_not_known_are_large() -> None:
    """Beside whatever the arm can weigh and turn."""
    largest = 9.81 * sum(link.mass for link in a5.parameters().links) * 0.4
    for made in (calibrate.scales(), calibrate.force_torque()):
        forces = made.offset[:3]
        assert (forces > largest).all()
    assert (calibrate.force_torque().offset[3:] > 0.5).all()
    assert not calibrate.efforts().offset.any()


def test_sensors_that_do_not_move_have_no_place() -> None:
    for made in (calibrate.weight(), calibrate.force_torque(), calibrate.efforts()):
        assert made.placement == 0.0
        assert made.positions is None
        assert made.size == len(made.unit) == len(made.matrix)
    assert calibrate.weight((0.0, 0.0, -0.5)).matrix == pytest.approx(
        calibrate.weight().matrix
    )


def test_a_vehicle_floats_on_four_fifths_of_its_weight() -> None:
    for share, good in ((0.81, True), (0.79, False)):
        facts = {**VEHICLE, "volume": share * 11.5 / 1000.0}
        sensor = calibrate.vehicle_tilt(facts)
        if good:
            calibrate.session(sensor, Q, fluid_density=1000.0)
            continue
        with pytest.raises(InputError, match=r"got '9\.09 kg displaced by 11\.5 kg'"):
            calibrate.session(sensor, Q, fluid_density=1000.0)
    for height, good in ((1e-6, True), (0.0, False), (-1e-6, False)):
        facts = {**VEHICLE, "com": [0, 0, 0.0], "cob": [0, 0, height]}
        sensor = calibrate.vehicle_tilt(facts)
        if good:
            calibrate.session(sensor, Q, fluid_density=1000.0)
            continue
        with pytest.raises(InputError, match="rights itself"):
            calibrate.session(sensor, Q, fluid_density=1000.0)


# --- unknowns of a session ------------------------------------------------------------


def equations(sensor: calibrate.Sensor, **options: Any) -> Equations:
    unknowns = arm_unknowns(a5.parameters(), moving=True)
    return Equations(unknowns, [calibrate.session(sensor, Q, **options)], TILT)


def test_the_names_of_the_unknowns() -> None:
    scale = [f"0.gain.scale_{k}" for k in (1, 2, 3)]
    offset = [f"0.offset.scale_{k}" for k in (1, 2, 3)]
    place = [f"0.placement.scale_{k}.{axis}" for k in (1, 2, 3) for axis in (1, 2)]
    tilts = ["0.tilt.1", "0.tilt.2"]
    found = equations(calibrate.scales(placement=0.001))
    assert list(found.names[78:]) == [*tilts, *scale, *offset, *place]
    axes = [f"axis_{letter}" for letter in "edcb"]
    gains = [f"0.gain.{axis}" for axis in axes]
    offsets = [f"0.offset.{axis}" for axis in axes]
    at_rest = equations(calibrate.efforts())
    assert list(at_rest.names[78:]) == [*tilts, *gains, *offsets]
    moving = equations(calibrate.efforts(), v=np.ones((3, 4)))
    friction = [f"0.{kind}.{axis}" for kind in ("Coulomb", "viscous") for axis in axes]
    assert list(moving.names[78:]) == [*tilts, *gains, *offsets, *friction]
    assert moving.deviation[78:80] == pytest.approx([TILT, TILT])
    # It is larger than any friction of this arm.
    assert (moving.deviation[-8:] > 5.0).all()
    of_vehicle = equations(tilt(), fluid_density=1000.0)
    assert of_vehicle.names[-1] == "0.yaw"


def test_the_change_with_the_density_is_linear() -> None:
    given = equations(calibrate.force_torque(gain=0.1), fluid_density=900.0)
    values = given.middle + 0.3 * given.deviation
    denser = equations(calibrate.force_torque(gain=0.1), fluid_density=1100.0)
    change = (denser.predicted(values, 0) - given.predicted(values, 0)) / 200.0
    assert given.by_density(values, 0) == pytest.approx(change, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, -9.81), (3.0, -8.0, 1.0)])
def test_two_directions_across_gravity(gravity: tuple[float, ...]) -> None:
    axes = across(np.array(gravity))
    assert axes @ axes.T == pytest.approx(np.eye(2), abs=1e-15)
    assert axes @ gravity == pytest.approx([0.0, 0.0], abs=1e-14)


def test_without_gravity_a_tilt_changes_nothing() -> None:
    given = equations(calibrate.force_torque(), gravity=(0.0, 0.0, 0.0))
    assert not across(np.zeros(3)).any()
    values = given.middle.copy()
    values[78:80] = 0.1
    assert not given.predicted(values, 0).any()
    slopes = given.slopes(values, 0)
    assert np.isfinite(slopes).all()
    assert not slopes[..., 78:80].any()


# --- a fit ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def fit_of_efforts() -> calibrate.Calibration:
    """A fit to three poses of the arm itself."""
    arm = a5.load(a5.AIR)
    still = np.zeros(4)
    read = [arm.inverse_dynamics(q, still, still) for q in Q]
    return calibrate.fit(calibrate.session(calibrate.efforts(), Q, read))


def test_what_a_fit_takes_if_it_is_not_told(
    fit_of_efforts: calibrate.Calibration,
) -> None:
    """Zeros within a degree and a mount within half a degree."""
    found = fit_of_efforts
    assert found.problems == ()
    assert found.readings == 12
    prior = dict(zip(found.names, found.prior, strict=True))
    assert prior["zeros.axis_d"] == pytest.approx(np.radians(1.0))
    others = equations(calibrate.efforts()).deviation[78:]
    assert others[:2] == pytest.approx(np.radians([0.5, 0.5]))
    assert not any(".inertia." in name for name in found.names)
    assert len(found.other_names) == len(found.other_deviation) == 6


def test_torques_that_hold_the_arm_over_other_poses(
    fit_of_efforts: calibrate.Calibration,
) -> None:
    found = fit_of_efforts
    joints = a5.parameters().joints[:4]
    lower = np.array([joint.lower for joint in joints])
    upper = np.array([joint.upper for joint in joints])
    q = np.random.default_rng(9).uniform(lower, upper, (800, 4))
    motion = Motion(q=q, v=0 * q, a=0 * q, gravity=np.array([0.0, 0.0, -9.81]))
    unknowns = arm_unknowns(a5.parameters())
    slopes = load_slopes(unknowns, unknowns.middle, a5.AIR, motion)[:, :4]
    before = np.sqrt(((slopes * unknowns.deviation) ** 2).sum(axis=2).mean(axis=0))
    assert found.torque_before == pytest.approx(before, rel=0.1)
    covariance = found.arm.covariance
    assert covariance is not None
    place = [NAMES.index(name) for name in covariance.names]
    known = slopes[..., place]
    variance = np.einsum("njk,kl,njl->nj", known, covariance.matrix, known)
    rest = np.delete(slopes * unknowns.deviation, place, axis=2)
    after = np.sqrt((variance + (rest**2).sum(axis=2)).mean(axis=0))
    assert found.torque_after == pytest.approx(after, rel=0.1, abs=1e-6)


def test_a_fit_by_other_priors() -> None:
    sensor = calibrate.weight()
    session = calibrate.session(sensor, Q, np.full((3, 1), 1.3))
    found = calibrate.fit(session, zeros=0.0, tilt=0.0)
    assert not any(name.startswith("zeros") for name in found.names)
    assert not any("tilt" in name for name in found.other_names)
    with pytest.raises(InputError, match="tilt"):
        calibrate.fit(session, tilt=-0.5)
