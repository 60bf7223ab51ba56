"""A cylinder's added mass across itself by rings of sources: another way to what the panels compute.

The potential of a body of revolution that moves across its axis goes like cos(angle), so an integral equation along
its outline is left. The pieces get smaller towards the edge, where the velocity has no bound.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

#: Pieces from the axis to the edge; the distances of their ends from the edge are powers of even steps.
PIECES, GRADING = 20, 3

Array = NDArray[np.float64]


def cylinder_across(ratio: float) -> float:
    """Added mass over displaced mass of a cylinder with flat ends.

    Args:
        ratio: Length over diameter.
    """
    inward = np.linspace(1.0, 0.0, PIECES + 1)[:, None] ** GRADING
    edge = np.array([1.0, ratio])  # of a radius of 1
    half = np.vstack(
        [edge * [0, 1] + (1 - inward) * [1, 0], (edge - inward[::-1] * [0, ratio])[1:]]
    )
    outline = np.vstack([half, half[-2::-1] * [1, -1]])
    starts, lines = outline[:-1], np.diff(outline, axis=0)
    lengths = np.linalg.norm(lines, axis=1)
    normals = np.column_stack([-lines[:, 1], lines[:, 0]]) / lengths[:, None]
    middles = starts + lines / 2
    nodes, weights = leggauss(8)
    nodes, weights = (nodes + 1) / 2, weights / 2
    # Of a piece seen from others, and from its own middle, to which they crowd.
    plain = nodes, weights
    crowded = (
        0.5 + 0.5 * np.concatenate([-(nodes**GRADING), nodes**GRADING]),
        0.5 * GRADING * np.tile(nodes ** (GRADING - 1) * weights, 2),
    )
    single, double = np.zeros((2, len(lines), len(lines)))
    for j, (start, line, length) in enumerate(zip(starts, lines, lengths, strict=True)):
        for places, shares in (plain, crowded):
            seen = (
                [j]
                if places is crowded[0]
                else [i for i in range(len(lines)) if i != j]
            )
            ring = start + places[:, None] * line
            source, dipole = _ring(middles[seen][:, None], ring, normals[j])
            single[seen, j] = (source * shares * ring[:, 0]).sum(axis=1) * length
            double[seen, j] = (dipole * shares * ring[:, 0]).sum(axis=1) * length
    speeds = normals[:, 0]
    potential = np.linalg.solve(
        2 * np.pi * np.eye(len(lines)) - double, single @ speeds
    )
    return float((potential * speeds * lengths * middles[:, 0]).sum() / (2 * ratio))


def _ring(at: Array, ring: Array, normal: Array) -> tuple[Array, Array]:
    """Of 1/R over a ring times cos(angle), and of its derivative along the ring's normal, seen from points at angle 0."""
    near = np.linalg.norm(at - ring, axis=-1) / ring[:, 0]
    span = np.arcsinh(np.pi / near)[..., None]
    nodes, weights = leggauss(40)
    step = (nodes + 1) / 2 * span  # angles crowd where the ring is near
    angles, shares = (
        near[..., None] * np.sinh(step),
        near[..., None] * np.cosh(step) * span * weights,
    )
    x = at[..., :1] - ring[:, :1] * np.cos(angles)
    z = (at[..., 1] - ring[:, 1])[..., None]
    distance = np.sqrt(x**2 + (ring[:, :1] * np.sin(angles)) ** 2 + z**2)
    # R's component along the normal of the ring at that angle.
    radial = at[..., :1] * np.cos(angles) - ring[:, :1]
    share = shares * np.cos(angles)
    source = (share / distance).sum(axis=-1)
    dipole = (share * (normal[0] * radial + normal[1] * z) / distance**3).sum(axis=-1)
    return source, dipole
