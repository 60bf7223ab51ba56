"""Which links of another model are the arm's own base, and which carry it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.numbers.parameters import Alpha5Parameters

#: A link on the way to axis_e that is lighter than this is a dummy of the arm's base,
#: not something that carries it.
CARRIED_FROM = 0.02  # [kg], a tenth of link_0


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
    """Links of the arm's own base, among those that stand still with it.

    These are all links that hang on one link of the way from the root to axis_e: on the
    first link whose mass comes closest to that of link_0. A link heavier than the whole
    arm is a vehicle even if it hangs on the arm's base. If axis_e turns in such a link,
    nothing is left for link_0.
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
    """The joints that carry some links, each after the joint before it."""
    carried = set(links)
    return [joint for joint in robot.joints.values() if joint.child in carried]


def _carried_weights(
    robot: UrdfRobot, links: Iterable[str], joints: Sequence[UrdfJoint]
) -> dict[str, float]:
    """Link -> its mass and that of everything that hangs on it [kg]."""
    weights = {name: robot.links[name].mass or 0.0 for name in links}
    for joint in reversed(joints):
        weights[joint.parent] += weights[joint.child]
    return weights


def _first_link(
    base_path: Sequence[str], weights: Mapping[str, float], mass: float
) -> str:
    """The link before axis_e that, with all it carries, comes closest to a mass."""
    best = base_path[0]
    for name in base_path[1:]:
        off = abs(weights[name] - mass)
        least_off = abs(weights[best] - mass)
        carrier_weight = weights[best] - weights[name]
        if off < least_off and carrier_weight > CARRIED_FROM:
            best = name
    return best


def hanging_on(links: set[str], joints: Iterable[UrdfJoint]) -> set[str]:
    """These links and all that they carry; joints each after the one before it."""
    found = set(links)
    for joint in joints:
        if joint.parent in found:
            found.add(joint.child)
    return found
