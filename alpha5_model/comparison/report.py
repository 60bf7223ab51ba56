"""The comparison itself: figures, findings and a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.alignment import (
    Alignment,
    align,
    axis_lines,
    bodies_in_our_frames,
    tip_distance,
)
from alpha5_model.comparison.diagnosis import explain_com, explain_inertia, explain_mass
from alpha5_model.comparison.mapping import AXES, FourJointArm, map_joints, reduce_robot
from alpha5_model.description.urdf_reading import UrdfRobot, parse_urdf, read_urdf
from alpha5_model.description.variants import Variant, urdf
from alpha5_model.inertia import inconsistencies
from alpha5_model.parameters import Alpha5Parameters, parameters

#: What still counts as the same geometry.
LENGTH_TOLERANCE = 1e-5  # [m]
ANGLE_TOLERANCE = 1e-4  # [rad]
#: The arm stretched out, base to finger tips: no part of it is larger.
REACH = 0.6  # [m]
#: Of Table 3's whole volume; its digits allow 5 * 0.5 mL of 573 mL.
VOLUME_TOLERANCE = 5e-3


@dataclass(frozen=True)
class Finding:
    """One thing that a person should know about the other model.

    Attributes:
        where: ``link_0`` to ``link_4``, ``axis_e`` to ``axis_b``, ``base``, ``volume`` or a file.
        text: What is wrong.
        serious: Whether the models differ by it; otherwise it is a remark.
    """

    where: str
    text: str
    serious: bool = True


@dataclass(frozen=True, eq=False)
class BodyDifference:
    """A body of the other model, expressed in our link frame.

    Attributes:
        name: ``link_0`` to ``link_4``.
        links: The other model's links that make it up.
        mass: [kg].
        com: (3,) [m].
        inertia: At the COM, (3, 3) [kg m^2].
        mass_error: Theirs minus ours [kg].
        com_error: Distance [m].
        inertia_error: Largest entry of the difference [kg m^2].
    """

    name: str
    links: tuple[str, ...]
    mass: float
    com: FloatArray
    inertia: FloatArray
    mass_error: float
    com_error: float
    inertia_error: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """Another model of this arm, held against ours.

    Attributes:
        name: Its name.
        joints: Ours -> theirs.
        alignment: Base, signs and zeros.
        bodies: Base to tip.
        tip_error: Largest distance of the tips over the workspace [m].
        gravity_error: Largest difference of the gravity torque in air, per joint, (4,) [N m].
        mass_matrix_error: Largest difference of an entry of the mass matrix [kg m^2].
        volume: Of its collision primitives [m^3]; NaN if it has none.
        findings: Base to tip; empty if the models agree.
    """

    name: str
    joints: dict[str, str]
    alignment: Alignment
    bodies: tuple[BodyDifference, ...]
    tip_error: float
    gravity_error: FloatArray
    mass_matrix_error: float
    volume: float
    findings: tuple[Finding, ...]

    @property
    def agrees(self) -> bool:
        """Nothing serious was found."""
        return not any(finding.serious for finding in self.findings)

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain numbers and texts, for JSON."""
        return {
            "name": self.name,
            "agrees": self.agrees,
            "joints": self.joints,
            "base": self.alignment.base.tolist(),
            "sign": self.alignment.sign.tolist(),
            "zero_rad": self.alignment.zero.tolist(),
            "tip_error_m": self.tip_error,
            "gravity_error_Nm": self.gravity_error.tolist(),
            "mass_matrix_error_kgm2": self.mass_matrix_error,
            "volume_m3": None if math.isnan(self.volume) else self.volume,
            "bodies": [
                {
                    "name": body.name,
                    "links": list(body.links),
                    "mass_kg": body.mass,
                    "com_m": body.com.tolist(),
                    "inertia_kgm2": body.inertia.tolist(),
                    "mass_error_kg": body.mass_error,
                    "com_error_m": body.com_error,
                    "inertia_error_kgm2": body.inertia_error,
                }
                for body in self.bodies
            ],
            "findings": [
                {"where": f.where, "text": f.text, "serious": f.serious} for f in self.findings
            ],
        }


def compare(
    path: str | Path,
    joints: Mapping[str, str] | None = None,
    samples: int = 500,
) -> Comparison:
    """Hold another URDF of this arm against ours.

    Joints are mapped by name, the bases are aligned by the joint axes, every other joint is frozen with
    the jaws closed, and each body is compared in our link frame with the tables.

    Args:
        path: The other URDF. Meshes need not be there.
        joints: Our joint name -> theirs, for those that names do not tell.
        samples: Random configurations for the kinematic and dynamic errors.

    Returns:
        The comparison; ``agrees`` is the verdict.

    Raises:
        MissingFileError, FileFormatError: The file cannot be read; the message says where.
        UnknownNameError, InputError: The joints cannot be mapped.
    """
    other = read_urdf(path)
    return compare_robots(other, joints, samples, Path(path).parent)


def compare_robots(
    other: UrdfRobot,
    names: Mapping[str, str] | None = None,
    samples: int = 500,
    folder: Path | None = None,
) -> Comparison:
    """As `compare`, for a model that is read already; ``folder`` is where its meshes are."""
    tables = parameters()
    ours = _ours()
    mapped = map_joints(other, names)
    theirs = reduce_robot(other, mapped)
    alignment = align(ours, theirs)
    com, inertia = bodies_in_our_frames(ours, theirs, alignment)
    bodies = tuple(
        BodyDifference(
            name=link.name,
            links=theirs.links[i],
            mass=float(theirs.mass[i]),
            com=com[i],
            inertia=inertia[i],
            mass_error=float(theirs.mass[i] - link.mass),
            com_error=float(np.linalg.norm(com[i] - link.com)),
            inertia_error=float(np.abs(inertia[i] - link.inertia).max()),
        )
        for i, link in enumerate(tables.links)
    )
    rng = np.random.default_rng(0)
    lower = np.array([joint.lower for joint in tables.joints[:4]])
    upper = np.array([joint.upper for joint in tables.joints[:4]])
    q = rng.uniform(lower, upper, (samples, 4))
    reach = -tables.dh[3].d
    tip_error = max(tip_distance(ours, theirs, alignment, reach, row) for row in q)
    gravity_error, mass_matrix_error = _dynamic_errors(ours, theirs, alignment, q)
    volume = float(theirs.volume.sum()) or math.nan
    findings = (
        *_geometry(ours, theirs, alignment, tip_error),
        *_limits(tables, theirs, alignment),
        *_mimics(other),
        *_bodies(tables, other, theirs, bodies),
        *_volume(tables, volume, ours, theirs),
        *_files(other, folder),
    )
    return Comparison(
        name=other.name,
        joints={axis: joint.name for axis, joint in zip(AXES, mapped, strict=True)},
        alignment=alignment,
        bodies=bodies,
        tip_error=tip_error,
        gravity_error=gravity_error,
        mass_matrix_error=mass_matrix_error,
        volume=volume,
        findings=findings,
    )


@cache
def _ours() -> FourJointArm:
    """Our own arm, generated from the tables and read like any other."""
    robot = parse_urdf(urdf(Variant()))
    return reduce_robot(robot, map_joints(robot))


def _geometry(
    ours: FourJointArm, theirs: FourJointArm, alignment: Alignment, tip_error: float
) -> list[Finding]:
    found = []
    shift, rotation = alignment.base[:3, 3], alignment.base[:3, :3]
    angle = math.acos(float(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
    if np.linalg.norm(shift) > LENGTH_TOLERANCE or angle > ANGLE_TOLERANCE:
        x, y, z = shift * 1e3
        found.append(
            Finding(
                "base",
                f"its root stands at ({x:.2f}, {y:.2f}, {z:.2f}) mm in our base_link, turned by "
                f"{math.degrees(angle):.2f} deg: another mount, or for a yaw a shifted zero of axis_e",
                serious=False,
            )
        )
    for axis, sign, zero in zip(AXES, alignment.sign, alignment.zero, strict=True):
        if sign < 0:
            found.append(Finding(axis, "turns the other way"))
        if abs(zero) > ANGLE_TOLERANCE:
            found.append(Finding(axis, f"its zero is shifted by {math.degrees(zero):.2f} deg"))
    if tip_error > LENGTH_TOLERANCE:
        first = _first_axis_off(ours, theirs, alignment)
        found.append(Finding(first, f"from here on the tip is up to {tip_error * 1e3:.2f} mm off"))
    return found


def _first_axis_off(ours: FourJointArm, theirs: FourJointArm, alignment: Alignment) -> str:
    points, directions = axis_lines(ours, np.zeros(4))
    there, _ = axis_lines(theirs, alignment.zero)
    there = there @ alignment.base[:3, :3].T + alignment.base[:3, 3]
    off = np.linalg.norm(np.cross(there - points, directions), axis=1) > LENGTH_TOLERANCE
    return AXES[int(off.argmax())] if off.any() else AXES[-1]


def _mimics(other: UrdfRobot) -> list[Finding]:
    """Joints that their leader drives beyond their own limits."""
    found = []
    for joint in other.joints.values():
        leader = other.joints.get(joint.mimic or "")
        if leader is None or None in (leader.lower, leader.upper, joint.lower, joint.upper):
            continue
        ends = [
            joint.multiplier * (end or 0.0) + joint.offset for end in (leader.lower, leader.upper)
        ]
        beyond = max((joint.lower or 0.0) - min(ends), max(ends) - (joint.upper or 0.0))
        if beyond > ANGLE_TOLERANCE:
            text = f"mimics {leader.name} {beyond:.4g} beyond its own limit"
            found.append(Finding(joint.name, text))
    return found


def _limits(tables: Alpha5Parameters, theirs: FourJointArm, alignment: Alignment) -> list[Finding]:
    found = []
    rows = zip(tables.joints[:4], theirs.joints, alignment.sign, alignment.zero, strict=True)
    for ours, joint, sign, zero in rows:
        if joint.lower is None or joint.upper is None:
            found.append(Finding(ours.name, "has no limits", serious=False))
            continue
        ends = sorted(float(sign * (end - zero)) for end in (joint.lower, joint.upper))
        if max(abs(ends[0] - ours.lower), abs(ends[1] - ours.upper)) > ANGLE_TOLERANCE:
            low, high = (math.degrees(end) for end in ends)
            found.append(
                Finding(
                    ours.name,
                    f"range {low:.1f} to {high:.1f} deg in place of "
                    f"{math.degrees(ours.lower):.1f} to {math.degrees(ours.upper):.1f} deg",
                    serious=False,
                )
            )
    return found


def _bodies(
    tables: Alpha5Parameters,
    other: UrdfRobot,
    theirs: FourJointArm,
    bodies: tuple[BodyDifference, ...],
) -> list[Finding]:
    found = []
    for i, (body, link) in enumerate(zip(bodies, tables.links, strict=True)):
        found += _dummies(other, body)
        bare = [name for name in body.links if name in theirs.without_inertial]
        mass = explain_mass(tables, i, body.mass)
        if mass is not None and body.mass == 0.0 and bare:
            found.append(Finding(link.name, f"no <inertial> in {', '.join(bare)}"))
            continue
        if bare:
            text = f"no <inertial> in {', '.join(bare)}: some tools take 1 kg for it"
            found.append(Finding(link.name, text, serious=False))
        reasons = [
            mass,
            explain_com(tables, i, body.com, theirs.com[i]) if body.mass else None,
            explain_inertia(tables, i, body.mass, body.inertia, theirs.inertia[i])
            if body.mass
            else None,
        ]
        found += [Finding(link.name, reason) for reason in reasons if reason is not None]
        if any(reasons) and body.mass:
            # Table 2 itself strains one body's bounds: what is ours is not held against them.
            own = inconsistencies(link.mass, link.com, link.inertia, link.bounds)
            problems = inconsistencies(
                body.mass, body.com, body.inertia, None if own else link.bounds
            )
            found += [Finding(link.name, f"impossible: {problem}") for problem in problems]
    return found


def _dummies(other: UrdfRobot, body: BodyDifference) -> list[Finding]:
    """Links that were given a token mass and an inertia that is anything but token."""
    found = []
    for name in body.links:
        link = other.links[name]
        if (
            link.mass
            and link.mass > 0
            and (size := np.abs(link.inertia).max() / link.mass) > REACH**2
        ):
            found.append(
                Finding(
                    body.name,
                    f"{name} has {link.mass * 1e3:g} g and {np.abs(link.inertia).max():g} kg m^2: a radius "
                    f"of gyration of {math.sqrt(size):.2f} m, more than the whole arm",
                )
            )
    return found


def _volume(
    tables: Alpha5Parameters, volume: float, ours: FourJointArm, theirs: FourJointArm
) -> list[Finding]:
    # Our own collision shapes enclose the bodies and are not meant to displace water.
    printed, enclosing = sum(link.volume for link in tables.links), float(ours.volume.sum())
    found = []
    if theirs.collision_meshes:
        count = len(theirs.collision_meshes)
        text = f"{count} collision meshes: their volume is not counted"
        found.append(Finding("volume", text, serious=False))
    known = any(abs(volume - v) <= VOLUME_TOLERANCE * printed for v in (printed, enclosing))
    if not math.isnan(volume) and not known:
        found.append(
            Finding(
                "volume",
                f"collision primitives sum to {volume * 1e3:.3f} L, the arm displaces "
                f"{printed * 1e3:.3f} L: wrong buoyancy in a tool that takes it from them",
                serious=False,
            )
        )
    return found


def _files(other: UrdfRobot, folder: Path | None) -> list[Finding]:
    if folder is None:
        return []
    names = sorted({file for link in other.links.values() for file in link.files})
    missing = [name for name in names if "://" not in name and not (folder / name).is_file()]
    return [Finding(name, "mesh is not there", serious=False) for name in missing]


def _dynamic_errors(
    ours: FourJointArm, theirs: FourJointArm, alignment: Alignment, samples: FloatArray
) -> tuple[FloatArray, float]:
    import pinocchio as pin

    models = [_model(ours), _model(theirs)]
    # Gravity points down in our base frame, wherever the other root stands.
    down = np.array([0.0, 0.0, -9.81])
    models[1].gravity.linear = alignment.base[:3, :3].T @ down
    data = [model.createData() for model in models]
    signs = alignment.sign
    gravity, matrix = np.zeros(4), 0.0
    for q in samples:
        there = alignment.theirs(q)
        g = pin.computeGeneralizedGravity(models[1], data[1], there) * signs
        gravity = np.maximum(
            gravity, np.abs(g - pin.computeGeneralizedGravity(models[0], data[0], q))
        )
        m = pin.crba(models[1], data[1], there) * np.outer(signs, signs)
        matrix = max(matrix, float(np.abs(m - pin.crba(models[0], data[0], q)).max()))
    return gravity, matrix


def _model(arm: FourJointArm) -> Any:
    import pinocchio as pin

    model, parent = pin.Model(), 0
    for i, joint in enumerate(arm.joints):
        placement = pin.SE3(arm.placements[i])
        # an unaligned axis keeps whatever direction the file gives
        kind = pin.JointModelRevoluteUnaligned(arm.axes[i])
        parent = model.addJoint(parent, kind, placement, joint.name)
        body = pin.Inertia(float(arm.mass[i + 1]), arm.com[i + 1], arm.inertia[i + 1])
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    return model
