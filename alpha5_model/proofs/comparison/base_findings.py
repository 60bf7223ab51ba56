"""What is odd about the base: its mount, what it carries, the place of the shoulder."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from alpha5_model.proofs.comparison.alignment import ANGLE_TOLERANCE, LENGTH_TOLERANCE
from alpha5_model.proofs.comparison.correction import angle_between
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.findings import finding
from alpha5_model.proofs.comparison.poses import origin_of, tilt_of
from alpha5_model.proofs.comparison.records import Finding

#: How many of the foreign links are named, the heaviest first.
NAMED = 3


def findings_of_mount(evidence: Evidence) -> Iterator[Finding]:
    """The place of the other model's root, and the foreign links that it carries."""
    yield from _mount(evidence)
    yield from _carried(evidence)


def _mount(evidence: Evidence) -> Iterator[Finding]:
    """A root of the other model that is not at our base_link."""
    alignment = evidence.alignment
    shift = origin_of(alignment.base)
    angle = angle_between(np.eye(4), alignment.base)

    base_link = evidence.theirs.link_poses[alignment.base_link]
    at_base = alignment.same_base and np.allclose(
        base_link, np.eye(4), atol=LENGTH_TOLERANCE
    )
    elsewhere = np.linalg.norm(shift) > LENGTH_TOLERANCE or angle > ANGLE_TOLERANCE
    if elsewhere and not at_base:
        x, y, z = shift * 1e3
        yield finding(
            "mount" if alignment.same_base else "mount.or_zero",
            root=evidence.other.root,
            x=x,
            y=y,
            z=z,
            turned=math.degrees(angle),
        )


def _carried(evidence: Evidence) -> Iterator[Finding]:
    """Foreign links, which move with the base and are left out of link_0."""
    masses: dict[str, float] = {}
    for name in evidence.theirs.foreign_links:
        mass = evidence.other.links[name].mass
        if mass:
            masses[name] = mass
    total = sum(masses.values())
    if not total:
        return

    heaviest = sorted(masses, key=lambda name: -masses[name])
    named = [f"{name} ({masses[name]:.5g} kg)" for name in heaviest[:NAMED]]
    names = ", ".join(named)
    unnamed = len(heaviest) - NAMED
    if unnamed > 0:
        names += f" and {unnamed} more, {total:.5g} kg in all"

    base_mass = evidence.theirs.mass[0]
    our_base_mass = evidence.parameters.links[0].mass
    excess = total + base_mass - our_base_mass
    yield finding("carried", names=names, excess=excess)


def findings_of_shoulder(evidence: Evidence) -> Iterator[Finding]:
    """A link meant to be base_link that is not where ours is below the shoulder."""
    alignment = evidence.alignment
    if not alignment.same_base:
        return
    length, angle = evidence.tolerance
    x, y, z = origin_of(alignment.stands) * 1e3
    beside = math.hypot(x, y)
    tilt = tilt_of(alignment.stands)
    line = "; ".join(filter(None, evidence.joint_replacements[:2]))
    if beside > length * 1e3 or tilt > angle:
        yield finding(
            "beside",
            link=alignment.base_link,
            beside=beside,
            tilt=math.degrees(tilt),
            line=line,
        )
    elif abs(z) > length * 1e3:
        d = evidence.parameters.dh[0].d * 1e3
        yield finding(
            "height",
            link=alignment.base_link,
            d=d,
            above=d - z,
            off=abs(z),
            way="lower" if z < 0 else "higher",
            line=line,
        )
