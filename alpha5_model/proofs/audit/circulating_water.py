"""Added masses that circulate for this arm, against our estimate and strip theory.

No document prints these numbers. They are in
``numbers/supplementary_hydrodynamics.toml`` with their sources.

References:
    [Newman1977] Marine Hydrodynamics, section 4.13: added mass of a strip, and how it
        moves to another point.
"""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, rotation_about
from alpha5_model.numbers.hydrodynamics import (
    BodyHydrodynamics,
    gauss_points,
    hydrodynamics,
)
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.audit.row import AuditRow, audited
from alpha5_model.theory.dh.chain import DHChain

#: Link -> added mass in its frame, (6, 6).
AddedMass = dict[str, FloatArray]

#: Positions of each joint except the first one, which changes no added inertia.
_GRID = 7


def audit(parameters: Alpha5Parameters) -> list[AuditRow]:
    """Rows of the kind ``observation``: no document claims these numbers."""
    bodies = hydrodynamics(numbers="supplementary")
    coupled = {name: _coupled(body) for name, body in bodies.items()}
    circulating = _added_mass(bodies)
    return [
        *_sizes(parameters, circulating, coupled),
        _coupling(bodies["link_2"], circulating["link_2"], coupled["link_2"]),
    ]


def _added_mass(bodies: dict[str, BodyHydrodynamics]) -> AddedMass:
    return {name: body.added_mass for name, body in bodies.items()}


def _sizes(
    parameters: Alpha5Parameters, circulating: AddedMass, coupled: AddedMass
) -> list[AuditRow]:
    """The added inertia about each joint, against our estimate."""
    theirs = added_inertia(parameters, circulating)
    ours = added_inertia(parameters, _added_mass(hydrodynamics()))
    most = added_inertia(parameters, _added_mass(hydrodynamics(level="high")))
    strips = added_inertia(parameters, coupled)
    return [
        audited(
            f"circulating_water.{joint.name}",
            measured=theirs[k] / ours[k],
            bound=most[k] / ours[k] - 1,
            expected=1.0,
            joint=joint.name,
            coupled=strips[k] / ours[k],
            surplus=100 * (theirs[k] / ours[k] - 1),
        )
        for k, joint in enumerate(parameters.joints[:3])
    ]


def _coupling(
    water: BodyHydrodynamics, circulating: FloatArray, coupled: FloatArray
) -> AuditRow:
    """Energy of link 2 in a turn about its middle: circulating over coupled masses."""
    (strip,) = water.strips
    middle = (strip.start + strip.end) / 2
    turning = np.array([0.0, 0.0, 1.0])
    twist = np.concatenate([-np.cross(turning, middle), turning])
    theirs = twist @ circulating @ twist
    whole = twist @ coupled @ twist
    factor = theirs / whole
    return audited(
        "circulating_water.coupling",
        measured=factor,
        bound=1e-3,
        expected=1.0,
        factor=factor,
    )


def _coupled(water: BodyHydrodynamics) -> FloatArray:
    """Added mass by strip theory with the same masses along the same line, (6, 6)."""
    (strip,) = water.strips
    line = strip.end - strip.start
    along = np.outer(line, line) / (line @ line)
    masses = np.diag(water.added_mass)[:3]
    per_strip = masses.max() * (np.eye(3) - along) + masses.min() * along

    out = np.zeros((6, 6))
    for point, share in gauss_points(strip):
        velocity = np.hstack([np.eye(3), -cross_matrix(point)])
        out += share * velocity.T @ per_strip @ velocity
    return out


def added_inertia(parameters: Alpha5Parameters, matrices: AddedMass) -> FloatArray:
    """Added inertia about each joint in water of 1000 kg/m^3, (4,) [kg m^2].

    The mean over a grid of the joints' ranges.
    """
    chain = DHChain.alpha5(arm=parameters)
    q = _grid(parameters)
    inertia = np.zeros((len(q), 4))
    for i in range(1, 5):
        twist = _twists(chain, q, i)
        added_mass = matrices[f"link_{i}"]
        inertia[:, :i] += np.einsum("nka,ab,nkb->nk", twist, added_mass, twist)
    return np.asarray(inertia.mean(axis=0))


def _twists(chain: DHChain, q: FloatArray, i: int) -> FloatArray:
    """Twists of link i in its frame, for a unit rate of each joint, (N, i, 6)."""
    # Inertial frame {i} is DH frame {i-1}, turned about its z by the joint (Section 2).
    pose = chain.frames(q)[:, i - 1]
    angle = q[:, i - 1] + chain.links[i - 1].offset
    turn = pose[:, :3, :3] @ rotation_about((0, 0, 1), angle)
    origin = pose[:, None, :3, 3]

    points, axes = chain.joint_axes(q)
    spin = axes[:, :i]
    speed = np.cross(spin, origin - points[:, :i])
    return np.concatenate([speed @ turn, spin @ turn], axis=-1)


def _grid(parameters: Alpha5Parameters) -> FloatArray:
    """Joint positions over the ranges of the joints, (N, 4)."""
    ranges = [
        np.linspace(joint.lower, joint.upper, _GRID) for joint in parameters.joints[1:4]
    ]
    positions = np.meshgrid([0.0], *ranges, indexing="ij")
    return np.stack(positions, axis=-1).reshape(-1, 4)
