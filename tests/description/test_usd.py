"""USD: what UsdPhysics parses of the file is the arm, by numbers of another source."""

from __future__ import annotations

import json
import math
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from lazily import Lazy
from own_arm_dynamics import RECORDS
from reference import LOWER, MASS, UPPER
from water_reference import Reference

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.usd import UsdOptions, usd_files
from alpha5_model.description.water_table import WaterOptions, water_files
from alpha5_model.errors import InputError, MissingDependencyError, UnknownNameError
from alpha5_model.numbers.parameters import Alpha5Parameters

Usd = Lazy("pxr.Usd", reason="OpenUSD is not installed")
UsdGeom = Lazy("pxr.UsdGeom", reason="OpenUSD is not installed")
UsdPhysics = Lazy("pxr.UsdPhysics", reason="OpenUSD is not installed")

#: Of numbers in single precision, as a share.
SINGLE = 2e-7
MEASURED = """
format = 1
name = "measured"
[mount]
parent = "rov"
xyz = [0.21, 0.0, -0.085]
rpy = [3.0, 0.1, 0.0]
[motors]
friction = {axis_d = 0.002}
friction_backward = {axis_d = 0.001}
viscous_friction = 1e-6
rotor_inertia = 2e-7
"""


@pytest.fixture(scope="module")
def measured(tmp_path_factory) -> Alpha5Parameters:
    """An arm file with measured motors and a mount."""
    file = tmp_path_factory.mktemp("arm") / "arm.toml"
    file.write_text(MEASURED, "utf-8")
    return a5.arm_file(file)


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Iterator[Any]:
    """Writes a variant once; returns its path."""
    pytest.importorskip("urdf_usd_converter", reason="the converter is not installed")
    folder = tmp_path_factory.mktemp("usd")
    written: dict[Any, str] = {}

    def write(gripper: str, arm: Alpha5Parameters | None = None) -> str:
        key = gripper, id(arm)
        if key not in written:
            file = folder / f"{len(written)}.usda"
            options = UsdOptions(gripper=gripper, arm=arm)
            file.write_bytes(usd_files(options)["alpha5.usda"])
            written[key] = str(file)
        return written[key]

    return write


def usd_model(file: str) -> pin.Model:
    """Pinocchio's model of what UsdPhysics parses of a file."""
    from conformance.usd_reading import usd_model

    return usd_model(file)


def matrix(model: pin.Model, data: pin.Data, q: np.ndarray) -> np.ndarray:
    upper = np.triu(pin.crba(model, data, q))
    return upper + np.triu(upper, 1).T


def test_the_parsed_articulation_is_table_2_in_its_frames(path, tmp_path):
    file = path("locked")
    heavier = tmp_path / "heavier.usda"
    text = Path(file).read_text("utf-8")
    printed = f"physics:mass = {MASS[2]}\n"
    assert text.count(printed) == 1
    heavier.write_text(text.replace(printed, "physics:mass = 0.39\n"))
    wrong = usd_model(str(heavier))
    model = usd_model(file)
    data, seen = model.createData(), wrong.createData()
    typed = Reference()
    assert tuple(model.names)[1:] == ("axis_e", "axis_d", "axis_c", "axis_b")
    rng = np.random.default_rng(29)
    for _ in range(20):
        q, v = rng.uniform(LOWER, UPPER), rng.uniform(-1.0, 1.0, 4)
        pin.framesForwardKinematics(model, data, q)
        tcp = data.oMf[model.getFrameId("tcp")].homogeneous
        np.testing.assert_allclose(tcp, typed.tcp(q), atol=3e-7)
        mass = typed.mass_matrix(q)
        np.testing.assert_allclose(matrix(model, data, q), mass, atol=SINGLE * 0.05)
        bias = pin.nonLinearEffects(model, data, q, v)
        np.testing.assert_allclose(bias, typed.bias(q, v), atol=5 * SINGLE)
        assert np.abs(matrix(wrong, seen, q) - mass).max() > 1e-5


@pytest.mark.parametrize("which", ["jaws", "measured", "random"])
def test_other_arms_are_those_of_their_urdf(which, path, measured):
    arm = {"jaws": None, "measured": measured, "random": RECORDS[9]}[which]
    gripper = "jaws" if which == "jaws" else "locked"
    model = usd_model(path(gripper, arm))
    reference = pin.buildModelFromXML(urdf(Variant(gripper=gripper, arm=arm)))
    data, expected = model.createData(), reference.createData()
    order = [reference.joints[reference.getJointId(n)].idx_v for n in model.names[1:]]
    assert model.nv == reference.nv
    rng = np.random.default_rng(30)
    for _ in range(5):
        q = rng.uniform(0.0, 0.01, model.nv)
        q[:4] = rng.uniform(LOWER, UPPER)
        there = np.empty(model.nv)
        there[order] = q
        mass = matrix(reference, expected, there)[np.ix_(order, order)]
        np.testing.assert_allclose(matrix(model, data, q), mass, atol=SINGLE * 0.1)
        weight = pin.computeGeneralizedGravity(reference, expected, there)[order]
        found = pin.computeGeneralizedGravity(model, data, q)
        np.testing.assert_allclose(found, weight, atol=5 * SINGLE)


def test_joints_have_limits_efforts_speeds_and_losses(path, measured):
    """From the URDF, whose angles are in rad; rotor inertia from the arm's file."""
    stage = Usd.Stage.Open(path("jaws", measured))
    joints = ET.fromstring(urdf(Variant(gripper="jaws", arm=measured))).findall("joint")
    names = ("axis_e", "axis_d", "axis_c", "axis_b")
    gears = dict(zip(names, measured.actuators[:4], strict=True))
    checked = 0
    for joint in joints:
        if joint.get("type") == "fixed":
            continue
        name = joint.get("name")
        prim = stage.GetPrimAtPath(f"/measured/Physics/{name}")
        turns = joint.get("type") == "revolute"
        unit = math.degrees(1.0) if turns else 1.0
        limit = {key: float(text) for key, text in joint.find("limit").attrib.items()}
        drive = UsdPhysics.DriveAPI(prim, "angular" if turns else "linear")
        found = {
            "lower": prim.GetAttribute("physics:lowerLimit").Get() / unit,
            "upper": prim.GetAttribute("physics:upperLimit").Get() / unit,
            "velocity": prim.GetAttribute("newton:velocityLimit").Get() / unit,
            "effort": drive.GetMaxForceAttr().Get(),
        }
        assert found == pytest.approx(limit, rel=SINGLE, abs=1e-9)
        physx = prim.GetAttribute("physxJoint:maxJointVelocity").Get() / unit
        assert physx == pytest.approx(limit["velocity"], rel=SINGLE)
        losses = joint.find("dynamics")
        if losses is None:
            assert name not in gears
            continue
        gear = gears[name].gear_ratio
        damping = prim.GetAttribute("newton:damping").Get() * unit
        friction = prim.GetAttribute("newton:friction").Get() or 0.0
        armature = prim.GetAttribute("newton:armature").Get()
        assert damping == pytest.approx(1e-6 * gear**2, rel=SINGLE)
        assert friction == pytest.approx(0.0015 * gear * (name == "axis_d"), rel=SINGLE)
        assert armature == pytest.approx(2e-7 * gear**2, rel=SINGLE)
        assert "PhysxJointAxisAPI:angular" in str(prim.GetMetadata("apiSchemas"))
        axis = {
            key: prim.GetAttribute(f"physxJointAxis:angular:{key}").Get()
            for key in (
                "armature",
                "maxJointVelocity",
                "staticFrictionEffort",
                "dynamicFrictionEffort",
                "viscousFrictionCoefficient",
            )
        }
        # Per degree, as PhysX reads them; its friction is a torque.
        assert axis == pytest.approx(
            {
                "armature": armature,
                "maxJointVelocity": math.degrees(limit["velocity"]),
                "staticFrictionEffort": friction,
                "dynamicFrictionEffort": friction,
                "viscousFrictionCoefficient": 1e-6 * gear**2 * math.pi / 180,
            },
            rel=SINGLE,
        )
        checked += 1
    assert checked == 4


def test_fingers_have_their_rule_and_no_other(path):
    """Newton's schema, which the converter writes, wants both joints of one type."""
    stage = Usd.Stage.Open(path("jaws"))
    for name in ("finger_1_joint", "finger_2_joint"):
        prim = stage.GetPrimAtPath(f"/alpha5/Physics/{name}")
        assert not [n for n in prim.GetPropertyNames() if "mimic" in n]
        assert "NewtonMimicAPI" not in str(prim.GetMetadata("apiSchemas"))
        (leader,) = prim.GetRelationship("alpha5:leader").GetTargets()
        rod = stage.GetPrimAtPath(leader)
        ends = []
        for limit in ("physics:lowerLimit", "physics:upperLimit"):
            factor = prim.GetAttribute("alpha5:multiplier").Get()
            offset = prim.GetAttribute("alpha5:offset").Get()
            ends.append(factor * rod.GetAttribute(limit).Get() + offset)
            own = np.radians(prim.GetAttribute(limit).Get())
            assert np.isclose(own, ends[-1], atol=1e-6)
        assert abs(ends[1] - ends[0]) > 0.5


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_collision_shapes_stand_where_the_urdfs_do(path, gripper):
    """Volume and centre of each, with all joints at zero, and the pairs of the SRDF."""
    stage = Usd.Stage.Open(path(gripper))
    cache = UsdGeom.XformCache()
    found = []
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.CollisionAPI):
            place = cache.GetLocalToWorldTransform(prim)
            found.append([_volume(prim), *place.ExtractTranslation()])

    file = a5.URDF_PATH if gripper == "locked" else a5.paths.JAWS_URDF_PATH
    model = pin.buildModelFromUrdf(file)
    shapes = pin.buildGeomFromUrdf(model, file, pin.COLLISION, package_dirs=["/"])
    data, placed = model.createData(), shapes.createData()
    pin.updateGeometryPlacements(model, data, shapes, placed, pin.neutral(model))
    expected = []
    for shape, place in zip(shapes.geometryObjects, placed.oMg, strict=True):
        expected.append([shape.geometry.computeVolume(), *place.translation])
    assert len(found) == len(expected)
    expected = np.array(expected)
    for row in np.array(found):
        misfit = np.abs(expected[:, 1:] - row[1:]).max(axis=1)
        nearest = misfit.argmin()
        assert misfit[nearest] < 1e-6
        assert row[0] == pytest.approx(expected[nearest, 0], rel=1e-5)

    pairs = set()
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.FilteredPairsAPI):
            for other in (
                UsdPhysics.FilteredPairsAPI(prim).GetFilteredPairsRel().GetTargets()
            ):
                pairs.add(frozenset((prim.GetName(), other.name)))
    srdf = ET.parse(Path(file).with_suffix(".srdf")).getroot()
    disabled = {
        frozenset((pair.get("link1"), pair.get("link2")))
        for pair in srdf.findall("disable_collisions")
    }
    bodies = {prim.GetName() for prim in stage.Traverse()}
    assert pairs == {pair for pair in disabled if pair <= bodies - {"base_link", "tcp"}}
    assert len(pairs) > 4


def _volume(prim: Any) -> float:
    place = prim.GetAttribute("xformOp:scale").Get() or (1.0, 1.0, 1.0)
    scale = float(np.prod(place))
    if prim.IsA(UsdGeom.Cube):
        return scale * UsdGeom.Cube(prim).GetSizeAttr().Get() ** 3
    if prim.IsA(UsdGeom.Sphere):
        return scale * 4 / 3 * math.pi * UsdGeom.Sphere(prim).GetRadiusAttr().Get() ** 3
    cylinder = UsdGeom.Cylinder(prim)
    radius = cylinder.GetRadiusAttr().Get()
    return scale * math.pi * radius**2 * cylinder.GetHeightAttr().Get()


def test_the_command_writes_the_table_of_the_water_beside(tmp_path, path, capsys):
    file = tmp_path / "arm.usda"
    arguments = ["generate", "usd", "--fluid", "fresh"]
    assert main([*arguments, "--output", str(file)]) == 0
    assert capsys.readouterr().err == ""
    written = {each.name for each in tmp_path.iterdir()}
    assert written == {"arm.usda", "arm_water.json"}
    table = json.loads((tmp_path / "arm_water.json").read_text("utf-8"))
    expected = water_files(WaterOptions(fluid_density=1000.0))["water.json"]
    assert table == json.loads(expected)
    stage = Usd.Stage.Open(str(file))
    names = {prim.GetName() for prim in stage.Traverse()}
    assert set(table["links"]) <= names
    assert "/tmp" not in file.read_text("utf-8")


@pytest.mark.parametrize(
    ("wrong", "error"),
    [
        ({"gripper": "none"}, UnknownNameError),
        ({"collision": "mesh"}, UnknownNameError),
        ({"corrections": ("no_such",)}, UnknownNameError),
        ({"fluid_density": -1.0}, InputError),
        ({"arm": 5}, InputError),
    ],
)
def test_bad_options_are_refused(wrong, error):
    with pytest.raises(error):
        UsdOptions(**wrong)


def test_without_the_converter_it_says_what_to_install(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "urdf_usd_converter", None)
    with pytest.raises(MissingDependencyError, match="pip install urdf-usd-converter"):
        usd_files()
    assert main(["generate", "usd"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
