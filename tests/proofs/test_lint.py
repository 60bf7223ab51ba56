"""What programs refuse in a URDF, or read differently: each claim is run.

One small robot, changed in one place for each finding. The programs that are named in
the finding's text read the file here.
"""

from __future__ import annotations

import itertools
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
import pytest
from lazily import Lazy

from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.numbers.parameters import parameters
from alpha5_model.proofs.comparison.lint import lint
from alpha5_model.proofs.comparison.result import Finding, finding_ids

mujoco = Lazy("mujoco")
yourdfpy = Lazy("yourdfpy")


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo writes its warnings into a file of the folder that it is called in."""
    monkeypatch.chdir(tmp_path)


LIMIT = '<limit lower="0" upper="1" velocity="1" effort="1"/>'
ORIGIN = '<origin xyz="0.1 0 0" rpy="0.1 0.2 0.3"/>'
QUATERNION = '<origin xyz="0.1 0 0" quat_xyzw="0.6 0 0 0.8"/>'
MOMENTS = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
INERTIAL = f'<inertial><mass value="1"/>{MOMENTS}</inertial>'
BALL = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
CAPSULE = BALL.replace("<sphere", '<capsule length="0.2"')
TWO_SHAPES = BALL.replace("</geo", '<box size="1 1 1"/></geo')
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def document(
    limit: str = LIMIT,
    kind: str = "revolute",
    origin: str = ORIGIN,
    body: str = INERTIAL,
    robot: str = 'name="small"',
    more: str = "",
) -> str:
    """A robot of one joint; every argument that is given replaces a part."""
    return (
        f'<robot {robot}><link name="base"/>\n<link name="arm">{body}</link>\n'
        f'<joint name="elbow" type="{kind}">{origin}<parent link="base"/>'
        f'<child link="arm"/><axis xyz="0 0 1"/>{limit}</joint>\n{more}</robot>'
    )


def limits(**written: str) -> str:
    """A ``<limit>`` like `LIMIT` with other attributes; None leaves one out."""
    values = {"lower": "0", "upper": "1", "velocity": "1", "effort": "1", **written}
    texts = [f'{name}="{text}"' for name, text in values.items() if text != "-"]
    return f"<limit {' '.join(texts)}/>"


def drawn(*meshes: str) -> str:
    parts = [INERTIAL]
    for mesh in meshes:
        parts.append(f"<visual><geometry><mesh {mesh}/></geometry></visual>")
    return "".join(parts)


def version(number: str) -> str:
    return f'name="small" version="{number}"'


class Case(NamedTuple):
    """A file with one thing that programs take differently.

    Attributes:
        id: The finding.
        text: The file.
        refused_by: The programs that do not load it.
    """

    id: str
    text: str
    refused_by: str = ""


CASES = (
    Case("no_name", document(robot=""), "urdfdom pinocchio yourdfpy"),
    Case("version", document(robot=version("1.3")), "urdfdom pinocchio"),
    Case("version", document(robot=version("1")), "urdfdom pinocchio"),
    Case("doubled", document(body=INERTIAL * 2), "mujoco"),
    Case("doubled", document(body=INERTIAL.replace(MOMENTS, MOMENTS * 2)), "mujoco"),
    Case("doubled", document(origin=ORIGIN * 2), "mujoco"),
    Case("doubled", document(limit=LIMIT * 2), "mujoco"),
    Case("doubled", document(limit=LIMIT + '<axis xyz="0 1 0"/>'), "mujoco"),
    Case("doubled", document(limit=LIMIT + '<parent link="base"/>'), "mujoco"),
    Case(
        "doubled",
        document(limit=LIMIT + '<dynamics damping="1"/><dynamics damping="2"/>'),
        "mujoco",
    ),
    Case(
        "doubled",
        document(body=INERTIAL + BALL.replace("<geo", ORIGIN * 2 + "<geo")),
        "mujoco",
    ),
    Case("shapes", document(body=INERTIAL + TWO_SHAPES)),
    Case("number", document(limits(upper="inf")), "urdfdom pinocchio"),
    Case("number", document(limits(upper="1 ")), "urdfdom pinocchio"),
    Case("number", document(limits(effort="inf")), "urdfdom pinocchio"),
    Case("number", document(body=INERTIAL.replace('"1"', '"1 "', 1))),
    Case("macro", document(more="<xacro:arm/>", robot=f'name="small" {XACRO}')),
    Case("expression", document(body=drawn('filename="$(find x)/a.stl"'))),
    Case("quaternion", document(origin=QUATERNION, robot=version("1.1"))),
    Case("quaternion", document(origin=QUATERNION, robot=version("1.2"))),
    Case("quaternion_1_0", document(origin=QUATERNION)),
    Case("quaternion_1_0", document(origin=QUATERNION, robot=version("1.0"))),
    Case(
        "capsule",
        document(body=INERTIAL + CAPSULE, robot=version("1.1")),
        "yourdfpy",
    ),
    Case("capsule_1_0", document(body=INERTIAL + CAPSULE), "yourdfpy"),
    Case("scale", document(body=drawn('filename="a.stl" scale="1000 1000 1000"'))),
    Case("scale", document(body=drawn('filename="a.stl" scale="0 0 0"'))),
    Case("scale_unread", document(body=drawn('filename="a.stl" scale="0.001"'))),
    Case("scale_unread", document(body=drawn('filename="a" scale="mm"')), "yourdfpy"),
    Case(
        "scale_missing",
        document(
            body=drawn(
                'filename="a.stl" scale="0.001 0.001 0.001"',
                'filename="b.STL"',
                'filename="c.obj"',
            )
        ),
    ),
    Case("mimic", document(LIMIT + '<mimic joint="other"/>')),
    Case("no_limit", document(""), "urdfdom pinocchio"),
    Case("no_limit", document("", "prismatic"), "urdfdom pinocchio"),
    Case("no_range", document(limits(lower="-"))),
    Case("no_range", document(limits(upper="-"))),
    Case("no_range", document(limits(lower="-", upper="-"), "prismatic")),
    Case(
        "no_range",
        document(limits(upper="-"), robot=version("1.2")),
        "urdfdom pinocchio",
    ),
    Case("reversed", document(limits(lower="2"))),
    Case(
        "reversed",
        document(limits(lower="2"), robot=version("1.2")),
        "urdfdom pinocchio",
    ),
    Case("equal", document(limits(upper="0"))),
    Case("equal", document(limits(lower="0.5", upper="0.5"), "prismatic")),
    Case("continuous", document(LIMIT, "continuous")),
    Case("no_velocity", document(limits(velocity="-")), "urdfdom pinocchio"),
    Case("no_velocity", document(limits(velocity="-"), "fixed"), "urdfdom pinocchio"),
    Case("no_effort", document(limits(effort="-")), "urdfdom pinocchio"),
    Case("negative", document(limits(velocity="-1")), "pinocchio"),
    Case("negative", document(limits(effort="-1")), "pinocchio"),
    Case(
        "negative",
        document(limits(effort="-1"), robot=version("1.2")),
        "urdfdom pinocchio",
    ),
    Case("velocity_zero", document(limits(velocity="0"))),
    Case("effort_zero", document(limits(effort="0"))),
    Case("no_dynamics", document(LIMIT + "<dynamics/>"), "urdfdom pinocchio"),
    Case(
        "negative_friction",
        document(LIMIT + '<dynamics friction="-1"/>'),
        "pinocchio",
    ),
    Case("negative_damping", document(LIMIT + '<dynamics damping="-1"/>')),
    Case(
        "impossible",
        document(body=INERTIAL.replace('izz="1"', 'izz="2.1"')),
        "mujoco",
    ),
    Case(
        "impossible",
        document(body=INERTIAL.replace('izz="1"', 'izz="-1"')),
        "mujoco",
    ),
    Case("no_mass", document(body=INERTIAL.replace('"1"', '"0"', 1)), "mujoco"),
    Case("negative_mass", document(body=INERTIAL.replace('"1"', '"-1"', 1)), "mujoco"),
    Case(
        "zero_moment",
        document(
            body=INERTIAL.replace(MOMENTS, MOMENTS.replace('izz="1"', 'izz="1e-16"'))
        ),
        "mujoco",
    ),
    Case("no_inertia", document(body=""), "mujoco"),
    Case("no_inertia", document(body=INERTIAL.replace('"1"', '"0"')), "mujoco"),
    Case(
        "no_inertia",
        document(body=INERTIAL.replace("1", "0").replace('"0"', '"1"', 1)),
        "mujoco",
    ),
)
#: The same robot, or one as good, in which nothing is wrong.
GOOD = (
    document(),
    document(robot=version("1.2")),
    document(limits(upper="1e16", lower="-1e16")),
    document(limits(lower="-", upper="-"), "continuous"),
    document("", "continuous"),
    document(limits(lower="0", upper="0"), "continuous"),
    document("", "fixed"),
    document(limits(velocity="-", effort="-"), robot=version("1.2")),
    document(LIMIT + '<dynamics damping="0" friction="9"/>'),
    document(body=drawn('filename="a.stl" scale="0.001 -0.001 0.001"')),
    document(
        body="",
        more=f'<link name="hand">{INERTIAL}</link><joint name="wrist" type="fixed">'
        '<parent link="arm"/><child link="hand"/></joint>',
    ),
)


def found(text: str) -> list[Finding]:
    return list(lint(parse_urdf(text), (), parameters()))


def name_of(case: Case) -> str:
    return case.id


@pytest.mark.parametrize("case", CASES, ids=name_of)
def test_one_thing_is_one_finding(case: Case) -> None:
    assert [one.id for one in found(case.text)] == [f"lint.{case.id}"]


def test_nothing_is_found_in_good_files() -> None:
    for text in GOOD:
        assert found(text) == []
    for gripper in ("locked", "jaws"):
        assert found(urdf(Variant(gripper=gripper, ros2_control=True))) == []


def test_every_finding_has_a_case() -> None:
    ids = {name.removeprefix("lint.") for name in finding_ids() if "lint." in name}
    assert ids == {case.id for case in CASES} | {"dynamics"}


def test_the_line_is_that_of_the_second_element() -> None:
    (again,) = found(document(body=f"{INERTIAL}\n\n{INERTIAL}"))
    assert "(line 4)" in again.text


# --- the arm's own joints


def edited(old: str, new: str) -> list[Finding]:
    """What is found in our own arm with another axis_d."""
    text = urdf(Variant(collision="none"))
    start = text.index('<joint name="axis_d"')
    end = text.index("</joint>", start)
    joint = text[start:end]
    assert old in joint
    robot = parse_urdf(text[:start] + joint.replace(old, new) + text[end:])
    joints = [robot.joints[f"axis_{letter}"] for letter in "edcb"]
    return list(lint(robot, joints, parameters()))


@pytest.mark.parametrize(
    ("old", "new", "name", "advice"),
    [
        ('velocity="0.5235987755982988"', "", "no_velocity", 'velocity="0.5235'),
        ('effort="9.0"', 'effort="0"', "effort_zero", 'effort="9.0"'),
        ('"revolute"', '"continuous"', "continuous", 'type="revolute"'),
        ("<axis", '<dynamics friction="6.6"/><axis', "dynamics", "no <dynamics>"),
        ("<axis", '<dynamics damping="5"/><axis', "dynamics", "no <dynamics>"),
    ],
)
def test_the_arms_joints_are_mended_by_the_advice(
    old: str, new: str, name: str, advice: str
) -> None:
    (one,) = edited(old, new)
    assert (one.id, one.where) == (f"lint.{name}", "axis_d")
    assert advice in one.instead


def test_measured_friction_is_plausible() -> None:
    """Viscous friction of real arms, fitted to a log of 2025: 2.4 N m s/rad at most."""
    assert edited("<axis", '<dynamics damping="2.4" friction="0.5"/><axis') == []


def test_a_revolute_mount_is_advised_as_fixed_where_it_stands() -> None:
    text = document(limits(lower="0.5", upper="0.5"))
    (one,) = found(text)
    (correction,) = one.corrections
    elements = correction.elements
    assert elements["joint"] == {"type": "fixed"}
    origin = elements["origin"] or {}
    fixed = document(
        "",
        "fixed",
        origin=f'<origin xyz="{origin["xyz"]}" rpy="{origin["rpy"]}"/>',
    )
    here, there = pin.buildModelFromXML(text), pin.buildModelFromXML(fixed)
    data = here.createData()
    pin.framesForwardKinematics(here, data, np.array([0.5]))
    placed = data.oMf[here.getFrameId("arm")]
    expected = there.frames[there.getFrameId("arm")].placement
    np.testing.assert_allclose(placed.homogeneous, expected.homogeneous, atol=1e-12)


# --- the programs


def urdfdom(path: Path) -> Any:
    program = Path(sys.executable).with_name("check_urdf")
    done = subprocess.run([program, path], capture_output=True, text=True, check=False)
    if "Successfully Parsed XML" not in done.stdout:
        raise ValueError(done.stderr)
    return done.stdout + done.stderr


READERS: dict[str, Callable[[Path], Any]] = {
    "urdfdom": urdfdom,
    "pinocchio": lambda path: pin.buildModelFromXML(path.read_text()),
    "mujoco": lambda path: mujoco.MjModel.from_xml_string(path.read_text()),
    "yourdfpy": lambda path: yourdfpy.URDF.load(str(path), load_meshes=False),
}


@pytest.mark.tools
@pytest.mark.parametrize("case", CASES, ids=name_of)
def test_the_programs_refuse_what_the_finding_says(case: Case, tmp_path: Path) -> None:
    path = tmp_path / "small.urdf"
    path.write_text(case.text)
    refused = []
    for name, read in READERS.items():
        try:
            read(path)
        except Exception:
            refused.append(name)
    assert refused == case.refused_by.split()
    words = " ".join(one.text for one in found(case.text)).lower()
    assert all(name in words for name in refused)


@pytest.mark.tools
def test_the_programs_take_good_files(tmp_path: Path) -> None:
    path = tmp_path / "small.urdf"
    for text in GOOD:
        path.write_text(text)
        for read in READERS.values():
            read(path)


def in_pinocchio(text: str) -> Any:
    return pin.buildModelFromXML(text)


def in_mujoco(text: str) -> Any:
    return mujoco.MjModel.from_xml_string(text)


@pytest.mark.tools
def test_limits_as_the_programs_read_them() -> None:
    for text in (
        document(limits(lower="2")),
        document(limits(upper="0")),
        document(limits(upper="-")),
        document(LIMIT, "continuous"),
        document(""),
    ):
        assert not in_mujoco(text).jnt_limited[0]
    assert in_mujoco(document()).jnt_limited[0]
    assert not in_mujoco(document(limits(effort="0"))).jnt_actfrclimited[0]

    turned = in_pinocchio(document(limits(lower="2")))
    assert turned.lowerPositionLimit[0] > turned.upperPositionLimit[0]
    assert in_pinocchio(document(limits(lower="-"))).lowerPositionLimit[0] == 0
    assert in_pinocchio(document(limits(upper="0"))).nq == 1
    assert in_pinocchio(document(LIMIT, "continuous")).nq == 2
    assert in_pinocchio(document(limits(velocity="0"))).velocityLimit[0] == 0
    assert in_pinocchio(document(limits(effort="0"))).upperEffortLimit[0] == 0


def agree(text: str, kind: str) -> bool:
    """Whether Pinocchio and MuJoCo read one joint with the same limits."""
    try:
        here, there = in_pinocchio(text), in_mujoco(text)
    except ValueError:
        return False
    if kind == "fixed":
        return bool(here.nv == there.nv == 0)
    moved = here.velocityLimit[0] > 0 and here.upperEffortLimit[0] > 0
    pushed = there.jnt_actfrcrange[0, 1] == here.upperEffortLimit[0]
    if here.upperEffortLimit[0] == np.inf:
        pushed = not there.jnt_actfrclimited[0]
    if kind == "continuous":
        return bool(moved and pushed and not there.jnt_limited[0])
    ends = [here.lowerPositionLimit[0], here.upperPositionLimit[0]]
    same = bool(there.jnt_limited[0]) and there.jnt_range[0].tolist() == ends
    return bool(moved and pushed and same)


@pytest.mark.tools
@pytest.mark.parametrize("kind", ["revolute", "prismatic", "continuous", "fixed"])
@pytest.mark.parametrize("number", ["1.0", "1.2"])
def test_any_limits_are_found_or_read_alike(kind: str, number: str) -> None:
    """Every combination of numbers that are there, and that are not."""
    seen = set()
    for ends in itertools.product(("-", "0", "1"), repeat=2):
        for ratings in itertools.product(("-", "-1", "0", "1"), repeat=2):
            names = ("lower", "upper", "velocity", "effort")
            limit = limits(**dict(zip(names, ends + ratings, strict=True)))
            text = document(limit, kind, robot=version(number))
            ids = {one.id for one in found(text)} - {"lint.continuous"}
            assert (ids == set()) is agree(text, kind), limit
            seen.add(frozenset(ids))
    assert len(seen) > 1


@pytest.mark.tools
def test_bodies_and_friction_as_the_programs_read_them() -> None:
    spaced = document(body=INERTIAL.replace('"1"', '"1 "', 1))
    assert in_pinocchio(spaced).inertias[1].mass == 0
    heavier = INERTIAL.replace('value="1"', 'value="2"')
    assert in_pinocchio(document(body=INERTIAL + heavier)).inertias[1].mass == 1

    rubbing = document(LIMIT + '<dynamics friction="6.6"/>')
    assert in_mujoco(rubbing).dof_frictionloss[0] == 6.6
    model = in_pinocchio(rubbing)
    moving = (np.zeros(1), np.ones(1), np.zeros(1))
    torque = pin.rnea(model, model.createData(), *moving)
    smooth = in_pinocchio(document())
    assert torque == pin.rnea(smooth, smooth.createData(), *moving)


@pytest.mark.tools
def test_limits_as_drake_reads_them() -> None:
    reason = "Drake is not installed"
    parsing = pytest.importorskip("pydrake.multibody.parsing", reason=reason)
    plants = pytest.importorskip("pydrake.multibody.plant", reason=reason)

    def in_drake(text: str) -> Any:
        plant = plants.MultibodyPlant(time_step=0.0)
        parsing.Parser(plant).AddModelsFromString(text, "urdf")
        plant.Finalize()
        return plant

    for limit in (limits(lower="2"), LIMIT + '<dynamics damping="-1"/>'):
        with pytest.raises((RuntimeError, SystemExit)):
            in_drake(document(limit))
    turning = in_drake(document(LIMIT, "continuous")).GetJointByName("elbow")
    assert turning.position_upper_limits().tolist() == [1.0]


@pytest.mark.tools
def test_two_shapes_as_the_programs_read_them() -> None:
    text = document(body=INERTIAL + TWO_SHAPES)
    shapes = pin.GeometryModel()
    model, kind = in_pinocchio(text), pin.GeometryType.COLLISION
    pin.buildGeomFromUrdfString(model, text, kind, shapes)
    (shape,) = shapes.geometryObjects
    assert type(shape.geometry).__name__ == "Sphere"
    assert in_mujoco(text).geom_type.tolist() == [mujoco.mjtGeom.mjGEOM_BOX]


@pytest.mark.tools
def test_elements_of_later_versions_as_the_programs_read_them(tmp_path: Path) -> None:
    for number, turned in (("1.0", False), ("1.1", True)):
        text = document(origin=QUATERNION, robot=version(number))
        placed = in_pinocchio(text).jointPlacements[1].rotation
        assert np.allclose(placed, np.eye(3)) is not turned
        assert in_mujoco(text).body_quat[-1].tolist() == [1, 0, 0, 0]
        path = tmp_path / "small.urdf"
        path.write_text(text)
        origin = READERS["yourdfpy"](path).robot.joints[0].origin
        assert np.allclose(origin[:3, :3], np.eye(3))

        shapes = pin.GeometryModel()
        text = document(body=INERTIAL + CAPSULE, robot=version(number))
        model = in_pinocchio(text)
        kind = pin.GeometryType.COLLISION
        pin.buildGeomFromUrdfString(model, text, kind, shapes)
        assert shapes.ngeoms == turned
        assert in_mujoco(text).ngeom == 1


@pytest.mark.tools
def test_a_mimic_of_nothing_as_the_programs_read_it() -> None:
    text = document(LIMIT + '<mimic joint="other"/>')
    with pytest.raises(ValueError, match="mimic"):
        pin.buildModelFromXML(text, mimic=True)
    model = in_mujoco(text)
    assert (model.nv, model.neq) == (1, 0)
