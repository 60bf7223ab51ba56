"""A recursive Newton-Euler of our own, in NumPy, from the tables of the document.

It shares nothing with the package. Tables 1 to 3 are those typed in `reference`; frames
are those of Section 2, with {0} not turned by pi (the correction ``base_frame``).
Newton's and Euler's equations are written in the axes of the base for N states at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import reference

# Table 1 and Section 2's offsets of theta, SI; the fixed last row moves nothing here.
D, OFFSET, A, ALPHA = np.array(reference.DH[:4]).T * [[1e-3], [1.0], [1e-3], [1.0]]
# Tables 2 and 3, SI; the tensors still have SolidWorks' sign.
MASS, COM = np.array(reference.MASS), np.array(reference.COM) / 1000
PRINTED = np.array(reference.INERTIA) * 1e-6
VOLUME, COB = np.array(reference.VOLUME) / 1000, np.array(reference.COB) / 1000


def tensors() -> np.ndarray:
    """(5, 3, 3) at the COM [kg m^2], products negated."""
    xx, yy, zz, xy, xz, yz = PRINTED.T
    rows = [[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]]
    return np.moveaxis(np.array(rows), 2, 0)


def rotation_z(angle: np.ndarray) -> np.ndarray:
    c, s, o, e = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.moveaxis(np.array([[c, -s, o], [s, c, o], [o, o, e]]), (0, 1), (-2, -1))


def rotation_x(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def link_frames(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotations (5, N, 3, 3) and origins (5, N, 3) of the inertial frames, in {0}."""
    n = len(q)
    rotations, origins = [np.broadcast_to(np.eye(3), (n, 3, 3))], [np.zeros((n, 3))]
    dh_rotation, dh_origin = rotations[0], origins[0]
    for i in range(4):
        turned = dh_rotation @ rotation_z(q[:, i] + OFFSET[i])
        rotations.append(turned)
        origins.append(dh_origin)
        dh_origin = dh_origin + turned @ np.array([A[i], 0.0, D[i]])
        dh_rotation = turned @ rotation_x(ALPHA[i])
    return np.array(rotations), np.array(origins)


@dataclass(frozen=True)
class Body:
    """A body in the axes of a link: kg, m, kg m^2, m^3."""

    mass: float
    com: np.ndarray
    tensor: np.ndarray
    volume: float
    cob: np.ndarray


@dataclass(frozen=True)
class LinkMotion:
    """The motion of a link's frame in the axes of the base, (N, 3) each."""

    rotation: np.ndarray
    omega: np.ndarray
    alpha: np.ndarray
    acceleration: np.ndarray

    def acceleration_at(self, point: np.ndarray) -> np.ndarray:
        """The acceleration of a point, seen from the frame's origin."""
        return self.acceleration + self.turning_at(point)

    def turning_at(self, point: np.ndarray) -> np.ndarray:
        """The acceleration that turning adds at a point."""
        tangential = np.cross(self.alpha, point)
        centripetal = np.cross(self.omega, np.cross(self.omega, point))
        return tangential + centripetal


def link_motions(
    v: np.ndarray, a: np.ndarray, rotations: np.ndarray, origins: np.ndarray
) -> list[LinkMotion]:
    """The motions of link_0, which rests, to link_4."""
    rest = np.zeros((len(v), 3))
    motions = [
        LinkMotion(rotation=rotations[0], omega=rest, alpha=rest, acceleration=rest)
    ]
    for i in range(1, 5):
        before = motions[-1]
        z = rotations[i][:, :, 2]
        rate = z * v[:, i - 1, None]
        turning = z * a[:, i - 1, None] + np.cross(before.omega, rate)
        motion = LinkMotion(
            rotation=rotations[i],
            omega=before.omega + rate,
            alpha=before.alpha + turning,
            acceleration=before.acceleration_at(origins[i] - origins[i - 1]),
        )
        motions.append(motion)
    return motions


def force_and_moment(
    body: Body, motion: LinkMotion, density: float, g: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment (N, 3) on a body in the fluid, about the link's origin."""
    rotation = motion.rotation
    to_com = rotation @ body.com
    to_cob = rotation @ body.cob
    weightless = body.mass * (motion.acceleration_at(to_com) - g)
    lift = -density * body.volume * np.broadcast_to(g, weightless.shape)

    world_tensor = rotation @ body.tensor @ np.swapaxes(rotation, 1, 2)
    spin = np.einsum("nij,nj->ni", world_tensor, motion.omega)
    turning = np.einsum("nij,nj->ni", world_tensor, motion.alpha)
    turning = turning + np.cross(motion.omega, spin)
    moment = turning + np.cross(to_com, weightless) - np.cross(to_cob, lift)
    return weightless - lift, moment


def held_body(
    mass: float, com: np.ndarray, tensor: np.ndarray, volume: float, cob: np.ndarray
) -> Body:
    """A body given in the axes of the tcp, in those of link_4."""
    turn = rotation_x(ALPHA[3]) @ rotation_z(np.array(reference.DH[4][1]))
    tcp = np.array([A[3], 0.0, D[3]])
    return Body(
        mass=mass,
        com=tcp + turn @ com,
        tensor=turn @ tensor @ turn.T,
        volume=volume,
        cob=tcp + turn @ cob,
    )


def newton_euler(
    q: np.ndarray,
    v: np.ndarray,
    a: np.ndarray,
    density: float,
    gravity: tuple[float, float, float] | np.ndarray = (0.0, 0.0, -9.81),
    mass: np.ndarray = MASS,
    volume: np.ndarray = VOLUME,
    cob: np.ndarray = COB,
    held: tuple[float, np.ndarray, np.ndarray, float, np.ndarray] | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joint torques (N, 4), and force and moment (N, 3) of the arm on its mount.

    The moment is about the mount's origin. ``held`` is a body at the tcp, in its axes:
    mass, COM, tensor at the COM, volume, centre of buoyancy.
    """
    g = np.asarray(gravity)
    rotations, origins = link_frames(q)
    motions = link_motions(v, a, rotations, origins)
    numbers = zip(mass, COM, tensors(), volume, cob, strict=True)
    bodies = [[Body(*of_link)] for of_link in numbers]
    if held is not None:
        bodies[4].append(held_body(*held))

    # From the tip inwards, each joint carries all that is outside of it.
    force, moment, tau = (
        np.zeros((len(q), 3)),
        np.zeros((len(q), 3)),
        np.zeros((len(q), 4)),
    )
    for i in (4, 3, 2, 1, 0):
        if i < 4:
            moment = moment + np.cross(origins[i + 1] - origins[i], force)
        for body in bodies[i]:
            own_force, own_moment = force_and_moment(body, motions[i], density, g)
            force = force + own_force
            moment = moment + own_moment
        if i > 0:
            tau[:, i - 1] = np.einsum("ni,ni->n", rotations[i][:, :, 2], moment)
    return tau, -force, -moment
