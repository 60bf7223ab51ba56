"""The lecture's relative pose A_j and its indices, on the arm of Table 1.

References:
    [Lecture7.1] Describing Robot Arms: the relative pose A_j.
"""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.audit.row import AuditRow, audited
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.link import dh_transform


def audit(parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of the relative pose, with all joints at mid-range."""
    return [*_forms(parameters), *_numbering(parameters)]


def _middle(parameters: Alpha5Parameters) -> FloatArray:
    """Mid-range of the turning joints, (4,) [rad]."""
    joints = parameters.joints[:4]
    return np.array([(joint.lower + joint.upper) / 2 for joint in joints])


def _forms(parameters: Alpha5Parameters) -> list[AuditRow]:
    """A_j as printed and with its sign corrected, against the product of factors."""
    rows = parameters.dh
    d = np.array([row.d for row in rows])
    a = np.array([row.a for row in rows])
    alpha = np.array([row.alpha for row in rows])
    offset = np.array([row.theta_offset for row in rows])
    theta = offset + np.append(_middle(parameters), 0.0)

    corrected = dh_transform(theta, d, a, alpha)
    printed = corrected.copy()
    printed[:, 1, 2] *= -1  # the third entry of row 2

    turn = transform(rotation_about((0, 0, 1), theta))
    lengths = np.column_stack([a, 0 * a, d])
    twist = transform(rotation_about((1, 0, 0), alpha), lengths)
    product = turn @ twist
    return [
        _form("printed", printed, product),
        _form("corrected", corrected, product),
    ]


def _form(name: str, form: FloatArray, product: FloatArray) -> AuditRow:
    """One form of the poses A_j, (N, 4, 4); its effect is the error of the tip."""
    tip = np.linalg.multi_dot(list(form))[:3, 3]
    right_tip = np.linalg.multi_dot(list(product))[:3, 3]
    return audited(
        f"relative_pose.{name}",
        measured=np.abs(form - product).max(),
        bound=None,
        effect=float(np.linalg.norm(tip - right_tip)),
    )


def _numbering(parameters: Alpha5Parameters) -> list[AuditRow]:
    """Two indices of the notes."""
    chain = DHChain.alpha5(arm=parameters)
    middle = _middle(parameters)
    return [_axis_labels(chain, middle), _superscript(chain.frames(middle))]


def _axis_labels(chain: DHChain, middle: FloatArray) -> AuditRow:
    """Number of the z axis that theta_1 turns about; the notes say z_1."""
    frames = chain.frames(middle)
    one_radian_on = chain.frames(middle + np.eye(4)[0])
    turn = one_radian_on[1, :3, :3] @ frames[1, :3, :3].T
    # A rotation leaves its axis where it is.
    z = frames[:2, :3, 2]
    moved = np.linalg.norm(z @ turn.T - z, axis=1)
    turning = int(np.argmin(moved))
    return audited("relative_pose.axis_labels", measured=turning, expected=1)


def _superscript(frames: FloatArray) -> AuditRow:
    """The factors {}^{j-1}A_j against {}^0A_j, frame {j} in the base."""
    steps = np.linalg.inv(frames[:-1]) @ frames[1:]
    tip_gap = steps[-1, :3, 3] - frames[-1, :3, 3]
    return audited(
        "relative_pose.superscript",
        measured=np.abs(steps - frames[1:]).max(),
        bound=None,
        effect=float(np.linalg.norm(tip_gap)),
    )
