"""What explains the arm: frames, centres of mass and buoyancy, forces as arrows, solutions as ghosts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, shaped
from alpha5_model.description.urdf_reading import UrdfJoint
from alpha5_model.kinematics.ik.solutions import BRANCHES, inverse_kinematics
from alpha5_model.spatial import transform
from alpha5_model.view.arm_poses import link_poses
from alpha5_model.view.scene import WORLD, Color, Label, Load, Mean, Rigid, Shape
from alpha5_model.view.shapes import arrow, ball, triad

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: Length of an arrow per force [m/N].
ARROW_SCALE = 0.015
#: Length of the axes of a frame [m].
_AXES = 0.05
_YELLOW, _BLACK, _OCHRE = (0.98, 0.80, 0.10), (0.10, 0.10, 0.10), (0.45, 0.33, 0.0)
_BLUE, _WHITE = (0.10, 0.45, 0.85), (0.97, 0.97, 0.97)
_RED, _SKY = (0.80, 0.17, 0.15), (0.16, 0.55, 0.86)

#: Links that no joint moves.
_STILL = ("base_link", "link_0")
_PINK = (0.85, 0.1, 0.5)
#: One colour for each branch.
_GHOSTS = ((0.05, 0.55, 0.50), (0.85, 0.45, 0.05), (0.45, 0.30, 0.75), (0.55, 0.50, 0.10))


class _Kind(NamedTuple):
    """A kind of centre and the force that acts there.

    Attributes:
        center, share, force: Attributes of `Load`: the point, its weight in the whole arm's, the force.
        name: What the label says.
        ball, ink, color: Colours of the centre, of its label and of the arrow.
        sense: 1 along gravity, -1 against it.
    """

    center: str
    share: str
    name: str
    ball: tuple[Color, Color]
    ink: Color
    force: str
    color: Color
    sense: float


_KINDS = (
    _Kind("com", "mass", "centre of mass", (_YELLOW, _BLACK), _OCHRE, "weight", _RED, 1.0),
    _Kind("cob", "volume", "centre of buoyancy", (_BLUE, _WHITE), _BLUE, "buoyancy", _SKY, -1.0),
)
_ball = cache(ball)


def loads_of(arm: Arm, tree: Sequence[UrdfJoint]) -> tuple[Load, ...]:
    """Weight and buoyancy on each joint of the model, payloads included."""
    carrier = {joint.name: joint.child for joint in tree}
    strength = float(np.linalg.norm(arm.model.gravity.linear))
    loads = []
    for name, inertia in zip(arm.model.names, arm.model.inertias, strict=True):
        displaced = [d for d in arm.displacements if d.joint == name and d.volume > 0.0]
        volume = sum(d.volume for d in displaced)
        if inertia.mass == 0.0 and volume == 0.0:
            continue
        cob = sum((d.volume * np.asarray(d.cob) for d in displaced), np.zeros(3))
        loads.append(
            Load(
                # the universe and the free-flyer carry the base
                link=carrier.get(name, tree[0].parent),
                mass=inertia.mass,
                com=np.array(inertia.lever),
                volume=volume,
                cob=cob / volume if volume else np.array(inertia.lever),
                weight=inertia.mass * strength,
                buoyancy=arm.fluid_density * volume * strength,
            )
        )
    return tuple(loads)


def frame_markers(tree: Sequence[UrdfJoint], sliders: Sequence[str]) -> Iterator[Shape | Label]:
    """Axes of every link frame, over the bodies; names of joints, frames and the tcp."""
    axes = triad(_AXES, 0.0013)
    beside = transform(translation=(_AXES, 0.0, 0.0))  # the tip of x
    yield Shape("frames", tree[0].parent, Rigid(tree[0].parent), axes, on_top=1)
    for joint in tree:
        link = joint.child
        yield Shape("frames", link, Rigid(link), axes, on_top=1)
        if link != "tcp":
            yield Label("frames", link, Rigid(link, beside), (0.1, 0.3, 0.6))
        if joint.name in sliders or link == "tcp":
            yield Label("bodies", "tcp" if link == "tcp" else joint.name, Rigid(link))


def load_markers(arm: Arm, loads: Sequence[Load]) -> Iterator[Shape | Label]:
    """Balls at the centres of each body, arrows of its forces to scale; larger of the whole arm."""
    gravity = np.array(arm.model.gravity.linear)
    down = gravity / (np.linalg.norm(gravity) or 1.0)
    named = {**{f"load_{i}": [load] for i, load in enumerate(loads)}, "arm": loads}
    for kind, (name, carried) in product(_KINDS, named.items()):
        points = tuple(
            (load.link, getattr(load, kind.share), getattr(load, kind.center))
            for load in carried
            if getattr(load, kind.share)
        )
        if not points:
            continue
        whole = name == "arm"
        yield Shape(
            kind.center,
            name,
            Mean(points),
            _ball(0.0095 if whole else 0.0048, *kind.ball),
            on_top=2,
        )
        if whole:
            yield Label(kind.center, kind.name, Mean(points), kind.ink)
        strength = sum(getattr(load, kind.force) for load in carried)
        if not strength:
            continue
        tip = ARROW_SCALE * kind.sense * strength * down
        r, g, b = (0.8 * c if whole else c for c in kind.color)
        mesh = arrow(tip, 0.004 if whole else 0.0022)
        yield Shape(kind.force, name, Mean(points), mesh, (r, g, b), on_top=1)
        if whole:
            yield Label(kind.force, f"{kind.force} {strength:.2f} N", Mean(points, tip), (r, g, b))


def ghosts_of(
    arm: Arm, tree: Sequence[UrdfJoint], bodies: Sequence[Shape], q: FloatArray, target: ArrayLike
) -> Iterator[Shape | Label]:
    """Every solution of the inverse kinematics for a target, as a ghost of the moving links' bodies."""
    point = shaped("target", target, (3,))
    solutions = inverse_kinematics(point)
    first = len(q) - len(arm.joint_names)
    for i, (branch, color) in enumerate(zip(BRANCHES, _GHOSTS, strict=True)):
        if not solutions.exists[i]:
            continue
        solution = q.copy()
        solution[first : first + 4] = solutions.q[i]
        poses = link_poses(arm, tree, solution)
        for body in bodies:
            if isinstance(body.anchor, Rigid) and body.anchor.link not in _STILL:
                at = Rigid(WORLD, poses[body.anchor.link])
                yield Shape("ghosts", f"{branch}/{body.name}", at, body.mesh, color, opacity=0.3)
        limits = "" if solutions.within_limits[i] else ", beyond the limits"
        elbow = Rigid(WORLD, transform(translation=poses["link_3"][:3, 3]))
        yield Label("ghosts", branch.replace("_", " ") + limits, elbow, color)
    base = arm.forward_kinematics(q, frame="base_link")
    at = Rigid(WORLD, transform(translation=base.act(point)))
    yield Shape("ghosts", "target", at, ball(0.008, _PINK, _WHITE), on_top=2)
    yield Label("ghosts", "target", at, (0.75, 0.05, 0.4))
