"""The arm in moving water: buoyancy, added mass and drag, in a uniform current.

The equation of motion is ``(M(q) + sum J^T A J) a + ... = tau + tau_buoyancy(q) +
tau_drag``. It is computed on the tree of the arm's joints, with its base on a
free-flyer (`alpha5_model.water.tree`). The tree moves at ``v_tree = G v``, so the arm's
torques are ``tau = G^T tau_tree``. On a fixed base, the first six torques of the tree
are the load on the mount.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    flag,
    frozen,
    listed,
    rigid_transform,
)
from alpha5_model._support.renaming import renamed
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.batch import solved, solved_rows
from alpha5_model.dynamics.dimensions import DRAWN, check_dimensions
from alpha5_model.dynamics.linear_model import LinearModel, linear_model
from alpha5_model.dynamics.regression import Regressor
from alpha5_model.dynamics.states import Partials, forces, rows
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.hydrodynamics import (
    WATER_DENSITY,
    BodyHydrodynamics,
    DragStrip,
    hydrodynamics,
)
from alpha5_model.water.forces import JointWater
from alpha5_model.water.tree import HydrodynamicTree
from alpha5_model.water.vehicle import (
    Trim,
    Vehicle,
    on_floating_base,
    static_trim,
    with_vehicle,
)

#: One state in each row, or one for all.
Rows = ArrayLike
#: Velocity of the water, in the world [m/s]; None for the arm's `water_velocity`.
WaterVelocity = ArrayLike | None


def in_moving_water(
    arm: Arm, water_velocity: ArrayLike, level: str, numbers: str
) -> HydrodynamicArm:
    """An arm in moving water: see `Arm.with_hydrodynamics`."""
    links = hydrodynamics(arm.gripper, level, numbers)
    needed_for = "the moving water at its links"
    check_dimensions(arm._model, needed_for, DRAWN, arm.parameters)
    bodies = [joint_water(arm, link, data) for link, data in links.items()]
    velocity = array("water_velocity", water_velocity, 3)
    plausibility.check("water_velocity", velocity, plausibility.WATER_VELOCITY)
    return HydrodynamicArm(arm, bodies, velocity)


@renamed("current", "water_velocity")
class HydrodynamicArm(Arm):
    """An arm in moving water.

    Make one with `Arm.with_hydrodynamics`, or with `on_vehicle`.

    It is an `alpha5_model.dynamics.arm.Arm`, whose methods it overrides where the water
    changes the result; arguments and errors are the same. Every method that depends on
    the current has an argument ``water_velocity``, the uniform velocity of the water in
    the world, (3,) [m/s]; batches take one for each row. The generated kernels, JAX,
    CasADi and C do not know moving water.

    Attributes:
        still: The same arm in still water: with buoyancy only.
        water_velocity: Velocity of the water if a method gets none, in the world, (3,)
            [m/s].
        bodies: The added mass and drag of each body.
    """

    has_hydrodynamics = True

    def __init__(
        self,
        still: Arm,
        bodies: Iterable[JointWater],
        water_velocity: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        super().__init__(*still._constructor_arguments, parameters=still.parameters)
        self.still = still
        self.bodies = tuple(bodies)
        self.water_velocity = frozen(array("water_velocity", water_velocity, 3))
        self._tree = HydrodynamicTree(still, self.bodies)

    def added_mass(self, link: str) -> FloatArray:
        """Added mass of a link at the arm's fluid density, (6, 6) [kg, kg m, kg m^2].

        Linear before angular, about and in the link's frame.

        Raises:
            UnknownNameError: No such link, or one without added mass.
        """
        data_of = {body.body: body.data for body in self.bodies}
        data = data_of[choice("link", link, tuple(data_of))]
        density_ratio = self.still.fluid_density / WATER_DENSITY
        return np.asarray(data.added_mass * density_ratio)

    def mass_matrix(self, q: ArrayLike) -> FloatArray:
        """``M(q) + sum J^T A J``, (nv, nv), symmetric positive definite [kg m^2]."""
        (q_tree,) = self._tree.expand(self._clean_q(q))
        return self._tree.mass(q_tree)

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        """C(q, v) in still water, (nv, nv), with ``dM/dt - 2 C`` skew-symmetric."""
        q_tree, v_tree = self._tree.expand(*self._clean_qv(q, v))
        return self._tree.coriolis(q_tree, v_tree)

    def nonlinear_effects(
        self, q: ArrayLike, v: ArrayLike, water_velocity: WaterVelocity = None
    ) -> FloatArray:
        """Inverse dynamics without acceleration, (nv,) [N m].

        This is Coriolis torque, weight, buoyancy and drag.
        """
        no_acceleration = np.zeros(self._model.nv)
        return self.inverse_dynamics(
            q, v, no_acceleration, water_velocity=water_velocity
        )

    def inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        fext: Any = None,
        water_velocity: WaterVelocity = None,
    ) -> FloatArray:
        """Joint torque for a motion, (nv,) [N m]; see `Arm.inverse_dynamics`."""
        state = self._clean_qva(q, v, a)
        return np.asarray(
            self._tree.g.T @ self._tree_torque(state, fext, water_velocity)
        )

    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        fext: Any = None,
        water_velocity: WaterVelocity = None,
    ) -> FloatArray:
        """Joint acceleration under a torque, (nv,) [rad/s^2].

        See `Arm.forward_dynamics`.
        """
        q, v, torque = self._clean_qvtau(q, v, tau)
        bias = self.inverse_dynamics(q, v, np.zeros_like(torque), fext, water_velocity)
        return solved(self.mass_matrix(q), torque - bias)

    def inverse_dynamics_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        water_velocity: WaterVelocity = None,
    ) -> Partials:
        """dtau/dq, dtau/dv, dtau/da = M, each (nv, nv).

        See `Arm.inverse_dynamics_derivatives`.
        """
        dq, dv, da, _ = self._derivatives(water_velocity, q, v, a)
        to_arm = self._tree.g.T
        return to_arm @ dq, to_arm @ dv, to_arm @ da

    def inverse_dynamics_current_derivative(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        water_velocity: WaterVelocity = None,
    ) -> FloatArray:
        """Derivative of `inverse_dynamics` by the current, (nv, 3) [N s]."""
        _, _, _, du = self._derivatives(water_velocity, q, v, a)
        return np.asarray(self._tree.g.T @ du)

    def forward_dynamics_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        water_velocity: WaterVelocity = None,
    ) -> Partials:
        """da/dq, da/dv, da/dtau = M^-1, each (nv, nv).

        See `Arm.forward_dynamics_derivatives`.
        """
        a = self.forward_dynamics(q, v, tau, water_velocity=water_velocity)
        dq, dv, mass = self.inverse_dynamics_derivatives(q, v, a, water_velocity)
        inverse = np.asarray(np.linalg.inv(mass), dtype=np.float64)
        return -inverse @ dq, -inverse @ dv, inverse

    def linearized(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        dt: float | None = None,
        motors: bool = False,
        water_velocity: WaterVelocity = None,
    ) -> LinearModel:
        """The linear model ``dx/dt = A x + B u`` about a state; see `Arm.linearized`.

        Drag is proportional to the square of the speed, so a model at rest in still
        water has none.
        """
        q, v, tau = self._clean_qvtau(q, v, tau)
        motors = flag("motors", motors)
        water = self._checked(water_velocity)
        return linear_model(self, q, v, tau, dt, motors, water_velocity=water)

    def base_wrench(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        fext: Any = None,
        water_velocity: WaterVelocity = None,
    ) -> Any:
        """Wrench that the arm exerts on its mount, a pin.Force in base_link.

        See `Arm.base_wrench`.
        """
        state = self._clean_qva(q, v, a)
        return pin.Force(-self._tree_torque(state, fext, water_velocity)[:6])

    def base_wrench_derivatives(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        water_velocity: WaterVelocity = None,
    ) -> Partials:
        """dw/dq, dw/dv, dw/da, each (6, nv); see `Arm.base_wrench_derivatives`."""
        dq, dv, da, _ = self._derivatives(water_velocity, q, v, a)
        return -dq[:6], -dv[:6], -da[:6]

    def current_load(
        self, q: ArrayLike, water_velocity: WaterVelocity = None
    ) -> tuple[FloatArray, FloatArray]:
        """Forces of a steady water current on an arm at rest.

        Weight and buoyancy are left out.

        Args:
            q: (nq,).
            water_velocity: Velocity of the water, (3,) [m/s]; None for the arm's.

        Returns:
            Torque that holds the joints, (nv,) [N m], and the wrench on the mount, in
            base_link, (6,).
        """
        at_rest = np.zeros(self._model.nv)
        position = self._clean_q(q)
        velocity = self._checked(water_velocity)
        (tree_torque,) = self._water_torques(position, at_rest, at_rest, velocity)
        return self._tree.g.T @ tree_torque, -tree_torque[:6]

    def current_acceleration_load(
        self, q: ArrayLike, acceleration: ArrayLike
    ) -> tuple[FloatArray, FloatArray]:
        """What a current that changes with time adds, at any velocity.

        Other methods take the current of an instant as steady. If it accelerates, add
        the torque to that of `inverse_dynamics`, or subtract it from the torque given
        to `forward_dynamics`, and add the wrench to `base_wrench`.

        The water pushes each body by ``(A + m_w) du/dt`` [Morison1950]_: by its added
        mass, and by the pressure that accelerates the water of mass m_w which the body
        displaces. The current remains uniform: all water accelerates alike.

        Args:
            q: (nq,).
            acceleration: du/dt in the world, (3,) [m/s^2].

        Returns:
            Torque, (nv,) [N m], and the wrench on the mount, in base_link, (6,).

        .. [Morison1950] Morison et al.: The force exerted by surface waves on piles,
           J. Petroleum Technology 2(5), 1950.
        """
        (position,) = self._tree.expand(self._clean_q(q))
        rate = array("acceleration", acceleration, 3)
        tree_torque = self._tree.torque_of_accelerating_water(position, rate)
        return self._tree.g.T @ tree_torque, -tree_torque[:6]

    def kinetic_energy(
        self, q: ArrayLike, v: ArrayLike, water_velocity: WaterVelocity = None
    ) -> float:
        """Kinetic energy of the arm and of the water that it moves [J].

        The arm has ``v^T M v / 2`` in the world, and the water ``nu^T A nu / 2`` with
        velocities nu relative to the water.
        """
        state = self._tree_state(q, v)
        return self._tree.kinetic_energy(state, self._checked(water_velocity))

    def dissipated_power(
        self, q: ArrayLike, v: ArrayLike, water_velocity: WaterVelocity = None
    ) -> float:
        """Power that drag takes out of the motion relative to the water [W].

        It is never negative.
        """
        nu, _ = self._tree.motion(self._tree_state(q, v), self._checked(water_velocity))
        return float(self._tree.water.dissipated_power(nu).item())

    def inverse_dynamics_batch(
        self,
        q: Rows,
        v: Rows,
        a: Rows,
        threads: int | None = None,
        water_velocity: WaterVelocity = None,
    ) -> FloatArray:
        """`inverse_dynamics` of many states, (N, nv).

        Args:
            q: (N, nq).
            v: (N, nv).
            a: (N, nv).
            threads: As in `Arm.inverse_dynamics_batch`.
            water_velocity: (3,), or (N, 3), one for each row.
        """
        water = self._water_torques(q, v, a, water_velocity) @ self._tree.g
        return np.asarray(self.still.inverse_dynamics_batch(q, v, a, threads) + water)

    def base_wrench_batch(
        self,
        q: Rows,
        v: Rows,
        a: Rows,
        threads: int | None = None,
        water_velocity: WaterVelocity = None,
    ) -> FloatArray:
        """`base_wrench` of many states, (N, 6).

        Arguments are as of `inverse_dynamics_batch`.
        """
        water = self._water_torques(q, v, a, water_velocity)[:, :6]
        return np.asarray(self.still.base_wrench_batch(q, v, a, threads) - water)

    def forward_dynamics_batch(
        self,
        q: Rows,
        v: Rows,
        tau: Rows,
        threads: int | None = None,
        water_velocity: WaterVelocity = None,
    ) -> FloatArray:
        """`forward_dynamics` of many states, (N, nv).

        Arguments are as of `inverse_dynamics_batch`.
        """
        return solved_rows(self, q, v, tau, threads, water_velocity=water_velocity)

    def with_payload(
        self,
        mass: float,
        com: ArrayLike = (0.0, 0.0, 0.0),
        inertia: ArrayLike | None = None,
        volume: float = 0.0,
        cob: ArrayLike | None = None,
        frame: str = "tcp",
        added_mass: ArrayLike | None = None,
        strips: Iterable[DragStrip] = (),
    ) -> HydrodynamicArm:
        """A new arm that holds a rigid body; this one stays as it is.

        Args:
            mass, com, inertia, volume, cob, frame: As in `Arm.with_payload`.
            added_mass: (6, 6) about and in ``frame``, in water of 1000 kg/m^3; None for
                none.
            strips: Its drag strips, in ``frame``.
        """
        still = self.still.with_payload(mass, com, inertia, volume, cob, frame)
        matrix: Any = np.zeros((6, 6)) if added_mass is None else added_mass
        data = BodyHydrodynamics(matrix, tuple(listed("strips", strips, "DragStrips")))
        body = joint_water(still, still.displacements[-1].body, data)
        return HydrodynamicArm(still, (*self.bodies, body), self.water_velocity)

    def with_hydrodynamics(
        self,
        water_velocity: ArrayLike = (0.0, 0.0, 0.0),
        level: str = "nominal",
        numbers: str = "estimated",
    ) -> HydrodynamicArm:
        """The arm with other water around it; see `Arm.with_hydrodynamics`.

        The added mass and drag of payloads stay.
        """
        other = self.still.with_hydrodynamics(water_velocity, level, numbers)
        links = {body.body for body in other.bodies}
        payloads = [body for body in self.bodies if body.body not in links]
        return HydrodynamicArm(
            self.still, (*other.bodies, *payloads), other.water_velocity
        )

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Regressor:
        """Drag is not linear in base parameters: ask ``still.regressor``.

        Raises:
            InputError: Always.
        """
        raise InputError("arm", self, "an arm in still water, such as arm.still")

    def on_vehicle(self, vehicle: Vehicle) -> ArmOnVehicle:
        """This arm, afloat, with a vehicle in place of the mount."""
        still = on_floating_base(self.still)
        floating = HydrodynamicArm(still, self.bodies, self.water_velocity)
        return ArmOnVehicle(floating, vehicle)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.still, self.bodies, self.water_velocity)

    def __repr__(self) -> str:
        velocity = self.water_velocity.tolist()
        return f"HydrodynamicArm({self.still!r}, water_velocity {velocity} m/s)"

    def _checked(self, water_velocity: WaterVelocity) -> FloatArray:
        """A velocity of the water (3,), checked; None for the arm's."""
        if water_velocity is None:
            return self.water_velocity
        return array("water_velocity", water_velocity, 3)

    def _tree_state(self, q: ArrayLike, v: ArrayLike) -> list[FloatArray]:
        """State of the tree, without acceleration."""
        position, velocity = self._clean_qv(q, v)
        return self._tree.expand(position, velocity, np.zeros_like(velocity))

    def _tree_torque(
        self, state: Iterable[FloatArray], fext: Any, water_velocity: WaterVelocity
    ) -> FloatArray:
        """Inverse dynamics of the tree, (tree nv,)."""
        outside = None
        if fext is not None:
            # Entry 0 is the universe's. On a fixed base that is the force on link_0,
            # which the tree's free-flyer carries.
            first = 1 if self.still.floating_base else 0
            given = forces(fext, self._model.njoints)[first:]
            outside = np.array([force.vector for force in given])
        state_of_tree = self._tree.expand(*state)
        return self._tree.torque(state_of_tree, self._checked(water_velocity), outside)

    def _water_torques(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, water_velocity: WaterVelocity
    ) -> FloatArray:
        """What moving water adds to the tree's torques, in each row, (N, tree nv)."""
        given = self.water_velocity if water_velocity is None else water_velocity
        *states, velocities = rows(self._model, q=q, v=v, a=a, water_velocity=given)
        return self._tree.water_torques(self._tree.expand(*states), velocities)

    def _derivatives(
        self, water_velocity: WaterVelocity, *given: ArrayLike
    ) -> tuple[FloatArray, ...]:
        state = self._tree.expand(*self._clean_qva(*given))
        return self._tree.derivatives(state, self._checked(water_velocity))


@renamed("current", "water_velocity")
class ArmOnVehicle(HydrodynamicArm):
    """A floating arm and its vehicle as one system.

    q, v and a begin with position, velocity and acceleration of base_link.

    Attributes:
        arm: The same arm without the vehicle.
        vehicle: The vehicle that carries it, in the frame ``vehicle``.
    """

    def __init__(self, arm: HydrodynamicArm, vehicle: Vehicle) -> None:
        still = with_vehicle(arm.still, vehicle)
        self.arm = arm
        self.vehicle = vehicle
        body = joint_water(
            still,
            "vehicle",
            BodyHydrodynamics(vehicle.added_mass),
            linear=vehicle.linear_damping,
            quadratic=vehicle.quadratic_damping,
        )
        super().__init__(still, (*arm.bodies, body), arm.water_velocity)

    def configuration(
        self, transform_vehicle_to_world: ArrayLike, q: ArrayLike
    ) -> FloatArray:
        """q of the system.

        Args:
            transform_vehicle_to_world: Pose of the vehicle, (4, 4).
            q: Joint positions of the arm, (n,).
        """
        pose = rigid_transform("transform_vehicle_to_world", transform_vehicle_to_world)
        base = pin.SE3(pose @ self.vehicle.mount)
        joints = array("q", q, self._model.nq - 7)
        return np.concatenate([pin.SE3ToXYZQUAT(base), joints])

    def mount_load(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        water_velocity: WaterVelocity = None,
    ) -> Any:
        """Wrench that the arm exerts on the vehicle, a pin.Force in base_link."""
        return self.arm.base_wrench(
            q, v, a, water_velocity=self._checked(water_velocity)
        )

    def reaction(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        water_velocity: WaterVelocity = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Reaction of the vehicle, with its thrusters off, to a motion of the arm.

        Args:
            q: (nq,).
            v: (nv,).
            a: Acceleration of the joints, (nv - 6,).
            water_velocity: Velocity of the water, (3,) [m/s]; None for the arm's.

        Returns:
            Spatial acceleration of base_link in its axes, (6,), and the torque of the
            joints, (nv - 6,).
        """
        joints = array("a", a, self._model.nv - 6)
        with_base_held = np.concatenate([np.zeros(6), joints])
        bias = self.inverse_dynamics(
            q, v, with_base_held, water_velocity=water_velocity
        )
        mass = self.mass_matrix(q)
        of_base = np.linalg.solve(mass[:6, :6], -bias[:6])
        acceleration = np.asarray(of_base, dtype=np.float64)
        return acceleration, bias[6:] + mass[6:, :6] @ acceleration

    def trim(self, q: ArrayLike) -> Trim:
        """Static trim of the vehicle in still water, with its thrusters off.

        The force that balances the net weight acts at the vehicle's origin.

        Args:
            q: Joint positions, (n,).

        Raises:
            InputError: No righting moment, or gravity that is not along the world's z.
        """
        return static_trim(self.still, self.vehicle, self.configuration(np.eye(4), q))

    def with_payload(self, *args: Any, **kwargs: Any) -> ArmOnVehicle:
        return ArmOnVehicle(self.arm.with_payload(*args, **kwargs), self.vehicle)

    def with_hydrodynamics(
        self,
        water_velocity: ArrayLike = (0.0, 0.0, 0.0),
        level: str = "nominal",
        numbers: str = "estimated",
    ) -> ArmOnVehicle:
        """The system with other water around it; the vehicle's numbers stay."""
        arm = self.arm.with_hydrodynamics(water_velocity, level, numbers)
        return ArmOnVehicle(arm, self.vehicle)

    def on_vehicle(self, vehicle: Vehicle) -> ArmOnVehicle:
        return ArmOnVehicle(self.arm, vehicle)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.arm, self.vehicle)


def joint_water(
    arm: Any, frame: str, data: BodyHydrodynamics, **damping: FloatArray
) -> JointWater:
    """Added mass and drag in a frame of an arm, on the joint that carries the frame.

    Args:
        arm: An `Arm`.
        frame: Name of the frame.
        data: Added mass and drag strips in the frame.
        damping: ``linear`` and ``quadratic``, see `JointWater`.

    Raises:
        UnknownNameError: No such frame.
    """
    model = arm._joint_tree.model
    carrier = model.frames[arm._frame(frame)]
    return JointWater(
        body=frame,
        joint=model.names[carrier.parentJoint],
        action=carrier.placement.actionInverse,
        data=data,
        **damping,
    )
