"""Static poses in which a sensor tells the most about an arm.

References:
    [Fedorov1972] Fedorov: Theory of Optimal Experiments, chapter 2 (D-optimal designs,
        one measurement after the other).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, count, generator, instance, real
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import AIR
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.planning.obstacles import Obstacle
from alpha5_model.planning.surroundings import Surroundings
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.loads import Motion, loads
from alpha5_model.studies.calibration.sensors import Sensor, plane
from alpha5_model.studies.calibration.sessions import Session, session
from alpha5_model.studies.calibration.unknowns import arm_unknowns

#: Poses that are looked at.
_CANDIDATES = 800
#: Draws for one candidate before the search is given up.
_DRAWS = 50
#: Kept to the ends of the joints' ranges [rad], and to the scales' table [m].
FROM_LIMITS = np.radians(3.0)
_CLEARANCE = 0.01
#: A scale carries at least this [kg].
_LEAST_LOAD = 0.02
#: The table that the scales stand on reaches beyond the arm [m].
_TABLE = (1.6, 1.6, 0.1)
#: What is known of the mount [rad].
TILT = np.radians(0.5)


def plan_poses(
    sensor: Sensor,
    poses: int = 12,
    *,
    arm: Alpha5Parameters | None = None,
    fluid_density: float = AIR,
    gravity: ArrayLike | None = None,
    prior: str = "digits",
    ballast: float = 0.0,
    seed: int = 0,
) -> Session:
    """Static poses in which a sensor tells the most about an arm.

    Pose after pose is taken from many random ones: each time the one that shrinks the
    volume of what is still possible the most [Fedorov1972], tilts, gains, offsets and
    the joints' zeros included. All are within the limits with a margin of 3 deg, free
    of self-collision, 10 mm above the plane of the scales, and press on every scale.
    They are sorted so that the joints turn little from one to the next; the ways
    between them are not checked.

    Args:
        sensor: From `scales`, `weight`, `force_torque`, `efforts` or `vehicle_tilt`.
        poses: How many.
        arm: Record of an arm of your own; None for the catalogue's.
        fluid_density: [kg/m^3].
        gravity: In base_link, (3,) [m/s^2]; None as of `session`.
        prior: As of `fit`.
        ballast: Mass that rests on the scales beside the arm, evenly [kg].
        seed: Of the random poses.

    Returns:
        The poses, without readings.

    Raises:
        InputError: Not such numbers, or no poses in which every scale is pressed on.
    """
    size = count("poses", poses)
    if not size:
        raise InputError("poses", poses, "at least 1")
    rng = generator(seed)
    record = chosen_arm(arm)
    ballast = real("ballast", ballast, minimum=0.0)
    chosen = instance("sensor", sensor, Sensor)
    options: dict[str, Any] = {"fluid_density": fluid_density, "gravity": gravity}
    start = session(chosen, np.zeros((1, 4)), **options)

    unknowns = arm_unknowns(record, prior)
    q = _candidates(record, start, max(_CANDIDATES, 4 * size), ballast, rng)
    equations = Equations(
        unknowns=unknowns, sessions=[session(chosen, q, **options)], tilt=TILT
    )
    slopes = equations.slopes(equations.middle, 0) * equations.deviation
    slopes /= chosen.noise[:, None]
    best = _greedy(slopes[..., equations.deviation > 0], size)
    return session(chosen, q[_short_way(q[best], best)], **options)


def _candidates(
    arm: Alpha5Parameters,
    start: Session,
    number: int,
    ballast: float,
    rng: np.random.Generator,
) -> FloatArray:
    """Random poses that can be taken, (number, 4)."""
    lower = np.array([joint.lower for joint in arm.joints[:4]]) + FROM_LIMITS
    upper = np.array([joint.upper for joint in arm.joints[:4]]) - FROM_LIMITS
    middle = (lower + upper) / 2
    half = np.maximum(upper - lower, 0.0) / 2
    surroundings = Surroundings(arm, _table(start.sensor), _CLEARANCE)
    found = np.empty((0, 4))
    for _ in range(_DRAWS):
        q = middle + half * rng.uniform(-1.0, 1.0, (number, 4))
        free = q[~surroundings.touches(q)]
        found = np.concatenate([found, free[_presses(arm, start, free, ballast)]])
        if len(found) >= number:
            return found[:number]
    expected = "scales further apart, or more ballast: in few poses all are pressed on"
    if start.sensor.kind != "scales":
        expected = "an arm with poses free of collision within its limits"
    raise InputError("sensor", start.sensor.kind, expected)


def _table(sensor: Sensor) -> tuple[Obstacle, ...]:
    """The table under scales, as an obstacle."""
    if sensor.positions is None:
        return ()
    along, beside, normal = plane(sensor.positions)
    rotation = np.column_stack([along, beside, normal])
    centre = sensor.positions.mean(axis=0) - normal * _TABLE[2] / 2
    return (Obstacle.box("table", _TABLE, centre, rpy_from_rotation(rotation)),)


def _presses(
    arm: Alpha5Parameters, start: Session, q: FloatArray, ballast: float
) -> Any:
    """Whether every scale carries something at q (N, 4), (N,) bool."""
    if start.sensor.kind != "scales" or not len(q):
        return np.ones(len(q), np.bool_)
    still = np.zeros_like(q)
    motion = Motion(q=q, v=still, a=still, gravity=start.motion.gravity)
    carried = loads(arm, start.density, motion) @ start.sensor.matrix.T
    return ((carried + ballast / 3) > _LEAST_LOAD).all(axis=1)


def _greedy(slopes: FloatArray, size: int) -> list[int]:
    """Poses whose readings, one after the other, tell the most.

    With P the covariance so far and J the slopes of a pose, its readings shrink the
    determinant of P by det(1 + J P J^T).

    Args:
        slopes: Derivatives of all poses' readings by the unknowns, in standard
            deviations of both, (N, k, K).
        size: How many to take.
    """
    readings = slopes.shape[1]
    unit = np.eye(readings)
    # J P of all poses; P is 1 before any reading.
    known = slopes.copy()
    taken: list[int] = []
    for _ in range(size):
        gain = unit + known @ slopes.swapaxes(1, 2)
        volume = np.linalg.slogdet(gain)[1]
        volume[taken] = -np.inf
        best = int(volume.argmax())
        taken.append(best)
        between = np.linalg.solve(gain[best], known[best])
        known -= (known @ slopes[best].T) @ between
    return taken


def _short_way(q: FloatArray, rows: list[int]) -> list[int]:
    """The rows in an order in which the joints turn little: the nearest one next."""
    left = list(range(len(rows)))
    order = [left.pop(int(np.abs(q).sum(axis=1).argmin()))]
    while left:
        turns = np.abs(q[left] - q[order[-1]]).max(axis=1)
        order.append(left.pop(int(turns.argmin())))
    return [rows[k] for k in order]
