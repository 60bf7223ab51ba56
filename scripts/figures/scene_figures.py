"""Pictures of the arm for the guides, as ``alpha5 view --image`` draws them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.framing import framed
from alpha5_model.viewer.picture import picture_png

SIZE = (1200, 640)
OWN_ARM = Path(__file__).resolve().parents[2] / "examples" / "my_arm.toml"


def picture_of(
    arm: a5.Arm, q: Sequence[float], show: Sequence[str], **scene: Any
) -> bytes:
    """A picture of an arm with jaws at a pose of its four joints, as PNG."""
    position = [*q, arm.limits.lower[4]]
    built = build_scene(arm, position, show=show, **scene)
    return picture_png(framed(built, SIZE), SIZE)


def payload_picture() -> bytes:
    """500 g of steel at the tcp, and what acts on the arm."""
    show = ("bodies", "labels", "weight", "buoyancy", "payload")
    steel = (0.5, (0.0, 0.0, 0.02), 0.5 / 7850)
    arm = a5.load(gripper="jaws")
    return picture_of(arm, a5.named_pose("reach"), show, payload=steel)


def own_arm_picture() -> bytes:
    """The arm of the example, upside down, with a spacer between wrist and jaws."""
    own = a5.arm_file(OWN_ARM)
    arm = a5.load(arm=own, gripper="jaws")
    return picture_of(arm, a5.named_pose("home", own), ("bodies", "labels", "com"))


def obstacles_picture() -> bytes:
    """The end of the motion among obstacles that the guide plans."""
    hull = a5.Obstacle.box("hull", (0.457, 0.338, 0.254), xyz=(-0.20, 0.0, -0.14))
    post = a5.Obstacle.cylinder("post", radius=0.03, length=1.0, xyz=(0.22, 0.15, 0.0))
    around = [hull, post]
    motion = a5.plan(a5.named_pose("home"), [0.05, 0.25, 0.20], obstacles=around)
    arm = a5.load(gripper="jaws")
    end = np.asarray(motion.position)[-1][:4]
    return picture_of(arm, end, ("bodies", "labels", "obstacles"), obstacles=around)


FIGURES = {
    "payload.png": payload_picture,
    "own_arm.png": own_arm_picture,
    "obstacles.png": obstacles_picture,
}
