"""Proof that a URDF of the arm says what the document's tables say.

Every check reads the file anew and compares it with the printed tables by a second route: the numbers
of the text with the printed digits, the frames that other tools compute with the product of Table 1's
rows, which the code that made the file does not form. If a tool is not installed, its row says
``not run``, which does not count as passed.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.corrections import DEFAULT_CORRECTIONS
from alpha5_model.description.committed import not_generated, stale_files
from alpha5_model.description.verification_text import (
    CHECKS,
    Subject,
    closed_jaws,
    jaw_limit_differences,
)
from alpha5_model.dh.link import dh_transform
from alpha5_model.dh.urdf import urdf_model
from alpha5_model.errors import FileFormatError, MissingFileError
from alpha5_model.parameters import Alpha5Parameters, parameters
from alpha5_model.paths import JAWS_URDF_PATH, URDF_PATH

Verdict = Literal["passed", "failed", "not run"]

#: Largest error of a frame, in metres and in radians; the project's promise for other tools is 1e-9.
FRAME_BOUND = 1e-12
YOURDFPY_BOUND = 1e-9
SAMPLES = 2000


@dataclass(frozen=True)
class FileCheck:
    """One check of one file.

    Attributes:
        file: Name of the file.
        check: What was checked.
        verdict: ``passed``, ``failed`` or ``not run``.
        finding: What was found, in one sentence.
        measured: The largest deviation, in ``unit``; None where there is no figure.
        bound: The largest deviation that passes.
        unit: Of both.
    """

    file: str
    check: str
    verdict: Verdict
    finding: str
    measured: float | None = None
    bound: float | None = None
    unit: str = ""


def verify_generated() -> tuple[FileCheck, ...]:
    """Check the committed URDF files, jaws locked and moving, and that no generated file is stale."""
    finding = "; ".join(not_generated())
    verdict: Verdict = "not run" if finding else "passed"
    finding = finding or "every file is what the generator writes now"
    if stale := [file.path for file in stale_files()]:
        verdict, finding = "failed", f"stale: {', '.join(stale)}"
    fresh = FileCheck("generated files", "fresh", verdict, finding)
    return (*_verify_committed(URDF_PATH), *_verify_committed(JAWS_URDF_PATH), fresh)


def _verify_committed(path: str) -> tuple[FileCheck, ...]:
    """A committed file that cannot be read has failed: it is not the caller's input."""
    try:
        return verify_urdf(path)
    except (FileFormatError, MissingFileError) as error:
        return (FileCheck(Path(path).name, "readable", "failed", str(error)),)


def verify_urdf(
    path: str | os.PathLike[str],
    corrections: Iterable[str] = DEFAULT_CORRECTIONS,
    samples: int = SAMPLES,
) -> tuple[FileCheck, ...]:
    """Check a URDF of the arm against the printed tables.

    Args:
        path: The file; whether it has jaws, and the prefix of its names, are read from it.
        corrections: Recorded corrections that it was generated with.
        samples: Number of random joint positions within the limits; the limits come on top.

    Returns:
        One row per check.

    Raises:
        MissingFileError, FileFormatError: The file cannot be read as a URDF at all.
        UnknownNameError: A correction that is not recorded.
    """
    text = Subject.read(path, parameters(corrections))
    q = configurations(text.expected, samples)
    rows = [
        *(_listed(text, name, find(text), claim) for name, (find, claim) in CHECKS.items()),
        _check_urdf(text),
        _frames("Pinocchio", text, q, pinocchio_frames, FRAME_BOUND),
        _frames("yourdfpy", text, q[:: max(1, len(q) // 100)], yourdfpy_frames, YOURDFPY_BOUND),
    ]
    if text.jaws:
        limits, claim = jaw_limit_differences(text), "rod and finger limits agree"
        rows += [_closed_jaws(text), _listed(text, "jaw limits", limits, claim)]
    return tuple(rows)


def _listed(text: Subject, check: str, problems: list[str], claim: str) -> FileCheck:
    if not problems:
        return FileCheck(text.path.name, check, "passed", claim)
    more = f" (and {len(problems) - 3} more)" if len(problems) > 3 else ""
    return FileCheck(text.path.name, check, "failed", "; ".join(problems[:3]) + more)


def _check_urdf(text: Subject) -> FileCheck:
    row = partial(FileCheck, text.path.name, "check_urdf")
    beside = str(Path(sys.executable).parent)  # of an environment that may not be activated
    program = shutil.which("check_urdf") or shutil.which("check_urdf", path=beside)
    if program is None:
        return row("not run", "the program check_urdf is not installed")
    command = [program, str(text.path)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode == 0:
        return row("passed", "urdfdom reads it as one tree")
    words = " ".join((done.stderr + done.stdout).split())
    return row("failed", words[:200] or f"exit status {done.returncode}")


#: From the file, names of its frames without prefix, base_link first, and joint positions (N, 4) to the
#: frames' poses in base_link, N times (F, 4, 4).
_Tool = Callable[[Subject, list[str], FloatArray], Iterator[list[FloatArray]]]


def _frames(tool: str, text: Subject, q: FloatArray, compute: _Tool, bound: float) -> FileCheck:
    """Forward kinematics of every frame by another tool against `dh_product`."""
    row = partial(FileCheck, text.path.name, f"frames, {tool}")
    expected = dh_product(text.expected, q)
    wanted = [n for n in expected if n[:3] != "dh_" or text.prefix + n in text.links]
    if absent := [n for n in wanted if text.prefix + n not in text.links]:
        return row("failed", f"no link {', '.join(absent)} to compute")
    try:
        given = np.array(list(compute(text, wanted, q)))
    except ImportError:
        return row("not run", f"{tool} is not installed")
    except Exception as error:  # other tools raise anything for a file that they cannot load
        return row("failed", f"{tool}: {' '.join(str(error).split())[:200]}")
    away = np.array([frame_error(given[:, k], expected[name]) for k, name in enumerate(wanted)])
    finding = (
        f"{len(wanted)} frames at {len(q)} joint positions against Table 1's DH product [m, rad]; "
        f"largest at {wanted[int(np.argmax(away))]}"
    )
    verdict: Verdict = "passed" if away.max() <= bound else "failed"
    return row(verdict, finding, float(away.max()), bound, "m, rad")


def _closed_jaws(text: Subject) -> FileCheck:
    row = partial(FileCheck, text.path.name, "closed jaws")
    away = closed_jaws(text)
    if away is None:
        return row("failed", "wrist, rod and fingers are not all there, with their joints")
    finding = "wrist, rod and fingers have link 4's mass, first and second moments (relative)"
    return row("passed" if away <= FRAME_BOUND else "failed", finding, away, FRAME_BOUND)


def configurations(p: Alpha5Parameters, count: int) -> FloatArray:
    """Seeded random joint positions within the limits, and every corner of the limits, (N, 4)."""
    lower, upper = (np.array([getattr(j, k) for j in p.joints[:4]]) for k in ("lower", "upper"))
    corners = np.where(np.indices((2,) * 4).reshape(4, -1).T == 0, lower, upper)
    return np.vstack([corners, np.random.default_rng(5).uniform(lower, upper, (count, 4))])


def dh_product(p: Alpha5Parameters, q: FloatArray) -> dict[str, FloatArray]:
    """Poses in base_link of all frames, from Table 1 and Section 2, by the relative poses A_j.

    Args:
        p: Table 1 in SI units.
        q: (N, 4) [rad].

    Returns:
        ``base_link``, ``link_0`` to ``link_4``, ``dh_1`` to ``dh_5`` and ``tcp`` -> (N, 4, 4).
    """
    pose = np.broadcast_to(np.eye(4), (len(q), 4, 4))
    frames = {"base_link": pose, "link_0": pose @ dh_transform(p.base_yaw, 0, 0, 0)}
    for i, row in enumerate(p.dh):
        angle = row.theta_offset + (q[:, i] if row.variable else 0.0)
        if row.variable:  # Section 2: after the rotation, before the rest
            frames[f"link_{i + 1}"] = pose @ dh_transform(angle, 0, 0, 0)
        pose = pose @ dh_transform(angle, row.d, row.a, row.alpha)
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


def pinocchio_frames(text: Subject, links: list[str], q: FloatArray) -> Iterator[list[FloatArray]]:
    """Poses of the links by Pinocchio; see `_Tool`."""
    import pinocchio as pin

    model = urdf_model(text.path)
    data = model.createData()
    if absent := [n for n in text.turning if not model.existJointName(text.prefix + n)]:
        raise ValueError(f"no movable joint {', '.join(absent)}")
    columns = [model.joints[model.getJointId(text.prefix + n)].idx_q for n in text.turning]
    frames = [model.getFrameId(text.prefix + n, pin.FrameType.BODY) for n in links]
    position = pin.neutral(model)
    for row in q:
        position[columns] = row
        pin.framesForwardKinematics(model, data, position)
        home = data.oMf[frames[0]].inverse()
        yield [(home * data.oMf[frame]).homogeneous for frame in frames]


def yourdfpy_frames(text: Subject, links: list[str], q: FloatArray) -> Iterator[list[FloatArray]]:
    """Poses of the links by yourdfpy; see `_Tool`."""
    import yourdfpy

    robot = yourdfpy.URDF.load(str(text.path), load_meshes=False, build_scene_graph=True)
    names = [text.prefix + n for n in text.turning]
    for row in q:
        robot.update_cfg(dict(zip(names, row, strict=True)))
        yield [robot.get_transform(text.prefix + n, text.prefix + links[0]) for n in links]
