"""Checks of `real_tools` by linters of robot files: simcheck and truerig.

Both report things that are so on purpose. These are listed here with their reason, and
anything else fails, as does one of these that is no longer reported.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path

from conformance.conformance import installed
from conformance.ros_tools import NotThereError, Result, Workspace

from alpha5_model._support.paths import REPOSITORY_PATH

#: Check and links of simcheck's finding -> why it is so.
_AT_ZERO = "q = 0 is out of the limits"
_FLOAT = "a float of buoyancy is drawn as a point"
SIMCHECK = {
    "urdf": {
        "engine.rest_contacts link_0|link_2": _AT_ZERO,
        "engine.rest_contacts link_0|link_4": _AT_ZERO,
    },
    # MuJoCo starts at its key frame.
    "mjcf": {
        f"inertia.geometry link_{number}_buoyancy": _FLOAT for number in range(1, 5)
    },
}
_FRAME = "a frame without a body"
#: Link and message of truerig's finding, without numbers -> why it is so.
TRUERIG = {
    "urdf": {
        "tcp: non-positive mass": _FRAME,
        "tcp: non-positive diagonal inertia": _FRAME,
        "tcp: inertia tensor not positive-definite": _FRAME,
        "base_link: non-leaf link has no inertia": _FRAME,
    },
    "mjcf": {"base_link: non-leaf link has no inertia": _FRAME},
}


def simcheck(work: Workspace) -> Result:
    """The URDF and the MuJoCo model, errors and warnings."""
    return _lint("simcheck", work, SIMCHECK)


def truerig(work: Workspace) -> Result:
    """The same, inertias and kinematics."""
    return _lint("truerig", work, TRUERIG)


def _lint(
    name: str, work: Workspace, explained: Mapping[str, Mapping[str, str]]
) -> Result:
    """Run a linter on both files; what is not explained is a complaint."""
    if not installed(name):
        raise NotThereError(f"{name} not there")
    folder = copied(work.folder / name)
    find = {"simcheck": simcheck_findings, "truerig": truerig_findings}[name]
    texts = []
    complaints = []
    for kind, file in (("urdf", "urdf/alpha5.urdf"), ("mjcf", "mjcf/alpha5.xml")):
        found = find(folder / file)
        complaints += unexplained(kind, found, explained[kind])
        reasons = sorted({explained[kind].get(one, "") for one in found} - {""})
        because = f" ({', '.join(reasons)})" if reasons else ""
        plural = "" if len(found) == 1 else "s"
        texts.append(f"{kind}: {len(found)} finding{plural}{because}")
    return Result("; ".join(texts), complaints=tuple(complaints), version=version(name))


def copied(folder: Path) -> Path:
    """The files in a folder of their own, where no settings of a linter are."""
    for name in ("urdf", "meshes", "mjcf"):
        shutil.copytree(Path(REPOSITORY_PATH) / name, folder / name)
    return folder


def unexplained(
    kind: str, found: Iterable[str], explained: Mapping[str, str]
) -> list[str]:
    """Findings without a reason, and reasons without a finding."""
    there = set(found)
    new = [f"{kind}: {one}" for one in sorted(there - set(explained))]
    gone = [f"{kind}: no longer {one}" for one in sorted(set(explained) - there)]
    return new + gone


def simcheck_findings(file: Path) -> list[str]:
    """Errors and warnings: the check, and what it is about."""
    command = [sys.executable, "-m", "simcheck", "check", "--no-config"]
    options = ["--engines", "mujoco", "--quiet", "--json", "-", str(file)]
    report = _report([*command, *options])
    found = []
    for check in report["results"]:
        for finding in check["findings"]:
            if finding["severity"] in ("error", "warning"):
                found.append(f"{finding['check']} {finding['target']}")
    return found


def truerig_findings(file: Path) -> list[str]:
    """Errors and warnings: the element, and the message without its numbers."""
    program = Path(sys.executable).with_name("truerig")
    report = _report([str(program), "validate", "--report", "json", str(file)])
    found = []
    for event in report["events"]:
        if event["severity"] in ("error", "warn"):
            message = event["message"].partition(" (")[0]
            found.append(f"{event['element']}: {message}")
    return found


def _report(command: list[str]) -> dict:
    """What a linter prints as JSON; its status says only whether it found errors."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if not done.stdout.strip():
        raise RuntimeError(f"{command[0]} printed nothing: {done.stderr[-200:]}")
    return json.loads(done.stdout[done.stdout.index("{") :])
