"""The record of an arm of your own: what `dataclasses.replace` accepts, and refuses."""

from __future__ import annotations

import copy
import dataclasses
import math
import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.errors import ImplausibleWarning, InputError, UnknownNameError
from alpha5_model.numbers.covariance import Covariance
from alpha5_model.numbers.jaws import FingerJoint, loaded_links, split_link_4
from alpha5_model.numbers.motors import Motors, joint_losses
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    DHParameters,
    JawParameters,
    JointParameters,
    LinkParameters,
    Measurement,
    is_catalogue,
)
from alpha5_model.numbers.pose import Pose
from alpha5_model.numbers.rigid_body import AttachedBody

ARM = a5.parameters()
BOX = np.diag([2e-5, 3e-5, 4e-5])


def attached(**changes: Any) -> AttachedBody:
    values: dict[str, Any] = {
        "name": "sensor",
        "mass": 0.12,
        "com": np.array([0.001, 0.002, -0.003]),
        "inertia": BOX,
        "volume": 4.5e-5,
        "cob": np.array([0.0, 0.001, 0.002]),
        "link": "link_4",
        "position": np.array([0.01, -0.02, -0.075]),
        "rotation": rotation_from_rpy((0.3, -0.4, 1.1)),
    }
    return AttachedBody(**{**values, **changes})


def with_body(**changes: Any) -> Alpha5Parameters:
    return dataclasses.replace(ARM, attached=(attached(**changes),))


def with_row(i: int, **changes: Any) -> Alpha5Parameters:
    rows = list(ARM.dh)
    rows[i] = dataclasses.replace(rows[i], **changes)
    return dataclasses.replace(ARM, dh=tuple(rows))


def with_joint(i: int, **changes: Any) -> Alpha5Parameters:
    joints = list(ARM.joints)
    joints[i] = dataclasses.replace(joints[i], **changes)
    return dataclasses.replace(ARM, joints=tuple(joints))


def mounted(**changes: Any) -> Alpha5Parameters:
    """The catalogue's arm on a mount."""
    pose = {"position": np.zeros(3), "rotation": np.eye(3), "parent": "rov"}
    return dataclasses.replace(ARM, mount=Pose(**{**pose, **changes}))


def tool(*position: float) -> Pose:
    return Pose(position=np.array(position), rotation=np.eye(3))


#: What is made -> what the error names.
REFUSED = {
    "a_0 of the other sign": (lambda: with_row(0, a=-0.02), "lengths.a_0"),
    "d_3 of the other sign": (lambda: with_row(3, d=0.18), "lengths.d_3"),
    "no length": (lambda: with_row(2, a=0.0), "lengths.a_2"),
    "a twist": (lambda: with_row(1, alpha=math.pi + 0.01), "dh[1].alpha"),
    "a twisted wrist": (lambda: with_row(3, alpha=1.56), "dh[3].alpha"),
    "a full turn both ways": (
        lambda: with_joint(3, lower=-3.2, upper=3.2),
        "axis_b.range",
    ),
    "a full turn": (lambda: with_joint(3, lower=0.0, upper=math.tau), "axis_b.range"),
    "a lower end that is too high": (lambda: with_joint(1, lower=4.0), "axis_d.range"),
    "an upper end that is too low": (lambda: with_joint(0, upper=0.0), "axis_e.range"),
    "a negative speed": (lambda: with_joint(0, velocity=-0.1), "axis_e.velocity"),
    "no effort": (lambda: with_joint(0, effort=0.0), "axis_e.effort"),
    "no acceleration": (lambda: with_joint(0, acceleration=0.0), "axis_e.acceleration"),
    "a negative jerk": (lambda: with_joint(0, jerk=-1.0), "axis_e.jerk"),
    "no sign": (lambda: with_joint(3, sign=0), "axis_b.sign"),
    "a sign that is a truth value": (lambda: with_joint(3, sign=True), "axis_b.sign"),
    "a mount on a link of its own": (
        lambda: dataclasses.replace(ARM, mount=Pose(np.zeros(3), np.eye(3), "tcp")),
        "mount.parent",
    ),
    "a COM far outside": (
        lambda: dataclasses.replace(ARM.links[2], com=[0.73, -0.34, 0.0]),
        "links.link_2.com",
    ),
    "a negative mass": (
        lambda: dataclasses.replace(ARM.links[2], mass=-1.0),
        "links.link_2.mass",
    ),
    "a tool far away": (
        lambda: dataclasses.replace(ARM, tool=tool(0, 0, -0.481)),
        "tool.position",
    ),
    "a tool that a spacer should have moved": (
        lambda: dataclasses.replace(with_body(spacer=0.02), tool=tool(0, 0, -0.18)),
        "tool.position",
    ),
    "a tool that a shorter spacer has moved": (
        lambda: dataclasses.replace(
            with_body(spacer=0.02), attached=(attached(spacer=0.03),)
        ),
        "tool.position",
    ),
    "a name twice": (
        lambda: dataclasses.replace(ARM, attached=(attached(), attached())),
        "attached[1].name",
    ),
    "the name of a link": (lambda: with_body(name="link_3"), "attached[0].name"),
    "a name with a space": (lambda: with_body(name="my sensor"), "attached.name"),
    "a spacer on link_3": (
        lambda: with_body(link="link_3", spacer=0.02),
        "attached.sensor.spacer",
    ),
    "a negative spacer": (lambda: with_body(spacer=-0.02), "attached.sensor.spacer"),
    "no rotation": (
        lambda: with_body(rotation=np.ones((3, 3))),
        "attached.sensor.rotation",
    ),
    "an impossible body": (
        lambda: with_body(inertia=np.diag([1e-5, 1e-5, 4e-5])),
        "attached.sensor.inertia",
    ),
    "not a body": (lambda: dataclasses.replace(ARM, attached=(1,)), "attached"),
    "not a mount": (lambda: dataclasses.replace(ARM, mount="world"), "mount"),
    "not motors": (lambda: dataclasses.replace(ARM, motors=None), "motors"),
    "not a name": (lambda: dataclasses.replace(ARM, name="<a>"), "name"),
    "a mount without a name": (lambda: mounted(parent=""), "mount.parent"),
    "a turned mount": (lambda: mounted(rotation=-np.eye(3)), "rotation"),
    "three rotors": (lambda: Motors(rotor_inertias=(1e-7,) * 3), "rotor_inertias"),
    "six rotors": (lambda: Motors(rotor_inertias=(1e-7,) * 6), "rotor_inertias"),
    "no supply": (lambda: Motors(supply_voltage=0.0), "supply_voltage"),
    "no current": (lambda: Motors(current_limits=(0.0,) * 5), "current_limits[0]"),
    "a negative width": (
        lambda: Measurement(key="links.link_2.mass", half_width=-1e-3),
        "links.link_2.mass.half_width",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_no_arm_can_have_is_refused(case: str) -> None:
    make, name = REFUSED[case]
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.name == name


def test_unknown_names_are_refused() -> None:
    for make in (
        lambda: with_body(link="link_5"),
        lambda: Motors(constants="both"),
        lambda: dataclasses.replace(ARM, corrections=("none",)),
    ):
        with pytest.raises(UnknownNameError):
            make()


def test_what_is_just_possible_is_accepted() -> None:
    with_joint(3, lower=0.0, upper=math.nextafter(math.tau, 0.0))
    dataclasses.replace(ARM, tool=tool(0.0, 0.3, -0.18))
    edge = ARM.links[2].bounds[:, 1]
    dataclasses.replace(ARM.links[2], com=edge)
    with_body(inertia=np.zeros((3, 3)))
    # A weightless float.
    with_body(mass=0.0, inertia=np.zeros((3, 3)))
    none = (0.0,) * 5
    Motors(rotor_inertias=none, backward_frictions=none, viscous_frictions=none)


def records_of(value: Any) -> Iterator[Any]:
    """A record and all records inside it."""
    if isinstance(value, tuple):
        for item in value:
            yield from records_of(item)
    elif dataclasses.is_dataclass(value):
        yield value
        for field in dataclasses.fields(value):
            yield from records_of(getattr(value, field.name))


def test_a_record_equals_itself_only() -> None:
    """As the arm that it is part of, by which caches remember what they computed."""
    own = dataclasses.replace(
        with_body(),
        tool=tool(0.0, 0.0, -0.2),
        mount=Pose(parent="rov", position=np.zeros(3), rotation=np.eye(3)),
        covariance=Covariance(
            names=("zeros.axis_d",), deviation=[0.01], factor=[[0.6]]
        ),
    )
    jaws = split_link_4(own)
    found = [*records_of(own), jaws, *records_of((jaws.bodies, jaws.joints))]
    kinds = {type(record) for record in found}
    assert {DHParameters, JointParameters, FingerJoint, JawParameters} <= kinds
    for record in found:
        again = dataclasses.replace(record)
        assert record == record
        assert again != record
        assert len({record, again}) == 2


def test_a_copy_of_the_catalogue_is_the_catalogue() -> None:
    """Processes send pickled records; a record that differs anywhere is another arm."""
    for names in ((), ("base_frame",), ("base_frame", "link3_cob")):
        record = a5.parameters(names)
        copies = [
            record,
            pickle.loads(pickle.dumps(record)),
            copy.deepcopy(record),
            dataclasses.replace(record),
        ]
        packed = [pickle.dumps(record) for record in copies]
        assert all(map(is_catalogue, copies))
        assert [pickle.dumps(record) for record in copies] == packed
        assert is_catalogue(pickle.loads(pickle.dumps(copies[1])))
    measured = (Measurement(key="links.link_2.mass", half_width=0.001),)
    others = [
        dataclasses.replace(ARM, name="mine"),
        dataclasses.replace(ARM, measurements=measured),
        dataclasses.replace(ARM, corrections=()),
        dataclasses.replace(ARM, links=(*ARM.links[:4], changed(ARM.links[4]))),
        mounted(),
        with_joint(0, sign=-1),
        with_joint(0, jerk=1.0),
    ]
    assert not any(map(is_catalogue, others))


def changed(link: LinkParameters) -> LinkParameters:
    """With a mass that differs in its last bit."""
    return dataclasses.replace(link, mass=math.nextafter(link.mass, 1.0))


def test_the_urdf_of_a_copy_is_the_catalogues() -> None:
    from alpha5_model.description.urdf import Variant, urdf

    copied = pickle.loads(pickle.dumps(ARM))
    assert urdf(Variant(arm=copied)) == urdf(Variant())


@pytest.mark.parametrize("jaw", [None, 0.005])
@pytest.mark.parametrize("spacer", [0.0, 0.022])
def test_the_tool_at_the_tip_is_the_frame_of_the_tip(
    spacer: float, jaw: float | None
) -> None:
    own = with_body(spacer=spacer)
    at_tip = dataclasses.replace(own, tool=a5.tool_at_tip(own, jaw=jaw))
    q = np.array([2.9, 1.1, 1.7, 2.0])
    with_jaws = np.append(q, own.joints[4].lower if jaw is None else jaw)
    tip = a5.load(gripper="jaws", arm=own).forward_kinematics(with_jaws, frame="tip")
    found = a5.load(arm=at_tip).forward_kinematics(q)
    assert found.translation == pytest.approx(tip.translation, abs=1e-14)
    solved = a5.inverse_kinematics(tip.translation, q[3], arm=at_tip)
    assert np.abs(solved.q - q).max(axis=-1).min() < 1e-9


def test_what_the_motors_add_to_the_joints() -> None:
    """Reflected by the gear: rotors and damping by its square, friction once."""
    assert joint_losses(ARM) == {}
    rows = list(ARM.actuators)
    rows[1] = dataclasses.replace(rows[1], friction=2e-3)
    rows[2] = dataclasses.replace(rows[2], friction=5e-3)
    motors = Motors(
        rotor_inertias=(1e-6, None, None, None, 1e-6),
        viscous_frictions=(None, 2e-6, None, None, 2e-6),
        backward_frictions=(None, None, 3e-3, None, 3e-3),
    )
    own = dataclasses.replace(ARM, actuators=tuple(rows), motors=motors)
    gear = 1754.4
    found = joint_losses(own)
    assert [*found] == ["axis_e", "axis_d", "axis_c"]
    assert found["axis_e"] == pytest.approx((1e-6 * gear**2, 0.0, 0.0), rel=1e-12)
    assert found["axis_d"] == pytest.approx(
        (0.0, 2e-3 * gear, 2e-6 * gear**2), rel=1e-12
    )
    # Friction that differs by direction counts with its mean.
    assert found["axis_c"] == pytest.approx((0.0, 4e-3 * gear, 0.0), rel=1e-12)
    backward = Motors(backward_frictions=(None, None, None, 1e-3, None))
    wrist = joint_losses(dataclasses.replace(ARM, motors=backward))
    mean = (0.469e-3 + 1e-3) / 2
    assert wrist == {"axis_b": pytest.approx((0.0, mean * 340.4, 0.0), rel=1e-12)}


def test_a_spacer_moves_the_tool() -> None:
    own = with_body(spacer=0.022)
    assert own.tool is not None
    assert own.tool.position == pytest.approx([0.0, 0.0, -0.202], abs=1e-15)
    # Columns: the tcp's axes. Table 1's frame {5} has z along -y of link_4.
    assert own.tool.rotation.tolist() == [[0, 1, 0], [0, 0, -1], [-1, 0, 0]]
    # Another change keeps it, and the orientation may be of its own.
    again = dataclasses.replace(own, name="lab")
    assert again.tool is own.tool
    without = dataclasses.replace(own, attached=(), tool=None)
    assert without.tool is None
    longer = (attached(spacer=0.03),)
    moved = dataclasses.replace(own, attached=longer, tool=None)
    assert moved.tool is not None
    assert moved.tool.position == pytest.approx([0.0, 0.0, -0.21], abs=1e-15)
    turned = Pose(position=own.tool.position, rotation=np.eye(3))
    dataclasses.replace(own, tool=turned)


def moments(body: Any, pose: np.ndarray) -> np.ndarray:
    """Integrals of 1, r and r r^T dm in another frame, and of 1 and r dV."""
    rotation = pose[:3, :3]
    spread = np.trace(body.inertia) / 2 * np.eye(3) - body.inertia
    com = rotation @ body.com + pose[:3, 3]
    cob = rotation @ body.cob + pose[:3, 3]
    second = rotation @ spread @ rotation.T + body.mass * np.outer(com, com)
    parts = [body.mass, *(body.mass * com), *second.ravel()]
    return np.array([*parts, body.volume, *(body.volume * cob)])


def pose_of(rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[:3, 3] = position
    return pose


@pytest.mark.parametrize(("link", "spacer"), [(0, 0.0), (2, 0.0), (4, 0.0), (4, 0.022)])
def test_a_loaded_link_has_the_moments_of_its_parts(link: int, spacer: float) -> None:
    own = with_body(link=f"link_{link}", spacer=spacer)
    (body,) = own.attached
    expected = moments(ARM.links[link], np.eye(4))
    expected += moments(body, pose_of(body.rotation, body.position))
    for jaw in split_link_4(ARM).bodies[1:] if spacer else ():
        closed = pose_of(rotation_from_rpy((jaw.roll, 0, 0)), jaw.origin)
        further = closed.copy()
        further[2, 3] -= spacer
        expected += moments(jaw, further) - moments(jaw, closed)

    found = loaded_links(own)
    assert moments(found[link], np.eye(4)) == pytest.approx(expected, abs=1e-16)
    for i in {*range(5)} - {link}:
        assert found[i] is ARM.links[i]


@pytest.mark.parametrize("spacer", [0.0, 0.022])
def test_the_jaws_of_a_loaded_link_add_up_to_it(spacer: float) -> None:
    own = with_body(spacer=spacer)
    jaws = split_link_4(own)
    total = np.sum([moments(body, np.eye(4)) for body in jaws.closed], axis=0)
    whole = moments(loaded_links(own)[4], np.eye(4))
    assert total == pytest.approx(whole, abs=1e-16)
    for body, printed in zip(
        jaws.bodies[1:], split_link_4(ARM).bodies[1:], strict=True
    ):
        shift = body.origin - printed.origin
        assert shift == pytest.approx([0, 0, -spacer], abs=1e-16)


def test_a_link_4_without_room_for_the_jaws_is_named() -> None:
    """It is a possible body, but not with rod and fingers inside."""
    slender = dataclasses.replace(ARM.links[4], inertia=np.diag([3e-4, 3e-4, 2e-4]))
    own = dataclasses.replace(ARM, links=(*ARM.links[:4], slender))
    with pytest.raises(InputError) as caught:
        split_link_4(own)
    assert caught.value.name == "links.link_4"


def test_the_jaw_rod_is_a_solid_cylinder() -> None:
    """Summed over points, which fill it evenly."""
    jaws = ARM.jaws
    even = (np.arange(60) + 0.5) / 60
    radius = jaws.rod_diameter / 2 * np.sqrt(even)
    turn = 2 * np.pi * even
    height = jaws.rod_length * (even - 0.5)
    r, a, z = (grid.ravel() for grid in np.meshgrid(radius, turn, height))
    points = np.column_stack([r * np.cos(a), r * np.sin(a), z])
    volume = math.pi * (jaws.rod_diameter / 2) ** 2 * jaws.rod_length
    mass = jaws.rod_density * volume
    squares = points.T @ points / len(points)
    inertia = mass * (np.trace(squares) * np.eye(3) - squares)

    rod = split_link_4(ARM).rod
    assert rod.mass == pytest.approx(mass, rel=1e-12)
    assert rod.inertia == pytest.approx(inertia, rel=1e-3, abs=1e-14)


@pytest.mark.parametrize("number", [1, 2])
def test_a_finger_is_a_solid_box_beside_the_wrist_axis(number: int) -> None:
    """Summed over points, which fill it evenly; closed, it hangs below its hinge."""
    side = -1.0 if number == 1 else 1.0
    jaws = ARM.jaws
    volume = jaws.finger_volume if number == 1 else jaws.second_finger_volume
    even = (np.arange(80) + 0.5) / 80 - 0.5
    size = [
        volume / (jaws.finger_length * jaws.finger_width),
        jaws.finger_length,
        jaws.finger_width,
    ]
    grid = np.meshgrid(*(length * even for length in size))
    points = np.column_stack([axis.ravel() for axis in grid])
    squares = points.T @ points / len(points)
    mass = jaws.finger_density * volume
    inertia = mass * (np.trace(squares) * np.eye(3) - squares)

    split = split_link_4(ARM)
    finger = getattr(split, f"finger_{number}")
    assert (finger.mass, finger.volume) == pytest.approx((mass, volume), rel=1e-12)
    assert finger.inertia == pytest.approx(inertia, rel=1e-3, abs=1e-14)
    assert finger.cob.tolist() == finger.com.tolist()
    hinge = jaws.collar_base + jaws.pivot_height
    assert finger.origin.tolist() == [side * jaws.pivot_offset, 0.0, -hinge]
    closed = next(body for body in split.closed if body.name == f"finger_{number}")
    below = hinge + jaws.finger_length / 2
    half_way = side * jaws.pivot_offset / 2
    assert closed.com == pytest.approx([half_way, 0.0, -below], abs=1e-16)


def test_the_rod_turns_the_fingers() -> None:
    """From closed to open, with the power that the rod has."""
    split = split_link_4(ARM)
    rod, *fingers = split.joints
    assert rod is ARM.joints[4]
    for finger in fingers:
        assert finger.multiplier * rod.lower + finger.offset == pytest.approx(
            finger.lower, abs=1e-15
        )
        assert finger.multiplier * rod.upper + finger.offset == pytest.approx(
            finger.upper, abs=1e-15
        )
        power = rod.effort * rod.velocity
        assert finger.effort * finger.velocity == pytest.approx(power, rel=1e-15)
        assert finger.velocity == finger.multiplier * rod.velocity
        assert finger.lower == 0.0
    assert split.rod.com.tolist() == split.rod.cob.tolist() == [0.0, 0.0, 0.0]
    height = ARM.jaws.collar_base + rod.lower
    assert split.rod.origin.tolist() == [0.0, 0.0, -height]
    assert split.wrist.origin.tolist() == [0.0, 0.0, 0.0]


def test_a_com_beside_the_body_is_warned_of() -> None:
    """The bounds are the printed body's, and yours may be another one."""
    with pytest.warns(ImplausibleWarning, match=r"links\.link_2\.com"):
        link = dataclasses.replace(ARM.links[2], com=[0.073, -0.034, 0.0])
    assert link.com.tolist() == [0.073, -0.034, 0.0]
