"""Random arms of one's own, and their dynamics by Newton and Euler from the record.

Attached bodies stay bodies of their own, and a spacer takes rod and fingers away at one
place and puts them at another. So nothing of the package adds bodies up here.
"""

from __future__ import annotations

import dataclasses
import math

import newton_euler as ne
import numpy as np
import own_arm

import alpha5_model as a5
from alpha5_model.numbers.parameters import Alpha5Parameters, LinkParameters
from alpha5_model.numbers.pose import Pose
from alpha5_model.numbers.rigid_body import AttachedBody


def random_record(seed: int) -> Alpha5Parameters:
    """An arm with bodies, lengths, zeros, limits, tool and attached bodies of its own.

    Odd seeds have a spacer and so Table 1's tool, moved; others a tool anywhere.
    """
    rng = np.random.default_rng(seed)
    record = own_arm.random_arm(rng, off_axis=True)
    joints = [
        dataclasses.replace(
            joint,
            velocity=joint.velocity * rng.uniform(0.5, 1.0),
            effort=joint.effort * rng.uniform(0.1, 1.0),
        )
        for joint in record.joints
    ]
    spacer = 0.0
    tool = record.tool
    if seed % 2:
        spacer = float(rng.uniform(0.01, 0.05))
        tool = None
    return dataclasses.replace(
        record,
        name=f"lab_{seed}",
        joints=tuple(joints),
        links=tuple(_random_link(rng, link) for link in record.links),
        tool=tool,
        attached=(
            random_attached(rng, "sensor", "link_4", spacer),
            random_attached(rng, "lamp", "link_2", 0.0),
            random_attached(rng, "plate", "link_0", 0.0),
        ),
    )


def _random_link(rng: np.random.Generator, link: LinkParameters) -> LinkParameters:
    heavier = rng.uniform(0.9, 1.3)
    return dataclasses.replace(
        link,
        mass=link.mass * heavier,
        com=link.com + rng.uniform(-1e-3, 1e-3, 3),
        inertia=link.inertia * heavier,
        volume=link.volume * rng.uniform(0.9, 1.1),
        cob=link.cob + rng.uniform(-1e-3, 1e-3, 3),
    )


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    """A rotation anywhere, (3, 3)."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.linalg.det(q)


def random_mount(seed: int) -> Pose:
    """A tilted mount on a vehicle."""
    rng = np.random.default_rng(seed)
    return Pose(
        parent="bluerov",
        position=rng.uniform(-0.2, 0.2, 3),
        rotation=random_rotation(rng),
    )


def random_attached(
    rng: np.random.Generator, name: str, link: str, spacer: float
) -> AttachedBody:
    """A body of up to 200 g, turned any way in its link."""
    mass = rng.uniform(0.05, 0.2)
    a, b, c = rng.uniform(0.01, 0.04, 3)
    sides = np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    return AttachedBody(
        name=name,
        mass=mass,
        com=rng.uniform(-0.01, 0.01, 3),
        inertia=mass / 12 * sides,
        volume=rng.uniform(1e-5, 1e-4),
        cob=rng.uniform(-0.01, 0.01, 3),
        link=link,
        position=rng.uniform(-0.05, 0.05, 3),
        rotation=random_rotation(rng),
        spacer=spacer,
    )


def bodies_of(record: Alpha5Parameters) -> list[list[ne.Body]]:
    """The bodies on link_0 to link_4, jaws closed."""
    bodies = [
        [ne.Body(link.mass, link.com, link.inertia, link.volume, link.cob)]
        for link in record.links
    ]
    for body in record.attached:
        r = body.rotation
        carried = ne.Body(
            mass=body.mass,
            com=body.position + r @ body.com,
            tensor=r @ body.inertia @ r.T,
            volume=body.volume,
            cob=body.position + r @ body.cob,
        )
        bodies[int(body.link[-1])].append(carried)
        if body.spacer:
            for part in _jaw_parts(record):
                bodies[4] += [_negative(part), _lower(part, body.spacer)]
    return bodies


def _jaw_parts(record: Alpha5Parameters) -> list[ne.Body]:
    """Rod and closed fingers in link_4, estimated: a cylinder and two boxes."""
    jaws = record.jaws
    radius, length = jaws.rod_diameter / 2, jaws.rod_length
    mass = jaws.rod_density * math.pi * radius**2 * length
    across = mass * (3 * radius**2 + length**2) / 12
    centre = np.array([0.0, 0.0, -jaws.collar_base - record.joints[4].lower])
    tensor = np.diag([across, across, mass * radius**2 / 2])
    parts = [ne.Body(mass, centre, tensor, 0.0, centre)]

    length, width = jaws.finger_length, jaws.finger_width
    for side, volume in ((-1, jaws.finger_volume), (1, jaws.second_finger_volume)):
        thickness = volume / length / width
        mass = jaws.finger_density * volume
        z = -jaws.collar_base - jaws.pivot_height - length / 2
        centre = np.array([side * jaws.pivot_offset / 2, 0.0, z])
        squares = np.array([thickness, width, length]) ** 2
        tensor = mass / 12 * np.diag(squares.sum() - squares)
        parts.append(ne.Body(mass, centre, tensor, volume, centre))
    return parts


def _negative(body: ne.Body) -> ne.Body:
    return ne.Body(-body.mass, body.com, -body.tensor, -body.volume, body.cob)


def _lower(body: ne.Body, distance: float) -> ne.Body:
    down = np.array([0.0, 0.0, distance])
    return dataclasses.replace(body, com=body.com - down, cob=body.cob - down)


def link_frames(
    record: Alpha5Parameters, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rotations (5, N, 3, 3) and origins (5, N, 3) of link_0 to link_4 in base_link."""
    n = len(q)
    base = ne.rotation_z(np.full(n, record.base_yaw))
    rotations, origins = [base], [np.zeros((n, 3))]
    turn, place = np.broadcast_to(np.eye(3), (n, 3, 3)), np.zeros((n, 3))
    for i in range(4):
        row = record.dh[i]
        link = turn @ ne.rotation_z(q[:, i] + row.theta_offset)
        rotations.append(link)
        origins.append(place)
        place = place + link @ np.array([row.a, 0.0, row.d])
        turn = link @ ne.rotation_x(row.alpha)
    return np.array(rotations), np.array(origins)


def inverse_dynamics(
    record: Alpha5Parameters,
    q: np.ndarray,
    v: np.ndarray,
    a: np.ndarray,
    density: float,
    gravity: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Torques (N, 4), and force and moment of the arm on its mount, (N, 6)."""
    frames = link_frames(record, q)
    return of_bodies(bodies_of(record), frames, v, a, density, gravity)


def of_bodies(
    bodies: list[list[ne.Body]],
    frames: tuple[np.ndarray, np.ndarray],
    v: np.ndarray,
    a: np.ndarray,
    density: float,
    gravity: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """The same for bodies on links with these rotations and origins."""
    rotations, origins = frames
    motions = ne.link_motions(v, a, rotations, origins)
    force, moment = np.zeros((len(v), 3)), np.zeros((len(v), 3))
    tau = np.zeros((len(v), 4))
    for i in (4, 3, 2, 1, 0):
        if i < 4:
            moment = moment + np.cross(origins[i + 1] - origins[i], force)
        for body in bodies[i]:
            own = ne.force_and_moment(body, motions[i], density, gravity)
            force = force + own[0]
            moment = moment + own[1]
        if i > 0:
            tau[:, i - 1] = np.einsum("ni,ni->n", rotations[i][:, :, 2], moment)
    return tau, np.hstack([-force, -moment])


def mass_matrix(record: Alpha5Parameters, q: np.ndarray) -> np.ndarray:
    """The mass matrix at one q, (4, 4): torques of unit accelerations."""
    at = np.tile(q, (4, 1))
    nothing = np.zeros((4, 4))
    return inverse_dynamics(record, at, nothing, np.eye(4), 0.0, np.zeros(3))[0]


def states(record: Alpha5Parameters, count: int) -> tuple[np.ndarray, ...]:
    """q, v, a within the limits, (count, 4) each."""
    rng = np.random.default_rng(count)
    v = rng.uniform(-1.0, 1.0, (count, 4))
    a = rng.uniform(-2.0, 2.0, (count, 4))
    return own_arm.within(record, count, 3), v, a


def tcp(record: Alpha5Parameters, q: np.ndarray) -> np.ndarray:
    """Pose of the tcp in base_link at one q, (4, 4)."""
    pose = np.eye(4)
    rotation = own_arm.TOOL_AXES
    position = np.array([0.0, 0.0, record.dh[3].d - record.spacer])
    if record.tool is not None and not record.spacer:
        rotation, position = record.tool.rotation, record.tool.position
    pose[:3, :3], pose[:3, 3] = rotation, position
    return own_arm.link_4(record, q) @ pose


#: Ten arms: with and without spacer, and two on the other base frame.
RECORDS = [random_record(seed) for seed in range(8)]
RECORDS += [
    dataclasses.replace(
        a5.parameters(()),
        attached=(random_attached(np.random.default_rng(8), "eye", "link_3", 0.0),),
    ),
    dataclasses.replace(random_record(9), mount=random_mount(9)),
]
