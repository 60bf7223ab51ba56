"""A tool of one's own: where the tcp is then, in every description of the arm."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from fk import fk, sample

import alpha5_model as a5
from alpha5_model._support.spatial import pose, rotation_from_rpy
from alpha5_model.description import frames
from alpha5_model.dynamics.load import arm_of
from alpha5_model.errors import ImplausibleWarning, InputError
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers.pose import Pose, printed_tool
from alpha5_model.theory.dh import DHChain

TOOL = Pose(
    position=np.array([0.004, -0.03, -0.245]),
    rotation=rotation_from_rpy((0.3, -0.4, 1.1)),
)
RECORD = dataclasses.replace(a5.parameters(), tool=TOOL)
#: Pose of link_4 in Table 1's tcp: d_4 is 180 mm, and the last two rows turn.
TCP_IN_LINK_4 = pose((0.0, 0.0, -0.18), (0.0, 0.0, 0.0)) @ np.array(
    [[0, 1, 0, 0], [0, 0, -1, 0], [-1, 0, 0, 0], [0, 0, 0, 1]], float
)


def with_tool(q: np.ndarray) -> np.ndarray:
    """transform_tcp_to_base by Table 1 as retyped in the tests, (N, 4, 4)."""
    link_4 = fk(q) @ np.linalg.inv(TCP_IN_LINK_4)
    tool = np.eye(4)
    tool[:3, :3] = TOOL.rotation
    tool[:3, 3] = TOOL.position
    return np.asarray(link_4 @ tool)


def test_the_tool_of_table_1_is_where_the_test_puts_it() -> None:
    placement = frames.tcp_placement(a5.parameters())
    assert pose(placement.xyz, placement.rpy) == pytest.approx(TCP_IN_LINK_4, abs=1e-16)


def test_a_chain_has_the_tool() -> None:
    chain = DHChain.alpha5(arm=RECORD)
    q = sample(200, seed=1)
    assert chain.forward_kinematics(q) == pytest.approx(with_tool(q), abs=1e-15)


def test_an_arm_has_the_tool() -> None:
    arm = arm_of(RECORD)
    q = sample(50, seed=2)
    tcp = [arm.forward_kinematics(row).homogeneous for row in q]
    assert np.array(tcp) == pytest.approx(with_tool(q), abs=1e-15)


def test_a_tool_as_published_changes_nothing() -> None:
    same = Pose(position=TCP_IN_LINK_4[:3, 3], rotation=TCP_IN_LINK_4[:3, :3])
    record = dataclasses.replace(a5.parameters(), tool=same)
    own = frames.tcp_placement(record)
    published = frames.tcp_placement(a5.parameters())
    assert own.xyz == published.xyz
    own_turn = rotation_from_rpy(own.rpy)
    assert own_turn == pytest.approx(rotation_from_rpy(published.rpy), abs=1e-15)


def test_the_plane_of_the_arm_has_a_tool_on_the_wrist_axis() -> None:
    on_axis = dataclasses.replace(TOOL, position=[0.0, 0.0, -0.245])
    geometry = Geometry.of(dataclasses.replace(RECORD, tool=on_axis))
    assert geometry.l_2 == math.hypot(0.02, 0.245)
    with pytest.raises(InputError, match="on the wrist axis"):
        Geometry.of(RECORD).require_tool_on_axis("this test")


def test_a_tool_is_read_only() -> None:
    with pytest.raises(ValueError, match="read-only"):
        TOOL.position[0] = 1.0


@pytest.mark.parametrize("twist", [-2, 0, 1, 3, 0.3])
@pytest.mark.parametrize("turn", [-1, 0, 2, -1.7])
def test_a_printed_tool_turns_by_its_rows(twist: float, turn: float) -> None:
    """By quarter turns it is exact: a matrix of -1, 0 and 1."""
    wrist, last = a5.parameters().dh[3:]
    quarter = math.pi / 2
    found = printed_tool(
        dataclasses.replace(wrist, alpha=twist * quarter),
        dataclasses.replace(last, theta_offset=turn * quarter),
    )
    about_x = rotation_from_rpy((twist * quarter, 0.0, 0.0))
    about_z = rotation_from_rpy((0.0, 0.0, turn * quarter))
    assert found.rotation == pytest.approx(about_x @ about_z, abs=1e-15)
    if isinstance(twist, int) and isinstance(turn, int):
        assert set(found.rotation.ravel().tolist()) <= {-1.0, 0.0, 1.0}
    assert found.position.tolist() == [wrist.a, 0.0, wrist.d]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"position": [0.0, math.nan, 0.0]}, "position"),
        ({"position": [0.0, 0.0]}, "position"),
        ({"rotation": np.diag([1.0, 1.0, -1.0])}, "a rotation matrix"),
        ({"rotation": 1.01 * np.eye(3)}, "a rotation matrix"),
    ],
)
def test_other_than_a_pose_is_refused(change: dict[str, object], expected: str) -> None:
    with pytest.raises(InputError, match=expected):
        dataclasses.replace(TOOL, **change)


def test_a_record_takes_no_other_kind_of_tool() -> None:
    with pytest.raises(InputError, match="a Pose"):
        dataclasses.replace(RECORD, tool=(0.0, 0.0, -0.2))  # type: ignore[arg-type]


def test_millimetres_warn() -> None:
    far = dataclasses.replace(TOOL, position=[4.0, 0.0, -245.0])
    with (
        pytest.warns(ImplausibleWarning, match="mm"),
        pytest.raises(InputError, match=r"tool\.position"),
    ):
        dataclasses.replace(RECORD, tool=far)
