"""A planned motion, computed by `alpha5_model.trajectory.analyse`, and its limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from alpha5_model.dynamics.arm import Arm
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.planning.s_curve import Samples
from alpha5_model.trajectory.analysis import Analysis, analyse
from alpha5_model.trajectory.motions import Motion

#: A quantity may be this share above its limit: rounding of a motion at the limit.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Peak:
    """The largest magnitude of a quantity of a joint, and its limit.

    Attributes:
        joint: Its name.
        quantity: ``speed``, ``torque``, ``current`` or ``voltage``.
        value: [rad/s, N m, A, V].
        limit: The same; NaN if none is known.
        unit: Of both.
    """

    joint: str
    quantity: str
    value: float
    limit: float
    unit: str

    @property
    def is_beyond(self) -> bool:
        """Whether it is above its limit."""
        return self.value > self.limit * (1.0 + ROUNDING)


def replayed(
    samples: Samples,
    arm: Arm,
    supply_voltage: float | None,
    current_limit: float | None,
) -> Analysis:
    """The loads of a motion, whose velocities are used as they are.

    Args:
        samples: Of axis_e to axis_b.
        arm: With closed jaws, on a fixed base.
        supply_voltage, current_limit: As for `alpha5_model.trajectory.analyse`.

    Raises:
        InputError: Another arm, or one limit without the other.
    """
    motion = Motion(
        time=samples.time,
        joints=JOINT_NAMES[:4],
        position=samples.position,
        velocity=samples.velocity,
        source="plan",
    )
    return analyse(
        motion,
        arm,
        method="interpolate",
        supply_voltage=supply_voltage,
        current_limit=current_limit,
    )


def peaks(analysis: Analysis) -> Iterator[Peak]:
    """The peaks of a motion: speed and torque, and with known drives also theirs.

    A current is the larger one of those at both ends of friction's printed tolerance.
    """
    limits = analysis.current_limits or (None,) * 4
    supply = analysis.supply_voltage
    for k, joint in enumerate(analysis.arm.parameters.joints[:4]):
        ends = (analysis.current_lower[:, k], analysis.current_upper[:, k])
        table = (
            ("speed", analysis.smooth.velocity[:, k], joint.velocity, "rad/s"),
            ("torque", analysis.torque[:, k], joint.effort, "N m"),
            ("current", np.concatenate(ends), limits[k], "A"),
            ("voltage", analysis.voltage[:, k], supply, "V"),
        )
        for quantity, values, limit, unit in table:
            yield Peak(
                joint=joint.name,
                quantity=quantity,
                value=float(np.abs(values).max()),
                limit=np.nan if limit is None else limit,
                unit=unit,
            )


def worst(found: list[Peak]) -> Peak | None:
    """The peak that is farthest beyond its limit; None if all are within."""
    beyond = [peak for peak in found if peak.is_beyond]
    return max(beyond, key=_share, default=None)


def _share(peak: Peak) -> float:
    return peak.value / peak.limit if peak.limit > 0.0 else np.inf
