"""A file of an arm of your own: its bodies and its mount against the record.

Bodies are added up as pseudo-inertias, which need no parallel-axis theorem. The
generator adds masses, COMs and tensors.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose, transform
from alpha5_model.description.verification.subject import Subject
from alpha5_model.numbers.inertia import pseudo_inertia
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody

#: Largest error of a body relative to the size of its mass, its first or its second
#: moments: computed ones are written with 12 digits.
INERTIA_BOUND = 1e-11
#: Largest error of the mount [m, and of a rotation matrix].
_MOUNT_BOUND = 1e-12


def closed_links(arm: Alpha5Parameters) -> list[FloatArray]:
    """Pseudo-inertia of each link with what is attached to it, jaws closed.

    Returns:
        (4, 4) each, about the origin of the link [kg, kg m, kg m^2].
    """
    totals = [_of_body(link) for link in arm.links]
    for body in arm.attached:
        i = int(body.link[-1])
        place = transform(body.rotation, body.position)
        totals[i] = totals[i] + _moved(_of_body(body), place)
    if arm.spacer:
        totals[4] = totals[4] + _moved_jaws(arm)
    return totals


def _moved_jaws(arm: Alpha5Parameters) -> FloatArray:
    """What a spacer changes of link 4: rod and fingers, taken away and put farther."""
    bare = split_link_4(replace(arm, attached=()))
    change = np.zeros((4, 4))
    for body in (bare.rod, bare.finger_1, bare.finger_2):
        here = pose(body.origin, (body.roll, 0.0, 0.0))
        there = here.copy()
        there[2, 3] -= arm.spacer
        own = _of_body(body)
        change += _moved(own, there) - _moved(own, here)
    return change


def _of_body(body: RigidBody) -> FloatArray:
    return pseudo_inertia(body.mass, body.com, body.inertia)


def _moved(pseudo: FloatArray, place: FloatArray) -> FloatArray:
    """The pseudo-inertia of a body at a place (4, 4) of another frame."""
    return np.asarray(place @ pseudo @ place.T)


def inertia_error(given: FloatArray, expected: FloatArray) -> float:
    """Largest error of a pseudo-inertia, relative to the size of its block.

    First moments are relative to the largest that the others permit: they are 0 if the
    COM is the origin.
    """
    difference = np.abs(given - expected)
    mass = expected[3, 3]
    second_moments = np.abs(expected[:3, :3]).max()
    first_moments = np.sqrt(mass * second_moments)
    return max(
        float(difference[:3, :3].max() / second_moments),
        float(difference[:3, 3].max() / first_moments),
        float(difference[3, 3] / mass),
    )


def own_inertial_differences(text: Subject) -> Iterator[str]:
    """Links that are not the arm's; moving jaws have a check of their own."""
    count = 4 if text.jaws else 5
    for i, expected in enumerate(closed_links(text.expected)[:count]):
        name = f"{text.prefix}link_{i}"
        given = text.links.get(name)
        if given is None or given.mass is None:
            yield f"{name}: no inertial"
            continue
        found = pseudo_inertia(given.mass, given.com, given.inertia)
        error = inertia_error(found, expected)
        if not error <= INERTIA_BOUND:
            yield (
                f"{name}: mass {given.mass:.6g} kg, expected {expected[3, 3]:.6g}; "
                f"mass or moments are off by {error:.2g} of their size"
            )


def mount_differences(text: Subject) -> Iterator[str]:
    """How the mount differs from that of the arm, if it has one."""
    mount = text.expected.mount
    if mount is None:
        return
    base = f"{text.prefix}base_link"
    joint = text.carriers.get(base)
    if joint is None or joint.parent != mount.parent or joint.kind != "fixed":
        found = "nothing" if joint is None else f"{joint.parent}, {joint.kind}"
        yield f"{base} on {found}, expected {mount.parent}, fixed"
        return
    expected = transform(mount.rotation, mount.position)
    error = float(np.abs(joint.transform - expected).max())
    if not error <= _MOUNT_BOUND:
        yield f"{base} is {error:.2g} from its place on {mount.parent} [m, rad]"
