"""USD: what UsdPhysics parses of the file is the arm, by numbers of another source."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from lazily import Lazy
from own_arm_dynamics import RECORDS
from reference import LOWER, UPPER
from water_reference import Reference

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.cli import main
from alpha5_model.description.bodies import arm_bodies
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.description.usd import UsdOptions, identifier, usd_files
from alpha5_model.errors import InputError, MissingDependencyError, UnknownNameError

Usd = Lazy("pxr.Usd", reason="usd-core is not installed")
UsdGeom = Lazy("pxr.UsdGeom", reason="usd-core is not installed")
UsdPhysics = Lazy("pxr.UsdPhysics", reason="usd-core is not installed")

JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
#: Of numbers in single precision, as a share.
SINGLE = 2e-7


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Iterator[Any]:
    """Writes a variant once; returns its path."""
    folder = tmp_path_factory.mktemp("usd")
    written: dict[str, str] = {}

    def write(gripper: str) -> str:
        if gripper not in written:
            path = folder / f"{gripper}.usda"
            path.write_bytes(usd_files(UsdOptions(gripper=gripper))["alpha5.usda"])
            written[gripper] = str(path)
        return written[gripper]

    return write


def usd_model(path: str) -> pin.Model:
    """Pinocchio's model of what UsdPhysics parses of a file."""
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from conformance.usd_reading import usd_model

    return usd_model(path)


def matrix(model: pin.Model, data: pin.Data, q: np.ndarray) -> np.ndarray:
    upper = np.triu(pin.crba(model, data, q))
    return upper + np.triu(upper, 1).T


def test_the_parsed_articulation_is_table_2_in_its_frames(file):
    model = usd_model(file("locked"))
    data = model.createData()
    typed = Reference()
    assert tuple(model.names)[1:] == JOINTS
    rng = np.random.default_rng(29)
    for _ in range(20):
        q, v = rng.uniform(LOWER, UPPER), rng.uniform(-1.0, 1.0, 4)
        pin.framesForwardKinematics(model, data, q)
        tcp = data.oMf[model.getFrameId("tcp")].homogeneous
        np.testing.assert_allclose(tcp, typed.tcp(q), atol=1e-8)
        mass = typed.mass_matrix(q)
        np.testing.assert_allclose(matrix(model, data, q), mass, atol=SINGLE * 0.05)
        bias = pin.nonLinearEffects(model, data, q, v)
        np.testing.assert_allclose(bias, typed.bias(q, v), atol=SINGLE)


def test_jaws_move_as_in_the_urdf(file):
    model = usd_model(file("jaws"))
    reference = pin.buildModelFromUrdf(a5.paths.JAWS_URDF_PATH)
    data, expected = model.createData(), reference.createData()
    order = [reference.joints[reference.getJointId(n)].idx_v for n in model.names[1:]]
    assert model.nv == 7
    rng = np.random.default_rng(30)
    for _ in range(5):
        q = rng.uniform(0.0, 0.01, 7)
        q[:4] = rng.uniform(LOWER, UPPER)
        there = np.empty(7)
        there[order] = q
        mass = matrix(reference, expected, there)[np.ix_(order, order)]
        np.testing.assert_allclose(matrix(model, data, q), mass, atol=1e-8)
        weight = pin.computeGeneralizedGravity(reference, expected, there)[order]
        found = pin.computeGeneralizedGravity(model, data, q)
        np.testing.assert_allclose(found, weight, atol=SINGLE)


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_limits_efforts_speeds_and_water(file, gripper):
    stage = Usd.Stage.Open(file(gripper))
    for body in arm_bodies(a5.parameters(), gripper):
        prim = stage.GetPrimAtPath(f"/alpha5/{body.name}")
        assert prim.GetAttribute("alpha5:volume").Get() == body.volume
        centre = np.array(prim.GetAttribute("alpha5:centerOfBuoyancy").Get())
        np.testing.assert_array_equal(centre, body.cob)
        joint = body.joint
        if joint is None:
            continue
        made = stage.GetPrimAtPath(f"/alpha5/joints/{joint.name}")
        unit = 180.0 / np.pi if joint.kind == "revolute" else 1.0
        limits = [
            made.GetAttribute(f"physics:{k}Limit").Get() for k in ("lower", "upper")
        ]
        np.testing.assert_allclose(
            np.array(limits) / unit, [joint.lower, joint.upper], rtol=SINGLE, atol=1e-9
        )
        speed = made.GetAttribute("physxJoint:maxJointVelocity").Get() / unit
        assert speed == pytest.approx(joint.velocity, rel=SINGLE)
        kind = "angular" if joint.kind == "revolute" else "linear"
        drive = UsdPhysics.DriveAPI(made, kind)
        assert drive.GetMaxForceAttr().Get() == pytest.approx(joint.effort)


def test_fingers_have_their_rule(file):
    stage = Usd.Stage.Open(file("jaws"))
    for name in ("finger_1_joint", "finger_2_joint"):
        prim = stage.GetPrimAtPath(f"/alpha5/joints/{name}")
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


def test_bodies_stand_at_home_where_their_joints_are(file):
    """An importer that takes angles from the poses of the bodies starts at home."""
    stage = Usd.Stage.Open(file("locked"))
    typed = Reference()
    cache = UsdGeom.XformCache()
    tcp = cache.GetLocalToWorldTransform(stage.GetPrimAtPath("/alpha5/link_4/tcp"))
    home = typed.tcp(np.array(NAMED_POSES["home"]))
    np.testing.assert_allclose(np.array(tcp).T, home, atol=5e-12)


def test_meshes_and_shapes_are_those_of_the_urdf(file):
    stage = Usd.Stage.Open(file("locked"))
    assert stage.GetDefaultPrim().GetPath() == "/alpha5"
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    meshes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    assert len(meshes) == 7
    box = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    for prim in meshes:
        name = prim.GetName().removeprefix("visual_")
        lines = (Path(REPOSITORY_PATH) / "meshes" / f"{name}.obj").read_text()
        rows = [line.split()[1:] for line in lines.splitlines() if line[:2] == "v "]
        points = np.array(rows, dtype=float)
        bound = box.ComputeUntransformedBound(prim).ComputeAlignedRange()
        np.testing.assert_allclose(bound.GetMin(), points.min(axis=0), atol=1e-7)
        np.testing.assert_allclose(bound.GetMax(), points.max(axis=0), atol=1e-7)
        assert UsdGeom.Mesh.ValidateTopology(
            UsdGeom.Mesh(prim).GetFaceVertexIndicesAttr().Get(),
            UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get(),
            len(points),
        )[0]
    model = pin.buildModelFromUrdf(a5.URDF_PATH)
    shapes = pin.buildGeomFromUrdf(
        model, a5.URDF_PATH, pin.COLLISION, package_dirs=[a5.REPOSITORY_PATH]
    )
    colliding = [p for p in stage.Traverse() if p.HasAPI(UsdPhysics.CollisionAPI)]
    assert len(colliding) == shapes.ngeoms
    volume = sum(float(_volume(prim)) for prim in colliding)
    expected = sum(_volume_of_coal(shape.geometry) for shape in shapes.geometryObjects)
    assert volume == pytest.approx(expected, rel=1e-6)


def _volume(prim: Any) -> float:
    if prim.IsA(UsdGeom.Cube):
        return float(np.prod(prim.GetAttribute("xformOp:scale").Get()))
    if prim.IsA(UsdGeom.Sphere):
        radius = UsdGeom.Sphere(prim).GetRadiusAttr().Get()
        return float(4.0 / 3.0 * np.pi * radius**3)
    cylinder = UsdGeom.Cylinder(prim)
    return np.pi * cylinder.GetRadiusAttr().Get() ** 2 * cylinder.GetHeightAttr().Get()


def _volume_of_coal(shape: Any) -> float:
    return float(shape.computeVolume())


@pytest.mark.slow
def test_an_arm_of_ones_own_stands_on_its_mount(tmp_path):
    record = RECORDS[9]
    path = tmp_path / "own.usda"
    path.write_bytes(
        usd_files(UsdOptions(arm=record, corrections=record.corrections))["alpha5.usda"]
    )
    model = usd_model(str(path))
    own = a5.load(a5.AIR, arm=record)
    q = np.array([2.0, 1.0, 1.5, 0.5])
    found = matrix(model, model.createData(), q)
    np.testing.assert_allclose(found, own.mass_matrix(q), atol=1e-7)


def test_names_that_usd_cannot_have():
    assert identifier("alpha5") == "alpha5"
    assert identifier("my arm-2") == "my_arm_2"
    assert identifier("5 arms") == "_5_arms"


@pytest.mark.slow
def test_same_bytes_twice():
    assert usd_files() == usd_files()


@pytest.mark.parametrize(
    ("wrong", "error"),
    [
        ({"gripper": "none"}, UnknownNameError),
        ({"collision": "mesh"}, UnknownNameError),
        ({"corrections": ("no_such",)}, UnknownNameError),
        ({"arm": 5}, InputError),
    ],
)
def test_bad_options_are_one_clear_line(wrong, error):
    with pytest.raises(error) as caught:
        UsdOptions(**wrong)
    assert "\n" not in str(caught.value)


def test_without_usd_core_it_says_what_to_install(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(MissingDependencyError, match="pip install usd-core"):
        usd_files()
    assert main(["generate", "--format", "usd"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
