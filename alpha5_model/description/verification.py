"""Proof that a URDF of the arm says what the document's tables say.

Every check reads the file anew and compares it with the printed tables by a second route: the numbers
of the text with the printed digits, the frames that other tools compute with the product of Table 1's
rows, which the code that made the file does not form. If a tool is not installed, its row says
``not run``, which does not count as passed.
"""

from __future__ import annotations

import logging
import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Literal

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.description.committed import not_generated, stale_files
from alpha5_model.description.reading import LIMITS, UrdfJoint, UrdfRobot, read_urdf
from alpha5_model.errors import FileFormatError, MissingFileError
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.inertia import inconsistencies, pseudo_inertia
from alpha5_model.numbers.parameters import Alpha5Parameters, in_si, parameters
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES
from alpha5_model.theory.dh.link import dh_transform
from alpha5_model.theory.dh.urdf import urdf_model

Verdict = Literal["passed", "failed", "not run"]
Finder = Callable[["Subject"], Iterator[str]]

#: Largest error of a frame, in metres and in radians; the project's promise for other tools is 1e-9.
FRAME_BOUND = 1e-12
YOURDFPY_BOUND = 1e-9
SAMPLES = 2000
JAW_LINKS = ("jaw_rod", "finger_1", "finger_2")
_CHILDREN = (*BODY_NAMES[1:], "jaw_rod")


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


@dataclass(frozen=True, eq=False)
class Subject(UrdfRobot):
    """A URDF file that is checked.

    Attributes:
        path: The file.
        prefix: What stands before ``base_link`` in it.
        expected: What it should say.
    """

    path: Path
    prefix: str
    expected: Alpha5Parameters

    @classmethod
    def read(cls, path: str | os.PathLike[str], expected: Alpha5Parameters) -> Subject:
        """Read a file; see `read_urdf` for what it raises."""
        robot = read_urdf(Path(path))
        base = [name for name in robot.links if name.endswith("base_link")]
        prefix = base[0].removesuffix("base_link") if len(base) == 1 else ""
        return cls(**vars(robot), path=Path(path), prefix=prefix, expected=expected)

    @property
    def jaws(self) -> bool:
        """Whether there is a link of moving jaws."""
        return any(self.prefix + name in self.links for name in JAW_LINKS)

    @property
    def carriers(self) -> dict[str, UrdfJoint]:
        """Link -> the joint that carries it."""
        return {joint.child: joint for joint in self.joints.values()}


def verify_generated() -> tuple[FileCheck, ...]:
    """Check the committed URDF files, jaws locked and moving, and that no generated file is stale."""
    rows: list[FileCheck] = []
    for path in (URDF_PATH, JAWS_URDF_PATH):
        try:
            rows += verify_urdf(path)
        except (
            FileFormatError,
            MissingFileError,
        ) as error:  # it is not the caller's input
            rows.append(FileCheck(Path(path).name, "readable", "failed", str(error)))
    finding = "; ".join(not_generated())
    verdict: Verdict = "not run" if finding else "passed"
    finding = finding or "every file is what the generator writes now"
    if stale := [file.path for file in stale_files()]:
        verdict, finding = "failed", f"stale: {', '.join(stale)}"
    return (*rows, FileCheck("generated files", "fresh", verdict, finding))


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
    rows, few = (
        [_listed(text, k, *how) for k, how in CHECKS.items()],
        max(1, len(q) // 100),
    )
    rows += [
        _check_urdf(text),
        _frames("Pinocchio", text, q, pinocchio_frames, FRAME_BOUND),
    ]
    rows.append(_frames("yourdfpy", text, q[::few], yourdfpy_frames, YOURDFPY_BOUND))
    if text.jaws:
        limits = _jaw_limit_differences, "rod and finger limits agree"
        rows += [_closed_jaws(text), _listed(text, "jaw limits", *limits)]
    return tuple(rows)


def _listed(text: Subject, check: str, find: Finder, claim: str) -> FileCheck:
    problems = list(find(text))
    if not problems:
        return FileCheck(text.path.name, check, "passed", claim)
    more = f" (and {len(problems) - 3} more)" if len(problems) > 3 else ""
    return FileCheck(text.path.name, check, "failed", "; ".join(problems[:3]) + more)


def _check_urdf(text: Subject) -> FileCheck:
    row = partial(FileCheck, text.path.name, "check_urdf")
    beside = str(
        Path(sys.executable).parent
    )  # of an environment that may not be activated
    program = shutil.which("check_urdf") or shutil.which("check_urdf", path=beside)
    if program is None:
        return row("not run", "the program check_urdf is not installed")
    command = [program, str(text.path)]
    done = subprocess.run(
        command, capture_output=True, text=True, errors="replace", check=False
    )
    if done.returncode == 0:
        return row("passed", "urdfdom reads it as one tree")
    words = " ".join((done.stderr + done.stdout).split())
    return row("failed", words[:200] or f"exit status {done.returncode}")


# What yourdfpy logs about a file, its row says.
logging.getLogger("yourdfpy").addHandler(logging.NullHandler())

#: From the file, names of its frames without prefix, base_link first, and joint positions (N, 4) to the
#: frames' poses in base_link, N times (F, 4, 4).
_Tool = Callable[[Subject, list[str], FloatArray], Iterator[list[FloatArray]]]


def _frames(
    tool: str, text: Subject, q: FloatArray, compute: _Tool, bound: float
) -> FileCheck:
    """Forward kinematics of every frame by another tool against `dh_product`."""
    row = partial(FileCheck, text.path.name, f"frames, {tool}")
    expected = dh_product(text.expected, q)
    wanted = [n for n in expected if n[:3] != "dh_" or text.prefix + n in text.links]
    if absent := [n for n in wanted if text.prefix + n not in text.links]:
        return row("failed", f"no link {', '.join(absent)} to compute")
    try:
        with np.errstate(
            all="ignore"
        ):  # infinite numbers of the file; the row says what they do
            given = np.array(list(compute(text, wanted, q)))
    except ImportError:
        return row("not run", f"{tool} is not installed")
    except (
        Exception
    ) as error:  # other tools raise anything for a file that they cannot load
        return row("failed", f"{tool}: {' '.join(str(error).split())[:200]}")
    away = np.array(
        [frame_error(given[:, k], expected[name]) for k, name in enumerate(wanted)]
    )
    count, largest = (
        f"{len(wanted)} frames at {len(q)} joint positions",
        float(away.max()),
    )
    finding = f"{count} against Table 1's DH product [m, rad]; largest at {wanted[away.argmax()]}"
    return row(
        "passed" if largest <= bound else "failed", finding, largest, bound, "m, rad"
    )


# --- the text against the printed digits


@cache
def _table_2() -> tuple[tuple[float, list[float], FloatArray, FloatArray], ...]:
    """Mass, COM, I_COM in URDF sign and I_Link as printed, in SI.

    From the printed digits and not from the SI record that the generator uses: SolidWorks prints
    ``+(integral of x y dm)`` off the diagonal, the format wants the negative.
    """
    rows = []
    for row in published().table_2.rows:
        at_com, at_link = np.array(in_si((row.inertia_com, row.inertia_link)))
        rows.append((row.mass.si, in_si(row.com), _opposite_products(at_com), at_link))
    return tuple(rows)


def _opposite_products(tensor: FloatArray) -> FloatArray:
    return np.where(np.eye(3, dtype=bool), tensor, -tensor)


def _missing_names(text: Subject) -> Iterator[str]:
    """Links and joints of the arm that are not there."""
    links = ["base_link", *BODY_NAMES, "tcp", *(JAW_LINKS if text.jaws else ())]
    joints = JOINT_NAMES[: 5 if text.jaws else 4]
    yield from (
        f"no link {text.prefix}{n}" for n in links if text.prefix + n not in text.links
    )
    yield from (
        f"no joint {text.prefix}{n}"
        for n in joints
        if text.prefix + n not in text.joints
    )


def _joint_differences(text: Subject) -> Iterator[str]:
    """Types, parents, children, axes and limits that are not the arm's."""
    for i, (joint, child) in enumerate(
        zip(text.expected.joints, _CHILDREN, strict=True)
    ):
        given = text.joints.get(text.prefix + joint.name)
        if given is None:
            continue
        for what, ours, theirs in (
            ("type", joint.kind, given.kind),
            ("parent", text.prefix + f"link_{i}", given.parent),
            ("child", text.prefix + child, given.child),
            ("axis", [0.0, 0.0, 1.0], given.axis.tolist()),
            ("limits", *({k: getattr(j, k) for k in LIMITS} for j in (joint, given))),
        ):
            if ours != theirs:
                yield f"{given.name}: {what} {theirs}, expected {ours}"


def _inertial_differences(text: Subject) -> Iterator[str]:
    """Masses, COMs and tensors that are not Table 2's, to the last bit.

    With jaws, link 4 is in four parts and `_closed_jaws` compares their sum.
    """
    for i, (mass, com, tensor, at_link) in enumerate(
        _table_2()[: 4 if text.jaws else 5]
    ):
        name = f"{text.prefix}link_{i}"
        given = text.links.get(name)
        if given is None or given.mass is None:
            yield f"{name}: no inertial"
            continue
        if given.mass != mass:
            yield f"{name}: mass {given.mass!r} kg, expected {mass!r}"
        if given.com.tolist() != com:
            away = float(np.linalg.norm(given.com - com)) * 1e3
            yield f"{name}: COM {given.com.tolist()} m, {away:.3g} mm from Table 2's"
        if given.inertia.tolist() != tensor.tolist():
            away = float(np.abs(given.inertia - tensor).max()) * 1e6
            words = _usual_mistake(given.inertia, tensor, at_link)
            yield f"{name}: inertia is {away:.3g} kg mm^2 from Table 2's I_COM{words}"


def _usual_mistake(given: FloatArray, tensor: FloatArray, at_link: FloatArray) -> str:
    """The two mistakes that public models make, by name."""
    alike = partial(np.allclose, rtol=1e-3, atol=1e-12)
    if alike(given, _opposite_products(tensor)):
        return " (products of inertia with SolidWorks' sign)"
    return " (it is I_Link)" if alike(np.abs(given), np.abs(at_link)) else ""


def _stray_masses(text: Subject) -> Iterator[str]:
    """Links beside the arm's that weigh something, and massless frames that do not say so."""
    mine = {text.prefix + "base_link"}  # and what it carries, not what it is mounted on
    for joint in text.joints.values():  # from the root outwards
        if joint.parent in mine:
            mine.add(joint.child)
    heavy = {
        text.prefix + name for name in (*BODY_NAMES, *(JAW_LINKS if text.jaws else ()))
    }
    for name in sorted(mine - heavy):
        given = text.links.get(name)
        if given is None or given.mass is None:
            # PyBullet gives such a link a mass of 1 kg; on a root KDL warns about any inertial element.
            if name in text.carriers:
                yield f"{name}: no inertial element"
        elif given.mass or given.inertia.any():
            yield f"{name}: mass {given.mass:g} kg where there is no body"


def _impossible_links(text: Subject) -> Iterator[str]:
    """Links that cannot be bodies; see `alpha5_model.numbers.inertia.inconsistencies`."""
    for name, given in text.links.items():
        if given.mass is not None and (given.mass or given.inertia.any()):
            problems = inconsistencies(given.mass, given.com, given.inertia)
            yield from (f"{name}: {problem}" for problem in problems)


#: Check -> what it finds, and what it claims if that is nothing.
CHECKS: dict[str, tuple[Finder, str]] = {
    "names": (_missing_names, "links and joints of the arm"),
    "joints": (_joint_differences, "parents, axes, types and limits"),
    "inertias": (
        _inertial_differences,
        "masses, COMs and tensors are Table 2's, to the last bit",
    ),
    "stray masses": (_stray_masses, "massless frames say that they are massless"),
    "physics": (_impossible_links, "every link with mass is a possible body"),
}


def _closed_jaws(text: Subject) -> FileCheck:
    """Largest relative error of the assembly's pseudo-inertia about the origin of link 4.

    The 4x4 pseudo-inertia holds mass, first and second moments, and adds up over the bodies, so the
    sum needs no parallel-axis theorem. Each entry is compared with the size of its block.
    """
    row = partial(FileCheck, text.path.name, "closed jaws")
    wrist, total = text.prefix + "link_4", np.zeros((4, 4))
    for name in (wrist, *(text.prefix + name for name in JAW_LINKS)):
        body, joint, placed = text.links.get(name), text.carriers.get(name), np.eye(4)
        carried = name == wrist or (joint is not None and joint.parent == wrist)
        if body is None or body.mass is None or not carried:
            return row(
                "failed", "wrist, rod and fingers are not all there, with their joints"
            )
        if joint is not None and name != wrist:
            leader = text.joints.get(joint.source)
            closed = 0.0 if leader is None else leader.lower or 0.0
            placed = joint.transform @ joint.motion(
                joint.multiplier * closed + joint.offset
            )
        total += placed @ pseudo_inertia(body.mass, body.com, body.inertia) @ placed.T
    mass, com, tensor, _ = _table_2()[4]
    printed = pseudo_inertia(mass, com, tensor)
    blocks = np.s_[:3, :3], np.s_[:3, 3], np.s_[3, 3]
    away = max(
        float(np.abs((total - printed)[b]).max() / np.abs(printed[b]).max())
        for b in blocks
    )
    finding = (
        "wrist, rod and fingers have link 4's mass, first and second moments (relative)"
    )
    return row(
        "passed" if away <= FRAME_BOUND else "failed", finding, away, FRAME_BOUND
    )


def _jaw_limit_differences(text: Subject) -> Iterator[str]:
    """Fingers whose range or speed is not what the rod's range and speed make of them."""
    rod = text.joints.get(text.prefix + "axis_a")
    if rod is None or rod.lower is None or rod.upper is None or rod.velocity is None:
        yield "axis_a: no limits"
        return
    nominal = text.expected.jaws.finger_turn
    for child in (text.prefix + "finger_1", text.prefix + "finger_2"):
        finger = text.carriers.get(child)
        if finger is None or finger.mimic != rod.name:
            yield f"{child}: no joint that follows {rod.name}"
            continue
        turn = finger.multiplier
        if abs(turn) != nominal:
            yield f"{finger.name}: {turn:g} rad/m, expected {nominal:g} rad/m"
        lower, upper = sorted(
            turn * end + finger.offset for end in (rod.lower, rod.upper)
        )
        made = {"lower": lower, "upper": upper, "velocity": abs(turn) * rod.velocity}
        for key, value in made.items():
            given = getattr(finger, key)
            if given is None or not math.isclose(
                given, value, rel_tol=0, abs_tol=1e-12
            ):
                yield f"{finger.name}: {key} {given}, the rod makes it {value:.12g}"


# --- frames by other tools against Table 1's product


def configurations(p: Alpha5Parameters, count: int) -> FloatArray:
    """Seeded random joint positions within the limits, and every corner of the limits, (N, 4)."""
    lower, upper = (
        np.array([getattr(j, k) for j in p.joints[:4]]) for k in ("lower", "upper")
    )
    corners = np.where(np.indices((2,) * 4).reshape(4, -1).T == 0, lower, upper)
    return np.vstack(
        [corners, np.random.default_rng(5).uniform(lower, upper, (count, 4))]
    )


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
    sine = np.linalg.norm(
        relative - np.swapaxes(relative, -1, -2), axis=(-2, -1)
    ) / np.sqrt(8)
    cosine = (np.trace(relative, axis1=-2, axis2=-1) - 1) / 2
    return float(max(shift, np.arctan2(sine, cosine).max()))


def pinocchio_frames(
    text: Subject, links: list[str], q: FloatArray
) -> Iterator[list[FloatArray]]:
    """Poses of the links by Pinocchio; see `_Tool`."""
    import pinocchio as pin

    model = urdf_model(text.path)
    data = model.createData()
    if absent := [
        n for n in JOINT_NAMES[:4] if not model.existJointName(text.prefix + n)
    ]:
        raise ValueError(f"no movable joint {', '.join(absent)}")
    columns = [
        model.joints[model.getJointId(text.prefix + n)].idx_q for n in JOINT_NAMES[:4]
    ]
    frames = [model.getFrameId(text.prefix + n, pin.FrameType.BODY) for n in links]
    position = pin.neutral(model)
    for row in q:
        position[columns] = row
        pin.framesForwardKinematics(model, data, position)
        home = data.oMf[frames[0]].inverse()
        yield [(home * data.oMf[frame]).homogeneous for frame in frames]


def yourdfpy_frames(
    text: Subject, links: list[str], q: FloatArray
) -> Iterator[list[FloatArray]]:
    """Poses of the links by yourdfpy; see `_Tool`."""
    import yourdfpy

    robot = yourdfpy.URDF.load(
        str(text.path), load_meshes=False, build_scene_graph=True
    )
    names = [text.prefix + n for n in JOINT_NAMES[:4]]
    for row in q:
        robot.update_cfg(dict(zip(names, row, strict=True)))
        yield [
            robot.get_transform(text.prefix + n, text.prefix + links[0]) for n in links
        ]
