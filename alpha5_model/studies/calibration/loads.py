"""Joint torques and the load on the mount, and how an arm's numbers change them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.regrouping import base_parameters
from alpha5_model.dynamics.regression import NAMES as BASE_NAMES
from alpha5_model.kernels import choice as kernels
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers.jaws import loaded_links
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.calibration.sensors import LOADS
from alpha5_model.studies.calibration.unknowns import (
    NAMES,
    OF_BODIES,
    ArmUnknowns,
    by_body,
)
from alpha5_model.studies.uncertainty.linear_maps import SYMMETRIC, UPPER, grouping

#: Steps of central differences: of angles [rad] and of lengths [m].
_STEP = 1e-5
#: Base parameters that act on an arm at rest.
_STATIC = np.array([".n" in name for name in BASE_NAMES])


@dataclass(frozen=True, eq=False)
class Motion:
    """States of the joints, (N, 4) each, and gravity in base_link, (3,)."""

    q: FloatArray
    v: FloatArray
    a: FloatArray
    gravity: FloatArray

    @property
    def rests(self) -> bool:
        """Whether no joint moves."""
        return not (self.v.any() or self.a.any())


def loads(arm: Alpha5Parameters, density: float, motion: Motion) -> FloatArray:
    """Joint torques, then force and moment on the mount in base_link, (N, 10).

    Args:
        arm: The record, with its attached bodies.
        density: Of the fluid [kg/m^3].
        motion: What the joints report.
    """
    bodies = base_parameters(loaded_links(arm), density, parameters=arm)[:-3]
    return _computed(bodies, motion, _dimensions(arm))


def load_slopes(
    unknowns: ArmUnknowns, values: FloatArray, density: float, motion: Motion
) -> FloatArray:
    """Derivative of `loads` by the numbers of an arm, (N, 10, 78).

    Args:
        unknowns: The numbers.
        values: Where, (78,).
        density, motion: As of `loads`.
    """
    slopes = np.zeros((len(motion.q), LOADS, len(NAMES)))
    arm = unknowns.record(values)
    slopes[..., :OF_BODIES] = _by_bodies(unknowns, values, density, motion)
    bodies = base_parameters(loaded_links(arm), density, parameters=arm)[:-3]
    dimensions = _dimensions(arm)
    for joint in range(4):
        if unknowns.deviation[OF_BODIES + joint]:
            step = _STEP * np.eye(4)[joint]
            after = _computed(bodies, _turned(motion, step), dimensions)
            before = _computed(bodies, _turned(motion, -step), dimensions)
            slopes[..., OF_BODIES + joint] = (after - before) / (2 * _STEP)

    for number in range(OF_BODIES + 4, len(NAMES)):
        if unknowns.deviation[number]:
            step = _STEP * np.eye(len(NAMES))[number]
            longer = loads(unknowns.record(values + step), density, motion)
            shorter = loads(unknowns.record(values - step), density, motion)
            slopes[..., number] = (longer - shorter) / (2 * _STEP)
    return slopes


def gravity_slopes(
    arm: Alpha5Parameters, density: float, q: FloatArray, directions: FloatArray
) -> FloatArray:
    """Derivative of `loads` by gravity along directions (k, 3), (N, 10, k).

    Loads are linear in gravity, so each is the load of an arm at rest in it.
    """
    bodies = base_parameters(loaded_links(arm), density, parameters=arm)[:-3]
    still = np.zeros_like(q)
    found = [
        _computed(
            bodies, Motion(q=q, v=still, a=still, gravity=gravity), _dimensions(arm)
        )
        for gravity in directions
    ]
    return np.moveaxis(np.array(found), 0, -1)


def _by_bodies(
    unknowns: ArmUnknowns, values: FloatArray, density: float, motion: Motion
) -> FloatArray:
    """Derivative by the numbers of the bodies, (N, 10, 70)."""
    dh = unknowns.lengthened(values) if _has_lengths(unknowns, values) else unknowns.arm
    by_moments = grouping(density, dh)
    by_numbers = moment_slopes(by_body(values))
    base_slopes = np.einsum("bkm,bmn->bkn", by_numbers, by_moments)
    base_slopes = base_slopes.reshape(OF_BODIES, -1)

    acts = _STATIC if motion.rests else np.ones_like(_STATIC)
    dimensions = _dimensions(unknowns.record(values))
    regressor = np.empty((len(motion.q), LOADS, int(acts.sum())))
    unit = np.eye(len(BASE_NAMES))[acts]
    for column, only_one in enumerate(unit):
        regressor[..., column] = _computed(only_one, motion, dimensions)
    return np.asarray(regressor @ base_slopes[:, acts].T)


def _has_lengths(unknowns: ArmUnknowns, values: FloatArray) -> bool:
    """Whether lengths differ from the arm's own; zeros do not matter to regrouping."""
    return not np.array_equal(values[-4:], unknowns.middle[-4:])


def moment_slopes(bodies: FloatArray) -> FloatArray:
    """Derivative of moments m, m c, second moments, V, V b by a body's numbers.

    Args:
        bodies: Numbers in the order of `NAMES`, (B, 14).

    Returns:
        (B, 14, 14), numbers before moments.
    """
    slopes = np.zeros((len(bodies), 14, 14))
    rows, columns = UPPER
    for i, numbers in enumerate(bodies):
        mass, com = numbers[0], numbers[1:4]
        slopes[i, 0, 0] = 1.0
        slopes[i, 0, 1:4] = com
        slopes[i, 0, 4:10] = com[rows] * com[columns]
        for axis in range(3):
            unit = np.eye(3)[axis]
            slopes[i, 1 + axis, 1 + axis] = mass
            square = np.outer(unit, com) + np.outer(com, unit)
            slopes[i, 1 + axis, 4:10] = mass * square[UPPER]
        slopes[i, 4:10, 4:10] = SECOND_BY_INERTIA
        slopes[i, 10, 10] = 1.0
        slopes[i, 10, 11:] = numbers[11:]
        slopes[i, 11:, 11:] = numbers[10] * np.eye(3)
    return slopes


def _second_by_inertia() -> FloatArray:
    """Derivative of the six second moments by the six of the tensor, (6, 6)."""
    slopes = []
    for unit in np.eye(6):
        tensor = unit[SYMMETRIC]
        slopes.append((np.trace(tensor) / 2 * np.eye(3) - tensor)[UPPER])
    return np.array(slopes)


SECOND_BY_INERTIA = _second_by_inertia()


def _dimensions(arm: Alpha5Parameters) -> FloatArray:
    return Geometry.of(arm).dimensions


def _turned(motion: Motion, angles: FloatArray) -> Motion:
    return Motion(q=motion.q + angles, v=motion.v, a=motion.a, gravity=motion.gravity)


def _computed(bodies: FloatArray, motion: Motion, dimensions: FloatArray) -> FloatArray:
    """Loads of base parameters (38,), (N, 10)."""
    numbers = np.concatenate([bodies, motion.gravity, dimensions])
    state = (motion.q, motion.v, motion.a)
    return np.hstack(kernels.rows("inverse_dynamics_with_base_wrench", numbers, *state))
