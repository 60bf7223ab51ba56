"""What an arm consists of: its models, their limits, and memory to compute in.

`alpha5_model.dynamics.arm` adds what an arm computes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, partial
from typing import Any, Self

import pinocchio as pin

from alpha5_model._support.checks import FloatArray, frozen, instance, listed, real
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.dynamics.buoyancy import (
    Displacement,
    check_inertias,
    displaced_fluid_model,
)
from alpha5_model.dynamics.joint_tree import (
    JointTree,
    mimicking,
    tree_of_model,
    tree_on_free_flyer,
    tree_under_mimics,
)
from alpha5_model.dynamics.kernel_numbers import kernel_parameters
from alpha5_model.dynamics.scratch import Scratch
from alpha5_model.dynamics.states import state_check
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.kinematics.limits import Limits
from alpha5_model.numbers import parameters as records
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.numbers.jaws import Gripper
from alpha5_model.numbers.parameters import Alpha5Parameters

_CheckOfOne = Callable[..., FloatArray]
_Check = Callable[..., Sequence[FloatArray]]


class ArmModel:
    """The models of an arm and of the fluid that it displaces.

    `alpha5_model.dynamics.arm.Arm` documents the arguments and attributes.
    """

    #: Whether the arm has added mass and drag.
    has_hydrodynamics = False

    def __init__(
        self,
        model: pin.Model,
        displacements: Iterable[Displacement],
        fluid_density: float = SEA_WATER,
        mimics: Iterable[UrdfJoint] = (),
        *,
        parameters: Alpha5Parameters | None = None,
    ) -> None:
        if not isinstance(model, pin.Model) or not pin.computeTotalMass(model):
            raise InputError("model", model, "a pin.Model with moving masses")
        self.displacements = tuple(
            instance("displacements", volume, Displacement)
            for volume in listed("displacements", displacements, "Displacements")
        )
        self.fluid_density = real("fluid_density", fluid_density, minimum=0.0)
        own = records.parameters() if parameters is None else parameters
        self.parameters = instance("parameters", own, Alpha5Parameters)
        self.floating_base = model.joints[1].nq == 7
        check_inertias(model)

        self._mimics = tuple(mimics)
        self._own_joints = model.copy()
        self._model = mimicking(model, self._mimics)
        self._fluid = self._displaced_fluid(self._model)
        self.model = self._model.copy()
        self.fluid_model = self._fluid.copy()
        self._scratch = Scratch(self._model, self._fluid, self.model)

        self._frames = {frame.name: i for i, frame in enumerate(self._model.frames)}
        # Checks of a state, which they return converted.
        self._clean_q: _CheckOfOne = state_check(self._model)
        self._clean_qv: _Check = state_check(self._model, "v")
        self._clean_qva: _Check = state_check(self._model, "v", "a")
        self._clean_qvtau: _Check = state_check(self._model, "v", "tau")

    @property
    def data(self) -> Any:
        """pin.Data of `model`, for the caller: one for each thread.

        No method changes it.
        """
        return self._scratch.callers_data

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints that q runs over, base to tip, without the free-flyer."""
        names = list(self._model.names)[1:]
        joints = list(self._model.joints)[1:]
        return tuple(
            name for name, joint in zip(names, joints, strict=True) if joint.nv == 1
        )

    @property
    def gripper(self) -> Gripper:
        """``jaws`` if axis_a moves them, or ``locked``; see `alpha5_model.load`."""
        return "jaws" if "finger_1" in self._frames else "locked"

    @property
    def limits(self) -> Limits:
        """Limits of the joints, in the order of `joint_names`."""
        model = self._model
        n = len(self.joint_names)
        return Limits(
            lower=frozen(model.lowerPositionLimit[-n:]),
            upper=frozen(model.upperPositionLimit[-n:]),
            velocity=frozen(model.velocityLimit[-n:]),
            effort=frozen(model.effortLimit[-n:]),
        )

    @cached_property
    def total_mass(self) -> float:
        """Mass of the whole arm, link_0 included [kg].

        ``pin.computeTotalMass(arm.model)`` leaves out what is fixed to the universe:
        link_0 on a fixed base.
        """
        return float(sum(body.mass for body in self._model.inertias))

    @cached_property
    def displaced_volume(self) -> float:
        """Volume that the whole arm displaces, link_0 included [m^3]."""
        return float(sum(body.volume for body in self.displacements))

    @cached_property
    def _joint_tree(self) -> JointTree:
        """The tree in which each joint has coordinates of its own."""
        if not self._mimics:
            return tree_of_model(self._model, self._fluid)
        tree = self._own_joints
        fluid = self._displaced_fluid(tree)
        return tree_under_mimics(self._model, tree, fluid, self._mimics)

    def _displaced_fluid(self, model: pin.Model) -> pin.Model:
        return displaced_fluid_model(model, self.displacements, self.fluid_density)

    @cached_property
    def _floating_tree(self) -> JointTree:
        """The same tree on a free-flyer, whose six torques load the mount."""
        if self.floating_base:
            return self._joint_tree
        return tree_on_free_flyer(self._joint_tree)

    @cached_property
    def _kernel_parameters(self) -> FloatArray | None:
        return kernel_parameters(self)

    @property
    def _constructor_arguments(self) -> tuple[Any, ...]:
        """The positional arguments that make the same arm."""
        # Pinocchio 4.1 crashes with a pickled model that has mimic joints.
        model = self._own_joints
        return model, self.displacements, self.fluid_density, self._mimics

    def _rebuilt(self, model: pin.Model, displacements: Iterable[Displacement]) -> Self:
        """An arm like this one, from another model and its volumes.

        Args:
            model: pin.Model in which each joint has coordinates of its own.
            displacements: The volumes on its joints.
        """
        return type(self)(
            model,
            displacements,
            self.fluid_density,
            self._mimics,
            parameters=self.parameters,
        )

    def _in_gravity(self, gravity: FloatArray) -> Self:
        """The same arm in another gravity, (3,), in the frame of this one's [m/s^2]."""
        model = self._own_joints.copy()
        model.gravity.linear = gravity
        return self._rebuilt(model, self.displacements)

    def _frame(self, name: str) -> int:
        try:
            return self._frames[name]
        except (KeyError, TypeError):
            raise UnknownNameError("frame", name, [*self._frames, "tip"]) from None

    @property
    def payload_mass(self) -> float:
        """Mass of all payloads that the arm holds [kg]."""
        frames = self._model.frames
        held = [f.inertia.mass for f in frames if f.name.startswith("payload")]
        return float(sum(held))

    def __reduce__(self) -> tuple[Any, ...]:
        rebuild = partial(type(self), parameters=self.parameters)
        return rebuild, self._constructor_arguments

    def __repr__(self) -> str:
        base = "floating" if self.floating_base else "fixed"
        parts = [f"fluid {self.fluid_density:g} kg/m^3"]
        for frame in self._model.frames:
            if frame.name.startswith("payload"):
                parts.append(f"{frame.name} {frame.inertia.mass:g} kg")
        joints = ", ".join(self.joint_names)
        contents = ", ".join(parts)
        return f"{type(self).__name__}({joints}; {base} base, {contents})"
