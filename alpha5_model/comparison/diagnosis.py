"""Why a body differs: hypotheses made from the tables, each tested against the numbers.

Nothing here looks at names. A hypothesis is a wrong number that a known mistake would give; the one
that the other model's number fits, within the tolerance, is the diagnosis.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.inertia import flip_products, tensor_at_origin
from alpha5_model.parameters import Alpha5Parameters, LinkParameters

#: What still counts as the same number: a model may print fewer digits than the tables.
MASS_TOLERANCE = 1e-3  # of the mass
COM_TOLERANCE = 1e-4  # [m]
INERTIA_TOLERANCE = 5e-3  # of the largest moment

_AXES = "xyz"


def explain_mass(parameters: Alpha5Parameters, body: int, mass: float) -> str | None:
    """Why the mass of a body differs, or None if it agrees."""
    links = parameters.links
    expected = links[body].mass
    if _same_mass(mass, expected):
        return None
    text = f"mass {mass:.4g} kg in place of {expected:g} kg"
    if mass == 0.0:
        return f"no mass in place of {expected:g} kg"
    for factor, words in ((1e3, "in grams"), (1e-3, "in tonnes")):
        if _same_mass(mass, expected * factor):
            return f"{text}: {words}"
    for link in links:
        if _same_mass(mass, link.mass):
            return f"{text}: that of {link.name}"
    total = sum(link.mass for link in links)
    if _same_mass(mass, total):
        return f"{text}: that of the whole arm"
    if _same_mass(mass, links[body].volume * 1000.0):
        return f"{text}: that of the displaced water"
    return f"{text} ({mass / expected:.3g} times)"


def explain_com(
    parameters: Alpha5Parameters, body: int, com: FloatArray, as_written: FloatArray
) -> str | None:
    """Why a COM differs, or None if it agrees.

    Args:
        parameters: The tables.
        body: 0 to 4.
        com: In our link frame, (3,) [m].
        as_written: In the other model's own frame, (3,) [m].
    """
    link = parameters.links[body]
    expected = link.com
    if _near(com, expected):
        return None
    distance = np.linalg.norm(com - expected) * 1e3
    text = f"COM {distance:.1f} mm off"
    error, words = min(
        ((float(np.linalg.norm(com - wrong)), words) for wrong, words in _wrong_coms(link)),
        key=lambda fit: fit[0],
    )
    if error <= COM_TOLERANCE:
        return f"{text}: {words}"
    if _near(as_written, expected):
        return f"{text}: Table 2's numbers, but the frame is not inertial frame {{{body}}}"
    for other in parameters.links:
        if other is not link and _near(as_written, other.com):
            return f"{text}: Table 2's numbers of {other.name}"
    if _near(as_written, np.zeros(3)):
        return f"{text}: at the origin of the other model's link frame"
    for factor, words in ((1e3, "millimetres"), (1e-3, "kilometres")):
        if np.linalg.norm(as_written - expected * factor) < COM_TOLERANCE * max(1, factor):
            return f"{text}: written in {words}"
    return text


def _wrong_coms(link: LinkParameters) -> Iterator[tuple[FloatArray, str]]:
    c, main = link.com, int(np.abs(link.com).argmax())
    yield link.cob, "the centre of buoyancy of Table 3"
    yield -c, "mirrored through the origin, on the wrong side of the joint"
    for axis in range(3):
        flipped = c.copy()
        flipped[axis] = -c[axis]
        side = ", on the wrong side of the joint" if axis == main else ""
        yield flipped, f"the sign of {_AXES[axis]} is wrong{side}"
    for axis in range(3):
        turned = -c
        turned[axis] = c[axis]
        side = "" if axis == main else ", on the wrong side of the joint"
        yield turned, f"turned by pi about {_AXES[axis]}{side}"
    for i, j, k in ((0, 2, 1), (1, 0, 2), (2, 1, 0), (1, 2, 0), (2, 0, 1)):
        order = f"{_AXES[i]}, {_AXES[j]}, {_AXES[k]}"
        yield c[[i, j, k]], f"its coordinates are in the order {order}"


def explain_inertia(
    parameters: Alpha5Parameters,
    body: int,
    mass: float,
    inertia: FloatArray,
    as_written: FloatArray,
) -> str | None:
    """Why a tensor differs, or None if it agrees.

    Args:
        parameters: The tables.
        body: 0 to 4.
        mass: Of the other body [kg]: a tensor is judged for the mass it goes with.
        inertia: At the other body's COM, in our link's axes, (3, 3) [kg m^2].
        as_written: The same in the other model's own axes, (3, 3) [kg m^2].
    """
    link = parameters.links[body]
    if _same_tensor(inertia, link.inertia):
        return None
    largest = np.linalg.eigvalsh(inertia)[-1] / np.linalg.eigvalsh(link.inertia)[-1]
    times = "" if abs(largest - 1) < 0.01 else f" (largest moment {largest:.3g} times)"
    text = f"inertia differs{times}"
    if not inertia.any():
        return "no inertia"
    fits = [
        (float(np.abs(inertia - wrong).max() / np.abs(wrong).max()), words)
        for wrong, words in _wrong_tensors(parameters, body)
    ]
    error, words = min(fits, key=lambda fit: fit[0])
    if error <= INERTIA_TOLERANCE:
        return f"{text}: {words}"
    if not _same_mass(mass, link.mass) and _same_tensor(inertia * (link.mass / mass), link.inertia):
        return f"{text}: scaled with the wrong mass"
    for exponent in (9, 6, 3, -3, -6, -9):
        if _same_tensor(inertia, link.inertia * 10.0**exponent):
            return f"{text}: wrong unit, a factor of 1e{exponent}"
    diagonal = np.diag(as_written)
    if not (as_written - np.diag(diagonal)).any():
        if np.ptp(diagonal) <= 1e-9 * diagonal.max():
            return f"{text}: a dummy, {diagonal[0]:g} kg m^2 about every axis"
        return f"{text}: a guess without products of inertia"
    return text


def _wrong_tensors(parameters: Alpha5Parameters, body: int) -> Iterator[tuple[FloatArray, str]]:
    link = parameters.links[body]
    solidworks = flip_products(link.inertia)
    at_origin = tensor_at_origin(link.mass, link.com, link.inertia)
    yield solidworks, "products of inertia have the SolidWorks sign"
    yield at_origin, "it is about the link frame, not the COM"
    yield (
        flip_products(at_origin),
        "it is about the link frame, not the COM, and its products have the SolidWorks sign",
    )
    yield (
        tensor_at_origin(link.mass, link.com, solidworks),
        "it is moved to the link frame, with products of the SolidWorks sign",
    )
    yield np.diag(np.diag(link.inertia)), "the products of inertia are zeroed"
    yield np.diag(np.diag(at_origin)), "it is about the link frame, and its products are zeroed"
    for i, j in ((0, 1), (0, 2), (1, 2)):
        flipped = link.inertia.copy()
        flipped[i, j] = flipped[j, i] = -link.inertia[i, j]
        yield flipped, f"i{_AXES[i]}{_AXES[j]} has the wrong sign"
    for axis in range(3):
        turn = -np.eye(3)
        turn[axis, axis] = 1.0
        yield turn @ link.inertia @ turn, f"turned by pi about {_AXES[axis]}"
    for other in parameters.links:
        if other is not link:
            yield other.inertia, f"that of {other.name}"


def _same_mass(a: float, b: float) -> bool:
    return abs(a - b) <= MASS_TOLERANCE * b


def _near(a: FloatArray, b: FloatArray) -> bool:
    return bool(np.linalg.norm(a - b) <= COM_TOLERANCE)


def _same_tensor(a: FloatArray, b: FloatArray) -> bool:
    return bool(np.abs(a - b).max() <= INERTIA_TOLERANCE * np.abs(b).max())
