"""What is wrong with each body, what that costs, and what to write instead."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison import diagnosis
from alpha5_model.comparison.alignment import Alignment, body_transforms
from alpha5_model.comparison.arm import FourJointArm, our_arm
from alpha5_model.comparison.diagnosis import TOKEN_MASS, Inertial
from alpha5_model.comparison.records import BodyDifference, Finding, finding
from alpha5_model.description.urdf_reading import UrdfRobot
from alpha5_model.inertia import inconsistencies, rotate_tensor
from alpha5_model.parameters import LinkParameters
from alpha5_model.spatial import moved

#: What still agrees with the tables: a model may print fewer digits.
MASS_TOLERANCE = 1e-3  # of the mass
COM_TOLERANCE = 1e-4  # [m]
INERTIA_TOLERANCE = 5e-3  # of the largest moment
#: The arm stretched out, base to finger tips: no part of it is larger.
REACH = 0.6  # [m]

#: What an error of a body's mass [kg] and first moment (3,) [kg m] is worth in gravity torque
#: [N m].
Cost = Callable[[int, float, FloatArray], float]


def body_findings(
    other: UrdfRobot,
    theirs: FourJointArm,
    alignment: Alignment,
    bodies: tuple[BodyDifference, ...],
    q: FloatArray,
) -> Iterator[Finding]:
    """What is wrong with the bodies, base to tip.

    Args:
        other: The other model as read.
        theirs: Its arm, reduced to four joints.
        alignment: Of that arm.
        bodies: The bodies compared with the tables.
        q: Our joint positions, (N, 4), at which costs are taken [rad].
    """
    regressor, transforms = our_arm().gravity_regressor(q), body_transforms(theirs, alignment)

    def cost(body: int, mass: float, moment: FloatArray) -> float:
        # no joint carries the base: it costs nothing
        return float(np.abs(regressor[:, :, body - 1] @ [mass, *moment]).max()) if body else 0.0

    for i, body in enumerate(bodies):
        written = []
        for link in (other.links[name] for name in body.links):
            pose = transforms[i] @ theirs.link_poses[link.name]
            written.append(Inertial(link.name, link.mass or 0.0, link.com, link.inertia, pose))
        # on a root, nothing is what KDL wants
        links = [name for name in body.links if name != other.root or not body.mass]
        bare = [name for name in links if other.links[name].mass is None]
        yield from _findings(i, body, written, bare, cost)


def _findings(
    index: int, body: BodyDifference, written: list[Inertial], bare: list[str], cost: Cost
) -> Iterator[Finding]:
    link, name = body.ours, body.name
    mass_cost = cost(index, body.mass_error, body.mass_error * link.com)
    yield from _dummies(name, written)
    if not written:
        yield finding("body.missing", name, mass_cost)
        return
    mass, com, inertia = _instead(link, written)
    if body.mass == 0.0:
        everything = " ".join((mass, com.partition(": ")[2], inertia.partition(": ")[2]))
        words = {"links": ", ".join(bare), "ours": link.mass, "everything": everything}
        key = "body.without_inertial" if bare else "body.without_mass"
        yield finding(key, name, mass_cost, tag=mass, **words)
        return
    if bare:
        yield finding("body.partly", name, links=", ".join(bare))
    wrong_mass = abs(body.mass_error) > MASS_TOLERANCE * link.mass
    if wrong_mass:
        reason = _reason(link, written, diagnosis.explain_mass)
        twice = ": the jaws are counted twice" * (index == 4 and "; beside it" in reason)
        reason = (reason or f" ({body.mass / link.mass:.3g} times)") + twice
        words = {"mass": body.mass, "ours": link.mass, "reason": reason}
        yield finding("body.mass", name, mass_cost, tag=mass, **words)
    wrong_com = body.com_error > COM_TOLERANCE + body.slack
    if wrong_com:
        key = "body.com_beyond" if index == 4 and body.com[2] > 0 else "body.com"
        com_cost = cost(index, 0.0, link.mass * (body.com - link.com))
        words = {"reason": _reason(link, written, diagnosis.explain_com), "z": body.com[2] * 1e3}
        yield finding(key, name, com_cost, tag=com, off=body.com_error * 1e3, **words)
    wrong_inertia = body.inertia_error > INERTIA_TOLERANCE * np.abs(link.inertia).max()
    if wrong_inertia:
        guess = diagnosis.explain_guess(link, written)
        reason = _reason(link, written, diagnosis.explain_inertia) or (guess and f": {guess}") or ""
        times = np.diag(body.inertia) / np.diag(link.inertia)
        key = "body.inertia_of_wrist" if index == 4 else "body.inertia"
        yield finding(key, name, tag=inertia, times=times, reason=reason)
    if wrong_mass or wrong_com or wrong_inertia:
        # Table 2 itself breaks one body's bounds: the other model is not asked to keep those.
        own = inconsistencies(link.mass, link.com, link.inertia, link.bounds)
        bounds = None if own else link.bounds
        for problem in inconsistencies(body.mass, body.com, body.inertia, bounds):
            yield finding("body.impossible", name, problem=problem)


def _reason(
    link: LinkParameters,
    written: list[Inertial],
    explain: Callable[[LinkParameters, Inertial], str | None],
) -> str:
    """The first subject whose number is explained, and which links stand beside it."""
    for subject in diagnosis.subjects(written):
        if reason := explain(link, subject):
            beside = [w for w in written if abs(w.mass) > TOKEN_MASS and w.link != subject.link]
            if not subject.link or not beside:
                return f": {reason}"
            grams = sum(w.mass for w in beside) * 1e3
            names = ", ".join(w.link for w in beside)
            return f": {subject.link} has {reason}; beside it {names} with {grams:.0f} g"
    return ""


def _dummies(name: str, written: list[Inertial]) -> Iterator[Finding]:
    """Links with an inertia that is far too large for their mass, alike ones together."""
    alike: dict[tuple[float, float], list[str]] = {}
    for w in written:
        largest = float(np.abs(w.inertia).max())
        if w.mass > 0 and largest / w.mass > REACH**2:
            alike.setdefault((w.mass, largest), []).append(w.link)
    for (mass, largest), links in alike.items():
        # a body with a mass of its own needs its tensor, not none: that is another finding
        key = "dummy" if mass <= TOKEN_MASS else "dummy.heavy"
        words = {"links": ", ".join(links), "s": "s" * (len(links) > 1), "grams": mass * 1e3}
        words |= {"have": "have" if len(links) > 1 else "has", "inertia": largest}
        yield finding(key, name, radius=math.sqrt(largest / mass), **words)


def _instead(link: LinkParameters, written: list[Inertial]) -> tuple[str, str, str]:
    """Mass, COM and tensor of Table 2 as URDF, in the frame of the other model's heaviest link."""
    main = max(written, key=lambda w: abs(w.mass))
    rest = [w.link for w in written if w is not main and w.mass]
    alone = f" (nothing in {', '.join(rest)})" if rest else ""
    back = np.asarray(np.linalg.inv(main.pose), np.float64)
    # Table 2 prints 1e-6 m and 1e-9 kg m^2; a frame written with fewer digits adds noise beyond.
    xyz = " ".join(f"{x + 0.0:.6g}" for x in moved(back, link.com).round(6))
    tensor = rotate_tensor(back[:3, :3], link.inertia).round(9) + 0.0
    entries = " ".join(
        f'i{"xyz"[i]}{"xyz"[j]}="{tensor[i, j]:.6g}"' for i in range(3) for j in range(i, 3)
    )
    return (
        f'{main.link}: <mass value="{link.mass:g}"/>{alone}',
        f'{main.link}: <origin xyz="{xyz}" rpy="0 0 0"/>{alone}',
        f"{main.link}: <inertia {entries}/>{alone}",
    )
