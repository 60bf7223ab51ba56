"""The arm's equations as CasADi Functions, for optimal control and estimation.

    from alpha5_model.casadi import load

    arm = load(fluid_density=1000.0)
    tau = arm.inverse_dynamics(q, v, a)  # of numbers, SX or MX
    print(arm.inverse_dynamics.__doc__)  # names, shapes and units

They are of SX kind, so that all of CasADi works on them, and are interpreted. From
Python, ``f.buffer()`` is far faster than a plain call. ``alpha5 generate c``
writes the same functions as C.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from alpha5_model._support.checks import flag, instance
from alpha5_model.codegen.arm_functions import (
    SUMMARIES,
    casadi,
    inverse_kinematics_of,
    products,
)
from alpha5_model.codegen.casadi_functions import folded
from alpha5_model.codegen.instructions import program
from alpha5_model.collision.approximate_distance import (
    SMOOTHING,
    Operations,
    approximate_distance,
    checked_smoothing,
    spheres_and_shapes,
)
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernel_numbers import arm_parameters
from alpha5_model.dynamics.load import load as load_arm
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

__all__ = ["approximate_collision_distance", "inverse_kinematics", "load"]


def load(
    arm: Arm | None = None, *, fold: bool = True, **options: Any
) -> SimpleNamespace:
    """The equations of an arm.

    Args:
        arm: On a fixed base with its jaws locked; ``a5.load(**options)`` if None.
        fold: Put its parameters into the Functions. Otherwise they are the last input,
            named ``parameters``, of every Function that depends on them.
        options: Of `alpha5_model.load`.

    Returns:
        casadi.Functions by the names of `Arm`'s methods, ``link_poses`` and
        ``inverse_kinematics``, each with names, shapes and units in its ``__doc__``.
        Poses are (4, 4), flags 0 or 1. ``parameters`` are the arm's 38 base parameters
        and its gravity, (41,); ``with_payload`` makes those of the arm that holds a
        body.

    Raises:
        InputError: The arm's base floats, or its jaws move.
    """
    arm = load_arm(**options) if arm is None else instance("arm", arm, Arm)
    base_parameters = arm_parameters(arm)
    known: dict[str, Any] = {"fluid_density": arm.fluid_density}
    if flag("fold", fold):
        known["parameters"] = base_parameters

    out = SimpleNamespace(parameters=base_parameters)
    for name, function in products(arm.parameters).items():
        made = folded(function, **_inputs_to_fold(function, known))
        made.__doc__ = program(made).documentation(SUMMARIES[name])
        setattr(out, name, made)
    return out


def inverse_kinematics(arm: Alpha5Parameters | None = None) -> casadi.Function:
    """The inverse kinematics of an arm with any lengths, zeros, limits and tool point.

    Args:
        arm: Record of the arm, whose numbers become constants; None is the catalogue's.

    Returns:
        casadi.Function of ``position`` (3,) [m] and ``wrist`` [rad], with the outputs
        ``q`` (4, 4) [rad], ``exists`` and ``within_limits`` (4,), and ``singular``, as
        in `load`.

    Raises:
        InputError: Not a vertical plane with two links in it.
    """
    made = inverse_kinematics_of(chosen_arm(arm))
    made.__doc__ = program(made).documentation(SUMMARIES["inverse_kinematics"])
    return made


def approximate_collision_distance(
    arm: Alpha5Parameters | None = None, *, smoothing: float = SMOOTHING
) -> casadi.Function:
    """An approximate distance of an arm from itself with its jaws closed.

    It is smooth, for optimisers, and counts the parts that can touch within the joint
    limits. At thousands of random positions of the catalogue's arm it was within 12 mm
    of their exact distance, mostly some millimetres too small, and above 0 only if the
    arm was free. Of arms with other lengths it was up to 2 mm above 0 in a contact.
    Check results with `Arm.in_collision`, which is exact.

    Args:
        arm: Record of the arm, whose numbers become constants; None is the catalogue's.
        smoothing: s of the soft minimum [m], see
            `alpha5_model.collision.approximate_distance`. A larger one is smoother, and
            makes the distance smaller.

    Returns:
        casadi.Function of ``q`` (4,) [rad] with the output ``distance`` [m].

    Raises:
        InputError: ``smoothing`` is not above 0, or ``arm`` is no record.
    """
    q: Any = casadi.SX.sym("q", 4)
    operations = Operations(
        constant=casadi.DM,
        cos=casadi.cos,
        sin=casadi.sin,
        absolute=casadi.fabs,
        sqrt=casadi.sqrt,
        maximum=casadi.fmax,
        side_by_side=lambda matrices: casadi.horzcat(*matrices),
        soft_minimum=_soft_minimum,
    )
    distance = approximate_distance(
        spheres_and_shapes(chosen_arm(arm)),
        casadi.vertsplit(q),
        checked_smoothing(smoothing),
        operations,
    )
    made = casadi.Function(
        "approximate_collision_distance", [q], [distance], ["q"], ["distance"]
    )
    made.__doc__ = (
        "approximate_collision_distance(q[4]) -> distance\n\n"
        "Approximate distance of the arm from itself, smooth; q [rad], distance [m]."
    )
    return made


def _soft_minimum(found: list[Any], smoothing: float) -> Any:
    """The soft minimum of all elements of matrices."""
    every = casadi.vertcat(*[casadi.vec(part) for part in found])
    least = casadi.mmin(every)
    return least - smoothing * casadi.log(
        casadi.sum1(casadi.exp((least - every) / smoothing))
    )


def _inputs_to_fold(function: casadi.Function, known: dict[str, Any]) -> dict[str, Any]:
    """The known inputs of a function; ``with_payload`` keeps its parameters free."""
    given = {name: known[name] for name in function.name_in() if name in known}
    if function.name() == "with_payload":
        given.pop("parameters", None)
    return given
