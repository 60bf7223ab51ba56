"""Proof that a URDF of the arm says what the document's tables say.

Every check reads the file anew and compares it with the printed tables by a second route: the numbers
of the text with the printed digits, the frames that other tools compute with the product of Table 1's
rows. A tool that is not installed gives a row ``not run``, which is not a pass.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.corrections import DEFAULT_CORRECTIONS
from alpha5_model.description.urdf_text import UrdfText, read_urdf
from alpha5_model.description.verification_inertia import (
    closed_jaws,
    impossible_links,
    inertial_differences,
    jaw_limit_differences,
    link_4_is_split,
    stray_masses,
)
from alpha5_model.parameters import Alpha5Parameters, parameters
from alpha5_model.paths import JAWS_URDF_PATH, URDF_PATH

Verdict = Literal["passed", "failed", "not run"]

#: Largest error of a frame, in metres and in radians; the project's promise for other tools is 1e-9.
FRAME_BOUND = 1e-12
YOURDFPY_BOUND = 1e-9
SAMPLES = 2000
_LINKS = ("base_link", "link_0", "link_1", "link_2", "link_3", "link_4", "tcp")
_JAW_LINKS = ("jaw_rod", "finger_1", "finger_2")


@dataclass(frozen=True)
class FileCheck:
    """One check of one file.

    Attributes:
        file: Name of the file.
        check: What was checked.
        measured: The largest deviation, in ``unit``; None where there is no figure.
        bound: The largest deviation that passes.
        unit: Of both.
        verdict: ``passed``, ``failed`` or ``not run``.
        finding: What was found, in one sentence.
    """

    file: str
    check: str
    measured: float | None
    bound: float | None
    unit: str
    verdict: Verdict
    finding: str


def verify_generated() -> tuple[FileCheck, ...]:
    """Check the committed URDF files, jaws locked and moving."""
    return verify_urdf(URDF_PATH) + verify_urdf(JAWS_URDF_PATH)


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
    text, p = read_urdf(path), parameters(corrections)
    jaws = any(text.prefix + name in text.links for name in _JAW_LINKS)
    q = configurations(p, samples)
    rows = [
        _listed("names", text, _missing_names(text, p, jaws), "links and joints of the arm"),
        _listed("joints", text, _joint_differences(text, p), "parents, axes, types and limits"),
        _listed(
            "inertias",
            text,
            inertial_differences(text, jaws),
            "masses, COMs and tensors are Table 2's, to the last bit",
        ),
        _listed(
            "stray masses",
            text,
            stray_masses(text, jaws),
            "massless frames say that they are massless",
        ),
        _listed("physics", text, impossible_links(text), "every link with mass is a possible body"),
        _check_urdf(text),
        _frames("Pinocchio", text, p, q, _pinocchio_frames, FRAME_BOUND),
        _frames("yourdfpy", text, p, q[:: max(1, len(q) // 100)], _yourdfpy_frames, YOURDFPY_BOUND),
    ]
    if jaws:
        rows.append(_closed_jaws(text))
        rows.append(
            _listed(
                "jaw limits", text, jaw_limit_differences(text, p), "rod and finger limits agree"
            )
        )
    return tuple(rows)


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


def _row(
    check: str,
    text: UrdfText,
    verdict: Verdict,
    finding: str,
    measured: float | None = None,
    bound: float | None = None,
    unit: str = "",
) -> FileCheck:
    return FileCheck(text.path.name, check, measured, bound, unit, verdict, finding)


def _listed(check: str, text: UrdfText, problems: list[str], claim: str) -> FileCheck:
    if not problems:
        return _row(check, text, "passed", claim)
    more = f" (and {len(problems) - 3} more)" if len(problems) > 3 else ""
    return _row(check, text, "failed", "; ".join(problems[:3]) + more)


def _missing_names(text: UrdfText, p: Alpha5Parameters, jaws: bool) -> list[str]:
    links = [*_LINKS, *(_JAW_LINKS if jaws else ())]
    joints = [joint.name for joint in p.joints[: 5 if jaws else 4]]
    return [
        *(f"no link {text.prefix}{n}" for n in links if text.prefix + n not in text.links),
        *(f"no joint {text.prefix}{n}" for n in joints if text.prefix + n not in text.joints),
    ]


def _joint_differences(text: UrdfText, p: Alpha5Parameters) -> list[str]:
    found = []
    for i, joint in enumerate(p.joints):
        given = text.joints.get(text.prefix + joint.name)
        if given is None:
            continue
        rod = joint.name == "axis_a"
        child = "jaw_rod" if rod else f"link_{i + 1}"
        for what, ours, theirs in (
            ("type", "prismatic" if rod else "revolute", given.kind),
            ("parent", text.prefix + f"link_{i}", given.parent),
            ("child", text.prefix + child, given.child),
            ("axis", [0.0, 0.0, 1.0], given.axis.tolist()),
            (
                "limits",
                {k: getattr(joint, k) for k in ("lower", "upper", "velocity", "effort")},
                given.limits,
            ),
        ):
            if ours != theirs:
                found.append(f"{given.name}: {what} {theirs}, expected {ours}")
    return found


def _check_urdf(text: UrdfText) -> FileCheck:
    program = shutil.which("check_urdf") or _beside_python("check_urdf")
    if program is None:
        return _row("check_urdf", text, "not run", "the program check_urdf is not installed")
    done = subprocess.run([program, str(text.path)], capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return _row("check_urdf", text, "passed", "urdfdom reads it as one tree")
    words = " ".join((done.stderr + done.stdout).split())
    return _row("check_urdf", text, "failed", words[:200] or f"exit status {done.returncode}")


def _beside_python(program: str) -> str | None:
    """A program of the environment whose interpreter runs, activated or not."""
    return shutil.which(program, path=str(Path(sys.executable).parent))


class _NotInstalledError(Exception):
    pass


_Frames = Callable[[UrdfText, list[str], list[str], FloatArray], dict[str, FloatArray]]


def _frames(
    tool: str, text: UrdfText, p: Alpha5Parameters, q: FloatArray, compute: _Frames, bound: float
) -> FileCheck:
    """Forward kinematics of every frame by another tool against `dh_product`."""
    check = f"frames, {tool}"
    expected = dh_product(p, q)
    wanted = [n for n in expected if n in _LINKS or text.prefix + n in text.links]
    joints = [joint.name for joint in p.joints[:4]]
    if absent := [n for n in wanted if text.prefix + n not in text.links]:
        return _row(check, text, "failed", f"no link {', '.join(absent)} to compute")
    try:
        given = compute(text, wanted, joints, q)
    except _NotInstalledError:
        return _row(check, text, "not run", f"{tool} is not installed")
    except Exception as error:  # whatever a foreign parser raises means that it cannot load it
        return _row(check, text, "failed", f"{tool}: {' '.join(str(error).split())[:200]}")
    away = np.array([_frame_error(given[name], expected[name]) for name in wanted])
    worst = wanted[int(np.argmax(away))]
    return _row(
        check,
        text,
        "passed" if away.max() <= bound else "failed",
        f"{len(wanted)} frames against the product of Table 1's rows at {len(q)} joint positions; "
        f"largest at {worst}",
        float(away.max()),
        bound,
        "m, rad",
    )


def _frame_error(given: FloatArray, expected: FloatArray) -> float:
    """Larger of the errors in position [m] and orientation [rad], over all samples."""
    shift = np.linalg.norm(given[:, :3, 3] - expected[:, :3, 3], axis=-1).max()
    relative = np.swapaxes(expected[:, :3, :3], -1, -2) @ given[:, :3, :3]
    # |R - R^T| / 2 is sin(angle): exact for small angles, where acos of the trace is blind.
    sine = np.linalg.norm(relative - np.swapaxes(relative, -1, -2), axis=(-2, -1)) / np.sqrt(8)
    cosine = (np.trace(relative, axis1=-2, axis2=-1) - 1) / 2
    return float(max(shift, np.arctan2(sine, cosine).max()))


def _pinocchio_frames(
    text: UrdfText, links: list[str], joints: list[str], q: FloatArray
) -> dict[str, FloatArray]:
    import pinocchio as pin

    model = pin.buildModelFromXML(text.path.read_text(encoding="utf-8"))
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


def _yourdfpy_frames(
    text: UrdfText, links: list[str], joints: list[str], q: FloatArray
) -> dict[str, FloatArray]:
    try:
        import yourdfpy
    except ImportError:
        raise _NotInstalledError from None
    robot = yourdfpy.URDF.load(str(text.path), load_meshes=False, build_scene_graph=True)
    out = {n: np.empty((len(q), 4, 4)) for n in links}
    names = [text.prefix + n for n in joints]
    for k, row in enumerate(q):
        robot.update_cfg(dict(zip(names, row, strict=True)))
        for name in links:
            out[name][k] = robot.get_transform(text.prefix + name, text.prefix + "base_link")
    return out


def _closed_jaws(text: UrdfText) -> FileCheck:
    check = "closed jaws"
    if not link_4_is_split(text):
        return _row(
            check, text, "failed", "wrist, rod and fingers are not all there, with their joints"
        )
    return _row(
        check,
        text,
        "passed" if (away := closed_jaws(text)) <= FRAME_BOUND else "failed",
        "mass, first and second moments of wrist, rod and fingers against link 4 of Table 2, relative",
        away,
        FRAME_BOUND,
    )
