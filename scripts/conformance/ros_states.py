"""Ask ROS 1's robot_state_publisher and tf where frames are.

This runs in Debian's own Python, which has rospy.

    /usr/bin/python3 ros_states.py REQUEST ANSWER

REQUEST: JSON with ``joints`` [...], ``positions`` [[...], ...], ``base`` and ``frames``
[...]. ANSWER: JSON, for each row of positions and each frame position [m] and
quaternion (x, y, z, w) in the base. A roscore and a robot_state_publisher must run.
"""

import json
import sys
from pathlib import Path

import rospy
import tf2_ros
from sensor_msgs.msg import JointState


def main(request: Path, answer: Path) -> None:
    """Publish each row until tf has it."""
    asked = json.loads(request.read_text(encoding="utf-8"))
    rospy.init_node("alpha5_states", disable_signals=True)
    buffer = tf2_ros.Buffer(rospy.Duration(60))
    listener = tf2_ros.TransformListener(buffer)
    publisher = rospy.Publisher("joint_states", JointState, queue_size=10)
    rows = []
    for positions in asked["positions"]:
        rospy.sleep(
            0.005
        )  # robot_state_publisher leaves out what follows within its period
        stamp = rospy.Time.now()
        message = JointState(name=asked["joints"], position=positions)
        message.header.stamp = stamp
        for _ in range(500):  # the first ones are lost until the nodes have met
            publisher.publish(message)
            found = buffer.can_transform(
                asked["base"], asked["frames"][-1], stamp, rospy.Duration(0.02)
            )
            if found:
                break
        rows.append(
            [pose(buffer, asked["base"], frame, stamp) for frame in asked["frames"]]
        )
    answer.write_text(json.dumps(rows), encoding="utf-8")
    listener.unregister()


def pose(buffer, base, frame, stamp):
    """Seven numbers."""
    found = buffer.lookup_transform(base, frame, stamp).transform
    x, r = found.translation, found.rotation
    return [x.x, x.y, x.z, r.x, r.y, r.z, r.w]


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
