"""Files of joint motion with comments, short rows, other arms and deep metadata."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bag_writer import State, write_bag
from short_recording import (
    JOINTS,
    POSITION,
    TIME,
    csv,
    kinds,
    positions,
    refused,
)

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.trajectory import (
    bag_limits,
)
from alpha5_model.trajectory.joint_map import JointMap

# --- what files expand to -------------------------------------------------------------


@pytest.mark.parametrize(("levels", "read"), [(20, True), (21, False)])
def test_metadata_of_a_bag_nests_twenty_levels(
    levels: int, read: bool, tmp_path: Path
) -> None:
    file = tmp_path / "metadata.yaml"
    file.write_text("[" * levels + "]" * levels + "\n", "utf-8")
    with refused(not read, "nests deeper than 20 levels"):
        bag_limits._check_metadata("bag", file)
    # Levels that are closed do not count.
    file.write_text("- [{a: [1]}]\n" * 40, "utf-8")
    bag_limits._check_metadata("bag", file)


# --- bags -----------------------------------------------------------------------------


def test_a_bag_without_the_arm_names_its_four_joints(tmp_path: Path) -> None:
    path = write_bag(tmp_path, ".mcap", [State(10**18, ["a", "b"], [1.0, 2.0])])
    joints = ", ".join(JOINTS)
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    words = f"no message has all of {joints}, but /joint_states: a, b"
    assert str(caught.value).endswith(words)


def test_the_last_of_several_comments_holds_the_names(tmp_path: Path) -> None:
    names = ",".join(["time", *JOINTS])
    rows = [f"{0.1 * k},1.1,1.2,1.3,1.4" for k in range(9)]
    path = tmp_path / "m.csv"
    for before in ([], ["# run 7"], ["# run 7", "# a,b,c,d,e"], ["# 1", "# 2", "# 3"]):
        path.write_text("\n".join([*before, f"# {names}", *rows]), "utf-8")
        found = a5.trajectory.read_motion(path)
        np.testing.assert_array_equal(found.position[4], [1.1, 1.2, 1.3, 1.4])


def test_a_date_is_found_behind_a_short_row(tmp_path: Path) -> None:
    """The time is the last column, and the first row lacks it."""
    head = ",".join([*JOINTS, "time"])
    rows = [f"1.1,1.2,1.3,1.4,2026-11-27T02:00:{k:02d}" for k in range(9)]
    path = tmp_path / "m.csv"
    path.write_text("\n".join([head, "1.1,1.2", *rows]), "utf-8")
    found = a5.trajectory.read_motion(path)
    np.testing.assert_array_equal(np.diff(found.time), np.ones(8))
    assert kinds(found) == ["bad_row"]


def test_the_longest_name_of_a_joint_is_taken() -> None:
    joints = JointMap({"axis_e": "j", "axis_d": "j_2", "axis_c": "j_2_b"})
    names = ["j_pos", "j_2_pos", "left_j_2_b_vel", "jj", "j2"]
    expected = ["axis_e_pos", "axis_d_pos", "left_axis_c_vel", "jj", "j2"]
    assert joints.renamed(names) == expected


def test_the_first_row_names_the_joints(tmp_path: Path) -> None:
    """Of a table with names in each row: the last row may be another one's."""
    head = ["time", *(f"name[{k}]" for k in range(4))]
    head += [f"position[{k}]" for k in range(4)]
    rows = [[f"{0.1 * k}", *JOINTS, "1.1", "1.2", "1.3", "1.4"] for k in range(9)]
    rows[-1][1:5] = JOINTS[::-1]
    path = tmp_path / "m.csv"
    path.write_text("\n".join(",".join(row) for row in (head, *rows)), "utf-8")
    found = a5.trajectory.read_motion(path)
    np.testing.assert_array_equal(found.position[:, 0], np.full(8, 1.1))
    assert [(w.kind, w.first) for w in found.warnings] == [
        ("bad_row", "line 10, column 2 (name[0])")
    ]
    path.write_text("\n".join(",".join(row) for row in (head, rows[0])), "utf-8")
    with pytest.raises(InputError, match="at least 5 samples, got 1"):
        a5.trajectory.read_motion(path)


@pytest.mark.parametrize("quantity", ["torque", "vel", "acc", "xyz", "temp", "status"])
def test_an_arm_without_positions_is_no_choice(quantity: str, tmp_path: Path) -> None:
    """Whatever else a file has of another arm's four joints."""
    columns = {f"left_{name}": angles for name, angles in positions().items()}
    columns |= {f"right_{joint}_{quantity}": TIME for joint in JOINTS}
    path = csv(tmp_path / "m.csv", {"time": TIME, **columns})
    np.testing.assert_array_equal(a5.trajectory.read_motion(path).position, POSITION)
