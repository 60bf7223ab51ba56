"""The arm in moving water: added mass and drag besides buoyancy, in a uniform current.

The equation of motion is ``(M(q) + sum J^T A J) a + ... = tau + tau_buoyancy(q) +
tau_drag``. Everything is computed on a tree in which every joint is its own and the
base stands on a free-flyer. Its velocities are ``G v``, so torques are ``G^T
tau_tree``. On a fixed base the first six of the tree are the load on the mount.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any, cast

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    float_array,
    frozen,
    rigid_transform,
)
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.codegen.water_parameters import water_parameters
from alpha5_model.dynamics.batch import kernel_rows, solved_rows
from alpha5_model.dynamics.dimensions import DRAWN, check_dimensions
from alpha5_model.dynamics.states import Partials, forces, rows
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.hydrodynamics import (
    WATER_DENSITY,
    BodyHydrodynamics,
    DragStrip,
    hydrodynamics,
)
from alpha5_model.water.forces import JointWater
from alpha5_model.water.tree import HydrodynamicTree
from alpha5_model.water.vehicle import Trim, Vehicle, afloat, carrying, static_trim

#: One state in each row, or one for all.
Rows = ArrayLike
#: Velocity of the water, in the world [m/s]; None for the arm's own.
Flow = ArrayLike | None


def in_moving_water(
    arm: Any, current: ArrayLike, level: str, numbers: str
) -> HydrodynamicArm:
    """An arm in moving water: see `Arm.with_hydrodynamics`."""
    gripper = "jaws" if "finger_1" in arm._frames else "locked"
    links = hydrodynamics(gripper, level, numbers)
    check_dimensions(arm._model, "the moving water at its links", DRAWN)
    bodies = [joint_water(arm, link, data) for link, data in links.items()]
    flow = array("current", current, 3)
    plausibility.check("current", flow, plausibility.CURRENT)
    return HydrodynamicArm(arm, bodies, flow)


class HydrodynamicArm:
    """An arm in moving water.

    Make one with `Arm.with_hydrodynamics`, or with `on_vehicle`.

    Arguments and errors are those of `alpha5_model.dynamics.arm.Arm`. The arm in still
    water answers what is not listed here (kinematics, weight, buoyancy, collisions,
    `model`, `joint_names`, ...). Every method that depends on the current takes one of
    its own, uniform, in the world, (3,) [m/s]; batches take one for each row.

    Attributes:
        still: The same arm in water that only bears it.
        current: Velocity of the water if a method gets none, in the world, (3,) [m/s].
        bodies: What moves water, on their joints.
    """

    def __init__(
        self,
        still: Any,
        bodies: Iterable[JointWater],
        current: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        self.still = still
        self.bodies = tuple(bodies)
        self._model = still._model
        self.current = frozen(array("current", current, 3))
        self._tree = HydrodynamicTree(still, self.bodies)

    def __getattr__(self, name: str) -> Any:
        # Moving water changes nothing of what this class does not define, or has no
        # such thing.
        without = ("still", "with_hydrodynamics", "regressor")
        if name.startswith("_") or name in without:
            own_type = type(self).__name__
            raise AttributeError(f"{own_type!r} object has no attribute {name!r}")
        return getattr(self.still, name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *dir(self.still)]

    def added_mass(self, link: str) -> FloatArray:
        """Added mass of a link at the arm's fluid density, (6, 6) [kg, kg m, kg m^2].

        Linear before angular, about and in the link's frame.

        Raises:
            UnknownNameError: No such link, or none that moves water.
        """
        bodies = {body.body: body.data for body in self.bodies}
        data = bodies[choice("link", link, tuple(bodies))]
        share = self.still.fluid_density / WATER_DENSITY
        return np.asarray(data.added_mass * share)

    def mass_matrix(self, q: ArrayLike) -> FloatArray:
        """``M(q) + sum J^T A J``, (nv, nv), symmetric positive definite [kg m^2]."""
        (q_tree,) = self._tree.expand(self.still._clean_q(q))
        return self._tree.mass(q_tree)

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        """C(q, v) in still water, (nv, nv), with ``dM/dt - 2 C`` skew-symmetric."""
        q_tree, v_tree = self._tree.expand(*self.still._clean_qv(q, v))
        return self._tree.coriolis(q_tree, v_tree)

    def nonlinear_effects(
        self, q: ArrayLike, v: ArrayLike, current: Flow = None
    ) -> FloatArray:
        """Inverse dynamics without acceleration, (nv,) [N m].

        This is Coriolis torque, weight, buoyancy and drag.
        """
        still = np.zeros(self._model.nv)
        return self.inverse_dynamics(q, v, still, current=current)

    def inverse_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        fext: Any = None,
        current: Flow = None,
    ) -> FloatArray:
        """Joint torque for a motion, (nv,) [N m]; see `Arm.inverse_dynamics`."""
        flow = self.current if current is None else current
        kernel = self._kernels[0]
        out: FloatArray | None = kernel(q, v, a, flow) if fext is None else None
        if out is not None:
            return out
        state = self.still._clean_qva(q, v, a)
        if fext is None and self._numbers is not None:
            return cast(FloatArray, kernel(*state, self._flow(current)))
        return np.asarray(self._tree.g.T @ self._torque(state, fext, current))

    def forward_dynamics(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        fext: Any = None,
        current: Flow = None,
    ) -> FloatArray:
        """Joint acceleration under a torque, (nv,) [rad/s^2].

        See `Arm.forward_dynamics`.
        """
        flow = self.current if current is None else current
        kernel = self._kernels[1]
        out: FloatArray | None = kernel(q, v, tau, flow) if fext is None else None
        if out is not None:
            return out
        q, v, torque = self.still._clean_qvtau(q, v, tau)
        if fext is None and self._numbers is not None:
            return cast(FloatArray, kernel(q, v, torque, self._flow(current)))
        bias = self.inverse_dynamics(q, v, np.zeros_like(torque), fext, current)
        a = np.linalg.solve(self.mass_matrix(q), torque - bias)
        return np.asarray(a, dtype=np.float64)

    def inverse_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: Flow = None
    ) -> Partials:
        """dtau/dq, dtau/dv, dtau/da = M, each (nv, nv).

        See `Arm.inverse_dynamics_derivatives`.
        """
        dq, dv, da, _ = self._derivatives(current, q, v, a)
        to_arm = self._tree.g.T
        return to_arm @ dq, to_arm @ dv, to_arm @ da

    def inverse_dynamics_current_derivative(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: Flow = None
    ) -> FloatArray:
        """Derivative of `inverse_dynamics` by the current, (nv, 3) [N s]."""
        _, _, _, du = self._derivatives(current, q, v, a)
        return np.asarray(self._tree.g.T @ du)

    def forward_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, current: Flow = None
    ) -> Partials:
        """da/dq, da/dv, da/dtau = M^-1, each (nv, nv).

        See `Arm.forward_dynamics_derivatives`.
        """
        a = self.forward_dynamics(q, v, tau, current=current)
        dq, dv, mass = self.inverse_dynamics_derivatives(q, v, a, current)
        inverse = np.asarray(np.linalg.inv(mass), dtype=np.float64)
        return -inverse @ dq, -inverse @ dv, inverse

    def forward_dynamics_current_derivative(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, current: Flow = None
    ) -> FloatArray:
        """Derivative of `forward_dynamics` with respect to the current, (nv, 3)."""
        a = self.forward_dynamics(q, v, tau, current=current)
        change = self.inverse_dynamics_current_derivative(q, v, a, current)
        faster = np.linalg.solve(self.mass_matrix(q), change)
        return np.asarray(-faster, dtype=np.float64)

    def base_wrench(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        fext: Any = None,
        current: Flow = None,
    ) -> Any:
        """Wrench that the arm exerts on its mount, a pin.Force in base_link.

        See `Arm.base_wrench`.
        """
        state = self.still._clean_qva(q, v, a)
        return pin.Force(-self._torque(state, fext, current)[:6])

    def base_wrench_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: Flow = None
    ) -> Partials:
        """dw/dq, dw/dv, dw/da, each (6, nv); see `Arm.base_wrench_derivatives`."""
        dq, dv, da, _ = self._derivatives(current, q, v, a)
        return -dq[:6], -dv[:6], -da[:6]

    def base_wrench_current_derivative(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: Flow = None
    ) -> FloatArray:
        """Derivative of `base_wrench` with respect to the current, (6, 3)."""
        _, _, _, du = self._derivatives(current, q, v, a)
        return -du[:6]

    def current_load(
        self, q: ArrayLike, current: Flow = None
    ) -> tuple[FloatArray, FloatArray]:
        """Load of a steady current alone on an arm at rest.

        Weight and buoyancy are left out.

        Args:
            q: (nq,).
            current: (3,) [m/s], None for the arm's own.

        Returns:
            Torque that holds the joints, (nv,) [N m], and the wrench on the mount, in
            base_link, (6,).
        """
        at_rest = np.zeros(self._model.nv)
        position = self.still._clean_q(q)
        flow = self._flow(current)
        (change,) = self._water_torques(position, at_rest, at_rest, flow)
        return self._tree.g.T @ change, -change[:6]

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike, current: Flow = None) -> float:
        """Kinetic energy of the arm and of the water that it moves [J].

        The arm's share is ``v^T M v / 2`` in the world, the water's ``nu^T A nu / 2``
        of the velocities relative to it.
        """
        return self._tree.kinetic_energy(self._moving(q, v), self._flow(current))

    def dissipated_power(
        self, q: ArrayLike, v: ArrayLike, current: Flow = None
    ) -> float:
        """Power that drag takes out of the motion relative to the water [W].

        It is never negative.
        """
        nu, _ = self._tree.motion(self._moving(q, v), self._flow(current))
        return float(self._tree.water.dissipated_power(nu)[0])

    def inverse_dynamics_batch(
        self,
        q: Rows,
        v: Rows,
        a: Rows,
        threads: int | None = None,
        current: Flow = None,
    ) -> FloatArray:
        """`inverse_dynamics` of many states, (N, nv).

        Args:
            q: (N, nq); v: (N, nv); a: (N, nv); threads: as in
                `Arm.inverse_dynamics_batch`.
            current: (3,), or (N, 3), one for each row.
        """
        out = self._rows_of_kernel(
            "inverse_dynamics_in_current", threads, current, q=q, v=v, a=a
        )
        if out is not None:
            return out
        water = self._water_torques(q, v, a, current) @ self._tree.g
        return np.asarray(self.still.inverse_dynamics_batch(q, v, a, threads) + water)

    def base_wrench_batch(
        self,
        q: Rows,
        v: Rows,
        a: Rows,
        threads: int | None = None,
        current: Flow = None,
    ) -> FloatArray:
        """`base_wrench` of many states, (N, 6).

        Arguments are as of `inverse_dynamics_batch`.
        """
        water = self._water_torques(q, v, a, current)[:, :6]
        return np.asarray(self.still.base_wrench_batch(q, v, a, threads) - water)

    def forward_dynamics_batch(
        self,
        q: Rows,
        v: Rows,
        tau: Rows,
        threads: int | None = None,
        current: Flow = None,
    ) -> FloatArray:
        """`forward_dynamics` of many states, (N, nv).

        Arguments are as of `inverse_dynamics_batch`.
        """
        kernel = "forward_dynamics_in_current"
        out = self._rows_of_kernel(kernel, threads, current, q=q, v=v, tau=tau)
        if out is not None:
            return out
        return solved_rows(self, q, v, tau, threads, current=current)

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
            strips: Where it drags, in ``frame``.
        """
        still = self.still.with_payload(mass, com, inertia, volume, cob, frame)
        matrix: Any = np.zeros((6, 6)) if added_mass is None else added_mass
        data = BodyHydrodynamics(matrix, strips)
        body = joint_water(still, still.displacements[-1].body, data)
        return HydrodynamicArm(still, (*self.bodies, body), self.current)

    def on_vehicle(self, vehicle: Vehicle) -> ArmOnVehicle:
        """This arm, afloat, with a vehicle in place of the mount."""
        floating = HydrodynamicArm(afloat(self.still), self.bodies, self.current)
        return ArmOnVehicle(floating, vehicle)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.still, self.bodies, self.current)

    def __repr__(self) -> str:
        return f"HydrodynamicArm({self.still!r}, current {self.current.tolist()} m/s)"

    def _flow(self, current: Flow) -> FloatArray:
        return self.current if current is None else array("current", current, 3)

    def _moving(self, q: ArrayLike, v: ArrayLike) -> list[FloatArray]:
        """State of the tree without acceleration."""
        position, velocity = self.still._clean_qv(q, v)
        return self._tree.expand(position, velocity, np.zeros_like(velocity))

    def _torque(
        self, state: Iterable[FloatArray], fext: Any, current: Flow
    ) -> FloatArray:
        """Inverse dynamics of the tree, (tree nv,)."""
        outside = None
        if fext is not None:
            # On a fixed base the tree has one joint more, and link_0 hangs on it.
            first = 1 if self.still.floating_base else 0
            given = forces(fext, self._model.njoints)[first:]
            outside = np.array([force.vector for force in given])
        state_of_tree = self._tree.expand(*state)
        return self._tree.torque(state_of_tree, self._flow(current), outside)

    def _water_torques(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: Flow
    ) -> FloatArray:
        """What moving water adds to the tree's torques, of each row, (N, tree nv)."""
        flow = self.current if current is None else current
        *states, flows = rows(self._model, q=q, v=v, a=a, current=flow)
        return self._tree.water_torques(self._tree.expand(*states), flows)

    def _rows_of_kernel(
        self, name: str, threads: int | None, current: Flow, q: Rows, **rates: Rows
    ) -> FloatArray | None:
        """A kernel's output for each row, (N, 4); None if it does not know the arm."""
        if self._numbers is None:
            return None
        given = self.current if current is None else current
        flow = float_array("current", given, (3,))
        if flow.ndim == 1 and isinstance(q, np.ndarray) and q.ndim == 2:
            # The kernels see that it is one row for all.
            flow = np.broadcast_to(flow, (len(q), 3))
        return kernel_rows(
            self.still, name, 4, threads, self._numbers, q=q, **rates, current=flow
        )

    @cached_property
    def _numbers(self) -> FloatArray | None:
        """Parameters of the kernels; None if they do not know the arm or its water."""
        of_still_water = self.still._kernel_parameters
        strips: dict[str, list[DragStrip]] = {
            joint: [] for joint in list(self._model.names)[1:]
        }
        moving = [body for body in self.bodies if body.joint in strips]
        if of_still_water is None or not all(body.plain for body in moving):
            return None
        for body in moving:
            strips[body.joint] += body.data.strips

        water = water_parameters(
            self._tree.water.added_mass[1:],
            [*strips.values()],
            self.still.fluid_density,
            self.still.parameters,
        )
        if water is None:
            return None
        added, of_moving_water = water
        return np.concatenate([of_still_water + added, of_moving_water])

    @cached_property
    def _kernels(self) -> list[Callable[..., Any]]:
        """Inverse and forward dynamics of this arm by kernels.

        Without kernels, they are functions that answer None.
        """
        if self._numbers is None:
            return [lambda *_: None, lambda *_: None]
        bind = kernels.module().bind
        return [
            bind("inverse_dynamics_in_current", self._numbers),
            bind("forward_dynamics_in_current", self._numbers),
        ]

    def _derivatives(self, current: Flow, *given: ArrayLike) -> tuple[FloatArray, ...]:
        state = self._tree.expand(*self.still._clean_qva(*given))
        return self._tree.derivatives(state, self._flow(current))


class ArmOnVehicle(HydrodynamicArm):
    """A floating arm and its vehicle as one system.

    q, v, a begin with those of base_link.

    Attributes:
        arm: The same arm without the vehicle.
        vehicle: What carries it; its frame is ``vehicle``.
    """

    def __init__(self, arm: HydrodynamicArm, vehicle: Vehicle) -> None:
        still = carrying(arm.still, vehicle)
        self.arm = arm
        self.vehicle = vehicle
        body = joint_water(
            still,
            "vehicle",
            BodyHydrodynamics(vehicle.added_mass),
            linear=vehicle.linear_damping,
            quadratic=vehicle.quadratic_damping,
        )
        super().__init__(still, (*arm.bodies, body), arm.current)

    def configuration(
        self, transform_vehicle_to_world: ArrayLike, q: ArrayLike
    ) -> FloatArray:
        """q of the system.

        Args:
            transform_vehicle_to_world: Pose of the vehicle, (4, 4).
            q: Joint positions of the arm, (n,).
        """
        pose = rigid_transform("transform_vehicle_to_world", transform_vehicle_to_world)
        base = pin.SE3(pose @ np.linalg.inv(self.vehicle.transform_vehicle_to_base))
        joints = array("q", q, self._model.nq - 7)
        return np.concatenate([pin.SE3ToXYZQUAT(base), joints])

    def mount_load(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: Flow = None
    ) -> Any:
        """Wrench that the arm exerts on the vehicle, a pin.Force in base_link."""
        return self.arm.base_wrench(q, v, a, current=self._flow(current))

    def reaction(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, current: Flow = None
    ) -> tuple[FloatArray, FloatArray]:
        """What a motion of the arm does to the vehicle with its thrusters off.

        Args:
            q: (nq,); v: (nv,).
            a: Acceleration of the joints, (nv - 6,).
            current: (3,) [m/s], None for the arm's own.

        Returns:
            Spatial acceleration of base_link in its axes, (6,), and the torque of the
            joints, (nv - 6,).
        """
        joints = array("a", a, self._model.nv - 6)
        with_base_held = np.concatenate([np.zeros(6), joints])
        bias = self.inverse_dynamics(q, v, with_base_held, current=current)
        mass = self.mass_matrix(q)
        of_base = np.linalg.solve(mass[:6, :6], -bias[:6])
        acceleration = np.asarray(of_base, dtype=np.float64)
        return acceleration, bias[6:] + mass[6:, :6] @ acceleration

    def trim(self, q: ArrayLike) -> Trim:
        """How the vehicle hangs at rest in still water, thrusters off.

        What the net weight needs to hold its depth acts at the vehicle's origin.

        Args:
            q: Joint positions, (n,).

        Raises:
            InputError: No righting moment, or gravity that is not along the world's z.
        """
        return static_trim(self.still, self.vehicle, self.configuration(np.eye(4), q))

    def with_payload(self, *args: Any, **kwargs: Any) -> ArmOnVehicle:
        return ArmOnVehicle(self.arm.with_payload(*args, **kwargs), self.vehicle)

    def on_vehicle(self, vehicle: Vehicle) -> ArmOnVehicle:
        return ArmOnVehicle(self.arm, vehicle)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.arm, self.vehicle)


def joint_water(
    arm: Any, frame: str, data: BodyHydrodynamics, **damping: FloatArray
) -> JointWater:
    """Moving water of a body in a frame of an arm, on the joint that carries the frame.

    ``damping`` is the `JointWater`'s, linear and quadratic.

    Raises:
        UnknownNameError: No such frame.
    """
    model = arm._arguments[0]
    carrier = model.frames[arm._frame(frame)]
    return JointWater(
        body=frame,
        joint=model.names[carrier.parentJoint],
        action=carrier.placement.actionInverse,
        data=data,
        **damping,
    )
