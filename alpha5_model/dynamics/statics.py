"""The arm at rest in the water: where it is, what it weighs, what the water carries."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, instance, listed, real
from alpha5_model.dynamics import batch
from alpha5_model.dynamics.collision import CollisionModel
from alpha5_model.dynamics.hydrostatics import (
    Displacement,
    displaced_fluid_model,
    net_weight_model,
)
from alpha5_model.dynamics.vectors import position_check
from alpha5_model.dynamics.water import SEA_WATER
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.kinematics import approach

# Bound once: where a whole call takes 0.3 us, looking up a module's attribute is seen.
_gravity = pin.computeGeneralizedGravity
_gravity_derivative = pin.computeGeneralizedGravityDerivatives
_forward_kinematics = pin.forwardKinematics
_frames_forward_kinematics = pin.framesForwardKinematics
_jacobian = pin.computeFrameJacobian
_potential_energy = pin.computePotentialEnergy
_center_of_mass = pin.centerOfMass


class Workspace(threading.local):
    """Pinocchio's scratch memory, one set for each thread."""

    def __init__(self, model: Any, fluid: Any, net: Any) -> None:
        self.data = model.createData()
        self.fluid_data = fluid.createData()
        self.net_data = net.createData()
        self.pools = batch.Pools()
        # These refer to the data's own memory, so the next computation moves them.
        self.placements = {frame.name: self.data.oMf[i] for i, frame in enumerate(model.frames)}
        self._model = model

    @cached_property
    def collisions(self) -> CollisionModel:
        """The collision bodies, made when first asked for."""
        return CollisionModel(self._model)


class Statics:
    """Kinematics and hydrostatics of an arm; base of `alpha5_model.dynamics.arm.Arm`.

    Attributes:
        model: pin.Model of the arm, the caller's to use. The arm computes on a copy of its own, so
            nothing done to this one changes what the arm's methods return. With jaws it has mimic joints, to
            which not every algorithm of Pinocchio is fit: see `alpha5_model.dynamics.jaw_arm`.
        fluid_model: pin.Model of the displaced fluid: point masses ``rho V`` at the centres of buoyancy.
        displacements: The displaced volumes.
        fluid_density: [kg/m^3].
        floating_base: Whether the first joint is Pinocchio's free-flyer.
    """

    def __init__(
        self,
        model: Any,
        displacements: Iterable[Displacement],
        fluid_density: float = SEA_WATER,
    ) -> None:
        if not isinstance(model, pin.Model) or not any(i.mass for i in list(model.inertias)[1:]):
            raise InputError("model", model, "a pin.Model with moving masses")
        bodies = listed("displacements", displacements, "Displacements")
        self.displacements = tuple(instance("displacements", b, Displacement) for b in bodies)
        self.fluid_density = real("fluid_density", fluid_density, minimum=0.0)
        self._model = model.copy()
        self._fluid = displaced_fluid_model(model, self.displacements, self.fluid_density)
        self.model = model.copy()
        self.fluid_model = self._fluid.copy()
        self.floating_base = model.joints[1].nq == 7
        self._net = net_weight_model(model, self._fluid)
        self._own = Workspace(self._model, self._fluid, self._net)
        self._users = threading.local()
        self._clean_q = position_check(self._model)
        self._frames = {frame.name: i for i, frame in enumerate(model.frames)}
        # Pinocchio leaves the bodies fixed to the universe (link_0 on a fixed base) out of its sums.
        moving = sum(inertia.mass for inertia in list(model.inertias)[1:])
        fixed = model.inertias[0]
        total = moving + fixed.mass
        self._moving_fraction = np.full(3, moving / total)
        self._fixed_fraction = fixed.lever * (fixed.mass / total)
        net = self._net.inertias[0]
        self._link_0_load = net * -model.gravity  # holds what is fixed to the universe
        self._fixed_potential = -net.mass * float(model.gravity.linear @ net.lever)
        self._volume = sum(body.volume for body in self.displacements)

    @property
    def data(self) -> Any:
        """pin.Data of `model`, the caller's to use: one for each thread; no method touches it."""
        try:
            return self._users.data
        except AttributeError:
            self._users.data = self.model.createData()
            return self._users.data

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints that q runs over, base to tip (without the free-flyer)."""
        joints = zip(self._model.names, self._model.joints, strict=True)
        return tuple(name for name, joint in list(joints)[1:] if joint.nv == 1)

    def forward_kinematics(self, q: ArrayLike, frame: str = "tcp") -> Any:
        """Pose of a frame.

        Args:
            q: Joint positions, (nq,) [rad, and m for axis_a]; with a floating base, position [m] and
                quaternion (x, y, z, w) of base_link come first.
            frame: Name of a frame of the model.

        Returns:
            pin.SE3 ``transform_frame_to_world``; the world is base_link if the base is fixed.

        Raises:
            InputError: q has the wrong shape or is not finite, or its quaternion has no unit norm.
            UnknownNameError: No such frame.
        """
        q = self._clean_q(q)
        own = self._own
        _frames_forward_kinematics(self._model, own.data, q)
        try:
            return own.placements[frame].copy()
        except (KeyError, TypeError):
            raise UnknownNameError("frame", frame, self._frames) from None

    def jacobian(
        self, q: ArrayLike, frame: str = "tcp", reference_frame: Any = pin.LOCAL_WORLD_ALIGNED
    ) -> FloatArray:
        """Geometric Jacobian of a frame.

        Args:
            q: (nq,).
            frame: Name of a frame of the model.
            reference_frame: Axes and point of the twist, a pin.ReferenceFrame. The default is the velocity of
                the frame's origin in the axes of the world.

        Returns:
            (6, nv), linear rows [m/rad] above angular rows, as Pinocchio has them.
        """
        q = self._clean_q(q)
        if type(reference_frame) is not pin.ReferenceFrame:
            raise InputError(
                "reference_frame", reference_frame, "pin.LOCAL, pin.WORLD or LOCAL_WORLD_ALIGNED"
            )
        index = self._frame(frame)
        out: FloatArray = _jacobian(self._model, self._own.data, q, index, reference_frame)
        return out

    def approach_directions(self, position: ArrayLike) -> approach.ApproachDirections:
        """From which directions the arm reaches points; see `kinematics.approach`.

        Args:
            position: tcp in ``base_link``, (..., 3) [m].
        """
        return approach.approach_directions(position)

    def gravity_torque(self, q: ArrayLike) -> FloatArray:
        """Torque that holds the weight, g(q) on the left side of the equation of motion.

        Args:
            q: (nq,).

        Returns:
            (nv,) [N m, N].
        """
        q = self._clean_q(q)
        out: FloatArray = _gravity(self._model, self._own.data, q)
        return out

    def buoyancy_torque(self, q: ArrayLike) -> FloatArray:
        """Generalized force that the fluid applies, on the right side of the equation of motion.

        Args:
            q: (nq,).

        Returns:
            (nv,) [N m, N].
        """
        q = self._clean_q(q)
        out: FloatArray = _gravity(self._fluid, self._own.fluid_data, q)
        return out

    def hydrostatic_torque(self, q: ArrayLike) -> FloatArray:
        """Torque that holds the arm still in the fluid: gravity_torque - buoyancy_torque.

        Args:
            q: (nq,).

        Returns:
            (nv,) [N m, N].
        """
        q = self._clean_q(q)
        out: FloatArray = _gravity(self._net, self._own.net_data, q)
        return out

    def hydrostatic_torque_derivative(self, q: ArrayLike) -> FloatArray:
        """Derivative of `hydrostatic_torque` with respect to q (tangent space for a floating base).

        Args:
            q: (nq,).

        Returns:
            (nv, nv): row = torque, column = coordinate.
        """
        q = self._clean_q(q)
        own = self._own
        # Not of the net weights: Pinocchio joins bodies here, which takes positive masses.
        out: FloatArray = _gravity_derivative(self._model, own.data, q)
        out -= _gravity_derivative(self._fluid, own.fluid_data, q)
        return out

    def buoyancy_wrenches(self, q: ArrayLike) -> Any:
        """Buoyancy as one wrench for each joint, by Archimedes at the centres of buoyancy.

        Args:
            q: (nq,).

        Returns:
            pin.StdVec_Force of length njoints, each in its joint's frame: Pinocchio's ``fext``. Entry 0 is what
            the fluid applies to bodies fixed to the universe, link_0 on a fixed base.
        """
        q = self._clean_q(q)
        data = self._own.data
        _forward_kinematics(self._model, data, q)
        out = pin.StdVec_Force([pin.Force.Zero()] * self._model.njoints)
        up = -self._model.gravity
        for joint, body in enumerate(self._fluid.inertias):
            if body.mass:
                out[joint] = body * data.oMi[joint].actInv(up)  # rho V g, acting at the centre
        return out

    def potential_energy(self, q: ArrayLike) -> float:
        """Potential energy of weight and buoyancy, zero for a point at the world's origin [J].

        Its gradient is `hydrostatic_torque`. link_0 counts, on a fixed base as a constant.
        """
        q = self._clean_q(q)
        energy: float = _potential_energy(self._net, self._own.net_data, q)
        total: float = energy + self._fixed_potential
        return total

    def center_of_mass(self, q: ArrayLike) -> FloatArray:
        """Centre of mass of the whole arm, link_0 included, in base_link, (3,) [m]."""
        q = self._in_base(q)
        out: FloatArray = _center_of_mass(self._model, self._own.data, q)
        out *= self._moving_fraction
        out += self._fixed_fraction
        return out

    def center_of_buoyancy(self, q: ArrayLike) -> FloatArray:
        """Centroid of the displaced volume of the whole arm, link_0 included, in base_link, (3,) [m].

        It does not depend on the fluid, and is there in air too.

        Raises:
            InputError: Also for an arm that displaces nothing.
        """
        q = self._in_base(q)
        if not self._volume:
            raise InputError("displacements", self.displacements, "a volume above 0")
        data = self._own.data
        _forward_kinematics(self._model, data, q)
        moment = np.zeros(3)
        for body in self.displacements:
            placement = data.oMi[self._model.getJointId(body.joint)]
            moment += body.volume * placement.act(np.array(body.cob))
        return moment / self._volume

    def in_collision(self, q: ArrayLike) -> bool:
        """Whether the arm touches itself at q, (nq,).

        The bodies are primitives that enclose the drawn ones within 3 mm; links that turn against each
        other at a joint are not compared, and a payload has no body.
        """
        return self._own.collisions.in_collision(self._clean_q(q))

    def collision_distance(self, q: ArrayLike) -> float:
        """Smallest distance between two links that `in_collision` compares [m]; negative inside.

        `alpha5_model.dynamics.collision.CollisionModel` also says where.
        """
        return self._own.collisions.clearance(self._clean_q(q)).distance

    def _frame(self, name: str) -> int:
        try:
            return self._frames[name]
        except (KeyError, TypeError):
            raise UnknownNameError("frame", name, self._frames) from None

    def _in_base(self, q: ArrayLike) -> FloatArray:
        """q with base_link at the world's origin."""
        checked: FloatArray = self._clean_q(q)
        if self.floating_base:
            checked = checked.copy()
            checked[:7] = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
        return checked
