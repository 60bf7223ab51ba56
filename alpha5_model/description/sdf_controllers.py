"""Gazebo's position controllers and joint state publisher for the arm.

Names of plugins and their elements are those of gz-sim [gz-sim]_. A controller takes a
``gz.msgs.Double`` on ``/model/NAME/joint/JOINT/0/cmd_pos``.

.. [gz-sim] github.com/gazebosim/gz-sim, ``src/systems/joint_position_controller/``
   and ``src/systems/joint_state_publisher/``.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from typing import NamedTuple

from alpha5_model.description.srdf import named_poses
from alpha5_model.description.xml import add, fill
from alpha5_model.numbers.jaws import FingerJoint
from alpha5_model.numbers.parameters import JointRange

#: The pose to which the controllers drive until a command comes.
START = "home"


class Gains(NamedTuple):
    """Gains of a joint's controller: tuned, not from the document.

    Attributes:
        proportional: [N m/rad, N/m].
        derivative: [N m s/rad, N s/m]. Gazebo differentiates over one step, so that
            twice as much would be unstable at 1 ms.
    """

    proportional: float
    derivative: float


GAINS = {
    "axis_e": Gains(200.0, 4.0),
    "axis_d": Gains(200.0, 4.0),
    "axis_c": Gains(200.0, 1.0),
    "axis_b": Gains(5.0, 0.01),
    "axis_a": Gains(500.0, 2.0),
}


def add_controllers(model: ET.Element, joints: Iterable[JointRange]) -> None:
    """Add a controller for each driven joint, and the publisher of all joints."""
    driven = [joint for joint in joints if not isinstance(joint, FingerJoint)]
    # The jaws are closed at their lower limit.
    positions = {joint.name: joint.lower for joint in driven}
    positions |= zip(positions, named_poses(driven)[START], strict=False)
    for joint in driven:
        gains = GAINS[joint.name]
        plugin = add(
            model,
            "plugin",
            filename="gz-sim-joint-position-controller-system",
            name="gz::sim::systems::JointPositionController",
        )
        fill(
            plugin,
            joint_name=joint.name,
            p_gain=gains.proportional,
            # Gazebo's own default is 0.1.
            i_gain=0.0,
            d_gain=gains.derivative,
            cmd_max=joint.effort,
            cmd_min=-joint.effort,
            initial_position=positions[joint.name],
        )
    add(
        model,
        "plugin",
        filename="gz-sim-joint-state-publisher-system",
        name="gz::sim::systems::JointStatePublisher",
    )
