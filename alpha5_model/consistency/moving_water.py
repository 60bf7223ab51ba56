"""The strip theory that circulates for this arm in water, against our estimate and against strip theory itself.

No document prints these numbers; they stand in ``published/supplementary_hydrodynamics.toml`` with their sources.

References:
    [Newman1977] Marine Hydrodynamics, section 4.13: added mass of a strip, and how it moves to another point.
"""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import AuditRow, audited
from alpha5_model.dh import DHChain
from alpha5_model.hydrodynamics import BodyHydrodynamics, gauss_points, hydrodynamics
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.spatial import cross_matrix, rotation_about

#: Positions of each joint but the first, on which nothing depends.
_GRID = 7


def audit(p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of the numbers that circulate: observations, no claims of a document."""
    bodies = hydrodynamics(numbers="supplementary")
    theirs, ours, most = (
        {name: body.added_mass for name, body in water.items()}
        for water in (bodies, hydrodynamics(), hydrodynamics(level="high"))
    )
    joined = {name: _coupled(body) for name, body in bodies.items()}
    sizes = [added_inertia(p, matrices) for matrices in (theirs, ours, most, joined)]
    rows = []
    for joint, other, size, high, strips in zip(p.joints[:3], *(s[:3] for s in sizes), strict=True):
        words = {"joint": joint.name, "coupled": f"{strips / size:.2f}"}
        claim, interval = f"circulating_water.{joint.name}", high / size - 1
        rows.append(audited(claim, other / size, 1.0, interval, **words))
    (strip,) = bodies["link_2"].strips
    turning = np.array([0.0, 0.0, 1.0])
    twist = np.concatenate([-np.cross(turning, (strip.start + strip.end) / 2), turning])
    energies = [twist @ matrices["link_2"] @ twist for matrices in (theirs, joined)]
    return [*rows, audited("circulating_water.coupling", energies[0] / energies[1], 1.0, 1e-3)]


def _coupled(water: BodyHydrodynamics) -> FloatArray:
    """Strip theory with the same masses along the same line, (6, 6)."""
    (strip,) = water.strips
    line, added = strip.end - strip.start, np.diag(water.added_mass)[:3]
    along = np.outer(line, line) / (line @ line)
    per_strip = added.max() * (np.eye(3) - along) + added.min() * along
    out = np.zeros((6, 6))
    for point, share in gauss_points(strip, 2):
        velocity = np.hstack([np.eye(3), -cross_matrix(point)])
        out += share * velocity.T @ per_strip @ velocity
    return out


def added_inertia(p: Alpha5Parameters, matrices: dict[str, FloatArray]) -> FloatArray:
    """Added inertia about each joint, mean over a grid of the joints' ranges, (4,) [kg m^2] at 1000 kg/m^3."""
    chain = DHChain.alpha5()
    ranges = [np.linspace(joint.lower, joint.upper, _GRID) for joint in p.joints[1:4]]
    q = np.stack(np.meshgrid([0.0], *ranges, indexing="ij"), axis=-1).reshape(-1, 4)
    frames = chain.frames(q)
    points, axes = chain.joint_axes(q)
    out = np.zeros((len(q), 4))
    for i in range(1, 5):
        # Inertial frame {i} stands at DH frame {i-1}, turned by the joint about its z (Section 2).
        pose, joint = frames[:, i - 1], chain.links[i - 1]
        turn = pose[:, :3, :3] @ rotation_about((0, 0, 1), q[:, i - 1] + joint.offset)
        spin = axes[:, :i]
        speed = np.cross(spin, pose[:, None, :3, 3] - points[:, :i])
        twist = np.concatenate([speed @ turn, spin @ turn], axis=-1)
        out[:, :i] += np.einsum("nka,ab,nkb->nk", twist, matrices[f"link_{i}"], twist)
    return np.asarray(out.mean(axis=0))
