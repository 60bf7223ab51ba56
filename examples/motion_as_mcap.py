"""Write an analysed motion as MCAP, for Foxglove and Rerun.

    python motion_as_mcap.py recording.csv motion.mcap

Both programs know these ROS 2 messages without an extension: joint states with the
computed torques as efforts, the load on the mount, the tcp, and each link's frame.
Needs the extra ``bags``.
"""

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin
from rosbags import rosbag2
from rosbags.typesys import Stores, get_typestore

import alpha5_model as a5

recording, target = sys.argv[1:]
analysis = a5.trajectory.analyse(a5.trajectory.read_motion(recording))
smooth = analysis.smooth
model = analysis.arm.model
data = model.createData()

store = get_typestore(Stores.ROS2_HUMBLE)
State, Header, Time, WrenchStamped, Wrench, Vector3 = (
    store.types[name]
    for name in (
        "sensor_msgs/msg/JointState",
        "std_msgs/msg/Header",
        "builtin_interfaces/msg/Time",
        "geometry_msgs/msg/WrenchStamped",
        "geometry_msgs/msg/Wrench",
        "geometry_msgs/msg/Vector3",
    )
)
PointStamped, Point, TFMessage, TransformStamped, Transform, Quaternion = (
    store.types[name]
    for name in (
        "geometry_msgs/msg/PointStamped",
        "geometry_msgs/msg/Point",
        "tf2_msgs/msg/TFMessage",
        "geometry_msgs/msg/TransformStamped",
        "geometry_msgs/msg/Transform",
        "geometry_msgs/msg/Quaternion",
    )
)


def parent_link(number: int) -> int:
    """The frame of the link before a link; 0 if there is none."""
    number = model.frames[number].parentFrame
    while number and model.frames[number].type != pin.FrameType.BODY:
        number = model.frames[number].parentFrame
    return number


links = {
    child: parent_link(child)
    for child, frame in enumerate(model.frames)
    if frame.type == pin.FrameType.BODY and parent_link(child)
}


def transforms(q: np.ndarray, stamp: object) -> object:
    """The pose of each link in the link before it."""
    pin.framesForwardKinematics(model, data, q)
    stamped = []
    for child, parent in links.items():
        pose = data.oMf[parent].actInv(data.oMf[child])
        turn = pin.Quaternion(pose.rotation).normalized().coeffs().tolist()
        stamped.append(
            TransformStamped(
                header=Header(stamp=stamp, frame_id=model.frames[parent].name),
                child_frame_id=model.frames[child].name,
                transform=Transform(
                    translation=Vector3(*pose.translation.tolist()),
                    rotation=Quaternion(*turn),
                ),
            )
        )
    return TFMessage(transforms=stamped)


with tempfile.TemporaryDirectory() as folder:
    bag = Path(folder, "motion")
    writer = rosbag2.Writer(bag, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP)
    with writer:
        topics = {
            "/joint_states": State,
            "/mount_load": WrenchStamped,
            "/tcp": PointStamped,
            "/tf": TFMessage,
        }
        connections = {
            topic: writer.add_connection(topic, kind.__msgtype__, typestore=store)
            for topic, kind in topics.items()
        }
        for k, seconds in enumerate(smooth.time):
            nanoseconds = round(float(seconds) * 1e9)
            stamp = Time(*divmod(nanoseconds, 10**9))
            header = Header(stamp=stamp, frame_id="base_link")
            force, moment = np.split(analysis.base_wrench[k], 2)
            messages = {
                "/joint_states": State(
                    header=header,
                    name=list(smooth.joints),
                    position=np.ascontiguousarray(smooth.position[k]),
                    velocity=np.ascontiguousarray(smooth.velocity[k]),
                    effort=np.ascontiguousarray(analysis.torque[k]),
                ),
                "/mount_load": WrenchStamped(
                    header=header,
                    wrench=Wrench(
                        force=Vector3(*force.tolist()),
                        torque=Vector3(*moment.tolist()),
                    ),
                ),
                "/tcp": PointStamped(
                    header=header, point=Point(*analysis.tcp[k].tolist())
                ),
                "/tf": transforms(smooth.position[k], stamp),
            }
            for topic, message in messages.items():
                raw = store.serialize_cdr(message, topics[topic].__msgtype__)
                writer.write(connections[topic], nanoseconds, raw)
    (file,) = bag.glob("*.mcap")
    shutil.copy(file, target)
print(f"wrote {target}: {smooth.time.size} samples")
