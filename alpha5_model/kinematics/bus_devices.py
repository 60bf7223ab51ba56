"""From what the devices on the arm's bus report to joint positions, and back.

The bus counts from the tip: device 1 is the jaws, device 5 the base. It reports the
jaws in mm and the four turning joints in rad. This package counts from the base, and
has the jaw rod in m. Directions are the same, unless an arm file has ``[signs]``; zeros
of an arm file are part of its model.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    chosen_arm,
)

_ROD = "axis_a"
_MM_PER_M = 1e3
#: A real arm's zero may be off by this share of the range of a joint.
_TOLERANCE_SHARE = 0.1


def q_from_devices(
    devices: Mapping[int, ArrayLike], arm: Alpha5Parameters | None = None
) -> FloatArray:
    """Joint positions from what the devices on the arm's bus report.

    Args:
        devices: Device -> its position, a number or an array (...) of samples: 5, 4, 3
            and 2 in rad (``axis_e`` to ``axis_b``), optionally 1, the jaws, in mm.
        arm: Record of an arm of your own, for the devices, signs and ranges of its
            joints; None for the catalogue's.

    Returns:
        (..., 4) [rad], base to tip, with device 1 (..., 5) with the jaw rod [m].

    Raises:
        InputError: A device that is missing or not the arm's, or a position that is out
            of its joint's range by more than a tenth of it: degrees, perhaps, or m.
        ShapeError: Numbers of samples that differ.

    Examples:
        >>> q_from_devices({5: 3.14, 4: 0.79, 3: 2.36, 2: 1.57, 1: 6.0}).tolist()
        [3.14, 0.79, 2.36, 1.57, 0.006]
    """
    joints = _joints_of(devices, chosen_arm(arm))
    positions = []
    for joint in joints:
        name = f"devices[{joint.device_id}]"
        reported = float_array(name, devices[joint.device_id], ())
        unit = "mm" if joint.name == _ROD else "rad"
        _check_range(name, reported, joint, _devices_unit(joint), unit)
        positions.append(reported / _devices_unit(joint))

    shapes = {position.shape for position in positions}
    if len(shapes) > 1:
        found = tuple(sorted(shapes))
        raise ShapeError("devices", found, "the same number of samples of each device")
    return np.stack(positions, axis=-1)


def devices_from_q(
    q: ArrayLike, arm: Alpha5Parameters | None = None
) -> dict[int, FloatArray]:
    """What the devices on the arm's bus report at joint positions.

    This is the inverse of `q_from_devices`.

    Args:
        q: (..., 4) [rad], base to tip, or (..., 5) with the jaw rod [m].
        arm: Record of an arm of your own, for the devices and signs of its joints; None
            for the catalogue's.

    Returns:
        Device -> its position, (...): 5, 4, 3 and 2 in rad, 1 in mm.

    Raises:
        ShapeError: Another shape.
        InputError: A position that is out of its joint's range by more than a tenth of
            it: degrees, perhaps, or mm.
    """
    positions = float_array("q", q, ())
    if positions.ndim == 0 or positions.shape[-1] not in (4, 5):
        expected = "shape (..., 4), or (..., 5) with the jaw rod"
        raise ShapeError("q", positions.shape, expected)
    joints = chosen_arm(arm).joints[: positions.shape[-1]]
    for k, joint in enumerate(joints):
        unit = "m" if joint.name == _ROD else "rad"
        _check_range(f"q[..., {k}]", positions[..., k], joint, 1.0, unit)
    return {
        joint.device_id: positions[..., k] * _devices_unit(joint)
        for k, joint in enumerate(joints)
    }


def _joints_of(
    devices: Mapping[int, ArrayLike], parameters: Alpha5Parameters
) -> list[JointParameters]:
    """The joints whose devices report, base to tip.

    Raises:
        InputError: A device that is missing or not the arm's.
    """
    expected = "a mapping from devices 5, 4, 3, 2 and perhaps 1 to their positions"
    if not isinstance(devices, Mapping):
        raise InputError("devices", devices, expected)
    by_device = {joint.device_id: joint for joint in parameters.joints}
    needed = {device for device, joint in by_device.items() if joint.name != _ROD}
    try:
        complete = needed <= devices.keys() <= by_device.keys()
    except TypeError:  # keys that cannot be compared
        complete = False
    if not complete:
        raise InputError("devices", [*devices], expected)
    return [joint for joint in parameters.joints if joint.device_id in devices]


def _devices_unit(joint: JointParameters) -> float:
    """What a device reports for a rad, or for a m of the jaw rod, with its sign."""
    return joint.sign * (_MM_PER_M if joint.name == _ROD else 1.0)


def _check_range(
    name: str, given: FloatArray, joint: JointParameters, factor: float, unit: str
) -> None:
    """Refuse positions that are far out of a joint's range.

    Args:
        name: Of the argument.
        given: Positions (...) in a unit and direction of their own.
        joint: Whose range it is.
        factor: What is given for a rad, or for a m of the jaw rod.
        unit: Its name.

    Raises:
        InputError: Such a position.
    """
    tolerance = _TOLERANCE_SHARE * (joint.upper - joint.lower)
    position = given / factor
    below = position < joint.lower - tolerance
    above = position > joint.upper + tolerance
    if (below | above).any():
        value = float(given[below | above].flat[0])
        low, high = sorted((factor * joint.lower, factor * joint.upper))
        # Adding zero turns a negative zero into zero.
        ends = f"{low + 0.0:.4g} to {high + 0.0:.4g} {unit}"
        raise InputError(name, value, f"{joint.name} in its range of {ends}")
