"""The seven bodies of the arm, each with the volume that Table 3 prints."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from alpha5_model.description.bodies import base, finger, shell, upper_arm, wrist
from alpha5_model.description.bodies.solid import Solid
from alpha5_model.description.bodies.solve import solve_volume
from alpha5_model.parameters import parameters

#: Bodies in the order base to tip.
BODIES = ("link_0", "link_1", "link_2", "link_3", "link_4", "finger_1", "finger_2")
_MM3_PER_M3 = 1e9


@dataclass(frozen=True, eq=False)
class Body:
    """A drawn body.

    Attributes:
        name: One of `BODIES`; the solid is in that link's frame [mm].
        solid: The solid.
        free_dimension: What was solved for.
        value: Its value [mm].
    """

    name: str
    solid: Solid
    free_dimension: str
    value: float


@cache
def bodies() -> dict[str, Body]:
    """Draw all bodies.

    Raises:
        MissingDependencyError: manifold3d is not installed.
    """
    arm = parameters(())
    volume = [link.volume * _MM3_PER_M3 for link in arm.links]
    jaws = arm.jaws
    mm = 1e3

    blank = base.base_blank()
    base_solid = solve_volume(lambda x: base.bored(blank, x), volume[0], 10.0, 80.0)
    shell_blank = shell.shell_blank()
    shell_1 = solve_volume(lambda x: shell.bored(shell_blank, x), volume[1], 8.0, 19.0)
    shell_3 = solve_volume(lambda x: shell.bored(shell_blank, x), volume[3], 8.0, 19.0)
    upper_blank = upper_arm.upper_arm_blank()
    upper = solve_volume(lambda x: upper_arm.bored(upper_blank, x), volume[2], 0.5, 14.0)
    wrist_blank = wrist.wrist_blank(
        jaws.collar_base * mm, jaws.pivot_height * mm, jaws.pivot_offset * mm
    )
    finger_volume = jaws.finger_volume * _MM3_PER_M3
    tube = solve_volume(
        lambda x: wrist.bored(wrist_blank, x), volume[4] - 2 * finger_volume, 0.5, 60.0
    )
    finger_blank = finger.finger_blank(
        jaws.finger_width * mm, jaws.pivot_offset * mm, jaws.finger_length * mm
    )
    claw = solve_volume(lambda x: finger.perforated(finger_blank, x), finger_volume, 0.5, 3.6)

    drawn = (
        Body("link_0", base_solid[0], "depth of the connector recess", base_solid[1]),
        Body(
            "link_1",
            shell.in_link_1(shell_1[0], arm.dh[0].d * mm),
            "bore radius of the half-shell",
            shell_1[1],
        ),
        Body("link_2", upper_arm.in_link_2(upper[0], arm.theta_c), "shaft bore radius", upper[1]),
        Body("link_3", shell.in_link_3(shell_3[0]), "bore radius of the half-shell", shell_3[1]),
        Body("link_4", tube[0], "depth of the bearing seat", tube[1]),
        Body("finger_1", claw[0], "radius of the perforation", claw[1]),
        Body("finger_2", finger.as_finger_2(claw[0]), "radius of the perforation", claw[1]),
    )
    return {body.name: body for body in drawn}
