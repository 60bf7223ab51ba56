"""Layouts of public loggers of robot arms, written here from the names they use.

Where each was found is beside it. The names of the joints are given where a logger
does not call them ``axis_e`` to ``axis_b``.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5

COUNT = 40
TIME = 0.05 * np.arange(COUNT)[:, None]
_SPEED = np.array([1.0, 1.5, 2.0, 1.2])
POSITION = np.array([3.1, 1.3, 1.6, 2.0]) + 0.2 * np.sin(TIME * _SPEED)
VELOCITY = 0.2 * _SPEED * np.cos(TIME * _SPEED)
EFFORT = 0.1 * POSITION
COMMAND = POSITION + 0.1
ONE = np.ones((COUNT, 1))
#: Seconds since 1970.
CLOCK = 1_620_000_000.0


@dataclass(frozen=True)
class Layout:
    """A table of a logger.

    Attributes:
        names: Names of the columns; ``*`` stands for four joints.
        columns: The numbers under each name.
        joint: Name of a joint, with its number in place of the braces.
        first: The number of the first joint.
        separator: What stands between two columns.
        reads: What is read beside the positions.
    """

    names: str
    columns: tuple[np.ndarray, ...]
    joint: str = ""
    first: int = 1
    separator: str = ","
    reads: str = ""

    def joints(self) -> dict[str, str] | None:
        """Joint of the arm -> its name in the file."""
        if not self.joint:
            return None
        return {
            f"axis_{letter}": self.joint.format(number)
            for number, letter in enumerate("edcb", start=self.first)
        }

    def text(self) -> str:
        """The file."""
        header = []
        for name in self.names.split():
            numbers = [str(self.first + k) for k in range(4)]
            own = [f"axis_{x}" for x in "edcb"] if not self.joint else numbers
            header += [name.replace("*", x) for x in own] if "*" in name else [name]
        rows = np.column_stack(self.columns)
        assert rows.shape[1] == len(header)
        lines = [header, *([repr(float(x)) for x in row] for row in rows)]
        return "".join(self.separator.join(line) + "\n" for line in lines)


LAYOUTS = {
    # LDWLDWLDW666/ros2_joint_recorder, README
    "t and joints": Layout("t *", (TIME, POSITION)),
    # mekala-2405/omx_ws_back, omx_log_joint_states.py
    "pos, vel, eff": Layout(
        "t *_pos *_vel *_eff",
        (TIME, POSITION, VELOCITY, EFFORT),
        reads="velocity effort",
    ),
    # a leader and a follower arm, each with a gripper
    "gripper": Layout(
        "timestamp joint_* gripper", (CLOCK + TIME, POSITION, ONE), "joint_{}"
    ),
    # training data of a learning environment
    "gripper and reward": Layout(
        "timestamp joint_* gripper reward",
        (CLOCK + TIME, POSITION, ONE, ONE),
        "joint_{}",
    ),
    # a predictive controller's own log
    "control and target": Layout(
        "time joint*_pos joint*_vel joint*_control joint*_target cost",
        (TIME, POSITION, VELOCITY, EFFORT, COMMAND, ONE),
        "joint{}",
        reads="velocity",
    ),
    # a recorder with two clocks
    "two clocks": Layout(
        "timestamp time_sec joint*_pos joint*_vel joint*_eff",
        (CLOCK + TIME, TIME, POSITION, VELOCITY, EFFORT),
        "joint{}",
        reads="velocity effort",
    ),
    # a simulator's recorder; such torques may be commands, so they are ignored
    "torque": Layout(
        "time joint*_pos joint*_vel joint*_torque",
        (TIME, POSITION, VELOCITY, EFFORT),
        "joint{}",
        reads="velocity",
    ),
    # record.py of Universal Robots' RTDE client
    "RTDE": Layout(
        "timestamp target_q_* actual_q_* actual_qd_*",
        (5000 + TIME, COMMAND, POSITION, VELOCITY),
        "actual_q_{}",
        first=0,
        separator=" ",
    ),
    "RTDE, joints by number": Layout(
        "timestamp target_q_* actual_q_* actual_qd_*",
        (5000 + TIME, COMMAND, POSITION, VELOCITY),
        "{}",
        first=0,
        reads="velocity",
    ),
    # a trajectory written by pandas from RTDE's names, the time last
    "RTDE, time last": Layout(
        "actual_q_* timestamp", (POSITION, TIME), "actual_q_{}", first=0, separator=" "
    ),
    # Intera's recorder of Sawyer
    "Sawyer": Layout(
        "time right_j* right_gripper", (TIME, POSITION, ONE), "right_j{}", first=0
    ),
    "q0": Layout("time q*", (TIME, POSITION), "q{}", first=0),
    "joint_0": Layout("time joint_*", (TIME, POSITION), "joint_{}", first=0),
    # PlotJuggler, with a topic of references beside the states
    "PlotJuggler": Layout(
        "__time /joint_states/joint*/position /joint_states/joint*/velocity "
        "/reference_joint_states/commands/data.*",
        (CLOCK + TIME, POSITION, VELOCITY, COMMAND),
        "joint{}",
        reads="velocity",
    ),
    # libfranka's log
    "libfranka": Layout(
        "time state.q[*] state.dq[*] cmd.tau_J[*]",
        (TIME, POSITION, VELOCITY, EFFORT),
        "state.q[{}]",
        first=0,
    ),
    # bagpy's tables of a bag
    "bagpy": Layout(
        "Time header.seq header.stamp.secs header.stamp.nsecs position_*",
        (CLOCK + TIME, ONE, ONE, ONE, POSITION),
        "position_{}",
        first=0,
    ),
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_layouts_of_public_loggers_are_read(name: str, tmp_path: Path) -> None:
    layout = LAYOUTS[name]
    path = tmp_path / "log.csv"
    path.write_text(layout.text())
    motion = a5.trajectory.read_motion(path, joints=layout.joints())
    np.testing.assert_array_equal(motion.position, POSITION)
    elapsed = motion.time - motion.time[0]
    np.testing.assert_allclose(elapsed, TIME[:, 0], rtol=0, atol=1e-6)
    given = {"velocity": VELOCITY, "effort": EFFORT}
    for quantity, numbers in given.items():
        read = getattr(motion, quantity)
        assert (read is not None) == (quantity in layout.reads.split())
        if read is not None:
            np.testing.assert_array_equal(read, numbers)
