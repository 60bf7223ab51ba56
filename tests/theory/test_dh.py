"""DH chains agree with the printed matrix, the literature, a toolbox and Pinocchio."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st
from literature import PUMA_560, STANFORD
from loops import each

import alpha5_model as a5
from alpha5_model.errors import (
    Alpha5Error,
    FileFormatError,
    InputError,
    MissingFileError,
    NonFiniteError,
    ShapeError,
    UnknownNameError,
)
from alpha5_model.theory.dh import DHChain, DHLink, dh_transform

QUARTER = math.pi / 2
ANGLE = st.floats(-7, 7)
LENGTH = st.floats(-3, 3)

# Tables as printed: [theta, d, a, alpha, sigma].
COBRA_600 = [  # Adept Cobra 600, a SCARA (mdl_cobra600)
    [0, 0.387, 0.325, 0, 0],
    [0, 0, 0.275, math.pi, 0],
    [0, 0, 0, 0, 1],
    [0, 0, 0, 0, 0],
]
TABLES = {"puma": PUMA_560, "stanford": STANFORD, "cobra": COBRA_600}


def elementary(theta: float, d: float, a: float, alpha: float) -> np.ndarray:
    """T_Rz(theta) T_z(d) T_x(a) T_Rx(alpha), one factor at a time."""
    rz, tz, tx, rx = (np.eye(4) for _ in range(4))
    rz[:2, :2] = [
        [math.cos(theta), -math.sin(theta)],
        [math.sin(theta), math.cos(theta)],
    ]
    tz[2, 3] = d
    tx[0, 3] = a
    rx[1:3, 1:3] = [
        [math.cos(alpha), -math.sin(alpha)],
        [math.sin(alpha), math.cos(alpha)],
    ]
    return rz @ tz @ tx @ rx


def printed(theta: float, d: float, a: float, alpha: float) -> np.ndarray:
    """The matrix as the notes print it."""
    ct = math.cos(theta)
    st_ = math.sin(theta)
    ca = math.cos(alpha)
    sa = math.sin(alpha)
    return np.array(
        [
            [ct, -st_ * ca, st_ * sa, a * ct],
            [st_, ct * ca, -ct * sa, a * st_],
            [0, sa, ca, d],
            [0, 0, 0, 1],
        ]
    )


def product(table: list[list[float]], q: np.ndarray) -> np.ndarray:
    out = np.eye(4)
    for (theta, d, a, alpha, sigma), x in zip(table, q, strict=True):
        out = out @ (
            elementary(theta, x, a, alpha) if sigma else elementary(x, d, a, alpha)
        )
    return out


@given(theta=ANGLE, d=LENGTH, a=LENGTH, alpha=ANGLE)
def test_transform_is_the_product_of_the_four_elementary_ones(
    theta, d, a, alpha
) -> None:
    transform = dh_transform(theta, d, a, alpha)
    assert np.abs(transform - elementary(theta, d, a, alpha)).max() < 1e-14
    assert np.abs(transform[:3, :3] @ transform[:3, :3].T - np.eye(3)).max() < 1e-14
    assert np.linalg.det(transform[:3, :3]) == pytest.approx(1)


def test_the_sign_of_the_second_row_is_the_rotation_not_the_scan() -> None:
    """The transcribed matrix has +cos(theta) sin(alpha), which makes it no rotation."""
    values = (0.7, 0.1, 0.2, 1.1)
    assert np.abs(dh_transform(*values) - printed(*values)).max() < 1e-15
    scanned = printed(*values)
    scanned[1, 2] *= -1
    assert np.abs(scanned[:3, :3] @ scanned[:3, :3].T - np.eye(3)).max() > 0.1


@given(
    theta=ANGLE,
    d=LENGTH,
    a=LENGTH,
    alpha=ANGLE,
    offset=ANGLE,
    q=ANGLE,
    sigma=st.sampled_from([0, 1]),
)
def test_the_variable_is_theta_or_d(theta, d, a, alpha, offset, q, sigma) -> None:
    link = DHLink(theta, d, a, alpha, sigma, offset)
    wanted = (theta, q + offset, a, alpha) if sigma else (q + offset, d, a, alpha)
    assert np.abs(link.transform(q) - elementary(*wanted)).max() < 1e-14
    assert link.home == (d if sigma else theta)


def test_link_of_the_notes() -> None:
    link = DHLink.from_vector([0, 0.1, 0.2, math.pi / 2, 0])
    assert (link.theta, link.d, link.a, link.alpha, link.sigma) == (
        0,
        0.1,
        0.2,
        math.pi / 2,
        0,
    )
    difference = link.transform(0.3) - printed(0.3, 0.1, 0.2, math.pi / 2)
    assert np.abs(difference).max() < 1e-15
    assert DHLink.from_vector([0, 0.1, 0.2, 1.0]) == DHLink(0, 0.1, 0.2, 1.0)
    assert DHLink.from_vector([0, 0.1, 0.2, 1.0, 1, 0.5]) == DHLink(
        0, 0.1, 0.2, 1.0, 1, 0.5
    )


def test_shapes_broadcast() -> None:
    theta = np.linspace(0, 1, 5)
    d = np.zeros((3, 1))
    assert dh_transform(theta, d, 0.1, 0.2).shape == (3, 5, 4, 4)
    chain = DHChain.from_table(PUMA_560)
    q = np.random.default_rng(1).normal(size=(2, 3, 6))
    assert chain.frames(q).shape == (2, 3, 8, 4, 4)
    assert chain.forward_kinematics(q).shape == (2, 3, 4, 4)
    assert chain.jacobian(q).shape == (2, 3, 6, 6)
    points, directions = chain.joint_axes(q)
    assert points.shape == directions.shape == (2, 3, 6, 3)
    one = chain.jacobian(q[1, 2])
    assert np.array_equal(one, chain.jacobian(q)[1, 2])
    assert chain.forward_kinematics(np.zeros((0, 6))).shape == (0, 4, 4)


@pytest.mark.parametrize("name", TABLES)
def test_chains_against_products_typed_from_the_tables(name: str) -> None:
    chain = DHChain.from_table(TABLES[name])
    for q in np.random.default_rng(2).uniform(-3, 3, (50, chain.n)):
        difference = chain.forward_kinematics(q) - product(TABLES[name], q)
        assert np.abs(difference).max() < 1e-14


def test_puma_at_zero_is_where_the_book_prints_it() -> None:
    # Corke 2011, section 7.3.1: p560.fkine(qz).
    tip = DHChain.from_table(PUMA_560).forward_kinematics(np.zeros(6))
    assert tip[:3, 3] == pytest.approx([0.4521, -0.15, 0.4318], abs=1e-4)
    assert np.abs(tip[:3, :3] - np.eye(3)).max() < 1e-15


@pytest.mark.parametrize(
    ("name", "model"),
    [("puma", "Puma560"), ("stanford", "Stanford"), ("cobra", "Cobra600")],
)
def test_against_roboticstoolbox(name: str, model: str) -> None:
    reason = "roboticstoolbox-python is not installed"
    toolbox = pytest.importorskip("roboticstoolbox", reason=reason)
    peer = getattr(toolbox.models.DH, model)()
    links = tuple(
        DHLink(
            theta=float(x.theta),
            d=float(x.d),
            a=float(x.a),
            alpha=float(x.alpha),
            sigma=int(x.sigma),
            offset=float(x.offset),
        )
        for x in peer.links
    )
    chain = DHChain(links, base=peer.base.A, tool=peer.tool.A)
    for row, link in zip(TABLES[name], links, strict=True):
        ours = DHLink.from_vector(row)
        # d may differ: the toolbox's Puma has a pedestal and its own shoulder offset.
        assert (ours.a, ours.sigma) == pytest.approx((link.a, link.sigma), abs=1e-4)
        twist = math.remainder(ours.alpha - link.alpha, 2 * math.pi)
        assert twist == pytest.approx(0, abs=1e-9)
    for q in np.random.default_rng(3).uniform(-3, 3, (30, chain.n)):
        assert np.abs(chain.forward_kinematics(q) - peer.fkine(q).A).max() < 1e-12
        assert np.abs(chain.jacobian(q) - peer.jacob0(q)).max() < 1e-12
        for link, theirs, x in zip(links, peer.links, q, strict=True):
            assert np.abs(link.transform(x) - theirs.A(x).A).max() < 1e-12


@pytest.mark.parametrize("name", [*TABLES, "alpha5"])
def test_jacobian_is_the_derivative(name: str) -> None:
    chain = DHChain.alpha5() if name == "alpha5" else DHChain.from_table(TABLES[name])
    q = np.random.default_rng(4).uniform(-2, 2, chain.n)
    h = 1e-6
    for frame in (0, 2, chain.n, "tool"):
        jacobian = chain.jacobian(q, frame)
        pose = chain.forward_kinematics(q, frame)
        for j in range(chain.n):
            e = h * np.eye(chain.n)[j]
            rate = chain.forward_kinematics(q + e, frame) - chain.forward_kinematics(
                q - e, frame
            )
            spin = (rate / (2 * h))[:3, :3] @ pose[:3, :3].T
            assert np.abs(rate[:3, 3] / (2 * h) - jacobian[:3, j]).max() < 1e-9
            difference = [spin[2, 1], spin[0, 2], spin[1, 0]] - jacobian[3:, j]
            assert np.abs(difference).max() < 1e-9


def test_joint_axes_stay_where_their_joint_moves() -> None:
    """The axis of joint j stays fixed if joint j or a joint after it moves."""
    chain = DHChain.from_table(STANFORD)
    q = np.random.default_rng(5).uniform(-1, 1, 6)
    points, directions = chain.joint_axes(q)
    for j in range(6):
        moved = q.copy()
        moved[j:] += 0.7
        other_points, other_directions = chain.joint_axes(moved)
        assert np.abs(other_points[j] - points[j]).max() < 1e-15
        assert np.abs(other_directions[j] - directions[j]).max() < 1e-15
        before = chain.forward_kinematics(q, j + 1)
        after = chain.forward_kinematics(q + 0.7 * np.eye(6)[j], j + 1)
        step = after @ np.linalg.inv(before)
        if chain.sigma[j]:
            assert np.abs(step[:3, 3] - 0.7 * directions[j]).max() < 1e-14
        else:
            turned_direction = step[:3, :3] @ directions[j]
            turned_point = step[:3, :3] @ points[j] + step[:3, 3]
            assert np.abs(turned_direction - directions[j]).max() < 1e-14
            assert np.abs(turned_point - points[j]).max() < 1e-14


def test_alpha5_is_table_1() -> None:
    """The chain is Table 1, in mm; its last row is fixed and becomes the tool."""
    theta_c = math.atan2(40, 145.3)
    a_1 = math.hypot(40, 145.3)
    rows = [
        (math.pi, 46.2, 20, QUARTER),
        (theta_c - QUARTER, 0, a_1, math.pi),
        (theta_c - QUARTER, 0, 20, -QUARTER),
        (QUARTER, -180, 0, QUARTER),
        (-QUARTER, 0, 0, 0),
    ]
    chain = DHChain.alpha5()
    assert chain.n == 4
    assert chain.joint_names == ("axis_e", "axis_d", "axis_c", "axis_b")
    for q in np.random.default_rng(6).uniform(-3, 3, (50, 4)):
        pose = np.eye(4)
        for (theta, d, a, alpha), x in zip(rows, (*q, 0.0), strict=True):
            pose = pose @ elementary(theta + x, d / 1e3, a / 1e3, alpha)
        assert np.abs(chain.forward_kinematics(q) - pose).max() < 1e-15
    assert chain.home.tolist() == [0.0, 0.0, 0.0, 0.0]
    joints = a5.parameters().joints[:4]
    assert chain.lower.tolist() == [j.lower for j in joints]
    assert chain.upper.tolist() == [j.upper for j in joints]


def test_alpha5_is_the_generated_urdf() -> None:
    model = pin.buildModelFromUrdf(a5.URDF_PATH)
    data = model.createData()
    chain = DHChain.alpha5()
    tcp = model.getFrameId("tcp")
    for q in np.random.default_rng(7).uniform(-3, 3, (50, 4)):
        pin.framesForwardKinematics(model, data, q)
        difference = data.oMf[tcp].homogeneous - chain.forward_kinematics(q)
        assert np.abs(difference).max() < 1e-12
        theirs = pin.computeFrameJacobian(model, data, q, tcp, pin.LOCAL_WORLD_ALIGNED)
        assert np.abs(theirs - chain.jacobian(q)).max() < 1e-12
        # URDF joint j turns about z of the DH frame {j-1}, displaced along it.
        points, directions = chain.joint_axes(q)
        for j in range(4):
            placement = data.oMi[j + 1]
            assert np.abs(placement.rotation[:, 2] - directions[j]).max() < 1e-12
            off = np.cross(placement.translation - points[j], directions[j])
            assert np.abs(off).max() < 1e-12


@each(
    ("call", "error", "words"),
    [
        (lambda: DHLink(0, 0, 0, 0, 2), InputError, "sigma"),
        (lambda: DHLink(0, 0, 0, 0, True), InputError, "sigma"),
        (lambda: DHLink(0, 0, 0, 0, 0.5), InputError, "sigma"),
        (lambda: DHLink(0, 0, math.nan, 0), NonFiniteError, "a:"),
        (lambda: DHLink(0, math.inf, 0, 0), NonFiniteError, "d:"),
        (lambda: DHLink(0, "x", 0, 0), InputError, "d:"),
        (lambda: DHLink(0, 0, 0, 0, lower=1, upper=0), InputError, "lower <= upper"),
        (lambda: DHLink(0, 0, 0, 0, lower=math.nan), NonFiniteError, "lower"),
        (lambda: DHLink(0, 0, 0, 0, lower=math.inf), InputError, "lower <= upper"),
        (
            lambda: DHLink.from_vector([0, 0, 0]),
            InputError,
            "theta, d, a, alpha, sigma",
        ),
        (lambda: DHLink.from_vector(3.0), InputError, "vector"),
        (lambda: DHLink.from_vector([[0, 0, 0, 0, 0]]), InputError, "vector"),
        (lambda: DHChain(()), InputError, "at least one"),
        (lambda: DHChain(None), InputError, "at least one"),
        (lambda: DHChain(([0, 0, 0, 0],)), InputError, "DHLink"),
        (lambda: DHChain((DHLink(0, 0, 0, 0),), base=np.eye(3)), ShapeError, "base"),
        (
            lambda: DHChain((DHLink(0, 0, 0, 0),), tool=2 * np.eye(4)),
            InputError,
            "rigid",
        ),
        (
            lambda: DHChain((DHLink(0, 0, 0, 0),), tool=np.diag([1, 1, -1, 1.0])),
            InputError,
            "rigid",
        ),
        (
            lambda: DHChain((DHLink(0, 0, 0, 0),), joint_names=("a", "b")),
            InputError,
            "1 different",
        ),
        (lambda: DHChain.alpha5().frames([0, 0, 0]), ShapeError, "q"),
        (
            lambda: DHChain.alpha5().frames([0, 0, math.nan, 0]),
            NonFiniteError,
            r"q\[2\]",
        ),
        (
            lambda: DHChain.alpha5().forward_kinematics([0] * 4, 5),
            UnknownNameError,
            "tool",
        ),
        (lambda: DHChain.alpha5().jacobian([0] * 4, "tcp"), UnknownNameError, "tool"),
        (lambda: DHChain.alpha5().jacobian([0] * 4, -1), UnknownNameError, "tool"),
        (lambda: dh_transform([1, 2], [1, 2, 3], 0, 0), InputError, "broadcast"),
        (lambda: DHChain.from_urdf("no/such.urdf"), MissingFileError, "such.urdf"),
    ],
)
def test_bad_input(call, error, words) -> None:
    with pytest.raises(error, match=words) as caught:
        call()
    assert isinstance(caught.value, Alpha5Error)
    assert "\n" not in str(caught.value)


def test_a_chain_cannot_be_changed() -> None:
    chain = DHChain.alpha5()
    with pytest.raises(ValueError, match="read-only"):
        chain.tool[0, 0] = 2.0
    mine = np.eye(4)
    DHChain((DHLink(0, 0, 0, 0),), base=mine)
    mine[0, 3] = 1.0  # the caller's array stays the caller's
    assert a5.dh.DHChain is DHChain


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_a_joint_without_limits_is_named_and_nothing_printed(
    kind: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="r"><link name="a"/><link name="b"/>'
        f'<joint name="j" type="{kind}"><parent link="a"/><child link="b"/>'
        '<axis xyz="0 0 1"/></joint></robot>'
    )
    with pytest.raises(FileFormatError, match=f"the {kind} joint j has no <limit>"):
        DHChain.from_urdf(file)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("ends", ["", 'lower="0" upper="0"', 'lower="1" upper="-1"'])
def test_a_range_without_width_is_none(ends: str, tmp_path: Path) -> None:
    """URDF's limits are 0 if they are not written."""
    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="r"><link name="a"/><link name="b"/><joint name="j" '
        f'type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>'
        f'<limit {ends} effort="1" velocity="1"/></joint></robot>'
    )
    (link,) = DHChain.from_urdf(file).links
    assert (link.lower, link.upper) == (-math.inf, math.inf)


def test_a_urdf_may_have_100_joints_that_move_and_1000_links(tmp_path: Path) -> None:
    def written(links: int, moving: int) -> Path:
        parts = ['<link name="l0"/>']
        for k in range(1, links):
            kind = "continuous" if k <= moving else "fixed"
            parts.append(
                f'<link name="l{k}"/><joint name="j{k}" type="{kind}">'
                f'<parent link="l{max(k - 1, 0) if k <= moving else moving}"/>'
                f'<child link="l{k}"/><axis xyz="0 0 1"/></joint>'
            )
        file = tmp_path / "arm.urdf"
        file.write_text(f'<robot name="r">{"".join(parts)}</robot>')
        return file

    assert DHChain.from_urdf(written(1000, 3), "l3").n == 3
    with pytest.raises(FileFormatError, match="at most 1000 links, got 1001"):
        DHChain.from_urdf(written(1001, 3), "l3")
    assert DHChain.from_urdf(written(101, 100), "l2").n == 2
    with pytest.raises(FileFormatError, match="at most 100 joints that move, got 101"):
        DHChain.from_urdf(written(102, 101), "l2")


@each("frame", ["tooth", "Tool", "", "tcp", 5, -1, True, 1.0])
def test_a_frame_is_a_number_or_the_tool(frame: object) -> None:
    chain = DHChain.alpha5()
    known = "unknown frame .*; choose from 0, 1, 2, 3, 4, tool"
    with pytest.raises(UnknownNameError, match=known):
        chain.jacobian(chain.home, frame)  # type: ignore[arg-type]
    assert chain.jacobian(chain.home, "tool").shape == (6, 4)
