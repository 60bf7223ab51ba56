"""Self-collision of the arm of a pin.Model: which angles its q gives the bodies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, float_array, real
from alpha5_model.collision.self_collision import self_collision
from alpha5_model.dynamics.dimensions import DRAWN, check_dimensions
from alpha5_model.dynamics.states import is_one_state, rows, state_check
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import FingerJoint, split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters, is_catalogue


class _Angle(NamedTuple):
    """How a coordinate of q turns a body: ``angle = scale * q[place] + offset``.

    Attributes:
        place: In q.
        rate: In v.
        scale: [rad/rad], or [rad/m] for a finger that follows the rod.
        offset: [rad].
    """

    place: int
    rate: int
    scale: float
    offset: float


class ArmCollision:
    """The self-collision of one arm, in terms of its q. Threads may share it.

    Attributes:
        one: A quick function of q (nq,) and a margin; it returns None unless both are
            plain.

    Raises:
        InputError: A model with other dimensions than those of its record, or whose
            fingers do not turn.
    """

    one: Callable[[Any, Any], bool | None]

    def __init__(self, model: pin.Model, parameters: Alpha5Parameters) -> None:
        record = None if is_catalogue(parameters) else parameters
        check_dimensions(model, "its bodies", DRAWN, record)
        gripper = "jaws" if model.existFrame("finger_1") else "locked"
        self._model = model
        self._check = state_check(model)
        self._scene = self_collision(parameters, gripper)
        turns = [_turn(model, joint.name) for joint in parameters.joints[:4]]
        if gripper == "jaws":
            _, *fingers = split_link_4(parameters).joints
            turns += [_finger_turn(model, finger) for finger in fingers]
        self._place, self._rate, self._scale, self._offset = map(
            np.array, zip(*turns, strict=True)
        )
        self._is_plain = model.nq == 4 and turns == [_plain(k) for k in range(4)]
        self.one = self._scene.one() if self._is_plain else _never

    def touches(self, q: ArrayLike, margin: float) -> bool | BoolArray:
        """Whether the arm comes within a margin of itself at q (..., nq), (...)."""
        margin = real("margin", margin, minimum=0.0)
        hits = self._scene.touches(self._angles(q), margin)
        return bool(hits[0]) if is_one_state(q) else hits.reshape(np.shape(q)[:-1])

    def distance(self, q: ArrayLike) -> float | FloatArray:
        """The least distance of compared links at q (..., nq), (...) [m]."""
        distance = self._scene.distance(self._angles(q))
        if is_one_state(q):
            return float(distance[0])
        return distance.reshape(np.shape(q)[:-1])

    def closest(self, q: ArrayLike) -> tuple[tuple[str, str], float]:
        """Names of the nearest two links at q (nq,), and their distance [m]."""
        contact = self._scene.nearest(self._turned(self._check(q)))
        return self._scene.links(contact), contact.distance

    def gradient(self, q: ArrayLike) -> FloatArray:
        """Derivative of the distance by the coordinates of v at q (nq,), (nv,)."""
        of_angles = self._scene.gradient(self._turned(self._check(q)))
        gradient = np.zeros(self._model.nv)
        np.add.at(gradient, self._rate, self._scale * of_angles)
        return gradient

    def _angles(self, q: ArrayLike) -> FloatArray:
        """Angles of the bodies at q (..., nq), (N, B-1)."""
        if is_one_state(q):
            return self._turned(self._check(q))[None]
        nq = self._model.nq
        given = float_array("q", q, (nq,))
        return self._turned(rows(self._model, q=given.reshape(-1, nq))[0])

    def _turned(self, q: FloatArray) -> FloatArray:
        if self._is_plain:
            return q
        return np.asarray(self._scale * q[..., self._place] + self._offset)


def _turn(model: pin.Model, name: str) -> _Angle:
    joint = model.joints[model.getJointId(name)]
    return _plain(joint.idx_q)._replace(rate=joint.idx_v)


def _plain(place: int) -> _Angle:
    """A coordinate that is the angle itself."""
    return _Angle(place=place, rate=place, scale=1.0, offset=0.0)


def _finger_turn(model: pin.Model, finger: FingerJoint) -> _Angle:
    """How a finger turns: by its own coordinate, or after the rod.

    Raises:
        InputError: Neither is a joint of the model.
    """
    if model.existJointName(finger.name):
        joint = model.joints[model.getJointId(finger.name)]
        if joint.nq == 1:
            return _turn(model, finger.name)
    if not model.existJointName(finger.leader):
        raise InputError(
            "arm",
            f"fingers without {finger.leader}",
            "jaws that move, or closed ones as part of link_4",
        )
    after = _turn(model, finger.leader)
    return after._replace(scale=finger.multiplier, offset=finger.offset)


def _never(q: Any, margin: Any) -> None:
    """The quick answer about arms that have none."""
