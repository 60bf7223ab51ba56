"""What sensors may be, and what a fit to few readings leaves open."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.studies.calibration.equations import Equations, across
from alpha5_model.studies.calibration.loads import Motion, load_slopes
from alpha5_model.studies.calibration.poses import TILT
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


#: Arguments that are standard deviations: whether 0 is one, too.
DEVIATIONS: list[tuple[Callable[..., calibrate.Sensor], dict[str, bool]]] = [
    (calibrate.scales, {"noise": False, "gain": True, "placement": True}),
    (calibrate.weight, {"noise": False, "gain": True}),
    (
        calibrate.force_torque,
        {"force_noise": False, "torque_noise": False, "gain": True},
    ),
    (calibrate.efforts, {"noise": False, "gain": True, "offset": True}),
    (tilt, {"noise": False, "gain": True, "offset": True, "yaw": True}),
]


def test_deviations_are_not_negative() -> None:
    for make, arguments in DEVIATIONS:
        for name, may_be_zero in arguments.items():
            for value in (-0.5, *([] if may_be_zero else [0.0])):
                with pytest.raises(InputError, match=f"{name}: expected"):
                    make(**{name: value})
            make(**{name: 0.0 if may_be_zero else 1e-12})


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
