"""Find the tool frame of another model by the names of its links."""

from __future__ import annotations

import re

from alpha5_model.description.urdf_robot import UrdfRobot

#: What tool frames are called, the likeliest first.
TOOL_WORDS = ("tcp", "tool", "tip", "grasp", "effector", "eef", "ee")


def tool_link(robot: UrdfRobot, wrist: str) -> str:
    """The link fixed to the wrist that is named like a tool; "" if there is none.

    If several are, the one with the likeliest word is taken, then the outermost.
    """
    steps = {wrist: 0}
    for joint in robot.joints.values():
        if joint.kind == "fixed" and joint.parent in steps:
            steps[joint.child] = steps[joint.parent] + 1
    del steps[wrist]

    ranked = [(_tool_rank(name), -count, name) for name, count in steps.items()]
    rank, _, name = min(ranked, default=(len(TOOL_WORDS), 0, ""))
    return name if rank < len(TOOL_WORDS) else ""


def _tool_rank(name: str) -> int:
    """Index in `TOOL_WORDS` of the likeliest word in a name, or their number."""
    separated = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name)
    words = re.split(r"[^a-z]+", separated.lower())
    if "base" in words:
        return len(TOOL_WORDS)
    found = [rank for rank, word in enumerate(TOOL_WORDS) if word in words]
    return min(found, default=len(TOOL_WORDS))
