"""Where a URDF's frames are: computed by other tools, and as the product of Table 1's rows."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.urdf_reading import UrdfRobot, read_urdf
from alpha5_model.dh.pinocchio import urdf_model
from alpha5_model.parameters import Alpha5Parameters


@dataclass(frozen=True, eq=False)
class Subject(UrdfRobot):
    """A URDF file that is checked.

    Attributes:
        path: The file.
        prefix: What stands before ``base_link`` in it.
    """

    path: Path
    prefix: str

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Subject:
        """Read a file; see `read_urdf` for what it raises."""
        robot = read_urdf(Path(path))
        base = [name for name in robot.links if name.endswith("base_link")]
        prefix = base[0].removesuffix("base_link") if len(base) == 1 else ""
        return cls(**vars(robot), path=Path(path), prefix=prefix)


class NotInstalledError(Exception):
    """The tool is not installed; caught, and said in the row."""


def configurations(p: Alpha5Parameters, count: int) -> FloatArray:
    """Seeded random joint positions within the limits, and every corner of the limits, (N, 4)."""
    lower, upper = (np.array([getattr(j, k) for j in p.joints[:4]]) for k in ("lower", "upper"))
    corners = np.where(np.indices((2,) * 4).reshape(4, -1).T == 0, lower, upper)
    return np.vstack([corners, np.random.default_rng(5).uniform(lower, upper, (count, 4))])


def dh_product(p: Alpha5Parameters, q: FloatArray) -> dict[str, FloatArray]:
    """Poses in base_link of all frames, from Table 1 and Section 2, by elementary matrices.

    Args:
        p: Table 1 in SI units.
        q: (N, 4) [rad].

    Returns:
        ``base_link``, ``link_0`` to ``link_4``, ``dh_1`` to ``dh_5`` and ``tcp`` -> (N, 4, 4).
    """

    def elementary(angle: Any, axis: int, shift: tuple[float, float, float]) -> FloatArray:
        angle = np.asarray(angle, dtype=np.float64)
        i, j = ((1, 2), (2, 0), (0, 1))[axis]
        out = np.zeros((*angle.shape, 4, 4))
        out[..., range(4), range(4)] = 1.0
        out[..., i, i] = out[..., j, j] = np.cos(angle)
        out[..., j, i] = np.sin(angle)
        out[..., i, j] = -out[..., j, i]
        out[..., :3, 3] = shift
        return out

    pose = np.broadcast_to(np.eye(4), (len(q), 4, 4))
    frames = {"base_link": pose, "link_0": pose @ elementary(p.base_yaw, 2, (0, 0, 0))}
    for i, row in enumerate(p.dh):
        angle = row.theta_offset + (q[:, i] if row.variable else 0.0)
        turned = pose @ elementary(angle, 2, (0, 0, 0))
        if row.variable:
            frames[f"link_{i + 1}"] = turned  # Section 2: after the rotation, before the rest
        pose = turned @ elementary(0.0, 2, (0, 0, row.d)) @ elementary(row.alpha, 0, (row.a, 0, 0))
        frames[f"dh_{i + 1}"] = pose
    frames["tcp"] = pose
    return frames


def frame_error(given: FloatArray, expected: FloatArray) -> float:
    """Larger of the errors in position [m] and orientation [rad], over all samples."""
    shift = np.linalg.norm(given[:, :3, 3] - expected[:, :3, 3], axis=-1).max()
    relative = np.swapaxes(expected[:, :3, :3], -1, -2) @ given[:, :3, :3]
    # |R - R^T| / 2 is sin(angle): exact for small angles, where acos of the trace is blind.
    sine = np.linalg.norm(relative - np.swapaxes(relative, -1, -2), axis=(-2, -1)) / np.sqrt(8)
    cosine = (np.trace(relative, axis1=-2, axis2=-1) - 1) / 2
    return float(max(shift, np.arctan2(sine, cosine).max()))


def pinocchio_frames(
    text: Subject, links: list[str], joints: list[str], q: FloatArray
) -> dict[str, FloatArray]:
    """Poses in base_link of the named links, name -> (N, 4, 4), by Pinocchio."""
    import pinocchio as pin

    model = urdf_model(text.path)
    data = model.createData()
    if absent := [n for n in joints if not model.existJointName(text.prefix + n)]:
        raise ValueError(f"no movable joint {', '.join(absent)}")
    columns = [model.joints[model.getJointId(text.prefix + n)].idx_q for n in joints]
    ids = {n: model.getFrameId(text.prefix + n, pin.FrameType.BODY) for n in links}
    base = ids["base_link"]
    out = {n: np.empty((len(q), 4, 4)) for n in links}
    position = pin.neutral(model)
    for k, row in enumerate(q):
        position[columns] = row
        pin.framesForwardKinematics(model, data, position)
        home = data.oMf[base].inverse()
        for name, index in ids.items():
            out[name][k] = (home * data.oMf[index]).homogeneous
    return out


def yourdfpy_frames(
    text: Subject, links: list[str], joints: list[str], q: FloatArray
) -> dict[str, FloatArray]:
    """Poses in base_link of the named links, name -> (N, 4, 4), by yourdfpy."""
    try:
        import yourdfpy
    except ImportError:
        raise NotInstalledError from None
    robot = yourdfpy.URDF.load(str(text.path), load_meshes=False, build_scene_graph=True)
    out = {n: np.empty((len(q), 4, 4)) for n in links}
    names = [text.prefix + n for n in joints]
    for k, row in enumerate(q):
        robot.update_cfg(dict(zip(names, row, strict=True)))
        for name in links:
            out[name][k] = robot.get_transform(text.prefix + name, text.prefix + "base_link")
    return out
