"""The YAML file with the arm's numbers that the xacro macros read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from alpha5_model.description.assets import template
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.frames import fixed_frames
from alpha5_model.description.origin import provenance
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.geometry.materials import MATERIALS
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange

#: Fields of a joint that are written if it has them: fingers have no device, and the
#: arm's joints follow no other joint.
_JOINT_FIELDS = (
    "lower",
    "upper",
    "velocity",
    "effort",
    "device_id",
    "multiplier",
    "offset",
)


def parameter_yaml(parameters: Alpha5Parameters) -> str:
    """Text of ``xacro/parameters.yaml`` for these parameters.

    Numbers are written so that they read back as the same doubles.
    """
    import yaml

    arm = arm_bodies(parameters, "locked")
    # With jaws, link_0 to link_3 are the same: only the wrist, rod and fingers are new.
    jaws = arm_bodies(parameters, "jaws")[4:]
    source = provenance(parameters)
    frames = fixed_frames(parameters)
    content = {
        "provenance": source,
        "materials": {material.name: list(material.rgba) for material in MATERIALS},
        "links": _links(arm),
        "joints": _joints(arm),
        "frames": {name: asdict(frame) for name, frame in frames.items()},
        # The wrist's joint, axis_b, is among the joints of the arm already.
        "jaws": {"links": _links(jaws), "joints": _joints(jaws[1:])},
        "home": _home(parameters),
    }
    text: str = yaml.safe_dump(
        content, sort_keys=False, default_flow_style=None, width=110
    )
    return template("parameters_head.yaml").format(**source) + text


def _links(bodies: Iterable[Body]) -> dict[str, dict[str, Any]]:
    links = {}
    for body in bodies:
        links[body.name] = {
            "mass": body.mass,
            "com": body.com.tolist(),
            "inertia": body.moments,
            "collision": [asdict(shape) for shape in body.shapes],
        }
    return links


def _joints(bodies: Iterable[Body]) -> dict[str, dict[str, Any]]:
    """Name -> pose, child and numbers of the joints that carry these bodies."""
    joints = {}
    for body in bodies:
        if body.joint is not None:
            joints[body.joint.name] = {
                **asdict(body.placement),
                "child": body.name,
                **_joint_numbers(body.joint),
            }
    return joints


def _joint_numbers(joint: JointRange) -> dict[str, float]:
    present = [name for name in _JOINT_FIELDS if hasattr(joint, name)]
    return {name: getattr(joint, name) for name in present}


def _home(parameters: Alpha5Parameters) -> dict[str, float]:
    """Joint positions at which mock hardware starts.

    At zero the arm would be beyond its limits and in collision.
    """
    rod = parameters.joints[4]
    positions = (*NAMED_POSES["home"], rod.lower)
    names = [joint.name for joint in parameters.joints]
    return dict(zip(names, positions, strict=True))
