"""What is wrong with each body, what that costs, and what to write instead."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.arm import FourJointArm
from alpha5_model.comparison.diagnosis import (
    COM_TOLERANCE,
    INERTIA_TOLERANCE,
    MASS_TOLERANCE,
    TOKEN_MASS,
    Inertial,
    explain_com,
    explain_guess,
    explain_inertia,
    explain_mass,
    subjects,
)
from alpha5_model.comparison.records import BodyDifference, Finding
from alpha5_model.description.urdf_reading import UrdfRobot
from alpha5_model.inertia import inconsistencies, rotate_tensor
from alpha5_model.parameters import LinkParameters

#: The arm stretched out, base to finger tips: no part of it is larger.
REACH = 0.6  # [m]

#: What an error of a body's mass [kg] and first moment (3,) [kg m] is worth in gravity torque [N m].
Cost = Callable[[int, float, FloatArray], float]


def body_findings(
    other: UrdfRobot,
    ours: FourJointArm,
    theirs: FourJointArm,
    transforms: FloatArray,
    bodies: tuple[BodyDifference, ...],
    cost: Cost,
) -> Iterator[Finding]:
    """What is wrong with the bodies, base to tip.

    Args:
        other: The other model as read.
        ours, theirs: Both arms, reduced to four joints.
        transforms: transform_theirs_to_ours of the body frames, (5, 4, 4).
        bodies: The bodies held against the tables.
        cost: What an error of a body is worth.
    """
    for i, body in enumerate(bodies):
        written = []
        for name in body.links:
            link, pose = other.links[name], transforms[i] @ theirs.link_poses[name]
            written.append(Inertial(name, link.mass or 0.0, link.com, link.inertia, pose))
        bare = [name for name in body.links if name in theirs.without_inertial]
        yield from _findings(ours, i, body, written, bare, cost)


def _findings(
    ours: FourJointArm,
    index: int,
    body: BodyDifference,
    written: list[Inertial],
    bare: list[str],
    cost: Cost,
) -> Iterator[Finding]:
    link, name = body.ours, body.name
    yield from _dummies(name, written)
    mass_error = body.mass - link.mass
    mass_cost = cost(index, mass_error, mass_error * link.com)
    if not written:
        yield Finding(name, "no link of the other model is this body", True, mass_cost)
        return
    mass, com, inertia = _instead(link, written)
    if body.mass == 0.0 and bare:
        everything = " ".join((mass, com.partition(": ")[2], inertia.partition(": ")[2]))
        yield Finding(name, f"no <inertial> in {', '.join(bare)}", True, mass_cost, everything)
        return
    if bare:
        text = f"no <inertial> in {', '.join(bare)}: some tools take 1 kg for it"
        yield Finding(name, text, serious=False)
    wrong_mass = abs(mass_error) > MASS_TOLERANCE * link.mass
    if body.mass == 0.0:
        yield Finding(name, f"no mass in place of {link.mass:g} kg", True, mass_cost, mass)
        return
    if wrong_mass:
        text = f"mass {body.mass:.4g} kg in place of {link.mass:g} kg"
        reason = _reason(written, lambda s: explain_mass(link, s))
        text += reason or f" ({body.mass / link.mass:.3g} times)"
        text += ": the jaws are counted twice" if index == 4 and "; beside it" in reason else ""
        yield Finding(name, text, True, mass_cost, mass)
    wrong_com = body.com_error > COM_TOLERANCE + body.slack
    if wrong_com:
        text = f"COM {body.com_error * 1e3:.1f} mm off"
        if index == 4 and body.com[2] > 0:
            z = body.com[2] * 1e3
            text += f": the wrist's COM is on the wrong side of the joint (z = {z:+.1f} mm)"
        text += _reason(written, lambda s: explain_com(ours, link, s))
        yield Finding(name, text, True, cost(index, 0.0, link.mass * (body.com - link.com)), com)
    wrong_inertia = body.inertia_error > INERTIA_TOLERANCE * np.abs(link.inertia).max()
    if wrong_inertia:
        x, y, z = np.diag(body.inertia) / np.diag(link.inertia)
        text = f"inertia differs, {x:.3g}, {y:.3g}, {z:.3g} times about x, y, z"
        text += " (z is the wrist's roll)" if index == 4 else ""
        reason = _reason(written, lambda s: explain_inertia(ours, link, s))
        guess = explain_guess(link, written)
        yield Finding(name, text + (reason or (guess and f": {guess}") or ""), True, 0.0, inertia)
    if wrong_mass or wrong_com or wrong_inertia:
        # Table 2 itself strains one body's bounds: what is ours is not held against them.
        own = inconsistencies(link.mass, link.com, link.inertia, link.bounds)
        bounds = None if own else link.bounds
        for problem in inconsistencies(body.mass, body.com, body.inertia, bounds):
            yield Finding(name, f"impossible: {problem}")


def _reason(written: list[Inertial], explain: Callable[[Inertial], str | None]) -> str:
    """The first subject whose number is explained, and which links stand beside it."""
    for subject in subjects(written):
        if reason := explain(subject):
            beside = [w for w in written if abs(w.mass) > TOKEN_MASS and w.link != subject.link]
            if not subject.link or not beside:
                return f": {reason}"
            grams = sum(w.mass for w in beside) * 1e3
            names = ", ".join(w.link for w in beside)
            return f": {subject.link} has {reason}; beside it {names} with {grams:.0f} g"
    return ""


def _dummies(name: str, written: list[Inertial]) -> Iterator[Finding]:
    """Links that were given a token mass and an inertia that is anything but token."""
    alike: dict[tuple[float, float], list[str]] = {}
    for w in written:
        largest = float(np.abs(w.inertia).max())
        if w.mass > 0 and largest / w.mass > REACH**2:
            alike.setdefault((w.mass, largest), []).append(w.link)
    for (mass, largest), links in alike.items():
        names, many = ", ".join(links), len(links) > 1
        dummy = f"dummy link{'s' * many} " if mass <= TOKEN_MASS else ""
        text = (
            f"{dummy}{names} {'have' if many else 'has'} {mass * 1e3:g} g and {largest:g} kg m^2: a "
            f"radius of gyration of {math.sqrt(largest / mass):.2f} m, more than the whole arm"
        )
        # a body with a mass of its own needs its tensor, not none: that is another finding
        yield Finding(name, text, instead=f"no <inertial> in {names}" if dummy else "")


def _instead(link: LinkParameters, written: list[Inertial]) -> tuple[str, str, str]:
    """Mass, COM and tensor of Table 2 as URDF, in the frame of the other model's heaviest link."""
    main = max(written, key=lambda w: abs(w.mass))
    rest = [w.link for w in written if w is not main and w.mass]
    alone = f" (nothing in {', '.join(rest)})" if rest else ""
    back = np.linalg.inv(main.pose)
    # Table 2 prints 1e-6 m and 1e-9 kg m^2; a frame written with fewer digits adds noise beyond.
    xyz = " ".join(f"{x + 0.0:.6g}" for x in (back[:3, :3] @ link.com + back[:3, 3]).round(6))
    tensor = rotate_tensor(back[:3, :3], link.inertia).round(9) + 0.0
    entries = " ".join(
        f'i{"xyz"[i]}{"xyz"[j]}="{tensor[i, j]:.6g}"' for i in range(3) for j in range(i, 3)
    )
    return (
        f'{main.link}: <mass value="{link.mass:g}"/>{alone}',
        f'{main.link}: <origin xyz="{xyz}" rpy="0 0 0"/>{alone}',
        f"{main.link}: <inertia {entries}/>{alone}",
    )
