"""Which links of another model are the arm's own base, and which are foreign to it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.numbers.parameters import Alpha5Parameters

#: A link before the arm's base that is lighter than this is a dummy and belongs to the
#: base; a heavier one is foreign.
LEAST_FOREIGN_MASS = 0.02  # [kg], a tenth of link_0


def path_to(robot: UrdfRobot, link: str) -> tuple[str, ...]:
    """The links from the root to this one."""
    parents = {joint.child: joint.parent for joint in robot.joints.values()}
    path = [link]
    while path[-1] in parents:
        path.append(parents[path[-1]])
    return tuple(reversed(path))


def own_base_links(
    robot: UrdfRobot,
    base_path: Sequence[str],
    still: set[str],
    parameters: Alpha5Parameters,
) -> set[str]:
    """Links of the arm's own base, among those that do not move against it.

    The base begins at the link on the way from the root to axis_e that, with all that
    hangs on it, comes closest to the mass of link_0. All that hangs on this link
    belongs to the base, except vehicles: a link heavier than the whole arm is one. If
    axis_e turns in a vehicle, the base has no links.

    Args:
        robot: The other model.
        base_path: Links from the root to the one that axis_e turns in.
        still: All links that do not move against the root.
        parameters: Our arm.
    """
    whole_arm = sum(link.mass for link in parameters.links)
    turned_in = robot.links[base_path[-1]]
    if (turned_in.mass or 0.0) > whole_arm:
        return set()

    joints = joints_to(robot, still)
    weights = _carried_weights(robot, still, joints)
    first = _first_link(base_path, weights, parameters.links[0].mass)
    aside = still.difference(base_path)
    vehicles = {name for name in aside if weights[name] > whole_arm}
    return hanging_on({first}, joints) - hanging_on(vehicles, joints)


def joints_to(robot: UrdfRobot, links: Iterable[str]) -> list[UrdfJoint]:
    """The joints whose children are these links, each after the joint before it."""
    carried = set(links)
    return [joint for joint in robot.joints.values() if joint.child in carried]


def _carried_weights(
    robot: UrdfRobot, links: Iterable[str], joints: Sequence[UrdfJoint]
) -> dict[str, float]:
    """Link -> its mass and that of all that hangs on it [kg]."""
    weights = {name: robot.links[name].mass or 0.0 for name in links}
    for joint in reversed(joints):
        weights[joint.parent] += weights[joint.child]
    return weights


def _first_link(
    base_path: Sequence[str], weights: Mapping[str, float], mass: float
) -> str:
    """The link before axis_e that comes closest to a mass, with all it carries."""
    best = base_path[0]
    for name in base_path[1:]:
        off = abs(weights[name] - mass)
        least_off = abs(weights[best] - mass)
        mass_before = weights[best] - weights[name]
        if off < least_off and mass_before > LEAST_FOREIGN_MASS:
            best = name
    return best


def hanging_on(links: set[str], joints: Iterable[UrdfJoint]) -> set[str]:
    """These links and all that hangs on them.

    Args:
        links: Names of links.
        joints: To search, each after the joint before it.
    """
    found = set(links)
    for joint in joints:
        if joint.parent in found:
            found.add(joint.child)
    return found
