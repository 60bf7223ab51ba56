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
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.corrections import DEFAULT_CORRECTIONS
from alpha5_model.description.committed import NOT_DRAWN, can_draw, stale_files
from alpha5_model.description.urdf_reading import LIMITS
from alpha5_model.description.verification_frames import (
    NotInstalledError,
    Subject,
    configurations,
    dh_product,
    frame_error,
    pinocchio_frames,
    yourdfpy_frames,
)
from alpha5_model.description.verification_inertia import (
    closed_jaws,
    impossible_links,
    inertial_differences,
    jaw_limit_differences,
    link_4_is_split,
    stray_masses,
)
from alpha5_model.errors import FileFormatError, MissingFileError
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
    verdict: Verdict = "passed" if can_draw() else "not run"
    finding = "every file is what the generator writes now" if can_draw() else NOT_DRAWN
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
    text, p = Subject.read(path), parameters(corrections)
    jaws = any(text.prefix + name in text.links for name in _JAW_LINKS)
    q = configurations(p, samples)
    lists = [
        ("names", _missing_names(text, p, jaws), "links and joints of the arm"),
        ("joints", _joint_differences(text, p), "parents, axes, types and limits"),
        (
            "inertias",
            inertial_differences(text, jaws),
            "masses, COMs and tensors are Table 2's, to the last bit",
        ),
        ("stray masses", stray_masses(text, jaws), "massless frames say that they are massless"),
        ("physics", impossible_links(text), "every link with mass is a possible body"),
    ]
    rows = [
        *(_listed(text, *entry) for entry in lists),
        _check_urdf(text),
        _frames("Pinocchio", text, p, q, pinocchio_frames, FRAME_BOUND),
        _frames("yourdfpy", text, p, q[:: max(1, len(q) // 100)], yourdfpy_frames, YOURDFPY_BOUND),
    ]
    if jaws:
        rows.append(_closed_jaws(text))
        problems = jaw_limit_differences(text, p)
        rows.append(_listed(text, "jaw limits", problems, "rod and finger limits agree"))
    return tuple(rows)


def _listed(text: Subject, check: str, problems: list[str], claim: str) -> FileCheck:
    if not problems:
        return FileCheck(text.path.name, check, "passed", claim)
    more = f" (and {len(problems) - 3} more)" if len(problems) > 3 else ""
    return FileCheck(text.path.name, check, "failed", "; ".join(problems[:3]) + more)


def _missing_names(text: Subject, p: Alpha5Parameters, jaws: bool) -> list[str]:
    links = [*_LINKS, *(_JAW_LINKS if jaws else ())]
    joints = [joint.name for joint in p.joints[: 5 if jaws else 4]]
    return [
        *(f"no link {text.prefix}{n}" for n in links if text.prefix + n not in text.links),
        *(f"no joint {text.prefix}{n}" for n in joints if text.prefix + n not in text.joints),
    ]


def _joint_differences(text: Subject, p: Alpha5Parameters) -> list[str]:
    found = []
    for i, joint in enumerate(p.joints):
        given = text.joints.get(text.prefix + joint.name)
        if given is None:
            continue
        child = "jaw_rod" if joint.name == "axis_a" else f"link_{i + 1}"
        for what, ours, theirs in (
            ("type", joint.kind, given.kind),
            ("parent", text.prefix + f"link_{i}", given.parent),
            ("child", text.prefix + child, given.child),
            ("axis", [0.0, 0.0, 1.0], given.axis.tolist()),
            ("limits", *({k: getattr(j, k) for k in LIMITS} for j in (joint, given))),
        ):
            if ours != theirs:
                found.append(f"{given.name}: {what} {theirs}, expected {ours}")
    return found


def _check_urdf(text: Subject) -> FileCheck:
    row = partial(FileCheck, text.path.name, "check_urdf")
    # also beside the interpreter that runs: its environment may not be activated
    program = shutil.which("check_urdf") or shutil.which(
        "check_urdf", path=str(Path(sys.executable).parent)
    )
    if program is None:
        return row("not run", "the program check_urdf is not installed")
    done = subprocess.run(
        [program, str(text.path)], capture_output=True, text=True, errors="replace", check=False
    )
    if done.returncode == 0:
        return row("passed", "urdfdom reads it as one tree")
    words = " ".join((done.stderr + done.stdout).split())
    return row("failed", words[:200] or f"exit status {done.returncode}")


_Frames = Callable[[Subject, list[str], list[str], FloatArray], dict[str, FloatArray]]


def _frames(
    tool: str, text: Subject, p: Alpha5Parameters, q: FloatArray, compute: _Frames, bound: float
) -> FileCheck:
    """Forward kinematics of every frame by another tool against `dh_product`."""
    row = partial(FileCheck, text.path.name, f"frames, {tool}")
    expected = dh_product(p, q)
    wanted = [n for n in expected if n in _LINKS or text.prefix + n in text.links]
    joints = [joint.name for joint in p.joints[:4]]
    if absent := [n for n in wanted if text.prefix + n not in text.links]:
        return row("failed", f"no link {', '.join(absent)} to compute")
    try:
        given = compute(text, wanted, joints, q)
    except NotInstalledError:
        return row("not run", f"{tool} is not installed")
    except Exception as error:  # whatever a foreign parser raises means that it cannot load it
        return row("failed", f"{tool}: {' '.join(str(error).split())[:200]}")
    away = np.array([frame_error(given[name], expected[name]) for name in wanted])
    finding = (
        f"{len(wanted)} frames at {len(q)} joint positions against Table 1's DH product [m, rad]; "
        f"largest at {wanted[int(np.argmax(away))]}"
    )
    verdict: Verdict = "passed" if away.max() <= bound else "failed"
    return row(verdict, finding, float(away.max()), bound, "m, rad")


def _closed_jaws(text: Subject) -> FileCheck:
    row = partial(FileCheck, text.path.name, "closed jaws")
    if not link_4_is_split(text):
        return row("failed", "wrist, rod and fingers are not all there, with their joints")
    away = closed_jaws(text)
    finding = "wrist, rod and fingers have link 4's mass, first and second moments (relative)"
    return row("passed" if away <= FRAME_BOUND else "failed", finding, away, FRAME_BOUND)
