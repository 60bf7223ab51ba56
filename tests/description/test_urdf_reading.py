"""The URDF reader: all records of a hand-written file, each error with its line."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
import pytest

from alpha5_model.description.reading import parse_urdf, urdf_shapes
from alpha5_model.errors import FileFormatError

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
    <visual><geometry><mesh filename="seen.obj"/></geometry></visual>
    <collision><geometry><box size="0.1 0.2 0.5"/></geometry></collision>
    <collision><geometry><sphere radius="0.3"/></geometry></collision>
    <collision><geometry><cylinder radius="0.2" length="0.7"/></geometry></collision>
    <collision><geometry><capsule radius="0.1" length="0.4"/></geometry></collision>
    <collision><geometry><mesh filename="hit.stl"/></geometry></collision>
  </link>
  <joint name="wheel" type="continuous">
    <parent link="tray"/><child link="hub"/>
    <limit lower="-1" upper="1" velocity="9" effort="7"/>
  </joint>
  <link name="hub"/>
  <joint name="follower" type="revolute">
    <parent link="hub"/><child link="finger"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="1"/>
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
LINES = ROBOT.splitlines()


def line_of(text: str, source: str = ROBOT) -> int:
    return next(k for k, line in enumerate(source.splitlines(), 1) if text in line)


def test_links() -> None:
    robot = parse_urdf(ROBOT)
    assert (robot.name, robot.root) == ("hand-written", "root")
    assert list(robot.links) == ["root", "tray", "hub", "finger", "thumb"]
    bare, tray = robot.links["root"], robot.links["tray"]
    assert (bare.mass, bare.volume, bare.meshes, bare.files) == (None, 0.0, (), ())
    assert not bare.com.any()
    assert not bare.inertia.any()
    assert tray.mass == 2.5
    np.testing.assert_allclose(tray.com, [1, 2, 3], rtol=0, atol=0)
    # A quarter turn about z: x of the inertial frame is y of the link, y is -x.
    np.testing.assert_allclose(
        tray.inertia,
        [[2, -0.1, -0.3], [-0.1, 1, 0.2], [-0.3, 0.2, 3]],
        rtol=0,
        atol=1e-15,
    )
    box, sphere = 0.1 * 0.2 * 0.5, 4 / 3 * math.pi * 0.3**3
    cylinder, capsule = (
        math.pi * 0.2**2 * 0.7,
        math.pi * 0.1**2 * 0.4 + 4 / 3 * math.pi * 0.1**3,
    )
    assert tray.volume == pytest.approx(box + sphere + cylinder + capsule, rel=1e-15)
    assert tray.meshes == ("hit.stl",)
    assert tray.files == ("seen.obj", "hit.stl")


def test_joints() -> None:
    joints = parse_urdf(ROBOT).joints
    assert list(joints) == ["slide", "wheel", "follower", "copy"]
    slide, wheel, follower, copy = joints.values()
    assert (slide.kind, slide.parent, slide.child) == ("prismatic", "root", "tray")
    assert (slide.lower, slide.upper, slide.velocity, slide.effort) == (
        -0.25,
        0.5,
        0.75,
        80.0,
    )
    np.testing.assert_allclose(slide.axis, [0, 0.6, -0.8], rtol=0, atol=1e-16)
    cr, sr, cp, sp, cy, sy = (
        f(x) for x in (0.4, -0.5, 0.6) for f in (math.cos, math.sin)
    )
    written_out = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, 0.1],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, 0.2],
        [-sp, cp * sr, cp * cr, 0.3],
        [0, 0, 0, 1],
    ]
    np.testing.assert_allclose(slide.transform, written_out, rtol=0, atol=1e-15)
    # A continuous joint has no range, whatever is written; no axis is x.
    assert (wheel.lower, wheel.upper, wheel.velocity, wheel.effort) == (
        None,
        None,
        9.0,
        7.0,
    )
    assert wheel.axis.tolist() == [1, 0, 0]
    assert wheel.transform.tolist() == np.eye(4).tolist()
    assert (slide.mimic, slide.multiplier, slide.offset) == (None, 1.0, 0.0)
    assert (follower.mimic, follower.multiplier, follower.offset) == (
        "slide",
        -2.0,
        0.125,
    )
    assert (follower.velocity, follower.effort) == (None, None)
    assert (copy.mimic, copy.multiplier, copy.offset) == ("slide", 1.0, 0.0)
    assert (copy.lower, copy.upper) == (None, None)


def test_joints_come_from_the_root_outwards() -> None:
    """Whatever their order in the file."""
    body = "\n".join(LINES[2:-1])
    links = "".join(re.findall(r"<link name=\"\w+\"/>|<link .*?</link>", body, re.S))
    joints = re.findall(r"<joint .*?</joint>", body, re.S)
    backwards = f'<robot name="r">{links}{"".join(joints[::-1])}</robot>'
    order = list(parse_urdf(backwards).joints)
    assert order[:2] == ["slide", "wheel"]
    assert set(order[2:]) == {"follower", "copy"}


@dataclass(frozen=True)
class Mistake:
    """An edit of `ROBOT`, the text where the error must be, and the error's words."""

    old: str
    new: str
    place: str
    says: str


REFUSALS = (
    Mistake(
        old='<robot name="hand-written">',
        new='<robt name="x">',
        place="<robt",
        says="not XML: mismatched tag",
    ),
    Mistake(
        old="</robot>",
        new="</robot><x/>",
        place="</robot>",
        says="not XML: junk after document element",
    ),
    Mistake(
        old='<link name="hub"/>',
        new='<link nam="hub"/>',
        place='<link nam="hub"',
        says="<link> has no attribute 'name'",
    ),
    Mistake(
        old='<link name="hub"/>',
        new='<link name="tray"/>',
        place='<link name="tray"/>',
        says="link 'tray' is there twice",
    ),
    Mistake(
        old='<link name="thumb"/>',
        new="",
        place='name="copy"',
        says="joint 'copy': no link 'thumb'",
    ),
    Mistake(
        old='<parent link="root"/>',
        new='<parent link="rot"/>',
        place='name="slide"',
        says="joint 'slide': no link 'rot'",
    ),
    Mistake(
        old='name="copy"',
        new='name="wheel"',
        place='name="wheel" type="revolute"',
        says="joint 'wheel' is there twice",
    ),
    Mistake(
        old='<child link="thumb"/>',
        new='<child link="finger"/>',
        place='name="copy"',
        says="link 'finger' has two parents",
    ),
    Mistake(
        old='<child link="thumb"/>',
        new="",
        place='name="copy"',
        says="joint 'copy' has no <child>",
    ),
    Mistake(
        old='<parent link="root"/>',
        new="",
        place='name="slide"',
        says="joint 'slide' has no <parent>",
    ),
    Mistake(
        old='type="continuous"',
        new='type="rotary"',
        place='name="wheel"',
        says="joint 'wheel': unknown type 'rotary'",
    ),
    Mistake(
        old='xyz="0 3 -4"',
        new='xyz="0 0 0"',
        place="<axis xyz",
        says="joint 'slide': the axis has no direction",
    ),
    Mistake(
        old='xyz="0 3 -4"',
        new="",
        place="<axis",
        says="<axis> has no attribute 'xyz'",
    ),
    Mistake(
        old='xyz="0 3 -4"',
        new='xyz="0 3"',
        place="<axis",
        says="<axis xyz>: expected 3 finite numbers, got '0 3'",
    ),
    Mistake(
        old='<mass value="2.5"/>',
        new="",
        place="<inertial>",
        says="<inertial> needs <mass> and <inertia>",
    ),
    Mistake(
        old='value="2.5"',
        new='value="nan"',
        place="<mass",
        says="<mass value>: expected a finite number, got 'nan'",
    ),
    Mistake(old='value="2.5"', new='value="1e12"', place="<mass", says="got '1e12'"),
    Mistake(
        old='value="2.5"',
        new='value="-1e-100"',
        place="<mass",
        says="got '-1e-100'",
    ),
    Mistake(
        old='izz="3"',
        new=f'izz="{"3" * 40}"',
        place="<inertia ",
        says=f"got '{'3' * 37}...'",
    ),
    Mistake(
        old='izz="3"',
        new=f'izz="x{"3" * 38}"',
        place="<inertia ",
        says=f"got 'x{'3' * 38}'",
    ),
    Mistake(
        old='<sphere radius="0.3"/>',
        new="",
        place="<collision><geometry></geometry>",
        says="<collision> has no geometry",
    ),
    Mistake(old="<sphere ", new="<ball ", place="<ball", says="unknown shape <ball>"),
    Mistake(
        old='<mimic joint="slide"/>',
        new="<mimic/>",
        place="<mimic/>",
        says="<mimic> has no attribute 'joint'",
    ),
    Mistake(
        old='<child link="hub"/>',
        new='<child link="root"/>',
        place="<robot",
        says="the joints form a loop",
    ),
)


@pytest.mark.parametrize("mistake", REFUSALS, ids=lambda mistake: mistake.says)
def test_a_refusal_names_the_line(mistake: Mistake) -> None:
    assert ROBOT.count(mistake.old) >= 1
    text = ROBOT.replace(mistake.old, mistake.new, 1)
    message = re.escape(mistake.says)
    with pytest.raises(FileFormatError, match=message) as caught:
        parse_urdf(text, "some.urdf")
    if "mismatched" not in mistake.says:  # the parser finds that one at the end
        assert caught.value.place == f"line {line_of(mistake.place, text)}"
    assert str(caught.value).startswith("some.urdf, line ")


@pytest.mark.parametrize("value", ["0", "-0.0", "9.9e11", "-9.9e11", "1.1e-100", "5"])
def test_numbers_of_any_sane_size(value: str) -> None:
    tray = parse_urdf(ROBOT.replace('value="2.5"', f'value="{value}"')).links["tray"]
    assert tray.mass == float(value)


def test_several_roots_loops_and_none() -> None:
    lonely = "".join(f'<link name="l{k}"/>' for k in range(6))
    with pytest.raises(FileFormatError, match=r"found 6 root links: l0, l1, l2, l3$"):
        parse_urdf(f"<robot>{lonely}</robot>")
    with pytest.raises(FileFormatError, match=r"there is no <link>$"):
        parse_urdf('<robot name="x"/>')
    with pytest.raises(FileFormatError, match=r"expected <robot>, got <sdf>$"):
        parse_urdf('<sdf version="1.9"/>')

    def joint(name: str, parent: str, child: str) -> str:
        ends = f'<parent link="{parent}"/><child link="{child}"/>'
        return f'<joint name="{name}" type="fixed">{ends}</joint>'

    ring = joint("a", "l0", "l1") + joint("b", "l1", "l0")
    with pytest.raises(FileFormatError, match="no root link"):
        parse_urdf(f'<robot><link name="l0"/><link name="l1"/>{ring}</robot>')
    with pytest.raises(FileFormatError, match=r"the joints form a loop$"):
        parse_urdf(
            f'<robot><link name="r"/><link name="l0"/><link name="l1"/>{ring}</robot>'
        )


def test_a_primitive_too_large_has_no_volume() -> None:
    huge = ROBOT.replace('radius="0.3"', 'radius="9e11"')
    assert parse_urdf(huge).links["tray"].volume == pytest.approx(
        4 / 3 * math.pi * 9e11**3
    )


def test_shapes() -> None:
    plain = "<collision><geometry><sphere"
    ball = (
        '<collision><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/>'
        '<material name="red"><color rgba="1 0 0.5 0.25"/></material><geometry><sphere'
    )
    hit = urdf_shapes(ROBOT.replace(plain, ball), "collision")
    assert [(s.link, s.index) for s in hit] == [("tray", k) for k in range(5)]
    assert [s.kind for s in hit] == ["box", "sphere", "cylinder", "capsule", "mesh"]
    assert [s.size for s in hit] == [
        (0.1, 0.2, 0.5),
        (0.3,),
        (0.2, 0.7),
        (0.1, 0.4),
        (),
    ]
    assert [s.file for s in hit] == ["", "", "", "", "hit.stl"]
    assert [s.color for s in hit] == [(), (1.0, 0.0, 0.5, 0.25), (), (), ()]
    assert hit[0].placement.tolist() == np.eye(4).tolist()
    turned = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
    np.testing.assert_allclose(hit[1].placement, turned, atol=1e-15)
    (seen,) = urdf_shapes(ROBOT)
    assert (seen.link, seen.kind, seen.file) == ("tray", "mesh", "seen.obj")
    with pytest.raises(FileFormatError, match="<visual> has no geometry"):
        urdf_shapes(
            ROBOT.replace('<geometry><mesh filename="seen.obj"/></geometry>', "")
        )


@pytest.mark.parametrize(
    ("written", "multiplier", "offset"),
    [("", 1.0, 0.0), ('multiplier="2"', 2.0, 0.0), ('offset="-3"', 1.0, -3.0)],
)
def test_a_mimic_joint_follows_one_to_one_unless_told(
    written: str, multiplier: float, offset: float
) -> None:
    text = ROBOT.replace(
        "</robot>",
        '<link name="end"/><joint name="second" type="prismatic">'
        '<parent link="root"/><child link="end"/><limit velocity="1" effort="1"/>'
        f'<mimic joint="slide" {written}/></joint></robot>',
    )
    joint = parse_urdf(text).joints["second"]
    assert (joint.multiplier, joint.offset) == (multiplier, offset)
    assert joint.source == "slide"
