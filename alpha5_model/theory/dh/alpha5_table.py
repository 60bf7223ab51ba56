"""Table 1 of the Reach Alpha 5 as the table of a `DHChain`."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import transform
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tool import ToolPose
from alpha5_model.theory.dh.link import DHLink, dh_transform


class ChainFields(TypedDict):
    """Fields of a `DHChain`."""

    links: tuple[DHLink, ...]
    tool: FloatArray
    name: str
    joint_names: tuple[str, ...]


def alpha5_table(parameters: Alpha5Parameters) -> ChainFields:
    """The moving rows of Table 1 as links.

    The tool is the record's, or else the fixed last row.
    """
    links = []
    names = []
    tool = np.eye(4)
    joints = {joint.dh_variable: joint for joint in parameters.joints}
    for row in parameters.dh:
        if row.variable is None:
            tool = tool @ dh_transform(row.theta_offset, row.d, row.a, row.alpha)
            continue
        joint = joints[row.variable]
        link = DHLink(
            theta=0.0,
            d=row.d,
            a=row.a,
            alpha=row.alpha,
            sigma=0,
            offset=row.theta_offset,
            lower=joint.lower,
            upper=joint.upper,
        )
        links.append(link)
        names.append(joint.name)
    if parameters.tool is not None:
        tool = _in_frame_4(parameters.tool, links[-1])
    return {
        "links": tuple(links),
        "tool": tool,
        "name": "alpha5",
        "joint_names": tuple(names),
    }


def _in_frame_4(tool: ToolPose, wrist: DHLink) -> FloatArray:
    """Pose of a tool in the frame {4}, which the wrist's row leads to from link_4."""
    frame_4_in_link_4 = dh_transform(0.0, wrist.d, wrist.a, wrist.alpha)
    tool_in_link_4 = transform(tool.rotation, tool.position)
    return np.linalg.inv(frame_4_in_link_4) @ tool_in_link_4
