"""Readings as a function of all unknowns: the arm's, and those of each session.

The unknowns of a session are the tilt of its mount, and what its sensor declares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray, choice, real
from alpha5_model._support.spatial import rotation_about
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_schema import NUMBERS
from alpha5_model.numbers.covariance import WIDTH
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.arm_numbers import (
    OF_BODIES,
    ArmNumbers,
    arm_numbers,
    by_body,
    load_slopes,
    loads,
)
from alpha5_model.studies.calibration.ar1 import whitened
from alpha5_model.studies.calibration.sensor import Loads, Own
from alpha5_model.studies.calibration.sessions import Session

#: What is known of the bodies before a calibration.
PRIORS = ("digits", "loose")
#: Standard deviations of the loose prior: relative ones, and of centres [m].
_LOOSE = 0.10
_LOOSE_CENTRE = 0.005
#: What is known of the zeros and of the mount [rad].
ZEROS = np.radians(1.0)
TILT = np.radians(0.5)
#: Step of central differences, in standard deviations before the readings.
_STEP = 1e-3


class Noise(NamedTuple):
    """Of a session's readings.

    Attributes:
        deviation: Standard deviation of each channel, (k,).
        correlation: Of one reading and the next, (k,).
    """

    deviation: FloatArray
    correlation: FloatArray


def prior_numbers(
    arm: Alpha5Parameters, prior: str, zeros: float, moves: bool
) -> ArmNumbers:
    """What is known of an arm before its calibration; half widths are deviations.

    Args:
        arm: Its record. Half widths of its file replace those of the digits.
        prior: ``digits``: each number is as good as its printed digits. ``loose``: the
            standard deviation of masses and volumes is 10 %, that of centres 5 mm, and
            that of moments of inertia 10 % of the largest.
        zeros: Standard deviation of the joints' zeros [rad].
        moves: Whether the arm moves in the data. If not, nothing is learnt of the
            moments of inertia, which are left out.

    Raises:
        UnknownNameError: No such prior.
        InputError: A deviation below 0, or an arm that has been calibrated.
    """
    if arm.covariance is not None:
        expected = "one before any calibration; fit all sessions together"
        raise InputError("arm", f"{arm.name}, calibrated", expected)
    choice("prior", prior, PRIORS)
    zeros = real("zeros", zeros, minimum=0.0)
    # Here the corrected centre of buoyancy is a number of its own.
    alone = tuple(name for name in arm.corrections if name != "link3_cob")
    numbers = arm_numbers(replace(arm, corrections=alone))
    known = dict(zip(numbers.names, numbers.half_width / WIDTH, strict=True))
    # Loads do not depend on the last one, d_3.
    names = NUMBERS[:-1]
    deviation = np.array([known[name] for name in names])
    for k, name in enumerate(names):
        if name.startswith("zeros.") and not deviation[k]:
            deviation[k] = zeros
        elif name == "lengths.a_1" and not deviation[k]:
            # The hypotenuse of two printed lengths.
            slopes = np.array([np.sin(arm.theta_c), np.cos(arm.theta_c)])
            sides = [known["elbow.opposite"], known["elbow.adjacent"]]
            deviation[k] = np.linalg.norm(slopes * sides)
        elif ".inertia." in name and not moves:
            deviation[k] = 0.0
    if prior == "loose":
        bodies = by_body(numbers.middle)
        loose = np.full(bodies.shape, _LOOSE_CENTRE)
        loose[:, [0, 10]] = _LOOSE * bodies[:, [0, 10]]
        loose[:, 4:10] = _LOOSE * np.abs(bodies[:, 4:10]).max(axis=1, keepdims=True)
        if not moves:
            loose[:, 4:10] = 0.0
        deviation[:OF_BODIES] = loose.ravel()
    return numbers.leading(deviation)


class Equations:
    """Readings of sessions in terms of all unknowns.

    Unknowns are the arm's numbers, then those of each session.

    Attributes:
        numbers: Of the arm, see `prior_numbers`.
        sessions: What was measured.
        names: Of all unknowns, (K,).
        middle: Their values beforehand, (K,).
        deviation: Their standard deviations beforehand, (K,).
    """

    def __init__(
        self, numbers: ArmNumbers, sessions: Sequence[Session], tilt: float = TILT
    ) -> None:
        self.numbers = numbers
        self.sessions = tuple(sessions)
        names = [*numbers.names]
        deviation = [numbers.half_width]
        #: Of each session: name of some unknowns -> their place.
        self._places: list[dict[str, slice]] = []
        for number, session in enumerate(self.sessions):
            own = (
                Own("tilt", ("1", "2"), np.full(2, tilt)),
                *session.sensor.own(session.moves),
            )
            places = {}
            for one in own:
                places[one.name] = slice(len(names), len(names) + len(one.labels))
                for label in one.labels:
                    names.append(f"{number}.{one.name}.{label}".rstrip("."))
                deviation.append(one.deviation)
            self._places.append(places)
        self.names = tuple(names)
        self.deviation = np.concatenate(deviation)
        self.middle = np.zeros(len(names))
        self.middle[: self.of_arm] = numbers.middle

    @property
    def of_arm(self) -> int:
        """How many unknowns are the arm's."""
        return len(self.numbers.names)

    def stated_noise(self) -> list[Noise]:
        """The noise that each sensor states: white."""
        return [
            Noise(one.sensor.deviation.copy(), np.zeros(one.sensor.size))
            for one in self.sessions
        ]

    def loads(
        self, values: FloatArray, number: int, density: float | None = None
    ) -> Loads:
        """What the arm does in a session.

        Args:
            values: Of all unknowns, (K,).
            number: Of the session.
            density: Of another fluid than the session's.
        """
        session = self.sessions[number]
        fluid = session.density if density is None else density
        record = self.numbers.record(values[: self.of_arm])
        q = session.q
        rest = np.zeros_like(q)
        still = [loads(record, fluid, unit, q, rest, rest) for unit in np.eye(3)]
        moving = np.zeros((len(q), still[0].shape[1]))
        if session.moves:
            moving = loads(record, fluid, np.zeros(3), q, session.v, session.a)
        return self._tilted(
            Loads(
                still=np.stack(still, axis=-1),
                moving=moving,
                turn=np.eye(3),
                gravity=session.gravity,
                velocity=session.v,
                density=fluid,
            ),
            values,
            number,
        )

    def predicted(
        self, values: FloatArray, number: int, density: float | None = None
    ) -> FloatArray:
        """Readings of a session, in the sensor's units, (N, k)."""
        return self._read(self.loads(values, number, density), values, number)

    def slopes(self, values: FloatArray) -> list[FloatArray]:
        """Derivatives of `predicted` by all unknowns, (N, k, K) of each session.

        Raises:
            InputError: Values so near to an impossible body that their slopes are not
                possible.
        """
        numbers = self.numbers.at(values[: self.of_arm])
        return [self._slopes(values, k, numbers) for k in range(len(self.sessions))]

    def _slopes(
        self, values: FloatArray, number: int, numbers: ArmNumbers
    ) -> FloatArray:
        """Derivatives of one session's readings, (N, k, K)."""
        session = self.sessions[number]
        density, q = session.density, session.q
        rest = np.zeros_like(q)
        by_gravity = [
            load_slopes(numbers, density, unit, q, rest, rest) for unit in np.eye(3)
        ]
        still = np.stack(by_gravity, axis=2)
        moving = np.zeros_like(by_gravity[0])
        if session.moves:
            weightless = np.zeros(3)
            moving = load_slopes(numbers, density, weightless, q, session.v, session.a)

        at = self.loads(values, number)
        out = np.zeros((*session.readings.shape, len(self.names)))
        for k in np.flatnonzero(self.deviation[: self.of_arm]).tolist():
            step = _STEP * self.deviation[k]
            ends = []
            for by in (step, -step):
                moved = replace(
                    at,
                    still=at.still + by * still[..., k],
                    moving=at.moving + by * moving[..., k],
                )
                ends.append(self._read(moved, values, number))
            out[..., k] = (ends[0] - ends[1]) / (2 * step)
        for place in self._places[number].values():
            for k in range(place.start, place.stop):
                step = _STEP * self.deviation[k]
                if not step:
                    continue
                ends = []
                for by in (step, -step):
                    other = values.copy()
                    other[k] += by
                    moved = self._tilted(at, other, number)
                    ends.append(self._read(moved, other, number))
                out[..., k] = (ends[0] - ends[1]) / (2 * step)
        return out

    def places(self, number: int) -> tuple[NDArray[Any], NDArray[Any]]:
        """State and channel of each reading of a session, channel after channel."""
        channels, states = np.nonzero(np.isfinite(self.sessions[number].readings.T))
        return states, channels

    def rows_of(self, number: int) -> slice:
        """The readings of a session in `rows`."""
        counts = [len(self.places(k)[0]) for k in range(number + 1)]
        return slice(sum(counts[:-1]), sum(counts))

    def rows(
        self, by_session: Sequence[FloatArray], noise: Sequence[Noise]
    ) -> FloatArray:
        """What belongs to readings, one below the other, their noise white and of 1.

        Args:
            by_session: (N, k, ...) each.
            noise: Of each session.

        Returns:
            (m, ...), in the order of `places`.
        """
        rows = []
        for number, values in enumerate(by_session):
            states, channels = self.places(number)
            for channel, (deviation, correlation) in enumerate(
                zip(*noise[number], strict=True)
            ):
                steps = states[channels == channel]
                if steps.size:
                    chance = deviation * np.sqrt(1.0 - correlation**2)
                    read = values[steps, channel]
                    rows.append(whitened(read, correlation, steps) / chance)
        return np.concatenate(rows)

    def residuals(self, values: FloatArray) -> list[FloatArray]:
        """Read minus predicted, of each session, (N, k); NaN for what is not read."""
        return [
            session.readings - self.predicted(values, number)
            for number, session in enumerate(self.sessions)
        ]

    def _read(self, at: Loads, values: FloatArray, number: int) -> FloatArray:
        own = {name: values[place] for name, place in self._places[number].items()}
        return self.sessions[number].sensor.read(at, own)

    def _tilted(self, at: Loads, values: FloatArray, number: int) -> Loads:
        """The loads of an arm whose mount is tilted about two axes across gravity."""
        gravity = self.sessions[number].gravity
        about = values[self._places[number]["tilt"]] @ _across(gravity)
        angle = np.linalg.norm(about)
        if not angle:
            return replace(at, turn=np.eye(3), gravity=gravity)
        turn = rotation_about(about / angle, angle)
        return replace(at, turn=turn.T, gravity=turn @ gravity)


def _across(gravity: FloatArray) -> FloatArray:
    """Two unit vectors at right angles to gravity, (2, 3); zeros without gravity."""
    size = np.linalg.norm(gravity)
    if not size:
        return np.zeros((2, 3))
    helper = np.eye(3)[np.abs(gravity).argmin()]
    first = np.cross(gravity / size, helper)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(gravity / size, first)])
