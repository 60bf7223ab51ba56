"""Section 1.2: the tori of the workspace.

References:
    [ReachAlpha] Manufacturer's document, Section 1.2, Figure 2.
"""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.kinematics.workspace import singular_elbow_angles
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit.rounding import figure, si
from alpha5_model.proofs.audit.row import AuditRow, audited
from alpha5_model.proofs.audit.table_1_lengths import lengths
from alpha5_model.theory.dh.chain import DHChain


def audit(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The lengths in the formulas of the tori."""
    return [
        _inner_offset(printed),
        _outer_torus(printed, parameters),
        _inner_torus(printed, parameters),
        _downward_centre(printed, parameters),
        _downward_radius(printed),
    ]


def _row(
    printed: Published,
    name: str,
    measured: float,
    expected: float,
    *,
    rounding: float | None = None,
) -> AuditRow:
    """A row of the workspace.

    Args:
        rounding: How far the two may differ because digits are rounded [m]; None if
            they must be the same length. The row then has no effect.
    """
    return audited(
        f"workspace.{name}",
        measured=measured,
        bound=rounding,
        expected=expected,
        effect=None if rounding is None else abs(measured - expected),
        numbers=printed.workspace,
        ours=printed.elbow.opposite,
    )


def _forearm(printed: Published) -> float:
    """Distance from the elbow to the tcp [m]."""
    table = lengths(printed)
    return float(np.hypot(table.a_2.si, table.d_3.si))


def _shoulder_distance(parameters: Alpha5Parameters, elbow: float) -> float:
    """From the shoulder, DH frame {1}, to the tcp, at a theta_2 [rad], in m."""
    chain = DHChain.alpha5(arm=parameters)
    frames = chain.frames([0.0, 0.0, elbow, 0.0])
    return float(np.linalg.norm(frames[-1, :3, 3] - frames[1, :3, 3]))


def _inner_offset(printed: Published) -> AuditRow:
    theirs = printed.workspace.inner_offset
    ours = printed.elbow.opposite
    rounding = theirs.rounding + ours.rounding
    return _row(printed, "inner_offset", theirs.si, ours.si, rounding=rounding)


def _outer_torus(printed: Published, parameters: Alpha5Parameters) -> AuditRow:
    """The longest distance: the elbow stretched, or as near to that as it can get."""
    elbow = parameters.joints[2]
    stretched = singular_elbow_angles(arm=parameters)["stretched"]
    bend = float(np.clip(stretched, elbow.lower, elbow.upper))

    longest = _shoulder_distance(parameters, bend)
    radius = parameters.dh[1].a + _forearm(printed)
    return _row(printed, "outer_torus", longest, radius)


def _inner_torus(printed: Published, parameters: Alpha5Parameters) -> AuditRow:
    numbers = printed.workspace
    elbow = printed.elbow
    table = lengths(printed)
    torus = [numbers.inner_offset, numbers.inner_length]
    caption = [elbow.opposite, elbow.adjacent]
    forearm = [table.a_2, table.d_3]

    def radius(sides: FloatArray, forearm: FloatArray) -> float:
        return float(np.hypot(*(sides + forearm)))

    def excess(x: FloatArray) -> float:
        """The printed radius less that with the caption's lengths."""
        return radius(x[:2], x[2:4]) - radius(x[4:], x[2:4])

    measured = radius(si(torus), si(forearm))
    rounding = figure(excess, [*torus, *forearm, *caption]).bound
    expected = _shoulder_distance(parameters, 0.0)
    return _row(printed, "inner_torus", measured, expected, rounding=rounding)


def _downward_centre(printed: Published, parameters: Alpha5Parameters) -> AuditRow:
    """The horizontal distance of the elbow from the shoulder at theta_1 = 0."""
    chain = DHChain.alpha5(arm=parameters)
    elbow = chain.frames(np.zeros(4))[2, :3, 3]
    offset = float(np.hypot(*elbow[:2])) - parameters.dh[0].a
    rounding = lengths(printed).a_0.rounding + printed.elbow.opposite.rounding
    return _row(printed, "downward_centre", offset, 0.0, rounding=rounding)


def _downward_radius(printed: Published) -> AuditRow:
    table = lengths(printed)
    drop = figure(lambda x: np.hypot(*x) - abs(x[1]), [table.a_2, table.d_3])
    printed_radius = -table.d_3.si
    return _row(
        printed,
        "downward_radius",
        _forearm(printed),
        printed_radius,
        rounding=drop.bound,
    )
