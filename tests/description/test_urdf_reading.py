"""The URDF reader: a hand-written file, mistakes by line, and Pinocchio as judge."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from lazily import Lazy

import alpha5_model as a5
from alpha5_model.description import reading
from alpha5_model.description.reading import parse_urdf, urdf_shapes
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.errors import FileFormatError

yourdfpy = Lazy("yourdfpy")

ROBOT = """<?xml version="1.0"?>
<robot name="hand-written">
  <link name="root"/>
  <joint name="slide" type="prismatic">
    <origin xyz="0.1 0.2 0.3" rpy="0.4 -0.5 0.6"/>
    <parent link="root"/><child link="tray"/>
    <axis xyz="0 3 -4"/>
    <limit lower="-0.25" upper="0.5" velocity="0.75" effort="80"/>
  </joint>
  <link name="tray">
    <inertial>
      <origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/>
      <mass value="2.5"/>
      <inertia ixx="1" iyy="2" izz="3" ixy="0.1" ixz="0.2" iyz="0.3"/>
    </inertial>
    <visual><geometry><mesh filename="seen.obj" scale="2 2 2"/></geometry></visual>
    <collision><geometry><box size="0.1 0.2 0.5"/></geometry></collision>
    <collision><geometry><sphere radius="0.3"/></geometry></collision>
    <collision><geometry><cylinder radius="0.2" length="0.7"/></geometry></collision>
    <collision><geometry><capsule radius="0.1" length="0.4"/></geometry></collision>
    <collision>
      <origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/>
      <geometry><mesh filename="hit.stl"/></geometry>
      <material name="red"><color rgba="1 0 0.5 0.25"/></material>
    </collision>
  </link>
  <joint name="wheel" type="continuous">
    <parent link="tray"/><child link="hub"/>
    <limit lower="-1" upper="1" velocity="9" effort="7"/>
    <dynamics damping="0.5"/>
  </joint>
  <link name="hub"/>
  <joint name="follower" type="revolute">
    <parent link="hub"/><child link="finger"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="1e16"/>
    <mimic joint="slide" multiplier="-2" offset="0.125"/>
  </joint>
  <link name="finger"/>
  <joint name="copy" type="revolute">
    <parent link="hub"/><child link="thumb"/>
    <mimic joint="slide"/>
  </joint>
  <link name="thumb"/>
</robot>
"""
QUARTER_TURN = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]


def test_links() -> None:
    robot = parse_urdf(ROBOT)
    assert (robot.name, robot.root, robot.version) == ("hand-written", "root", "")
    assert list(robot.links) == ["root", "tray", "hub", "finger", "thumb"]
    bare, tray = robot.links["root"], robot.links["tray"]
    assert (bare.mass, bare.volume, bare.meshes, bare.files) == (None, 0.0, (), ())
    assert tray.mass == 2.5
    assert tray.com.tolist() == [1, 2, 3]
    # A quarter turn about z: x of the inertial frame is y of the link, y is -x.
    turned = [[2, -0.1, -0.3], [-0.1, 1, 0.2], [-0.3, 0.2, 3]]
    np.testing.assert_allclose(tray.inertia, turned, rtol=0, atol=1e-15)

    box, sphere = 0.1 * 0.2 * 0.5, 4 / 3 * math.pi * 0.3**3
    cylinder = math.pi * 0.2**2 * 0.7
    capsule = math.pi * 0.1**2 * 0.4 + 4 / 3 * math.pi * 0.1**3
    assert tray.volume == pytest.approx(box + sphere + cylinder + capsule, rel=1e-15)
    assert (tray.meshes, tray.files) == (("hit.stl",), ("seen.obj", "hit.stl"))
    assert tray.scales == {"seen.obj": (2.0, 2.0, 2.0)}


def test_joints() -> None:
    slide, wheel, follower, copy = parse_urdf(ROBOT).joints.values()
    assert (slide.kind, slide.parent, slide.child) == ("prismatic", "root", "tray")
    limits = (slide.lower, slide.upper, slide.velocity, slide.effort)
    assert limits == (-0.25, 0.5, 0.75, 80.0)
    np.testing.assert_allclose(slide.axis, [0, 0.6, -0.8], rtol=0, atol=1e-16)
    assert (slide.source, slide.printed[1]) == ("slide", "0.4 -0.5 0.6")

    # A continuous joint has no range, whatever is written; no axis is x.
    assert (wheel.lower, wheel.upper, wheel.velocity) == (None, None, 9.0)
    assert (wheel.limit or {})["upper"] == "1"
    assert wheel.dynamics == {"damping": 0.5}
    assert wheel.axis.tolist() == [1, 0, 0]
    assert wheel.transform.tolist() == np.eye(4).tolist()

    assert (follower.lower, follower.upper, follower.velocity) == (0.0, None, None)
    led = (follower.source, follower.multiplier, follower.offset)
    assert led == ("slide", -2.0, 0.125)
    assert (copy.mimic, copy.multiplier, copy.offset) == ("slide", 1.0, 0.0)
    assert (copy.limit, copy.lower) == (None, None)


def test_shapes() -> None:
    hit = urdf_shapes(ROBOT, "collision")
    assert [(s.link, s.index) for s in hit] == [("tray", k) for k in range(5)]
    assert [s.kind for s in hit] == ["box", "sphere", "cylinder", "capsule", "mesh"]
    sizes = [(0.1, 0.2, 0.5), (0.3,), (0.2, 0.7), (0.1, 0.4), ()]
    assert [s.size for s in hit] == sizes
    assert (hit[4].file, hit[4].color) == ("hit.stl", (1.0, 0.0, 0.5, 0.25))
    np.testing.assert_allclose(hit[4].placement, QUARTER_TURN, atol=1e-15)
    (seen,) = urdf_shapes(ROBOT)
    assert (seen.link, seen.kind, seen.file) == ("tray", "mesh", "seen.obj")


def joint(name: str, parent: str, child: str) -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="fixed">{ends}</joint>'


def test_joints_come_from_the_root_outwards() -> None:
    """Whatever their order in the file."""
    links = "".join(f'<link name="{name}"/>' for name in "abcd")
    joints = joint("3", "c", "d") + joint("1", "a", "b") + joint("2", "b", "c")
    assert list(parse_urdf(f"<robot>{joints}{links}</robot>").joints) == [*"123"]


#: What is changed in the file, into what, and a text on the line of the error.
MISTAKES = (
    ("</robot>", "</robot><x/>", "</robot>"),
    ('<link name="hub"/>', '<link nam="hub"/>', '<link nam="hub"'),
    ('<link name="hub"/>', '<link name="tray"/>', '<link name="tray"/>'),
    ('<link name="hub"/>', '<link name="h&#10;b"/>', '<link name="h&#10;b"'),
    ('<link name="thumb"/>', "", 'name="copy"'),
    ('<parent link="root"/>', '<parent link="rot"/>', 'name="slide"'),
    ('name="copy"', 'name="wheel"', 'name="wheel" type="revolute"'),
    ('<child link="thumb"/>', '<child link="finger"/>', 'name="copy"'),
    ('<child link="thumb"/>', "", 'name="copy"'),
    ('<child link="hub"/>', '<child link="root"/>', "<robot"),
    ('type="continuous"', 'type="rotary"', 'name="wheel"'),
    ('xyz="0 3 -4"', 'xyz="0 0 0"', "<axis xyz"),
    ('xyz="0 3 -4"', "", "<axis"),
    ('xyz="0 3 -4"', 'xyz="0 3"', "<axis"),
    ('<mass value="2.5"/>', "", "<inertial>"),
    ('value="2.5"', 'value="nan"', "<mass"),
    ('value="2.5"', 'value="1_0"', "<mass"),
    ('value="2.5"', 'value="٣"', "<mass"),
    ('value="2.5"', 'value="${m}"', "<mass"),
    ('value="2.5"', 'value="1e12"', "<mass"),
    ('value="2.5"', 'value="-1e-100"', "<mass"),
    ('<sphere radius="0.3"/>', "", "<collision><geometry></geometry>"),
    ("<sphere ", "<ball ", "<ball"),
    ('<mimic joint="slide"/>', "<mimic/>", "<mimic/>"),
    ('damping="0.5"', 'damping="much"', "<dynamics"),
)


@pytest.mark.parametrize(("old", "new", "place"), MISTAKES)
def test_a_mistake_is_named_by_its_line(old: str, new: str, place: str) -> None:
    assert old in ROBOT
    text = ROBOT.replace(old, new, 1)
    lines = text.splitlines()
    number = next(k for k, line in enumerate(lines, 1) if place in line)
    with pytest.raises(FileFormatError) as caught:
        parse_urdf(text, "some.urdf")
    assert caught.value.place == f"line {number}"
    assert str(caught.value).startswith(f"some.urdf, line {number}: ")


@pytest.mark.parametrize(
    "text",
    [
        '<sdf version="1.9"/>',
        '<robot name="x"/>',
        '<robot><link name="a"/><link name="b"/></robot>',
        f'<robot><link name="a"/>{joint("j", "a", "a")}</robot>',
        '<robot><link name="r"/><link name="a"/><link name="b"/>'
        f"{joint('i', 'a', 'b')}{joint('j', 'b', 'a')}</robot>",
    ],
)
def test_what_is_no_tree_of_links_is_refused(text: str) -> None:
    with pytest.raises(FileFormatError):
        parse_urdf(text)


def test_the_largest_number_of_links(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MOST_LINKS", 5)
    assert len(parse_urdf(ROBOT).links) == 5
    monkeypatch.setattr(reading, "MOST_LINKS", 4)
    with pytest.raises(FileFormatError):
        parse_urdf(ROBOT)


# --- what comes around the XML

OWN = Path(a5.URDF_PATH).read_text("utf-8")


@pytest.mark.parametrize(
    "content",
    [
        f"\n \r\n\t{OWN}".encode(),
        OWN.encode("utf-8-sig"),
        b"\n\n" + OWN.encode("utf-8-sig"),
        OWN.encode("utf-16"),
        f"\n{OWN}\n\n".encode("utf-16"),
        OWN.replace("?>", ' encoding="latin-1"?>', 1).encode("latin-1"),
    ],
)
def test_blank_lines_and_byte_order_marks_are_read(
    content: bytes, tmp_path: Path
) -> None:
    path = tmp_path / "arm.urdf"
    path.write_bytes(content)
    ours = parse_urdf(Path(a5.URDF_PATH).read_bytes())
    assert list(parse_urdf(path.read_bytes()).joints) == list(ours.joints)


def test_lines_are_counted_from_the_first_of_the_file() -> None:
    wrong = ROBOT.replace('<link name="hub"/>', "<link/>")
    broken = ROBOT.replace('<link name="hub"/>', "<link>")
    here = ROBOT.splitlines().index('  <link name="hub"/>') + 1
    for blank in ("\n\n", "\r\n\r\n"):
        for text, line in ((wrong, here + 2), (broken, ROBOT.count("\n") + 2)):
            for content in (blank + text, (blank + text).encode()):
                with pytest.raises(FileFormatError) as caught:
                    parse_urdf(content)
                assert caught.value.place == f"line {line}"


@pytest.mark.parametrize(
    ("before", "tool"),
    [
        ("String value is: ", "ros2 param get"),
        ("data: '", "ros2 topic echo"),
        ("robot_description: |\n  ", "YAML"),
        ("/robot_state_publisher:\n  ros__parameters:\n    robot_description: '", ""),
        (f"response:\nGetParameters_Response(values=[{'x' * 300}string_value='", ""),
    ],
)
def test_the_answer_of_a_ros_tool_is_refused_as_that(before: str, tool: str) -> None:
    for text in (before + OWN, (before + OWN).encode()):
        with pytest.raises(FileFormatError, match=tool or "delete") as caught:
            parse_urdf(text)
        assert caught.value.place == "line 1"
        assert "--hide-type" in str(caught.value)


def test_other_text_before_the_xml_is_refused() -> None:
    for text in (f"# a comment\n{OWN}", f'"{OWN}"', f"\u2028{OWN}", f"{OWN}---\n"):
        with pytest.raises(FileFormatError, match="delete"):
            parse_urdf(text)


# --- URDF 1.1 and 1.2, and other readers


def turned(rng: np.random.Generator, how: str) -> str:
    """An origin with a random rotation: rpy, or a quaternion of any length."""
    xyz = " ".join(map(repr, rng.uniform(-1, 1, 3).tolist()))
    numbers = rng.normal(size=4 if how == "quat_xyzw" else 3)
    return f'<origin xyz="{xyz}" {how}="{" ".join(map(repr, numbers.tolist()))}"/>'


def random_robot(seed: int, version: str) -> str:
    """A chain of six joints, origins and inertials turned in either way."""
    rng = np.random.default_rng(seed)
    parts = [f'<robot name="r" version="{version}"><link name="l0"/>']
    for k in range(6):
        how = ["rpy", "quat_xyzw"]
        kind = ("revolute", "prismatic", "fixed")[k % 3]
        a, b, c = rng.uniform(1, 2, 3).tolist()
        axis = " ".join(map(repr, rng.normal(size=3).tolist()))
        parts.append(
            f'<link name="l{k + 1}"><inertial>{turned(rng, how[k // 3])}'
            f'<mass value="{a}"/><inertia ixx="{a}" iyy="{b}" izz="{c}" '
            f'ixy="0.1" ixz="-0.2" iyz="0.3"/></inertial></link>'
            f'<joint name="j{k}" type="{kind}">{turned(rng, how[k % 2])}'
            f'<parent link="l{k}"/><child link="l{k + 1}"/><axis xyz="{axis}"/>'
            f'<limit lower="-{a}" upper="{b}" velocity="{c}" effort="{a}" '
            'acceleration="3" jerk="4"/></joint>'
        )
    return "".join([*parts, "</robot>"])


def difference(text: str, robot: UrdfRobot) -> float:
    """Largest difference of frames and inertias from Pinocchio's reading of a text."""
    model = pin.buildModelFromXML(text)
    data = model.createData()
    q = np.random.default_rng(0).uniform(-1, 1, model.nq)
    pin.framesForwardKinematics(model, data, q)
    moving = iter(q)
    pose = np.eye(4)
    inertias = [pin.Inertia.Zero() for _ in model.inertias]
    worst = 0.0
    for joint in robot.joints.values():
        position = 0.0 if joint.kind == "fixed" else next(moving)
        pose = pose @ joint.transform @ joint.motion(position)
        frame = model.getFrameId(joint.child)
        worst = max(worst, np.abs(data.oMf[frame].homogeneous - pose).max())
        link = robot.links[joint.child]
        at = model.frames[frame]
        body = pin.Inertia(link.mass, link.com, link.inertia)
        inertias[at.parentJoint] += at.placement.act(body)
    for ours, theirs in zip(inertias[1:], list(model.inertias)[1:], strict=True):
        off = ours.toDynamicParameters() - theirs.toDynamicParameters()
        worst = max(worst, np.abs(off).max())
    return worst


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.2"])
def test_every_version_is_read_as_pinocchio_reads_it(version: str) -> None:
    for seed in range(5):
        text = random_robot(seed, version)
        assert difference(text, parse_urdf(text)) < 1e-12
    # Another version of the same text would be seen.
    other = text.replace(f'version="{version}"', 'version="1.0"')
    is_seen = difference(other, parse_urdf(text)) > 0.01
    assert bool(is_seen) == (version != "1.0")


def test_later_limits_count_since_1_2() -> None:
    for version, expected in (("1.1", (None, None, None)), ("1.2", (3, None, 4))):
        text = random_robot(0, version)
        model = pin.buildModelFromXML(text)
        for joint in parse_urdf(text).joints.values():
            found = (joint.acceleration, joint.deceleration, joint.jerk)
            assert found == expected
            if joint.kind != "fixed":
                v = model.joints[model.getJointId(joint.name)].idx_v
                assert joint.velocity == model.velocityLimit[v]
                assert joint.lower == model.lowerPositionLimit[v]


def test_quaternions_that_urdfdom_refuses_are_refused() -> None:
    origin = '<origin xyz="0.1 0.2 0.3" rpy="0.4 -0.5 0.6"/>'
    for version, attributes, is_read in (
        ("1.1", 'quat_xyzw="0 0 2 0"', True),
        ("1.1", 'rpy="0 0 0" quat_xyzw="0 0 0 1"', False),
        ("1.1", 'quat_xyzw="0 0 1"', False),
        ("1.0", 'rpy="0 0 0" quat_xyzw="0 0 1"', True),
    ):
        text = ROBOT.replace('name="hand', f'version="{version}" name="hand')
        text = text.replace(origin, f"<origin {attributes}/>")
        text = text.replace("<capsule ", "<cylinder ")
        text = text.replace(
            '<limit lower="0" upper="1e16"/>',
            '<limit lower="0" upper="1" velocity="1" effort="1"/>',
        ).replace('<mimic joint="slide"/>', '<limit velocity="1" effort="1"/>')
        for read in (parse_urdf, pin.buildModelFromXML):
            if is_read:
                read(text)
            else:
                with pytest.raises(ValueError):
                    read(text)
    # Pinocchio reads four zeros as no rotation; nobody can have meant that.
    with pytest.raises(FileFormatError):
        parse_urdf(text.replace('"1.0"', '"1.1"', 2).replace('"0 0 1"', '"0 0 0 0"'))


def test_yourdfpy_reads_the_same_of_our_arm() -> None:
    ours = parse_urdf(Path(a5.URDF_PATH).read_bytes())
    theirs = yourdfpy.URDF.load(a5.URDF_PATH, load_meshes=False).robot
    assert [link.name for link in theirs.links] == list(ours.links)
    for link in theirs.links:
        if link.inertial is not None:
            mine = ours.links[link.name]
            assert link.inertial.mass == mine.mass
            assert link.inertial.origin[:3, 3].tolist() == mine.com.tolist()
            assert link.inertial.inertia.tolist() == mine.inertia.tolist()
    for joint in theirs.joints:
        mine = ours.joints[joint.name]
        np.testing.assert_allclose(joint.origin, mine.transform, rtol=0, atol=1e-15)
        if joint.limit is not None:
            assert (joint.limit.lower, joint.limit.upper) == (mine.lower, mine.upper)
