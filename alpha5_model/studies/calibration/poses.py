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
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.fluids import AIR, Fluid
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.planning.surroundings import Surroundings
from alpha5_model.studies.calibration.equations import ZEROS, Equations, prior_numbers
from alpha5_model.studies.calibration.sensor import Sensor
from alpha5_model.studies.calibration.sessions import MOST_STATES, Session, session

#: Poses that are looked at.
_CANDIDATES = 800
#: Draws for one candidate before the search is given up.
_DRAWS = 50
#: Kept to the ends of the joints' ranges: 3 deg, and what angles are rounded by [deg].
_FROM_LIMITS = 3.01
#: Kept to what stands around the arm [m].
_CLEARANCE = 0.01


def plan_poses(
    sensor: Sensor,
    poses: int = 12,
    *,
    arm: Alpha5Parameters | None = None,
    fluid_density: Fluid = AIR,
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
        fluid_density: [kg/m^3], or a name as for `alpha5_model.load`.
        gravity: In base_link, (3,) [m/s^2]; None as of `session`.
        prior: As of `fit`.
        ballast: Mass that rests on the scales beside the arm, evenly [kg].
        seed: Of the random poses.

    Returns:
        The poses, without readings.

    Raises:
        InputError: Not such numbers, more than 5000 poses, or no poses in which every
            scale is pressed on.
    """
    size = count("poses", poses)
    if size > MOST_STATES:
        raise InputError("poses", poses, f"at most {MOST_STATES}")
    rng = generator(seed)
    record = chosen_arm(arm)
    ballast = real("ballast", ballast, minimum=0.0)
    plausibility.check("ballast", ballast, plausibility.MASS)
    chosen = instance("sensor", sensor, Sensor)  # type: ignore[type-abstract]
    options: dict[str, Any] = {"fluid_density": fluid_density, "gravity": gravity}
    numbers = prior_numbers(record, prior, ZEROS, moves=False)

    joints = record.joints[:4]
    lower = np.degrees([joint.lower for joint in joints]) + _FROM_LIMITS
    upper = np.degrees([joint.upper for joint in joints]) - _FROM_LIMITS
    middle = (lower + upper) / 2
    half = np.maximum(upper - lower, 0.0) / 2
    surroundings = Surroundings(record, chosen.obstacles(), _CLEARANCE)
    wanted = max(_CANDIDATES, 4 * size)
    q = np.empty((0, 4))
    for _ in range(_DRAWS):
        degrees = middle + half * rng.uniform(-1.0, 1.0, (_CANDIDATES, 4))
        drawn = np.radians(np.round(degrees, 2))
        drawn = drawn[~surroundings.touches(drawn)]
        if len(drawn):
            tried = Equations(numbers, [session(chosen, drawn, **options)])
            readings = tried.predicted(tried.middle, 0)
            q = np.concatenate([q, drawn[chosen.holds(readings, ballast)]])
        if len(q) >= wanted:
            break
    else:
        expected = "one that can be read in many poses: scales further apart, or more "
        expected += "ballast; or an arm with poses free of collision"
        raise InputError("sensor", chosen.kind, expected)

    q = q[:wanted]
    equations = Equations(numbers, [session(chosen, q, **options)])
    (slopes,) = equations.slopes(equations.middle)
    slopes = slopes * equations.deviation / chosen.deviation[:, None]
    best = _greedy(slopes[..., equations.deviation > 0], size)
    return session(chosen, q[_short_way(q[best], best)], **options)


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
