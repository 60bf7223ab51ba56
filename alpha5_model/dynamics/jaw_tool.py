"""The jaws as a tool: opening, gap between the blades, what fits, and grip force.

Seen along their hinges, the blades of the two fingers mirror each other about the wrist
axis. Widths are across that axis, in x of link_4. Places along it are ``at``, the
distance beyond the tcp towards the tips.

Lengths of the hinges, and of the fingers from hinge to tip, were measured in the
manufacturer's public CAD, and its SDK says how far a finger turns
(`alpha5_model.numbers.parameters.JawParameters`). The curve of the blades is our own
drawing. Gaps are those of the shapes that are compared for collision, which enclose the
drawn blades within 3 mm: a real gap may be larger by up to 6 mm, and differs by as much
as real blades differ from the drawn ones.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, bounded, float_array, real
from alpha5_model.dynamics.actuators import (
    EFFICIENCIES,
    Actuator,
    Interval,
    actuator,
)
from alpha5_model.errors import InputError
from alpha5_model.geometry.collision_shapes import collision_primitives
from alpha5_model.kinematics.limits import beyond
from alpha5_model.kinematics.tolerances import ON_LIMIT
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.pose import tool_of

#: Share of a screw's work that reaches the rod: tan(l) / tan(l + r) is 0.2 at a lead
#: angle l of 2 degrees and a friction of 0.14, tan(r); a screw without friction has 1.
SCREW_EFFICIENCY = (0.2, 1.0)
#: Corners of the polygon around a round shape.
_CORNERS = 32
#: A speed that is slow enough for no viscous friction [m/s].
_SLOW = 1e-12


@dataclass(frozen=True, eq=False)
class JawTool:
    """The jaws of an arm, as a tool. `alpha5_model.jaws` makes one.

    Attributes:
        arm: Record of the arm.
        closed, open: Positions of the rod, axis_a, at its limits [m].
        throat: ``at`` of the collar's end, from which objects lie between the blades
            [m].
    """

    arm: Alpha5Parameters
    closed: float
    open: float
    throat: float

    def opening(self, rod: ArrayLike) -> FloatArray:
        """Distance between the finger tips at positions of the rod (...) [m], (...).

        The tips meet at 0; each is one finger length from its hinge.

        Raises:
            InputError: A position beyond the limits of axis_a.
        """
        turn = self._turn(self._rods(rod))
        jaws = self.arm.jaws
        aside = jaws.pivot_offset * (1.0 - np.cos(turn))
        return np.asarray(2.0 * (jaws.finger_length * np.sin(turn) + aside))

    def rod(self, opening: ArrayLike) -> FloatArray:
        """The inverse of `opening`: positions of axis_a, (...) [m].

        Raises:
            InputError: A distance that the tips do not reach.
        """
        wanted = bounded("opening", float_array("opening", opening, ()))
        widest = float(self.opening(self.open))
        if (wanted < 0.0).any() or (wanted > widest + ON_LIMIT).any():
            expected = f"distances of the tips from 0 to {widest:.4g} m"
            raise InputError("opening", wanted.tolist(), expected)
        jaws = self.arm.jaws
        # L sin(a) - p cos(a) = R sin(a - b)
        radius = math.hypot(jaws.finger_length, jaws.pivot_offset)
        shift = math.atan2(jaws.pivot_offset, jaws.finger_length)
        turn = shift + np.arcsin((wanted / 2 - jaws.pivot_offset) / radius)
        rods = self.closed + turn / jaws.finger_turn
        return np.asarray(np.clip(rods, self.closed, self.open))

    def end(self, rod: float) -> float:
        """``at`` of the ends of the blades, at a position of the rod [m].

        Raises:
            InputError: A position beyond the limits of axis_a.
        """
        blade = self._finger(self._rod(rod))
        return max(float(outline[:, 1].max()) for outline in blade) - self._height(0.0)

    def gap(self, rod: float, at: ArrayLike) -> FloatArray:
        """Clear width between the blades at places along them, (...) [m].

        It is clear over the whole width of the blades, teeth of the tips included: an
        object that is narrower may be larger at the tips. 0 if nothing passes; NaN if
        there are no blades at the place.

        Args:
            rod: Position of axis_a [m].
            at: Distances beyond the tcp, (...) [m].

        Raises:
            InputError: A position beyond the limits of axis_a.

        Warns:
            ImplausibleWarning: A distance that seems to be in mm.
        """
        places = bounded("at", float_array("at", at, ()))
        farthest = np.abs(places).max(initial=0.0)
        plausibility.check("at", farthest, plausibility.JAW_LENGTH)
        blade = [*self._finger(self._rod(rod))]
        inner = np.full(places.shape, np.nan)
        for index, place in np.ndenumerate(places):
            ends = [_greatest_x(outline, self._height(place)) for outline in blade]
            found = [end for end in ends if end is not None]
            inner[index] = max(found, default=np.nan)
        return np.asarray(np.maximum(-2.0 * inner, 0.0))

    def widest(
        self, rod: float | None = None, at: float = 0.0, across: float = 0.0
    ) -> float:
        """Diameter of the widest round object at a place that touches nothing [m].

        It is a pipe along the hinges (y of link_4) or a ball, with its centre at the
        place; fingers and collar bound it. 0 if the place is not in the gap. Its way in
        is the `gap` at the places before it.

        Args:
            rod: Position of axis_a [m]; None for open jaws.
            at: Of the centre, beyond the tcp [m].
            across: Of the centre, x in link_4 [m].

        Raises:
            InputError: A position beyond the limits of axis_a, or a place that is not
                between the blades.
        """
        position = self.open if rod is None else self._rod(rod)
        along, across = self._between(at, position), real("across", across)
        if 2.0 * abs(across) >= float(self.gap(position, along)):
            return 0.0
        place = np.array([across, self._height(along)])
        mirrored = place * [-1.0, 1.0]
        distances = [_distance(self._wrist(), place)]
        for outline in self._finger(position):
            distances += [_distance(outline, place), _distance(outline, mirrored)]
        return max(0.0, 2.0 * float(min(distances)))

    def force(
        self,
        current: ArrayLike,
        screw_lead: float,
        at: float = 0.0,
        *,
        rod: float | None = None,
        screw_efficiency: ArrayLike = SCREW_EFFICIENCY,
    ) -> Interval:
        """With what force the jaws squeeze, while a current closes them, (...) [N].

        The force is across the wrist axis; the object receives it from either finger.
        By virtual work it is the rod's force over twice the lever times the turn of a
        finger per travel. Both ends are 0 if friction takes all of the current.

        The interval covers what the documents leave open: both motor constants of Table
        4, unless the arm's record has chosen one; the tolerance of the friction;
        whether eta_max is the gearbox's; and the screw. An object that was pressed by a
        larger current before may be held more firmly than this, as friction keeps it.

        Args:
            current: Magnitude of the motor's current (...) [A].
            screw_lead: Of the rod's screw [m per turn]. It is not published.
            at: Where the fingers touch the object, beyond the tcp [m].
            rod: Position of axis_a, which bounds ``at``; None for closed jaws.
            screw_efficiency: Least and greatest share of the screw's work that reaches
                the rod. It is not published; the default says almost nothing.

        Raises:
            InputError: A place without blades or not beyond the hinges, a lead or
                share that is none.

        Warns:
            ImplausibleWarning: A current or a lead that seems to be in another unit.
        """
        currents = bounded("current", float_array("current", current, ()))
        lead = real("screw_lead", screw_lead, minimum=0.0, strict=True)
        plausibility.check("screw_lead", lead, plausibility.SCREW_LEAD)
        shares = array("screw_efficiency", screw_efficiency, 2)
        if not 0.0 < shares[0] <= shares[1] <= 1.0:
            expected = "two shares above 0 and up to 1, the smaller one first"
            raise InputError("screw_efficiency", shares.tolist(), expected)
        position = self.closed if rod is None else self._rod(rod)
        place = self._between(at, position)

        lever = self._height(place) - self._pivot
        if lever <= 0.0:
            nearest = place - lever
            raise InputError("at", place, f"a place beyond the hinges, {nearest:.4g} m")

        closing = -np.abs(currents)
        # The lead was looked at above, once for all motors.
        with plausibility.silenced():
            motors = [*self._motors(lead)]
        _check_current(currents, motors[0].parameters.resistance)
        rod_forces = np.array([-motor.torque(closing, -_SLOW) for motor in motors])
        per_rod = 1.0 / (2.0 * self.arm.jaws.finger_turn * lever)
        return Interval(
            lower=np.maximum(rod_forces.min(axis=0), 0.0) * shares[0] * per_rod,
            upper=np.maximum(rod_forces.max(axis=0), 0.0) * shares[1] * per_rod,
        )

    def _motors(self, screw_lead: float) -> Iterator[Actuator]:
        """What the jaws' motor may be."""
        chosen = self.arm.motors.constants
        choices = ("torque", "voltage") if chosen == "printed" else (chosen,)
        for constants in choices:
            for efficiency in EFFICIENCIES:
                motor = actuator(
                    "axis_a",
                    constants,
                    screw_lead=screw_lead,
                    efficiency=efficiency,
                    arm=self.arm,
                )
                yield from motor.extremes()

    def _between(self, at: float, rod: float) -> float:
        """A place between the blades.

        Raises:
            InputError: Another one.
        """
        place, end = real("at", at), self.end(rod)
        if not self.throat <= place <= end:
            expected = f"a place between the blades, {self.throat:.4g} to {end:.4g} m"
            raise InputError("at", place, expected)
        return place

    @property
    def _pivot(self) -> float:
        """How far the hinges are along -z of link_4 [m]."""
        jaws = self.arm.jaws
        return jaws.collar_base + jaws.pivot_height + self.arm.spacer

    def _height(self, at: float) -> float:
        """How far a place is along -z of link_4 [m]."""
        return at - float(tool_of(self.arm).position[2])

    def _turn(self, rods: FloatArray) -> FloatArray:
        return np.asarray(self.arm.jaws.finger_turn * (rods - self.closed))

    def _rod(self, rod: float) -> float:
        """One position of axis_a within its limits.

        Raises:
            InputError: Not one number, or beyond the limits.
        """
        return float(self._rods(real("rod", rod)))

    def _rods(self, rod: ArrayLike) -> FloatArray:
        """Positions of axis_a within its limits.

        Raises:
            InputError: One is beyond them.
        """
        rods = bounded("rod", float_array("rod", rod, ()))
        if beyond(rods, self.closed, self.open).any():
            expected = f"positions of axis_a, {self.closed:g} to {self.open:g} m"
            raise InputError("rod", rods.tolist(), expected)
        return np.clip(rods, self.closed, self.open)

    def _wrist(self) -> FloatArray:
        """Outline of tube and collar, as `_finger` has that of a finger."""
        (wrist,) = collision_primitives("jaws")["link_4"]
        radius, _ = wrist.size
        return np.array(
            [
                [-radius, 0.0],
                [radius, 0.0],
                [radius, self._height(self.throat)],
                [-radius, self._height(self.throat)],
            ]
        )

    def _finger(self, rod: float) -> Iterator[FloatArray]:
        """Outlines of finger_1's shapes, seen along its hinge.

        The other finger mirrors them in x.

        Yields:
            Corners of a convex polygon in their order, x and distance along -z of
            link_4, (n, 2) [m].
        """
        turn = float(self._turn(np.asarray(rod)))
        origin = np.array([-self.arm.jaws.pivot_offset, self._pivot])
        for shape in collision_primitives("jaws")["finger_1"]:
            # All are turned about the hinge only: x and y of the finger's frame.
            if shape.kind == "cylinder":
                around = np.arange(_CORNERS) * 2 * np.pi / _CORNERS
                radius = shape.size[0] / np.cos(np.pi / _CORNERS)
                corners = radius * np.column_stack([np.cos(around), np.sin(around)])
            else:
                half = np.array(shape.size[:2]) / 2
                corners = half * [[-1, -1], [1, -1], [1, 1], [-1, 1]]
            placed = corners @ _turned(shape.rpy[2]).T + shape.xyz[:2]
            yield placed @ _turned(turn).T + origin


def jaws(arm: Alpha5Parameters | None = None) -> JawTool:
    """The jaws of an arm as a tool: opening, gaps, what fits, grip force.

    Args:
        arm: Record of the arm; None is the catalogue's. Its spacers and tool count.
            Fingers of another length have the drawn blades.

    Examples:
        >>> jaws = a5.jaws()
        >>> round(1e3 * float(jaws.opening(jaws.open)))  # between the tips [mm]
        103
    """
    record = chosen_arm(arm)
    joint = record.joints[4]
    (wrist,) = collision_primitives("jaws")["link_4"]
    _, length = wrist.size
    end = length / 2 - wrist.xyz[2] + record.spacer
    return JawTool(
        arm=record,
        closed=joint.lower,
        open=joint.upper,
        throat=end + float(tool_of(record).position[2]),
    )


def _check_current(currents: FloatArray, resistance: float) -> None:
    """Warn of a current that no plausible supply drives through the winding.

    Args:
        currents: (...) [A].
        resistance: Of the winding [Ohm].

    Warns:
        ImplausibleWarning: Such a current.
    """
    most = plausibility.SUPPLY_VOLTAGE.ranges[0][1] / resistance
    plausible = replace(plausibility.CURRENT_LIMIT, ranges=((0.0, most),))
    largest = np.abs(currents).max(initial=0.0)
    plausibility.check("current", float(largest), plausible)


def _turned(angle: float) -> FloatArray:
    """Rotation in the plane, (2, 2)."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]])


def _greatest_x(outline: FloatArray, height: float) -> float | None:
    """The greatest x of a convex polygon at a height; None if it is not there."""
    start, end = outline, np.roll(outline, -1, axis=0)
    low, high = np.minimum(start, end)[:, 1], np.maximum(start, end)[:, 1]
    crosses = (low <= height) & (height <= high)
    # A level edge ends where others cross the height.
    crosses &= low < high
    if not crosses.any():
        return None
    start, step = start[crosses], (end - start)[crosses]
    share = (height - start[:, 1]) / step[:, 1]
    return float((start[:, 0] + share * step[:, 0]).max())


def _distance(outline: FloatArray, point: FloatArray) -> float:
    """Of a point from a convex polygon whose corners go round; at most 0 inside."""
    start = outline
    step = np.roll(outline, -1, axis=0) - outline
    away = point - start
    share = np.clip((away * step).sum(axis=1) / (step**2).sum(axis=1), 0.0, 1.0)
    nearest = float(np.linalg.norm(away - share[:, None] * step, axis=1).min())
    left = step[:, 0] * away[:, 1] - step[:, 1] * away[:, 0]
    is_inside = bool((left >= 0.0).all() or (left <= 0.0).all())
    return -nearest if is_inside else nearest
