"""Frame assignment: axes to parameters and back, every special position, real arms."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from loops import each

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, InputError, UnknownNameError
from alpha5_model.theory.dh.chain import DHChain

QUARTER = math.pi / 2

KINDS = ("skew", "parallel", "antiparallel", "intersecting", "coincident", "opposed")
TIGHT = 1e-12
assign_frames = DHChain.from_axes


def next_axis(kind: str, p: np.ndarray, z: np.ndarray, rng: np.random.Generator):
    """An axis of a kind, such as skew, relative to the previous axis."""
    slide = rng.normal()
    return {
        "skew": lambda: (rng.normal(size=3), rng.normal(size=3)),
        "parallel": lambda: (rng.normal(size=3), z.copy()),
        "antiparallel": lambda: (rng.normal(size=3), -3 * z),
        "intersecting": lambda: (p + slide * z, rng.normal(size=3)),
        "coincident": lambda: (p + slide * z, 2 * z),
        "opposed": lambda: (p + slide * z, -z),
    }[kind]()


def random_axes(kinds, rng: np.random.Generator):
    axes = [(rng.normal(size=3), rng.normal(size=3))]
    for kind in kinds:
        axes.append(next_axis(kind, *axes[-1], rng))
    return np.array([p for p, _ in axes]), np.array([z for _, z in axes])


def axis_error(chain: DHChain, q, points, directions) -> float:
    p, z = chain.joint_axes(q)
    unit = directions / np.linalg.norm(directions, axis=1)[:, None]
    return max(np.abs(z - unit).max(), np.abs(np.cross(p - points, unit)).max())


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("with_tool", [False, True])
def test_round_trip(kind: str, with_tool: bool) -> None:
    rng = np.random.default_rng(KINDS.index(kind))
    for _ in range(60):
        others = rng.choice(KINDS, 4)
        points, directions = random_axes([kind, *others], rng)
        sigma = rng.integers(0, 2, len(points)).tolist()
        end = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3)).homogeneous
        chain = assign_frames(points, directions, sigma, end if with_tool else None)
        assert chain.sigma == tuple(sigma)
        assert axis_error(chain, chain.home, points, directions) < 1e-11
        if with_tool:
            assert np.abs(chain.forward_kinematics(chain.home) - end).max() < 1e-11
        # and once more, from the axes of the chain
        again = assign_frames(
            *chain.joint_axes(chain.home), sigma, end if with_tool else None
        )
        assert axis_error(again, again.home, points, directions) < 1e-11


def test_every_motion_is_the_same_as_turning_about_the_axes() -> None:
    """Product of exponentials over the given axes, written without any DH table."""
    rng = np.random.default_rng(11)
    for _ in range(30):
        points, directions = random_axes(rng.choice(KINDS, 5), rng)
        sigma = rng.integers(0, 2, 6)
        end = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
        drawn = rng.normal(size=6)
        q = rng.normal(size=6)
        chain = assign_frames(
            points, directions, sigma.tolist(), end.homogeneous, drawn
        )
        assert chain.home == pytest.approx(drawn)
        pose = pin.SE3.Identity()
        for p, z, slides, x in zip(points, directions, sigma, q - drawn, strict=True):
            u = z / np.linalg.norm(z)
            twist = (
                pin.Motion(u, np.zeros(3)) if slides else pin.Motion(np.cross(p, u), u)
            )
            pose = pose * pin.exp6(x * twist)
        difference = (pose * end).homogeneous - chain.forward_kinematics(q)
        assert np.abs(difference).max() < 1e-11


@pytest.mark.parametrize("kind", KINDS)
def test_the_frames_obey_the_rule(kind: str) -> None:
    rng = np.random.default_rng(21)
    for _ in range(40):
        points, directions = random_axes([kind], rng)
        chain = assign_frames(points, directions, end_effector=np.eye(4))
        frames = chain.frames(chain.home)
        link = chain.links[0]
        x = frames[1, :3, 0]
        z = frames[:2, :3, 2]
        # x_1 is normal to both axes and meets both.
        assert np.abs(z @ x).max() < TIGHT
        gap = frames[1, :3, 3] - frames[0, :3, 3]
        assert np.abs(np.cross(gap - (gap @ z[0]) * z[0], x)).max() < TIGHT
        if kind == "skew":
            assert link.a > 0
        if kind == "intersecting":
            assert link.a == pytest.approx(0, abs=TIGHT)
            assert 0 < link.alpha < math.pi
        if "parallel" in kind:
            assert link.d == pytest.approx(0, abs=TIGHT)
            distance = np.linalg.norm(np.cross(points[1] - points[0], z[0]))
            assert link.a == pytest.approx(distance, abs=TIGHT)
        if kind in ("coincident", "opposed"):
            assert (link.theta, link.d, link.a) == pytest.approx((0, 0, 0), abs=TIGHT)
        if kind in ("parallel", "coincident"):
            assert link.alpha == pytest.approx(0, abs=TIGHT)
        if kind in ("antiparallel", "opposed"):
            assert abs(link.alpha) == pytest.approx(math.pi, abs=TIGHT)


@each("point", [(0, 0, 0.3), (0.2, 0, 0), (0, 0.2, 0), (0, 1e-6, 0)])
@each("direction", [(0, 0, 1), (0, 0, -1), (0, 1e-6, 1), (1e-6, 0, 1)])
def test_the_world_frame_is_the_first_one_on_its_own_axis(
    point: tuple[float, ...], direction: tuple[float, ...]
) -> None:
    """Only if the first axis is the world's z axis; else a frame on that axis."""
    points = np.array([point, (0.4, 0.3, 0.2)])
    directions = np.array([direction, (0.0, 1.0, 0.3)])
    chain = assign_frames(points, directions)
    assert axis_error(chain, chain.home, points, directions) < 1e-12
    on_world_axis = direction == (0, 0, 1) and point[:2] == (0, 0)
    assert np.array_equal(chain.base, np.eye(4)) == on_world_axis


@pytest.mark.parametrize("angle", [1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
def test_nearly_parallel_axes(angle: float) -> None:
    """Little accuracy is lost although the common normal is far away."""
    rng = np.random.default_rng(31)
    for _ in range(20):
        p = rng.normal(size=(2, 3))
        z = rng.normal(size=3)
        z = z / np.linalg.norm(z)
        side = np.cross(z, rng.normal(size=3))
        tilted = z + angle * side / np.linalg.norm(side)
        chain = assign_frames(p, [z, tilted])
        assert axis_error(chain, chain.home, p, np.array([z, tilted])) < 1e-7


def product_of_exponentials(points, directions, end, q) -> np.ndarray:
    """The pose of the end effector by rotations about the axes, without a DH table."""
    pose = pin.SE3.Identity()
    for p, z, angle in zip(points, directions, q, strict=True):
        pose = pose * pin.exp6(angle * pin.Motion(np.cross(p, z), z))
    return pose.homogeneous @ end


def tilted_axes(tilts, rng: np.random.Generator):
    """Axes through a cube of 1 m, each tilted against the previous one by its angle."""
    points = rng.uniform(-0.5, 0.5, (len(tilts) + 1, 3))
    directions = [unit(rng.normal(size=3))]
    for tilt in tilts:
        side = unit(np.cross(directions[-1], rng.normal(size=3)))
        directions.append(rng.choice([-1, 1]) * unit(directions[-1] + tilt * side))
    return points, np.array(directions)


def unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


def worst_error(tilts, rng: np.random.Generator) -> float:
    """The largest error of the end effector's pose at random joint positions."""
    points, z = tilted_axes(tilts, rng)
    end = pin.SE3(pin.exp3(rng.normal(size=3)), rng.uniform(-0.5, 0.5, 3)).homogeneous
    if rng.integers(3) == 0:  # along the last axis
        x = unit(np.cross(z[-1], rng.normal(size=3)))
        end[:3, :3] = np.column_stack([x, np.cross(z[-1], x), z[-1]])
    chain = assign_frames(points, z, None, end, np.zeros(len(points)))
    states = [np.zeros(len(points)), *rng.uniform(-3, 3, (4, len(points)))]
    found = [chain.forward_kinematics(q) for q in states]
    expected = [product_of_exponentials(points, z, end, q) for q in states]
    return float(np.abs(np.subtract(found, expected)).max())


def test_tilts_next_to_the_tolerance() -> None:
    """The error is small if some tilts are just above the tolerance and some below."""
    rng = np.random.default_rng(52)
    for _ in range(100):
        tilts = 1.5e-8 * np.array([1.2, 0.7, 1.9, 0.4])[rng.permutation(4)]
        assert worst_error(tilts, rng) < 2e-7


@pytest.mark.slow
@pytest.mark.parametrize("first", [0.0, *10.0 ** np.arange(-12, -5.5, 0.5)])
def test_axes_that_are_nearly_parallel_move_the_tool_as_they_were_drawn(
    first: float,
) -> None:
    """The error is small for up to six axes with tilts of 1e-12 to 1e-6 rad."""
    rng = np.random.default_rng(51)
    for _ in range(60):
        others = 10 ** rng.uniform(-12, -6, rng.integers(0, 5)) * rng.integers(0, 2)
        tilts = rng.permutation([first, *others])
        assert worst_error(tilts, rng) < 1e-7


def test_alpha5_axes_from_its_urdf_give_table_1() -> None:
    chain = DHChain.from_urdf(a5.URDF_PATH, "tcp")
    table = DHChain.alpha5()
    for ours, printed in zip(chain.links, table.links, strict=True):
        assert (ours.d, ours.a) == pytest.approx((printed.d, printed.a), abs=TIGHT)
        for a, b in ((ours.offset, printed.offset), (ours.alpha, printed.alpha)):
            assert math.remainder(a - b, 2 * math.pi) == pytest.approx(0, abs=TIGHT)
        assert (ours.lower, ours.upper) == (printed.lower, printed.upper)
    assert np.abs(chain.base - np.eye(4)).max() == 0
    assert np.abs(chain.tool - table.tool).max() < TIGHT
    assert chain.joint_names == table.joint_names


def test_without_a_name_the_last_frame_of_the_last_joint_is_meant() -> None:
    q = [0.3, 0.2, 0.1, 0.4]
    tips = {
        frame: DHChain.from_urdf(a5.URDF_PATH, frame).forward_kinematics(q)
        for frame in (None, "tcp", "link_4")
    }
    assert np.array_equal(tips[None], tips["tcp"])
    assert np.abs(tips["link_4"] - tips["tcp"]).max() > 0.1


@pytest.mark.parametrize(
    ("robot", "frame", "d", "a", "alpha"),
    [
        # Universal Robots: "DH parameters for calculations of kinematics and dynamics".
        (
            "ur5",
            "tool0",
            [0.089159, 0, 0, 0.10915, 0.09465, 0.0823],
            [0, 0.425, 0.39225, 0, 0, 0],
            [QUARTER, 0, 0, QUARTER, QUARTER, 0],
        ),
        # Franka Control Interface documentation; a and alpha are shifted by one row,
        # which makes its modified convention the standard one.
        (
            "panda",
            "panda_link8",
            [0.333, 0, 0.316, 0, 0.384, 0, 0.107],
            [0, 0, 0.0825, 0.0825, 0, 0.088, 0],
            [QUARTER, QUARTER, QUARTER, QUARTER, QUARTER, QUARTER, 0],
        ),
    ],
)
def test_real_arms_from_their_urdf(robot: str, frame: str, d, a, alpha) -> None:
    """Manufacturers' tables up to the signs that the direction of x_j leaves free."""
    from example_robot_data import load

    model = load(robot).model
    chain = DHChain.from_pinocchio(model, frame)
    assert [abs(x.d) for x in chain.links] == pytest.approx(np.abs(d), abs=1e-5)
    assert [abs(x.a) for x in chain.links] == pytest.approx(np.abs(a), abs=1e-5)
    assert [abs(x.alpha) for x in chain.links] == pytest.approx(np.abs(alpha), abs=1e-5)
    data = model.createData()
    rng = np.random.default_rng(51)
    tip = model.getFrameId(frame)
    for q in rng.uniform(-2, 2, (30, chain.n)):
        full = np.zeros(model.nq)
        full[: chain.n] = q
        pin.framesForwardKinematics(model, data, full)
        pose = data.oMf[tip].homogeneous
        assert np.abs(pose - chain.forward_kinematics(q)).max() < 1e-12


def test_joints_that_have_no_dh_row_are_refused() -> None:
    model = pin.buildModelFromUrdf(a5.URDF_PATH, pin.JointModelFreeFlyer())
    with pytest.raises(InputError, match="revolute or prismatic"):
        DHChain.from_pinocchio(model, "tcp")
    screw = pin.Model()
    screw.addJoint(0, pin.JointModelHZ(0.1), pin.SE3.Identity(), "screw")
    screw.addBodyFrame("nut", 1, pin.SE3.Identity(), 0)
    with pytest.raises(InputError, match="screw"):
        DHChain.from_pinocchio(screw)
    fixed = pin.buildModelFromUrdf(a5.URDF_PATH)
    with pytest.raises(InputError, match="a joint moves"):
        DHChain.from_pinocchio(fixed, "base_link")
    with pytest.raises(UnknownNameError, match="tcp"):
        DHChain.from_pinocchio(fixed, "nose")


@each(
    ("arguments", "words"),
    [
        (([], []), "shape"),
        ((np.zeros((0, 3)), np.zeros((0, 3))), "N at least 1"),
        (([[0, 0, 0]], [[0, 0, 0]]), "not zero"),
        (([[0, 0, 0]], [[0, 0, 1], [0, 0, 1]]), r"\(N, 3\)"),
        (([0, 0, 0], [0, 0, 1]), r"\(N, 3\)"),
        (([[0, 0, math.nan]], [[0, 0, 1]]), "finite"),
        (([[0, 0, 0]], [[0, 0, 1]], [0, 1]), "sigma"),
        (([[0, 0, 0]], [[0, 0, 1]], [3]), "sigma"),
        (([[0, 0, 0]], [[0, 0, 1]], None, np.zeros((4, 4))), "rigid"),
        (([[0, 0, 0]], [[0, 0, 1]], None, None, [1, 2]), "q"),
        (([[0, 0, 0]], [[0, 0, 1]], None, None, None, [(1, 0)]), "lower <= upper"),
    ],
)
def test_bad_axes(arguments, words) -> None:
    with pytest.raises(Alpha5Error, match=words):
        assign_frames(*arguments)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("points", {"points": np.full((3, 3), 1e300)}),
        ("end_effector", {"end_effector": np.eye(4) + 1e300 * np.eye(4, k=3)}),
        ("sigma", {"sigma": np.eye(3), "q": np.zeros(3)}),
        ("sigma", {"sigma": [0, 2, 0], "q": np.zeros(3)}),
    ],
)
def test_what_cannot_be_computed_with_is_named(name: str, wrong: dict) -> None:
    given = {"points": np.zeros((3, 3)), "directions": np.eye(3), **wrong}
    with pytest.raises(InputError, match=f"^{name}"):
        assign_frames(**given)


@pytest.mark.parametrize("direction", [[0.0, 0.6, 0.8], [1.0, 0.0, 0.0]])
def test_a_single_joint_turns_about_its_axis(direction: list[float]) -> None:
    from scipy.spatial.transform import Rotation

    point = np.array([0.1, -0.2, 0.3])
    chain = DHChain.from_axes([point], [direction])
    poses = chain.forward_kinematics(np.array([[0.0], [0.7]]))
    turned = poses[1] @ np.linalg.inv(poses[0])
    expected = Rotation.from_rotvec(0.7 * np.array(direction)).as_matrix()
    np.testing.assert_allclose(turned[:3, :3], expected, atol=1e-12)
    np.testing.assert_allclose(turned[:3, :3] @ point + turned[:3, 3], point, atol=1e-9)


def test_directions_of_any_length() -> None:
    points = [[0.0, 0, 0], [1, 0, 0]]
    for scale in (1e-300, 1.0, 1e300):
        chain = a5.dh.DHChain.from_axes(points, [[0, 0, scale], [0, 0, scale]])
        assert chain.links[0].a == pytest.approx(1.0)
