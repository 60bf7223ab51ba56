"""Table 1 of the Reach Alpha 5 as the table of a `DHChain`."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.theory.dh.link import DHLink, dh_transform


class ChainFields(TypedDict):
    """Fields of a `DHChain`."""

    links: tuple[DHLink, ...]
    tool: FloatArray
    name: str
    joint_names: tuple[str, ...]


def alpha5_table(parameters: Alpha5Parameters) -> ChainFields:
    """The moving rows of Table 1 as links; the fixed last row is the tool."""
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
    return {
        "links": tuple(links),
        "tool": tool,
        "name": "alpha5",
        "joint_names": tuple(names),
    }
