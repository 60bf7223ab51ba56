"""Kinematics, dh, planar and workspace answer any input or raise a package error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model import planar
from alpha5_model.errors import Alpha5Error, InputError, UnknownNameError
from alpha5_model.kinematics import pose
from alpha5_model.theory.dh import (
    arm_types,
    dh_transform,
    frame_assignment,
    orientations,
    sampling,
    tasks,
    urdf,
)

space = a5.workspace
CHAIN = a5.dh.DHChain.alpha5()
LINK = CHAIN.links[0]
ARM = planar.PlanarArm((5.0, 4.0, 1.0))
MODEL = a5.load().model
Q = np.array([3.0, 1.0, 1.0, 1.0])
P = np.array([0.2, 0.1, 0.1])
POSE = CHAIN.forward_kinematics(Q)
PLANE = {"radius": np.array([0.2]), "z": np.array([0.1])}
SIDE: dict[str, Any] = {"side": "both"}
REACH: dict[str, Any] = {"positions": P, "limits": True}
AXES = {"points": [[0.0, 0, 0], [1, 0, 0]], "directions": [[0.0, 0, 1], [0, 0, 1]]}
LINES = {
    "point_1": P,
    "direction_1": [0.0, 0, 1],
    "point_2": 2 * P,
    "direction_2": [1.0, 0, 0],
}
FOUR_BAR = {"l_1": 5.0, "l_2": 4.0, "l_3": 1.0, "l_4": 3.0}

#: Function, and arguments that it takes; each in turn is replaced.
CALLS: list[tuple[Callable[..., Any], dict[str, Any]]] = [
    (a5.inverse_kinematics, {"position": P, "wrist": 0.0}),
    (a5.inverse_kinematics(P).best, {"q_reference": Q}),
    (a5.inverse_kinematics(P[None]).best, {"q_reference": Q}),
    (a5.inverse_kinematics_pose, {"transform": POSE}),
    (a5.inverse_kinematics_pose(POSE).best, {"q_reference": Q}),
    (
        a5.inverse_kinematics_path,
        {"positions": P[None], "q_start": None, "wrist": None, "max_step": 0.5},
    ),
    (a5.published_inverse_kinematics, {"position": P}),
    (a5.reachable, REACH),
    (a5.distance_to_reach, REACH),
    (a5.nearest_reachable, REACH),
    (space.boundary, {"side": "both", "limits": True}),
    (space.cross_section_area, {"side": "both", "limits": True}),
    (space.volume, {"limits": True}),
    (space.published_reachable, {"positions": P}),
    (space.published_but_unreachable, SIDE),
    (space.reachable_but_unpublished, SIDE),
    (space.in_tori, PLANE),
    (space.in_half_plane, {**PLANE, "side": "both", "limits": True}),
    (space.manipulability, {"q": Q}),
    (space.singularities, {"q": Q}),
    (space.singularities(Q).near, {"angle": 1e-6, "distance": 1e-6}),
    (space.boundary()[0].points, {"angle": 0.3}),
    (pose.approach_directions, {"position": P}),
    (
        a5.dh.DHChain,
        {"links": (LINK,), "base": POSE, "tool": POSE, "name": "x", "joint_names": "j"},
    ),
    (a5.dh.DHChain.from_table, {"rows": [[0, 0, 1, 0, 0]], "joint_names": ()}),
    (a5.dh.DHChain.alpha5, {"corrections": ()}),
    (a5.dh.DHChain.from_pinocchio, {"model": MODEL, "frame": None}),
    (urdf.pinocchio_axes, {"model": MODEL, "frame": None}),
    (a5.dh.DHChain.from_urdf, {"path": a5.URDF_PATH, "frame": None}),
    (CHAIN.frames, {"q": Q}),
    (CHAIN.forward_kinematics, {"q": Q, "frame": "tool"}),
    (CHAIN.joint_axes, {"q": Q}),
    (CHAIN.jacobian, {"q": Q, "frame": 2}),
    (dh_transform, {"theta": 0.0, "d": 0.0, "a": 0.0, "alpha": 0.0}),
    (
        a5.dh.DHLink,
        {
            "theta": 0.0,
            "d": 0.0,
            "a": 1.0,
            "alpha": 0.0,
            "sigma": 0,
            "lower": -1.0,
            "upper": 1.0,
        },
    ),
    (a5.dh.DHLink.from_vector, {"vector": [0, 0, 1, 0, 0]}),
    (LINK.transform, {"q": 0.3}),
    (
        a5.dh.DHChain.from_axes,
        {**AXES, "sigma": None, "end_effector": None, "q": None, "limits": None},
    ),
    (
        a5.dh.DHChain.from_axes,
        {**AXES, "tolerance": 1e-9, "name": "n", "joint_names": ()},
    ),
    (frame_assignment.common_normal, LINES),
    (arm_types.classify, {"chain": CHAIN, "vertical": (0.0, 0, 1)}),
    (
        tasks.task_capability,
        {"chain": CHAIN, "tool_axis": None, "samples": 2, "seed": 0},
    ),
    (
        sampling.sample_configurations,
        {"chain": CHAIN, "count": 2, "rng": np.random.default_rng(0)},
    ),
    (sampling.chain_size, {"chain": CHAIN}),
    (tasks.spatial_conditions, {"chain": CHAIN}),
    (orientations.orientation_freedom, {"chain": CHAIN, "q": Q}),
    (
        orientations.spatial_dexterity,
        {
            "chain": CHAIN,
            "positions": P,
            "orientations": 2,
            "starts": 1,
            "steps": 2,
            "seed": 0,
        },
    ),
    (orientations.even_rotations, {"number": 3}),
    (
        planar.PlanarArm,
        {"lengths": (5.0, 4.0), "limits": None, "joints": "RR", "angles": None},
    ),
    (ARM.part, {"start": 0, "stop": 1}),
    (ARM.poses, {"q": [0.0, 0, 0]}),
    (ARM.forward_kinematics, {"q": [0.0, 0, 0]}),
    (ARM.jacobian, {"q": [0.0, 0, 0]}),
    (planar.workspace, {"arm": ARM}),
    (planar.annulus, {"length_ranges": [(1.0, 2.0)]}),
    (ARM.workspace().contains, {"points": [0.0, 1.0]}),
    (
        planar.dexterity,
        {"arm": ARM, "points": [0.0, 1.0], "orientations": 4, "samples": 3},
    ),
    (
        planar.dexterity_map,
        {"arm": ARM, "resolution": 3, "orientations": 4, "samples": 3},
    ),
    (planar.dexterous_area, {"arm": ARM}),
    (planar.dexterous_radii, {"arm": ARM}),
    (planar.necessary_conditions, {"arm": ARM}),
    (planar.turns_fully, {"arm": ARM, "radius": 3.0}),
    (planar.lecture_theorem, FOUR_BAR),
    (planar.theorem_row, FOUR_BAR),
    (planar.theorem_radii, {"l_1": 5.0, "l_2": 4.0, "l_3": 1.0}),
]
BAD: list[Any] = [
    *(
        None,
        True,
        np.True_,
        1,
        0,
        -1,
        1.0,
        -5.5,
        10**400,
        1e308,
        np.inf,
        np.nan,
        1j,
        object(),
    ),
    *(
        "abc",
        "",
        b"x",
        [],
        [1],
        (1, 2),
        {1: 2},
        set(),
        [[1, 2], [3]],
        range(3),
        [True] * 4,
    ),
    *(
        np.array(3.0),
        np.array([1.0, 2.0]),
        np.eye(4),
        np.zeros((0, 3)),
        np.zeros((2, 2, 2)),
    ),
    *(
        np.array(["a"]),
        np.array([None]),
        [[1e300] * 3],
        [1e308] * 4,
        np.full(3, np.nan),
    ),
]


@pytest.mark.parametrize(("function", "arguments"), CALLS)
def test_an_answer_or_an_error_of_the_package(
    function: Callable[..., Any], arguments: dict[str, Any]
) -> None:
    function(**arguments)
    for name in arguments:
        refused = []
        for bad in BAD:
            try:
                function(**{**arguments, name: bad})
            except Alpha5Error as error:
                refused.append(error)
        assert all(
            "\n" not in str(e) and isinstance(e, ValueError | OSError) for e in refused
        )
        assert len(refused) > len(BAD) // 3, f"{name} takes anything"


@pytest.mark.parametrize(
    "bad", [1, 0, "no", None, [True], np.array([True, False]), np.eye(3)]
)
def test_limits_are_true_or_false(bad: Any) -> None:
    for function, first in (
        (a5.reachable, [P]),
        (a5.distance_to_reach, [P]),
        (a5.nearest_reachable, [P]),
        (space.boundary, ["both"]),
        (space.cross_section_area, ["both"]),
        (space.volume, []),
        (space.in_half_plane, [0.2, 0.1, "both"]),
    ):
        with pytest.raises(InputError, match="limits: expected True or False"):
            function(*first, bad)
        assert repr(function(*first, np.False_)) == repr(function(*first, False))


@pytest.mark.parametrize(
    "frame", [-1, 5, True, 1.0, None, "tcp", np.array([1, 2]), [0]]
)
def test_frames_of_a_chain(frame: Any) -> None:
    with pytest.raises(UnknownNameError, match="choose from 0, 1, 2, 3, 4, tool"):
        CHAIN.forward_kinematics(Q, frame)


@pytest.mark.parametrize("frame", [0, 4, np.int64(2)])
def test_frames_that_exist(frame: Any) -> None:
    assert np.array_equal(
        CHAIN.forward_kinematics(Q, frame), CHAIN.frames(Q)[int(frame)]
    )


def test_sides_are_checked_before_they_are_looked_up() -> None:
    for function in (space.boundary, space.published_but_unreachable):
        with pytest.raises(UnknownNameError, match="underarm, overarm, both"):
            function([1])
    with pytest.raises(UnknownNameError, match="side"):
        space.in_half_plane(0.2, 0.1, "left")


def test_half_planes_take_shapes_that_broadcast() -> None:
    radius = np.linspace(0, 0.4, 5)
    z = np.linspace(-0.2, 0.3, 4)[:, None]
    for function in (space.in_half_plane, space.in_tori):
        table = function(radius, z)
        assert table.shape == (4, 5)
        for i, j in np.ndindex(4, 5):
            assert table[i, j] == function(radius[j], z[i, 0])
        with pytest.raises(
            InputError, match=r"radius, z: expected .*shapes that broadcast"
        ):
            function(radius, z[:, 0])


def test_a_reference_far_away_still_picks_a_solution_within_the_limits() -> None:
    """The best branch is within the limits even if the squared distance overflows."""
    p = np.random.default_rng(0).uniform(-0.3, 0.3, (500, 3))
    s = a5.inverse_kinematics(p)
    only_later = s.within_limits.any(axis=-1) & ~s.within_limits[:, 0]
    assert only_later.any()
    p = p[only_later]
    best = a5.inverse_kinematics(p).best([1e200, 0.0, 0.0, 0.0], allow_collision=True)
    assert np.isfinite(best).all()
    np.testing.assert_allclose(CHAIN.forward_kinematics(best)[:, :3, 3], p, atol=1e-12)


def test_directions_of_any_length() -> None:
    for scale in (1e-300, 1.0, 1e300):
        chain = a5.dh.DHChain.from_axes(AXES["points"], [[0, 0, scale], [0, 0, scale]])
        assert chain.links[0].a == pytest.approx(1.0)
        assert arm_types.classify(CHAIN, [0, 0, scale]) == arm_types.classify(CHAIN)
