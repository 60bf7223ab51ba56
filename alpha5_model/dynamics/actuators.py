"""The DC motors with gearboxes of Table 4: current, voltage, power and limits.

With motor speed ``w = ratio * velocity`` and, at the motor shaft, gearbox input torque
``T``:

    K_t i = T + F sign(w) + B w + J dw/dt   shaft
    T = torque / (ratio * eta)        the motor drives the joint (torque * velocity > 0)
    T = torque * eta / ratio          the joint drives the motor (torque * velocity < 0)
    u = R i + L di/dt + K_e w         winding

K_e is the back-EMF constant: K_v or K_t, by the choice of `constants`.

At rest the direction of friction and gear loss is undefined: `Actuator.current` then
leaves both out, and `Actuator.holding_current` gives the whole interval of currents at
which the joint stays still.

**The printed motor constants contradict each other.** In SI units K_t [N m/A] and K_v
[V s/rad] of one motor are the same number, because the power ``K_v w i`` that leaves
the winding is the power ``K_t i w`` that reaches the shaft. Table 4 prints two numbers:
K_t is about 15 % above K_v for actuators 0 to 2 and half of it for 3 and 4
(`Actuator.constants_ratio`). Constants given per phase and line to line would differ by
factors near 2/sqrt(3) and 1/2, but the document does not say. Which ones to believe is
the caller's choice, `constants`:

- ``"printed"``: K_t for torque, K_v for voltage, as printed; then electrical and
  mechanical power do not balance, and `ActuatorPower.contradiction` holds what is left
  over;
- ``"torque"``: K_t for both; ``"voltage"``: K_v for both.

**Table 4 does not say whose efficiency eta_max is**: its columns come from
"motor/gearbox" data sheets. All currents and powers depend on it, and the choice is the
caller's, `efficiency`:

- ``"gearbox"``: the gearbox has the efficiency eta_max, as above;
- ``"motor"``: eta_max is the highest efficiency of the motor alone, whose losses are R
  i^2 and F w already, and no loss of the gearbox is printed: eta = 1. A gearbox of
  1754:1 with 86 % beside one of 340:1 with 77 % speaks for this (`alpha5_model.audit`,
  row ``efficiency``).

Table 4 prints one friction F for both directions, and no viscous friction B. An arm
file may have both: F of the backward direction, and B.

Not published, hence without default: rotor inertia, the lead of the jaw's screw, supply
voltage and current limit. Friction F carries its printed tolerance; eta_max is the
*highest* efficiency, so that currents are on the low side while driving. An effort
rating is not published either.

References:
    [ReachAlpha] Manufacturer's document, Section 2.2.1, Table 4.
    [Siciliano2009] Siciliano et al.: Robotics, Sections 5.2.1 and 5.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    LARGEST,
    FloatArray,
    bounded,
    choice,
    fitting,
    instance,
    real,
)
from alpha5_model.errors import MissingParameterError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.motors import CONSTANTS
from alpha5_model.numbers.parameters import (
    ActuatorParameters,
    Alpha5Parameters,
    chosen_arm,
)
from alpha5_model.numbers.tables import JOINT_NAMES

#: Whose efficiency Table 4's eta_max is taken for.
EFFICIENCIES = ("gearbox", "motor")


class Interval(NamedTuple):
    """Lower and upper end of a quantity, arrays of one shape.

    They are NaN if nothing is possible.
    """

    lower: FloatArray
    upper: FloatArray


@dataclass(frozen=True, eq=False)
class ActuatorPower:
    """Where the power goes, arrays of one shape [W].

    ``electrical`` is the sum of all others.

    Attributes:
        electrical: Drawn from the supply, ``u i``; negative when the motor feeds back.
        mechanical: Given to the joint, ``torque * velocity``.
        copper: Heat in the winding, ``R i^2``.
        friction: Heat from F and B at the motor shaft.
        gear: Heat in the gearbox.
        rotor: Into the kinetic energy of the rotor; zero without a rotor inertia.
        contradiction: ``(K_e - K_t) i w``, what the two printed constants disagree
            about; zero unless ``constants`` is ``"printed"``.
    """

    electrical: FloatArray
    mechanical: FloatArray
    copper: FloatArray
    friction: FloatArray
    gear: FloatArray
    rotor: FloatArray
    contradiction: FloatArray


@dataclass(frozen=True, eq=False)
class Actuator:
    """A DC motor with its gearbox. Methods take scalars or arrays that broadcast.

    "Torque" and "velocity" are those of the joint: N m and rad/s, for the jaw rod N and
    m/s.

    Attributes:
        joint: ``axis_e`` (actuator 0) to ``axis_a`` (actuator 4, the jaw rod).
        parameters: The row of Table 4.
        constants: Which motor constants are believed, one of `CONSTANTS`.
        rotor_inertia: Rotor and first gear stage, at the motor shaft [kg m^2]; not
            published.
        screw_lead: Travel of the jaw rod per turn of the gearbox output [m]; not
            published. The screw is taken as free of loss.
        efficiency: Whose efficiency eta_max is, one of `EFFICIENCIES`.
        friction_backward: F while the joint turns backward [N m]; None for that of the
            other direction.
        viscous_friction: B, at the motor shaft [N m s/rad].

    Raises:
        UnknownNameError: No such joint, or choice of constants or efficiency.
        InputError: A rotor inertia or a friction below 0, or a screw lead not above 0.

    Warns:
        ImplausibleWarning: A rotor inertia or a screw lead that seems to be in another
            unit.
    """

    joint: str
    parameters: ActuatorParameters
    constants: str = "printed"
    rotor_inertia: float | None = None
    screw_lead: float | None = None
    efficiency: str = "gearbox"
    friction_backward: float | None = None
    viscous_friction: float = 0.0

    def __post_init__(self) -> None:
        choice("joint", self.joint, JOINT_NAMES)
        instance("parameters", self.parameters, ActuatorParameters)
        choice("motor constants", self.constants, CONSTANTS)
        choice("efficiency", self.efficiency, EFFICIENCIES)
        if self.rotor_inertia is not None:
            inertia = real("rotor_inertia", self.rotor_inertia, minimum=0.0)
            plausibility.check("rotor_inertia", inertia, plausibility.ROTOR_INERTIA)
            object.__setattr__(self, "rotor_inertia", inertia)
        if self.friction_backward is not None:
            backward = real("friction_backward", self.friction_backward, minimum=0.0)
            object.__setattr__(self, "friction_backward", backward)
        viscous = real("viscous_friction", self.viscous_friction, minimum=0.0)
        object.__setattr__(self, "viscous_friction", viscous)
        if self.screw_lead is not None:
            lead = real("screw_lead", self.screw_lead, minimum=1 / LARGEST)
            plausibility.check("screw_lead", lead, plausibility.SCREW_LEAD)
            object.__setattr__(self, "screw_lead", lead)

    # Constants of the motor
    # -----------------------------------------------------------------

    @property
    def torque_constant(self) -> float:
        """Motor torque per current [N m/A], by the choice of constants."""
        p = self.parameters
        return p.voltage_constant if self.constants == "voltage" else p.torque_constant

    @property
    def back_emf_constant(self) -> float:
        """Voltage per motor speed [V s/rad], by the choice of constants."""
        p = self.parameters
        return p.torque_constant if self.constants == "torque" else p.voltage_constant

    @property
    def constants_ratio(self) -> float:
        """Printed K_t over printed K_v; 1 if they agreed."""
        return self.parameters.torque_constant / self.parameters.voltage_constant

    @property
    def ratio(self) -> float:
        """Motor angle per joint motion: [rad/rad], for the jaw rod [rad/m].

        Raises:
            MissingParameterError: The jaw rod without a screw lead.
        """
        gear = self.parameters.gear_ratio
        if self.joint != "axis_a":
            return gear
        if self.screw_lead is None:
            raise MissingParameterError("screw_lead", "the jaw rod axis_a")
        return gear * 2 * math.pi / self.screw_lead

    @property
    def gear_efficiency(self) -> float:
        """Efficiency of the gearbox, by the choice of `efficiency`."""
        return self.parameters.efficiency if self.efficiency == "gearbox" else 1.0

    @property
    def joint_friction(self) -> float:
        """F carried to the joint, ``F * ratio`` [N m], for the jaw rod [N]."""
        return self.parameters.friction * self.ratio

    # Torque and current
    # ---------------------------------------------------------------------

    def current(
        self,
        torque: ArrayLike,
        velocity: ArrayLike = 0.0,
        acceleration: ArrayLike | None = None,
    ) -> FloatArray:
        """Motor current that gives a joint torque.

        Args:
            torque: Delivered to the joint [N m].
            velocity: Of the joint; its sign is that of friction. Zero leaves losses
                out.
            acceleration: Of the joint; None leaves the rotor's inertia out.

        Returns:
            [A].

        Raises:
            MissingParameterError: An acceleration without a rotor inertia.
        """
        tau, v, _ = _checked_arrays(
            torque=torque, velocity=velocity, acceleration=acceleration
        )
        shaft = self._gear_input(tau, v) + self._friction_torque(v)
        return (shaft + self._rotor_torque(acceleration)) / self.torque_constant

    def torque(
        self,
        current: ArrayLike,
        velocity: ArrayLike = 0.0,
        acceleration: ArrayLike | None = None,
    ) -> FloatArray:
        """Joint torque that a motor current gives: the inverse of `current`.

        Returns:
            [N m].
        """
        i, v, _ = _checked_arrays(
            current=current, velocity=velocity, acceleration=acceleration
        )
        shaft = self.torque_constant * i - self._friction_torque(v)
        shaft = shaft - self._rotor_torque(acceleration)
        loss = self.gear_efficiency ** np.sign(shaft * v)
        return shaft * self.ratio * loss

    def holding_current(self, torque: ArrayLike) -> Interval:
        """Currents at which the joint stays still under a load, [A].

        The lower end just keeps the load from falling, and the upper end starts to lift
        it. The interval contains 0 if friction alone holds the load.
        """
        (tau,) = _checked_arrays(torque=torque)
        eta = self.gear_efficiency
        shaft = np.stack([tau * eta, tau / eta]) / self.ratio
        least = shaft.min(axis=0) - self._backward
        greatest = shaft.max(axis=0) + self.parameters.friction
        return Interval(
            lower=least / self.torque_constant, upper=greatest / self.torque_constant
        )

    def holding_torque(self, current: ArrayLike = 0.0) -> Interval:
        """Loads under which the joint stays still at a current, [N m].

        This is the inverse of `holding_current`.
        """
        (i,) = _checked_arrays(current=current)
        shaft = self.torque_constant * i
        low = shaft - self.parameters.friction
        high = shaft + self._backward
        eta = self.gear_efficiency
        return Interval(
            lower=low * self.ratio * eta ** np.sign(low),
            upper=high * self.ratio * eta ** -np.sign(high),
        )

    # Voltage and speed
    # ----------------------------------------------------------------------

    def voltage(
        self,
        current: ArrayLike,
        velocity: ArrayLike = 0.0,
        current_rate: ArrayLike = 0.0,
    ) -> FloatArray:
        """Voltage at the winding, ``R i + L di/dt + K_e w``.

        Args:
            current: [A].
            velocity: Of the joint.
            current_rate: di/dt [A/s].

        Returns:
            [V].
        """
        i, v, rate = _checked_arrays(
            current=current, velocity=velocity, current_rate=current_rate
        )
        p = self.parameters
        return (
            p.resistance * i
            + p.inductance * rate
            + self.back_emf_constant * self.ratio * v
        )

    def speed(self, voltage: ArrayLike, current: ArrayLike = 0.0) -> FloatArray:
        """Steady joint velocity at a voltage and a current: inverse of `voltage`."""
        u, i = _checked_arrays(voltage=voltage, current=current)
        return (u - self.parameters.resistance * i) / (
            self.back_emf_constant * self.ratio
        )

    # Limits
    # ---------------------------------------------------------------------------------

    def torque_limits(
        self,
        velocity: ArrayLike,
        supply_voltage: float,
        current_limit: float,
        acceleration: ArrayLike | None = None,
    ) -> Interval:
        """Joint torques available at a velocity (the speed-torque limit).

        Args:
            velocity: Of the joint.
            supply_voltage: The winding sees at most this, either way [V].
            current_limit: Of the driver [A]. Not published and not optional: without
                one the stall torque at 24 V would be beyond 100 N m.
            acceleration: Of the joint, as of `current`.

        Returns:
            [N m]; NaN if no current within the limit can be kept at this velocity.

        Raises:
            InputError: A supply voltage or current limit that is not positive.
            MissingParameterError: An acceleration without a rotor inertia.
        """
        supply, limit = _drive_limits(supply_voltage, current_limit)
        v, _ = _checked_arrays(velocity=velocity, acceleration=acceleration)
        back_emf = self.back_emf_constant * self.ratio * v
        low = np.maximum((-supply - back_emf) / self.parameters.resistance, -limit)
        high = np.minimum((supply - back_emf) / self.parameters.resistance, limit)
        possible = low <= high

        def torque_at(i: FloatArray) -> FloatArray:
            torque = self.torque(np.where(possible, i, 0.0), v, acceleration)
            return np.where(possible, torque, np.nan)

        return Interval(lower=torque_at(low), upper=torque_at(high))

    # Power
    # ----------------------------------------------------------------------------------

    def power(
        self,
        torque: ArrayLike,
        velocity: ArrayLike,
        acceleration: ArrayLike | None = None,
    ) -> ActuatorPower:
        """Electrical and mechanical power, and where the difference goes.

        ``di/dt`` is left out.
        """
        tau, v, _ = _checked_arrays(
            torque=torque, velocity=velocity, acceleration=acceleration
        )
        i = self.current(tau, v, acceleration)
        w = self.ratio * v
        mechanical = tau * v
        return ActuatorPower(
            electrical=self.voltage(i, v) * i,
            mechanical=mechanical,
            copper=self.parameters.resistance * i**2,
            friction=self._friction_torque(v) * w,
            gear=self._gear_input(tau, v) * w - mechanical,
            rotor=self._rotor_torque(acceleration) * w,
            contradiction=(self.back_emf_constant - self.torque_constant) * i * w,
        )

    # Uncertainty
    # ----------------------------------------------------------------------------

    def extremes(self) -> tuple[Actuator, Actuator]:
        """This actuator with the least and the greatest friction of its tolerance."""
        p = self.parameters
        ends = []
        for factor in (1 - p.friction_tolerance, 1 + p.friction_tolerance):
            backward = self.friction_backward
            end = replace(
                self,
                parameters=replace(p, friction=p.friction * factor),
                friction_backward=None if backward is None else backward * factor,
            )
            ends.append(end)
        return ends[0], ends[1]

    def current_interval(
        self,
        torque: ArrayLike,
        velocity: ArrayLike = 0.0,
        acceleration: ArrayLike | None = None,
    ) -> Interval:
        """`current` over the printed tolerance of the friction, [A]."""
        ends = [end.current(torque, velocity, acceleration) for end in self.extremes()]
        lower, upper = np.sort(ends, axis=0)
        return Interval(lower=lower, upper=upper)

    # Inside
    # ---------------------------------------------------------------------------------

    def _gear_input(self, torque: FloatArray, velocity: FloatArray) -> FloatArray:
        """Torque into the gearbox at the motor shaft [N m]; at rest without loss."""
        loss = self.gear_efficiency ** -np.sign(torque * velocity)
        return torque / self.ratio * loss

    @property
    def _backward(self) -> float:
        """Friction while the joint turns backward [N m]."""
        backward = self.friction_backward
        return self.parameters.friction if backward is None else backward

    def _friction_torque(self, velocity: FloatArray) -> FloatArray:
        """Friction at the motor shaft against a joint velocity [N m]."""
        dry = np.where(velocity < 0, self._backward, self.parameters.friction)
        viscous = self.viscous_friction * self.ratio * velocity
        return np.asarray(dry * np.sign(velocity) + viscous)

    def _rotor_torque(self, acceleration: ArrayLike | None) -> FloatArray:
        if acceleration is None:
            return np.zeros(())
        if self.rotor_inertia is None:
            needed_for = f"the acceleration of {self.joint}'s motor"
            raise MissingParameterError("rotor_inertia", needed_for)
        (a,) = _checked_arrays(acceleration=acceleration)
        return np.asarray(self.rotor_inertia * self.ratio * a)


def actuator(
    joint: str,
    constants: str | None = None,
    rotor_inertia: float | None = None,
    screw_lead: float | None = None,
    efficiency: str = "gearbox",
    arm: Alpha5Parameters | None = None,
) -> Actuator:
    """The actuator of a joint, from Table 4, or from the record of an arm.

    Args:
        joint: ``axis_e`` to ``axis_a``.
        constants: Motor constants to believe: ``"printed"``, ``"torque"`` or
            ``"voltage"``; see the head of this module. None for those of the arm's
            record, ``"printed"`` for the catalogue's.
        rotor_inertia: At the motor shaft [kg m^2]; None for that of the arm's record.
        screw_lead: Of the jaw rod [m per turn].
        efficiency: Whose efficiency eta_max is: ``"gearbox"`` or ``"motor"``; see the
            head of this module.
        arm: Record of an arm of your own; None for the catalogue's.

    Raises:
        UnknownNameError: No such joint, or choice of constants or efficiency.
        InputError: A rotor inertia below 0, or a screw lead not above 0.
    """
    record = chosen_arm(arm)
    number = JOINT_NAMES.index(choice("joint", joint, JOINT_NAMES))
    motors = record.motors
    if constants is None:
        constants = motors.constants
    if rotor_inertia is None:
        rotor_inertia = motors.rotor_inertias[number]
    return Actuator(
        joint=joint,
        parameters=record.actuators[number],
        constants=constants,
        rotor_inertia=rotor_inertia,
        screw_lead=screw_lead,
        efficiency=efficiency,
        friction_backward=motors.backward_frictions[number],
        viscous_friction=motors.viscous_frictions[number] or 0.0,
    )


def _drive_limits(supply_voltage: float, current_limit: float) -> tuple[float, float]:
    """Check the limits of a drive: both are above zero [V], [A]."""
    supply = real("supply_voltage", supply_voltage, minimum=0.0, strict=True)
    limit = real("current_limit", current_limit, minimum=0.0, strict=True)
    return supply, limit


def _checked_arrays(**values: ArrayLike | None) -> list[FloatArray]:
    """Check arrays whose shapes broadcast with one another; None is zero."""
    given: dict[str, tuple[ArrayLike, tuple[int, ...]]] = {}
    for name, value in values.items():
        given[name] = (0.0 if value is None else value, ())
    arrays = zip(given, fitting(**given), strict=True)
    return [bounded(name, array) for name, array in arrays]
