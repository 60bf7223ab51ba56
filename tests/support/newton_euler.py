"""A recursive Newton-Euler of our own, in NumPy, from the tables of the document as printed.

It shares nothing with the package: Tables 1 to 3 as typed in `reference`, frames from Section 2 (with {0} not
turned by pi, the correction ``base_frame``), Newton's and Euler's equations written in the axes of the base for N states at once.
"""

from __future__ import annotations

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
    """Rotations (5, N, 3, 3) and origins (5, N, 3) of the inertial frames {0} to {4} in {0}."""
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
    """Joint torques (N, 4), and force and moment at the origin that the arm exerts on its mount (N, 3).

    ``held`` is a body at the tcp, in its axes: mass, COM, tensor at the COM, volume, centre of buoyancy.
    """
    g = np.asarray(gravity)
    rotations, origins = link_frames(q)
    bodies = list(zip(range(5), mass, COM, tensors(), volume, cob, strict=True))
    if held is not None:
        m, com, tensor, v_held, cob_held = held
        turn = rotation_x(ALPHA[3]) @ rotation_z(np.array(reference.DH[4][1]))
        tcp = np.array([A[3], 0.0, D[3]])
        held_tensor = turn @ tensor @ turn.T
        bodies.append(
            (4, m, tcp + turn @ com, held_tensor, v_held, tcp + turn @ cob_held)
        )
    n = len(q)
    omega, alpha, acceleration = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3))
    forces, moments, arms = [], [], []
    for i in range(5):
        rotation = rotations[i]
        if i > 0:
            step = origins[i] - origins[i - 1]
            acceleration = (
                acceleration
                + np.cross(alpha, step)
                + np.cross(omega, np.cross(omega, step))
            )
            z = rotation[:, :, 2]
            rate = z * v[:, i - 1, None]
            alpha = alpha + z * a[:, i - 1, None] + np.cross(omega, rate)
            omega = omega + rate
        total, turning = np.zeros((n, 3)), np.zeros((n, 3))
        for _, m, com, tensor, displaced, centre in (
            body for body in bodies if body[0] == i
        ):
            to_com, to_cob = rotation @ com, rotation @ centre
            com_acceleration = (
                acceleration
                + np.cross(alpha, to_com)
                + np.cross(omega, np.cross(omega, to_com))
            )
            world_tensor = rotation @ tensor @ np.swapaxes(rotation, 1, 2)
            spin = np.einsum("nij,nj->ni", world_tensor, omega)
            weightless = m * (com_acceleration - g)
            lift = -density * displaced * np.broadcast_to(g, (n, 3))
            total = total + weightless - lift
            turning = (
                turning
                + np.einsum("nij,nj->ni", world_tensor, alpha)
                + np.cross(omega, spin)
                + np.cross(to_com, weightless)
                - np.cross(to_cob, lift)
            )
        forces.append(total)
        moments.append(turning)
        arms.append(origins[i])
    force, moment, tau = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 4))
    for i in (4, 3, 2, 1, 0):
        outer = arms[i + 1] - arms[i] if i < 4 else np.zeros((n, 3))
        moment = moments[i] + moment + np.cross(outer, force)
        force = forces[i] + force
        if i > 0:
            tau[:, i - 1] = np.einsum("ni,ni->n", rotations[i][:, :, 2], moment)
    return tau, -force, -moment
