"""All checks of a URDF file, and of the files that are committed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.description.verification.frames import (
    FRAME_BOUND,
    YOURDFPY_BOUND,
    check_frames,
    configurations,
    pinocchio_frames,
    yourdfpy_frames,
)
from alpha5_model.description.verification.jaws import (
    check_closed_jaws,
    jaw_limit_differences,
)
from alpha5_model.description.verification.own_arm import (
    mount_differences,
    own_inertial_differences,
)
from alpha5_model.description.verification.subject import FileCheck, Subject
from alpha5_model.description.verification.values import CHECKS, Finder
from alpha5_model.errors import FileFormatError, MissingFileError
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm, is_catalogue

SAMPLES = 2000


def verify_generated() -> tuple[FileCheck, ...]:
    """Check the committed URDF files."""
    rows: list[FileCheck] = []
    for path in (URDF_PATH, JAWS_URDF_PATH):
        try:
            rows += verify_urdf(path)
        except (FileFormatError, MissingFileError) as error:
            # The file is not the caller's input, so the error is a finding.
            unreadable = FileCheck(
                file=Path(path).name,
                check="readable",
                verdict="failed",
                finding=str(error),
            )
            rows.append(unreadable)
    return tuple(rows)


def verify_urdf(
    path: str | os.PathLike[str],
    corrections: Iterable[str] = DEFAULT_CORRECTIONS,
    samples: int = SAMPLES,
    arm: Alpha5Parameters | None = None,
) -> tuple[FileCheck, ...]:
    """Check a URDF of the arm against the printed tables, or against a record.

    Args:
        path: The file. It may have jaws, and a prefix of its names.
        corrections: Recorded corrections that it was generated with.
        samples: Number of random joint positions within the limits, in addition to the
            limits.
        arm: Record of an arm of your own, which has its corrections already; None for
            the catalogue's.

    Returns:
        One row per check.

    Raises:
        MissingFileError, FileFormatError: The file cannot be read as a URDF at all.
        UnknownNameError: A correction that is not recorded.
        InputError: ``arm`` is no record, or has other corrections.
    """
    record = chosen_arm(arm, corrections)
    text = Subject.read(path, record)
    checks = CHECKS if is_catalogue(record) else _checks_of_own(record)
    rows = []
    for check, (find, claim) in checks.items():
        rows.append(_check_values(text, check, find, claim))
    rows.append(_check_urdf(text))

    q = configurations(text.expected, samples)
    # yourdfpy is slow: a hundredth of the positions.
    few = q[:: max(1, len(q) // 100)]
    rows.append(check_frames("Pinocchio", text, q, pinocchio_frames, FRAME_BOUND))
    rows.append(check_frames("yourdfpy", text, few, yourdfpy_frames, YOURDFPY_BOUND))

    if text.jaws:
        rows.append(check_closed_jaws(text))
        claim = "rod and finger limits agree"
        rows.append(_check_values(text, "jaw limits", jaw_limit_differences, claim))
    return tuple(rows)


def _checks_of_own(arm: Alpha5Parameters) -> dict[str, tuple[Finder, str]]:
    """The checks of values for an arm of your own."""
    checks = dict(CHECKS)
    claim = "masses, COMs and tensors are the arm's, with what is attached"
    checks["inertias"] = (own_inertial_differences, claim)
    if arm.mount is not None:
        checks["mount"] = (mount_differences, "base_link is on the arm's mount")
    return checks


def _check_values(text: Subject, check: str, find: Finder, claim: str) -> FileCheck:
    """A row with the first problems found, or with the claim if there is none."""
    problems = list(find(text))
    if not problems:
        return text.row(check, "passed", claim)
    more = f" (and {len(problems) - 3} more)" if len(problems) > 3 else ""
    return text.row(check, "failed", "; ".join(problems[:3]) + more)


def _check_urdf(text: Subject) -> FileCheck:
    """Check that urdfdom's program reads the file."""
    # The environment of this Python may not be activated, so its folder is searched
    # too.
    beside = str(Path(sys.executable).parent)
    program = shutil.which("check_urdf") or shutil.which("check_urdf", path=beside)
    if program is None:
        finding = "the program check_urdf is not installed"
        return text.row("check_urdf", "not run", finding)

    done = subprocess.run(
        [program, str(text.path)],
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    if done.returncode == 0:
        return text.row("check_urdf", "passed", "urdfdom reads it as one tree")
    words = " ".join((done.stderr + done.stdout).split())
    finding = words[:200] or f"exit status {done.returncode}"
    return text.row("check_urdf", "failed", finding)
