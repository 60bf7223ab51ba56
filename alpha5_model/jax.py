"""The arm's equations in JAX: to compile, map over batches and differentiate.

    from alpha5_model.jax import load

    arm = load(fluid_density=1000.0)
    tau = jax.jit(arm.inverse_dynamics)(q, v, a)
    batch = jax.jit(jax.vmap(arm.forward_dynamics))(q, v, tau)       # rows of states

    def torque(mass):
        return arm.with_payload(mass).inverse_dynamics(q, v, a)[1]

    slope = jax.grad(torque)(0.5)

Results have the precision of the input. Without ``jax_enable_x64``, JAX computes in
float32, torques then to some 1e-6. Compile what you call more than once: without
``jax.jit``, each of some hundred operations is a call of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from alpha5_model._support.checks import FloatArray, instance
from alpha5_model.codegen.payload import slope_by_moments_at_the_tcp
from alpha5_model.collision.approximate_distance import SMOOTHING as _SMOOTHING
from alpha5_model.collision.approximate_distance import (
    Operations,
    approximate_distance,
    checked_smoothing,
    spheres_and_shapes,
)
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernel_numbers import arm_dimensions, arm_parameters
from alpha5_model.dynamics.load import load as load_arm
from alpha5_model.errors import ShapeError, needing
from alpha5_model.kernels.generated import formulas
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.tolerances import DOUBLE, SINGLE
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

with needing("alpha5_model.jax", "pip install jax"):
    import jax.numpy as jnp
    from jax import Array, jacfwd, jit
    from jax.scipy.special import logsumexp
    from jax.tree_util import register_dataclass
    from jax.tree_util import tree_leaves as leaves

#: Anything that JAX or NumPy reads as real numbers.
Numbers: TypeAlias = Any
Arrays: TypeAlias = tuple[Array, ...]


class Solutions(NamedTuple):
    """All solutions of one target, as `alpha5_model.inverse_kinematics` has them.

    Attributes:
        q: (4, 4): branch (`alpha5_model.BRANCHES`) and joint [rad]; NaN if the branch
            does not reach the target. Its derivatives then mean nothing.
        exists, within_limits: (4,).
        singular: ().
    """

    q: Array
    exists: Array
    within_limits: Array
    singular: Array


@partial(
    register_dataclass,
    data_fields=("parameters", "fluid_density", "dimensions", "payload_slope"),
    meta_fields=(),
)
@dataclass(frozen=True, eq=False)
class JaxArm:
    """The arm on a fixed base with its jaws locked.

    It is a pytree, so that it can go through JAX's transformations. Methods are those
    of `alpha5_model.Arm`; q, v, a and tau are (4,), and `jax.vmap` adds axes.

    Attributes:
        parameters: 38 base parameters and gravity, (41,), see
            `alpha5_model.codegen.regrouping`. A NumPy array is folded into what is
            compiled; a JAX array is an input like any other.
        fluid_density: Around a payload [kg/m^3].
        dimensions: Lengths, zeros and tool, (24,), see
            `alpha5_model.kinematics.geometry`.
        payload_slope: Of the parameters by the moments of a body at the tcp, (41, 32).
    """

    parameters: Any
    fluid_density: Any
    dimensions: Any
    payload_slope: Any

    @property
    def _numbers(self) -> Any:
        """The last input of the dynamics: base parameters, then dimensions."""
        parts = self.parameters, self.dimensions
        if any(map(_is_for_jax, parts)):
            return jnp.concatenate([jnp.asarray(part) for part in parts])
        return np.concatenate(parts)

    def forward_kinematics(self, q: Numbers) -> Array:
        """Pose of the tcp in base_link, (4, 4)."""
        return _only("forward_kinematics", q, self._numbers)

    def link_poses(self, q: Numbers) -> Arrays:
        """Poses of link_1 to link_4 in base_link, (4, 4) each."""
        return _computed("link_poses", q, self._numbers)

    def jacobian(self, q: Numbers) -> Array:
        """Of the tcp in the axes of base_link, (6, 4): linear above angular."""
        return _only("jacobian", q, self._numbers)

    def gravity_torque(self, q: Numbers) -> Array:
        """Torque that holds the weight, (4,) [N m]."""
        return _only("gravity_torque", q, self._numbers)

    def buoyancy_torque(self, q: Numbers) -> Array:
        """Torque that the water applies, (4,) [N m]."""
        return _only("buoyancy_torque", q, self._numbers)

    def hydrostatic_torque(self, q: Numbers) -> Array:
        """Torque that holds the arm still in the water, (4,) [N m]."""
        return _only("hydrostatic_torque", q, self._numbers)

    def hydrostatic_torque_derivative(self, q: Numbers) -> Array:
        """With respect to q, (4, 4)."""
        slope: Array = jacfwd(self.hydrostatic_torque)(_given_to_jax(q))
        return slope

    def mass_matrix(self, q: Numbers) -> Array:
        """M(q), (4, 4) [kg m^2]."""
        return _only("mass_matrix", q, self._numbers)

    def coriolis_matrix(self, q: Numbers, v: Numbers) -> Array:
        """C(q, v), (4, 4)."""
        return _only("coriolis_matrix", q, v, self._numbers)

    def nonlinear_effects(self, q: Numbers, v: Numbers) -> Array:
        """``C(q, v) v + hydrostatic_torque(q)``, (4,) [N m]."""
        return _only("nonlinear_effects", q, v, self._numbers)

    def inverse_dynamics(self, q: Numbers, v: Numbers, a: Numbers) -> Array:
        """Joint torque for a motion, water included, (4,) [N m]."""
        return _only("inverse_dynamics", q, v, a, self._numbers)

    def inverse_dynamics_derivatives(
        self, q: Numbers, v: Numbers, a: Numbers
    ) -> Arrays:
        """dtau/dq, dtau/dv, dtau/da = M, (4, 4) each."""
        return _derivatives(self.inverse_dynamics, q, v, a)

    def forward_dynamics(self, q: Numbers, v: Numbers, tau: Numbers) -> Array:
        """Joint acceleration under a torque, water included, (4,) [rad/s^2]."""
        return _only("forward_dynamics", q, v, tau, self._numbers)

    def forward_dynamics_derivatives(
        self, q: Numbers, v: Numbers, tau: Numbers
    ) -> Arrays:
        """da/dq, da/dv, da/dtau = M^-1, (4, 4) each."""
        return _derivatives(self.forward_dynamics, q, v, tau)

    def base_wrench(self, q: Numbers, v: Numbers, a: Numbers) -> Array:
        """Force above moment that the arm exerts on its mount, (6,) [N, N m].

        Both are at the origin and in the axes of base_link.
        """
        return _only("base_wrench", q, v, a, self._numbers)

    def base_wrench_derivatives(self, q: Numbers, v: Numbers, a: Numbers) -> Arrays:
        """dw/dq, dw/dv, dw/da, (6, 4) each."""
        return _derivatives(self.base_wrench, q, v, a)

    def with_payload(
        self,
        mass: Numbers,
        com: Numbers = (0.0, 0.0, 0.0),
        inertia: Numbers | None = None,
        volume: Numbers = 0.0,
        cob: Numbers | None = None,
    ) -> JaxArm:
        """A new arm that holds a rigid body fixed to its tcp.

        Args:
            mass: [kg]. No number is checked, since each may be what you look for.
            com: Centre of mass in tcp, (3,) [m].
            inertia: At the COM in the axes of tcp, (3, 3) [kg m^2]; None for a point
                mass.
            volume: Displaced volume [m^3].
            cob: Centre of buoyancy in tcp, (3,) [m]; None for the COM.
        """
        body = (
            mass,
            com,
            np.zeros((3, 3)) if inertia is None else inertia,
            volume,
            com if cob is None else cob,
            self.fluid_density,
        )
        moments = _only("moments_of_body", *body)
        parameters = self.parameters + self.payload_slope @ moments
        return replace(self, parameters=parameters)


def load(arm: Arm | None = None, **options: Any) -> JaxArm:
    """The equations of an arm.

    Args:
        arm: On a fixed base with its jaws locked; ``a5.load(**options)`` if None.
        options: Of `alpha5_model.load`.

    Raises:
        InputError: The arm's base floats, or its jaws move.
    """
    arm = load_arm(**options) if arm is None else instance("arm", arm, Arm)
    return JaxArm(
        parameters=arm_parameters(arm),
        fluid_density=arm.fluid_density,
        dimensions=arm_dimensions(arm),
        payload_slope=slope_by_moments_at_the_tcp(arm.parameters),
    )


def inverse_kinematics(
    position: Numbers,
    wrist: Numbers = 0.0,
    *,
    arm: Alpha5Parameters | None = None,
) -> Solutions:
    """All joint positions that put the tcp at a point.

    If a branch does not reach the target, its joint positions are NaN and their
    derivatives mean nothing.

    Args:
        position: tcp in base_link, (3,) [m].
        wrist: theta_3 [rad].
        arm: Record of the arm; None is the catalogue's. Its lengths, zeros, limits and
            tool point are constants of what is compiled.
    """
    geometry = Geometry.of(chosen_arm(arm))
    is_single = jnp.result_type(_given(position), float) == np.float32
    numbers = geometry.ik_parameters_with(SINGLE if is_single else DOUBLE)
    q, exists, within, singular = _computed(
        "inverse_kinematics", position, wrist, numbers
    )
    return Solutions(
        q=q,
        exists=exists,
        within_limits=within,
        singular=singular[0],
    )


def approximate_collision_distance(
    q: Numbers, *, arm: Alpha5Parameters | None = None, smoothing: float = _SMOOTHING
) -> Array:
    """An approximate distance of the arm from itself with its jaws closed, () [m].

    It is smooth, for optimisers, and counts the parts that can touch within the joint
    limits. At thousands of random positions of the catalogue's arm it was within 12 mm
    of their exact distance, mostly some millimetres too small, and above 0 only if the
    arm was free. Of arms with other lengths it was up to 2 mm above 0 in a contact.
    Check results with `Arm.in_collision`, which is exact.

    Args:
        q: Joint positions, (4,) [rad].
        arm: Record of the arm; None is the catalogue's. Its numbers are constants of
            what is compiled.
        smoothing: s of the soft minimum [m], see
            `alpha5_model.collision.approximate_distance`. A larger one is smoother, and
            makes the distance smaller.

    Raises:
        InputError: ``smoothing`` is not above 0, or ``arm`` is no record.
        ShapeError: Not (4,).
    """
    angles = jnp.asarray(_given(q))
    if angles.shape != (4,):
        raise ShapeError("q", angles.shape, "shape (4,)")
    record = chosen_arm(arm)
    softness = checked_smoothing(smoothing)
    distance: Array = _approximate_distance(angles, record, softness)
    return distance


@partial(jit, static_argnums=(1, 2))
def _approximate_distance(
    angles: Array, arm: Alpha5Parameters, smoothing: float
) -> Array:
    """`approximate_collision_distance`, compiled: it has too many operations."""
    dtype = jnp.result_type(angles, float)
    operations = Operations(
        constant=partial(jnp.asarray, dtype=dtype),
        cos=jnp.cos,
        sin=jnp.sin,
        absolute=jnp.abs,
        sqrt=jnp.sqrt,
        maximum=jnp.maximum,
        side_by_side=jnp.hstack,
        soft_minimum=_soft_minimum,
    )
    distance: Array = approximate_distance(
        spheres_and_shapes(arm), [*angles.astype(dtype)], smoothing, operations
    )
    return distance


def _soft_minimum(found: list[Array], smoothing: float) -> Array:
    """The soft minimum of all elements of arrays."""
    every = jnp.concatenate([jnp.ravel(part) for part in found])
    return jnp.asarray(-smoothing * logsumexp(-every / smoothing))


def _derivatives(function: Any, *state: Numbers) -> Arrays:
    """The Jacobians of a function by each part of a state."""
    slopes = jacfwd(function, argnums=(0, 1, 2))(*map(_given_to_jax, state))
    return tuple(slopes)


def _given_to_jax(value: Numbers) -> Array:
    """What derivatives are taken by: in JAX's precision."""
    return jnp.asarray(_given(value))


def _only(name: str, *given: Numbers) -> Array:
    """The one output of a formula."""
    (result,) = _computed(name, *given)
    return result


def _computed(name: str, *given: Numbers) -> Arrays:
    """The outputs of a formula."""
    formula: Any
    formula, inputs, outputs = formulas.KERNELS[name]
    elements = [
        _elements(name, x, shape) for x, shape in zip(given, inputs, strict=True)
    ]
    results = formula(*elements, jnp)
    return tuple(_array(r, shape) for r, shape in zip(results, outputs, strict=True))


def _elements(name: str, value: Numbers, shape: tuple[int, ...]) -> Array | list[float]:
    """Entries, row by row.

    Those of JAX stay as they are. Others become numbers, which leave the precision to
    those of JAX.
    """
    array = _given(value)
    is_number = array.shape == () and shape == (1,)
    if array.shape != shape and not is_number:
        raise ShapeError(f"an input of {name}", array.shape, f"shape {shape}")

    flat = array.reshape(-1)
    return flat if isinstance(flat, Array) else flat.tolist()


def _given(value: Numbers) -> Array | FloatArray:
    """JAX's array if any part is one or has single precision, else NumPy's."""
    if any(_is_for_jax(leaf) for leaf in leaves(value)):
        return jnp.asarray(value)
    return np.asarray(value, np.float64)


def _is_for_jax(leaf: Any) -> bool:
    return isinstance(leaf, Array) or getattr(leaf, "dtype", 0) == np.float32


def _array(elements: Sequence[Any], shape: tuple[int, ...]) -> Any:
    """An array of elements: NumPy's if all are numbers, so that they stay folded."""
    if all(isinstance(x, float) for x in elements):
        return np.array(elements).reshape(shape)
    return jnp.stack(elements).reshape(shape)
