"""An analysed motion as an MCAP file of ROS 2 messages, for Foxglove and Rerun.

Both programs know these messages without an extension: they plot joint states, draw the
frames of transforms, and know the mount load as a wrench.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError, needing
from alpha5_model.trajectory.analysis import Analysis
from alpha5_model.trajectory.file_table import CHUNK, Progress

if TYPE_CHECKING:
    import pinocchio as pin

#: ROS counts the seconds of a stamp in 32 bits.
_END_OF_STAMPS = 2**31


class _Channel(NamedTuple):
    """Messages of one topic.

    Attributes:
        topic: Its name.
        kind: Type of its messages.
        message: Makes the message of a sample from its number and its header.
    """

    topic: str
    kind: str
    message: Callable[[int, Any], Any]


def mcap(analysis: Analysis, progress: Progress | None = None) -> bytes:
    """The motion as an MCAP file.

    Topics: ``/joint_states`` with the smoothed motion and, as efforts, the torques;
    ``/torques`` with the torques by cause, and the recorded efforts, named as the
    columns of `columns`; ``/mount_load``, the force and moment on the mount at
    base_link; ``/tcp``; and ``/tf`` with every link's frame.

    Args:
        analysis: What to write.
        progress: Called with ``"write"`` and the part done, 0 to 1.

    Raises:
        InputError: Times that ROS cannot write.
        MissingDependencyError: rosbags is not installed.
    """
    time = analysis.smooth.time
    if time[0] < 0.0 or time[-1] >= _END_OF_STAMPS:
        found = f"{time[0]:.10g} to {time[-1]:.10g} s"
        raise InputError("time", found, f"0 to {_END_OF_STAMPS - 1} s, as ROS counts")
    nanoseconds = np.rint(time * 1e9).astype(np.int64).tolist()

    with needing("an MCAP file", "python -m pip install 'alpha5-model[bags]'"):
        from rosbags import rosbag2
        from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    channels = _channels(analysis, store.types)
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder, "motion")
        writer = rosbag2.Writer(
            bag, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP
        )
        writer.set_compression(
            rosbag2.CompressionMode.STORAGE, rosbag2.CompressionFormat.ZSTD
        )
        with writer:
            connections = [
                writer.add_connection(channel.topic, channel.kind, typestore=store)
                for channel in channels
            ]
            for sample, now in enumerate(nanoseconds):
                header = _header(store.types, now)
                for channel, connection in zip(channels, connections, strict=True):
                    message = channel.message(sample, header)
                    data = store.serialize_cdr(message, channel.kind)
                    writer.write(connection, now, data)
                if progress and sample % CHUNK == 0:
                    progress("write", sample / len(nanoseconds))
        (file,) = bag.glob("*.mcap")
        content = file.read_bytes()

    if progress:
        progress("write", 1.0)
    return content


def _header(types: Any, nanoseconds: int) -> Any:
    """A header with a time [ns], in base_link."""
    sec, nanosec = divmod(nanoseconds, 10**9)
    stamp = types["builtin_interfaces/msg/Time"](sec=sec, nanosec=nanosec)
    return types["std_msgs/msg/Header"](stamp=stamp, frame_id="base_link")


def _channels(analysis: Analysis, types: Any) -> list[_Channel]:
    """All topics of the file."""
    return [
        _joint_states(analysis, types),
        _torques(analysis, types),
        _mount_load(analysis, types),
        _tcp(analysis, types),
        _transforms(analysis, types),
    ]


def _joint_states(analysis: Analysis, types: Any) -> _Channel:
    kind = "sensor_msgs/msg/JointState"
    names = list(analysis.smooth.joints)
    smooth = analysis.smooth

    def message(sample: int, header: Any) -> Any:
        return types[kind](
            header=header,
            name=names,
            position=_row(smooth.position, sample),
            velocity=_row(smooth.velocity, sample),
            effort=_row(analysis.torque, sample),
        )

    return _Channel("/joint_states", kind, message)


def _torques(analysis: Analysis, types: Any) -> _Channel:
    """Torques by cause and recorded efforts, as efforts of joint states."""
    kind = "sensor_msgs/msg/JointState"
    columns = {f"torque_{cause}": torque for cause, torque in analysis.causes().items()}
    if analysis.effort is not None:
        columns["effort"] = analysis.effort
    joints = analysis.smooth.joints
    names = [f"{joint}_{ending}" for ending in columns for joint in joints]
    values = np.concatenate(list(columns.values()), axis=1)
    none = np.empty(0)

    def message(sample: int, header: Any) -> Any:
        return types[kind](
            header=header,
            name=names,
            position=none,
            velocity=none,
            effort=_row(values, sample),
        )

    return _Channel("/torques", kind, message)


def _mount_load(analysis: Analysis, types: Any) -> _Channel:
    kind = "geometry_msgs/msg/WrenchStamped"
    wrenches = analysis.base_wrench.tolist()

    def message(sample: int, header: Any) -> Any:
        wrench = types["geometry_msgs/msg/Wrench"](
            force=_vector(types, wrenches[sample][:3]),
            torque=_vector(types, wrenches[sample][3:]),
        )
        return types[kind](header=header, wrench=wrench)

    return _Channel("/mount_load", kind, message)


def _tcp(analysis: Analysis, types: Any) -> _Channel:
    kind = "geometry_msgs/msg/PointStamped"
    points = analysis.tcp.tolist()

    def message(sample: int, header: Any) -> Any:
        x, y, z = points[sample]
        point = types["geometry_msgs/msg/Point"](x=x, y=y, z=z)
        return types[kind](header=header, point=point)

    return _Channel("/tcp", kind, message)


def _transforms(analysis: Analysis, types: Any) -> _Channel:
    """The pose of each link in the link before it."""
    import pinocchio as pin

    kind = "tf2_msgs/msg/TFMessage"
    model = analysis.arm.model
    data = model.createData()
    links = list(_links(model))

    def message(sample: int, header: Any) -> Any:
        pin.framesForwardKinematics(model, data, analysis.smooth.position[sample])
        stamped = [
            types["geometry_msgs/msg/TransformStamped"](
                header=types["std_msgs/msg/Header"](
                    stamp=header.stamp, frame_id=model.frames[parent].name
                ),
                child_frame_id=model.frames[child].name,
                transform=_transform(types, data.oMf[parent].actInv(data.oMf[child])),
            )
            for parent, child in links
        ]
        return types[kind](transforms=stamped)

    return _Channel("/tf", kind, message)


def _links(model: pin.Model) -> Iterator[tuple[int, int]]:
    """Numbers of the frames of each link and of the link before it."""
    import pinocchio as pin

    def is_link(number: int) -> bool:
        return bool(model.frames[number].type == pin.FrameType.BODY)

    for child in range(model.nframes):
        parent = model.frames[child].parentFrame
        while parent and not is_link(parent):
            parent = model.frames[parent].parentFrame
        if parent and is_link(child):
            yield parent, child


def _transform(types: Any, placement: pin.SE3) -> Any:
    import pinocchio as pin

    x, y, z, w = pin.Quaternion(placement.rotation).normalized().coeffs().tolist()
    return types["geometry_msgs/msg/Transform"](
        translation=_vector(types, placement.translation.tolist()),
        rotation=types["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w),
    )


def _vector(types: Any, values: list[float]) -> Any:
    x, y, z = values
    return types["geometry_msgs/msg/Vector3"](x=x, y=y, z=z)


def _row(values: FloatArray, sample: int) -> FloatArray:
    """Numbers of a sample, in one piece."""
    return np.ascontiguousarray(values[sample], dtype=np.float64)
