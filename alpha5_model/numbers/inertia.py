"""Conversions and checks of rigid-body inertia: pure functions on arrays.

Conventions: a *tensor* is (..., 3, 3) [kg m^2]. Its products of inertia are negative
integrals, ``I_xy = -(integral of x y dm)``, as in URDF, Pinocchio and textbooks.
SolidWorks prints them with the opposite sign. ``com`` is (..., 3) [m] and ``mass``
(...) [kg]. Other input raises an `InputError`, and leading shapes that do not broadcast
raise a `ShapeError`.

References:
    [Wensing2018] Wensing, Kim, Slotine: Linear matrix inequalities for physically
        consistent inertial parameter identification, IEEE RA-L 3(1), 2018.
    [Traversaro2016] Traversaro, Brossette, Escande, Nori: Identification of fully
        physical consistent inertial parameters using optimization on manifolds, IROS
        2016.
    [Bhatia2000] Bhatia, Davis: A better bound on the variance, Amer. Math. Monthly
        107(4), 2000.
    [ReachAlpha] Manufacturer's document, Section 2.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    bounded,
    fitting,
    is_rotation,
    real,
)
from alpha5_model.errors import InputError

#: Relative error of a tensor by rounding.
_ROUNDING = 1e-12


def flip_products(inertia: ArrayLike) -> FloatArray:
    """Change the sign of the products of inertia: SolidWorks to URDF, and back.

    [ReachAlpha] prints ``+(integral of x y dm)`` off the diagonal; URDF expects the
    negative.

    Args:
        inertia: (..., 3, 3) [kg m^2].

    Returns:
        (..., 3, 3), the same diagonal, every off-diagonal entry negated.
    """
    (tensor,) = _broadcastable(inertia=inertia)
    return np.where(np.eye(3, dtype=bool), tensor, -tensor)


def point_mass_tensor(mass: ArrayLike, position: ArrayLike) -> FloatArray:
    """Tensor of a point mass about the origin, ``m ((p . p) E_3 - p p^T)``.

    This is the parallel-axis term. The document's equation (1) prints ``(p . p)^T`` for
    the outer product and equation (2) prints ``+m skew(p)^2`` where ``-m skew(p)^2`` is
    meant.

    Args:
        mass: (...) [kg].
        position: (..., 3) [m].

    Returns:
        (..., 3, 3) [kg m^2].
    """
    m, p = _broadcastable(mass=mass, position=position)
    return _point_mass_tensor(m, p)


def _point_mass_tensor(m: FloatArray, p: FloatArray) -> FloatArray:
    m = m[..., None, None]
    square = np.einsum("...i,...i->...", p, p)[..., None, None]
    return np.asarray(m * (square * np.eye(3) - p[..., :, None] * p[..., None, :]))


def tensor_at_origin(
    mass: ArrayLike, com: ArrayLike, inertia_com: ArrayLike
) -> FloatArray:
    """Parallel-axis theorem, from the COM to the origin of the frame.

    Args:
        mass: (...) [kg].
        com: (..., 3) [m].
        inertia_com: (..., 3, 3) about the COM [kg m^2].

    Returns:
        (..., 3, 3) about the origin, same axes [kg m^2].
    """
    m, c, tensor = _broadcastable(mass=mass, com=com, inertia_com=inertia_com)
    return tensor + _point_mass_tensor(m, c)


def tensor_at_com(
    mass: ArrayLike, com: ArrayLike, inertia_origin: ArrayLike
) -> FloatArray:
    """Parallel-axis theorem, from the origin to the COM; see `tensor_at_origin`."""
    m, c, tensor = _broadcastable(mass=mass, com=com, inertia_origin=inertia_origin)
    return tensor - _point_mass_tensor(m, c)


def rotate_tensor(rotation_a_to_b: ArrayLike, inertia: ArrayLike) -> FloatArray:
    """Tensor in the axes of {b} from the tensor in the axes of {a}, ``R I R^T``.

    Args:
        rotation_a_to_b: (..., 3, 3), maps coordinates in {a} to coordinates in {b}.
        inertia: (..., 3, 3) in {a} [kg m^2].

    Returns:
        (..., 3, 3) in {b} [kg m^2].

    Raises:
        InputError: ``rotation_a_to_b`` is not a rotation.
    """
    r, tensor = _broadcastable(rotation_a_to_b=rotation_a_to_b, inertia=inertia)
    if not is_rotation(r).all():
        raise InputError(
            "rotation_a_to_b", r.tolist(), "rotations: orthonormal, determinant +1"
        )
    return r @ tensor @ np.swapaxes(r, -1, -2)


def combine(
    masses: ArrayLike, coms: ArrayLike, inertias: ArrayLike
) -> tuple[float, FloatArray, FloatArray]:
    """Mass, COM and tensor of rigidly joined bodies; a negative mass removes a body.

    Args:
        masses: (N,) [kg].
        coms: (N, 3) [m], in one common frame.
        inertias: (N, 3, 3), each about its own COM, in that frame's axes [kg m^2];
            that of a removed body is negated like its mass.

    Returns:
        Mass [kg], COM (3,) [m], tensor about that COM (3, 3) [kg m^2].

    Raises:
        InputError: The masses add up to zero, so there is no COM.
    """
    (m,) = fitting(masses=(masses, ()))
    n = m.size
    m = array("masses", m, n)
    c = array("coms", coms, n, 3)
    tensors = array("inertias", inertias, n, 3, 3)
    mass = float(m.sum())
    if mass == 0:
        raise InputError("masses", m.tolist(), "masses that do not add up to zero")
    com = (m[:, None] * c).sum(axis=0) / mass
    return mass, com, (tensors + _point_mass_tensor(m, c - com)).sum(axis=0)


def second_moments(inertia: ArrayLike) -> FloatArray:
    """Second moments of mass, ``integral of r r^T dm = tr(I)/2 E_3 - I``.

    See [Wensing2018, eq. 8].

    Args:
        inertia: (..., 3, 3) about any point [kg m^2].

    Returns:
        (..., 3, 3) about the same point [kg m^2].
    """
    (tensor,) = _broadcastable(inertia=inertia)
    return _second_moments(tensor)


def _second_moments(tensor: FloatArray) -> FloatArray:
    trace = np.trace(tensor, axis1=-2, axis2=-1)[..., None, None]
    return np.asarray(trace / 2 * np.eye(3) - tensor)


def pseudo_inertia(
    mass: ArrayLike, com: ArrayLike, inertia_com: ArrayLike
) -> FloatArray:
    """The 4x4 pseudo-inertia ``[[Sigma, m c], [m c^T, m]]`` about the origin.

    See [Wensing2018, eq. 7]. A body is physically possible exactly when it is positive
    definite.

    Args:
        mass: (...) [kg].
        com: (..., 3) [m].
        inertia_com: (..., 3, 3) about the COM [kg m^2].

    Returns:
        (..., 4, 4).
    """
    return _pseudo_inertia(*_broadcastable(mass=mass, com=com, inertia_com=inertia_com))


def _pseudo_inertia(m: FloatArray, c: FloatArray, tensor: FloatArray) -> FloatArray:
    sigma = _second_moments(tensor + _point_mass_tensor(m, c))
    out = np.empty((*sigma.shape[:-2], 4, 4))
    out[..., :3, :3] = sigma
    out[..., :3, 3] = out[..., 3, :3] = m[..., None] * c
    out[..., 3, 3] = m
    return out


def principal_moments(inertia: ArrayLike) -> FloatArray:
    """Eigenvalues of the symmetric part, ascending, (..., 3) [kg m^2]."""
    (tensor,) = _broadcastable(inertia=inertia)
    return _principal_moments(tensor)


def _principal_moments(tensor: FloatArray) -> FloatArray:
    symmetric = (tensor + np.swapaxes(tensor, -1, -2)) / 2
    return np.asarray(np.linalg.eigvalsh(symmetric), dtype=np.float64)


def inconsistencies(
    mass: float,
    com: ArrayLike,
    inertia_com: ArrayLike,
    bounds: ArrayLike | None = None,
    tolerance: float = _ROUNDING,
) -> tuple[str, ...]:
    """What makes one body physically impossible; empty if nothing does.

    The conditions are a positive mass, a symmetric and positive definite tensor, the
    triangle inequality of the principal moments, and a positive definite pseudo-inertia
    [Traversaro2016, Wensing2018]. If the body's outer bounds are given, the COM must
    also lie inside, and along each axis the variance of the mass must be at most
    ``(max - com)(com - min)`` [Bhatia2000]. The bounds reveal errors that satisfy the
    triangle inequality: a tensor about the link frame instead of the COM, a COM on the
    wrong side, a guessed inertia of a larger body.

    Args:
        mass: [kg].
        com: (3,) [m].
        inertia_com: (3, 3) about the COM [kg m^2].
        bounds: (3, 2), min and max of the body along each axis [m].
        tolerance: Relative slack of the triangle inequality, the symmetry and the
            bounds, for rounding. The pseudo-inertia must be positive definite without
            slack.

    Returns:
        One short sentence for each violated condition.

    Raises:
        InputError: Not finite real numbers; ShapeError: of other shapes.
    """
    mass = real("mass", mass)
    tolerance = real("tolerance", tolerance, minimum=0.0)
    c = array("com", com, 3)
    tensor = array("inertia_com", inertia_com, 3, 3)
    found = _violations(mass, c, tensor, tolerance)
    if bounds is not None:
        box = array("bounds", bounds, 3, 2)
        found += _beyond_bounds(mass, c, tensor, box, tolerance)
    return tuple(found)


def _violations(
    mass: float, com: FloatArray, tensor: FloatArray, tolerance: float
) -> list[str]:
    """Conditions on mass, COM and tensor that do not hold."""
    slack = tolerance * float(np.abs(tensor).max())
    small, middle, large = _principal_moments(tensor)
    others = small + middle
    found = []
    if mass <= 0:
        found.append(f"mass {mass:g} kg is not positive")
    if np.abs(tensor - tensor.T).max() > slack:
        found.append("the inertia tensor is not symmetric")
    if small <= slack:
        found.append(
            f"the smallest principal moment {small:.4g} kg m^2 is not positive"
        )
    if large > others * (1 + tolerance):
        found.append(
            f"the largest principal moment {large:.4g} kg m^2 "
            f"exceeds the sum of the others, {others:.4g}"
        )
    pseudo_inertia = _pseudo_inertia(np.asarray(mass), com, tensor)
    if not found and np.linalg.eigvalsh(pseudo_inertia)[0] <= 0:
        found.append("the pseudo-inertia is not positive definite")
    return found


def _beyond_bounds(
    mass: float, com: FloatArray, tensor: FloatArray, box: FloatArray, tolerance: float
) -> list[str]:
    """Axes along which the COM, or the spread of mass, does not fit the box (3, 2)."""
    variances = np.zeros(3)
    if mass > 0:
        variances = np.diagonal(_second_moments(tensor)) / mass

    found = []
    for axis, (low, high), position, variance in zip(
        "xyz", box, com, variances, strict=True
    ):
        largest = (high - position) * (position - low)
        if not low <= position <= high:
            place = f"{axis} = {position * 1e3:.1f} mm"
            span = f"{low * 1e3:.1f} to {high * 1e3:.1f} mm"
            found.append(f"the COM's {place} is outside the body, {span}")
        elif variance > largest * (1 + tolerance):
            spread = f"{np.sqrt(variance) * 1e3:.1f} mm along {axis}"
            limit = f"{np.sqrt(largest) * 1e3:.1f} mm"
            found.append(
                f"the mass spreads {spread}, more than a body of this size can, {limit}"
            )
    return found


def check_possible(
    name: str, mass: float, com: FloatArray, inertia: FloatArray
) -> None:
    """Check that a body can have this mass, COM and inertia.

    A body without any mass and inertia, such as a frame, passes.

    Args:
        name: Of the inertia, for the message.
        mass, com, inertia: See `inconsistencies`.

    Raises:
        InputError: No body can have them.
    """
    size = real("mass", mass)
    at = array("com", com, 3)
    tensor = array("inertia", inertia, 3, 3)
    wrong = _violations(size, at, tensor, _ROUNDING)
    if wrong and (size or np.any(tensor)):
        raise InputError(name, tensor.tolist(), f"a possible body, but {wrong[0]}")


def _broadcastable(**given: ArrayLike) -> list[FloatArray]:
    """Checked arrays whose leading axes broadcast.

    Args:
        given: Arrays by their names in messages. ``mass`` has no trailing axes, ``com``
            and ``position`` have (3,), all others (3, 3).
    """
    trailing: dict[str, tuple[int, ...]] = {"mass": (), "com": (3,), "position": (3,)}
    expected = {
        name: (value, trailing.get(name, (3, 3))) for name, value in given.items()
    }
    arrays = fitting(**expected)
    return [bounded(name, array) for name, array in zip(given, arrays, strict=True)]
