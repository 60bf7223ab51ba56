"""The MuJoCo model is the same arm in the same water, to the last digits, and runs."""

from __future__ import annotations

import dataclasses
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from lazily import Lazy
from PIL import Image
from reference import LOWER, UPPER, configurations
from scipy.spatial.transform import Rotation
from water_reference import URDF, VOLUME, Reference

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH, MJCF_PATH, URDF_PATH
from alpha5_model._support.writing import atomic_write
from alpha5_model.cli import main
from alpha5_model.description.mjcf import MjcfOptions, mjcf, mjcf_files
from alpha5_model.description.mjcf_bodies import principal_axes
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import InputError, NonFiniteError, UnknownNameError
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.rigid_body import AttachedBody

mujoco = Lazy("mujoco", minversion="3.5", reason="MuJoCo 3.5 or later")


def compiled(text: str, *disabled: str):
    """Model and data; limits, contacts and equalities can be switched off."""
    model = mujoco.MjModel.from_xml_string(text)
    for name in disabled:
        model.opt.disableflags |= getattr(mujoco.mjtDisableBit, f"mjDSBL_{name}")
    return model, mujoco.MjData(model)


def free(text: str):
    """A model in which nothing but inertia, weight and water acts."""
    return compiled(text, "LIMIT", "CONTACT", "EQUALITY", "ACTUATION")


def mass_matrix(model, data) -> np.ndarray:
    columns = np.zeros((model.nv, model.nv))
    for column, unit in zip(columns, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, column, unit)
    return columns


def errors(text: str, count: int = 1000, density: float = 1025.0) -> dict[str, float]:
    """Largest differences from Pinocchio over random states."""
    reference = Reference(density)
    model, data = free(text)
    q_all = configurations(count, seed=11)
    v_all = np.random.default_rng(12).uniform(-2, 2, (count, 4))
    worst = dict.fromkeys(("fk", "mass", "acceleration", "buoyancy"), 0.0)
    for q, v in zip(q_all, v_all, strict=True):
        data.qpos, data.qvel = q, v
        mujoco.mj_forward(model, data)
        tcp, mass = reference.tcp(q), reference.mass_matrix(q)
        found = {
            "fk": np.abs(data.site("tcp").xpos - tcp[:3, 3]).max()
            + np.abs(data.site("tcp").xmat.reshape(3, 3) - tcp[:3, :3]).max(),
            "mass": np.abs(mass_matrix(model, data) - mass).max(),
            # qacc in place of its fields: the motion itself must contain the buoyancy.
            "acceleration": np.abs(
                mass @ data.qacc + reference.bias(q, v) - reference.buoyancy(q)
            ).max(),
            "buoyancy": np.abs(data.qfrc_passive - reference.buoyancy(q)).max(),
        }
        worst = {name: max(worst[name], float(value)) for name, value in found.items()}
    return worst


@pytest.fixture(scope="module")
def text() -> str:
    return mjcf()


@pytest.mark.parametrize(
    ("density", "count"), [(1025.0, 1000), (1000.0, 100), (0.0, 100)]
)
def test_equals_pinocchio_in_every_fluid(density, count):
    worst = errors(mjcf(MjcfOptions(fluid_density=density)), count, density)
    assert max(worst.values()) < 1e-12


def tensor(inertial: ET.Element) -> np.ndarray:
    """The tensor that principal moments and axes stand for."""
    w, x, y, z = map(float, inertial.get("quat").split())
    axes = pin.Quaternion(w, x, y, z).matrix()
    moments = [float(moment) for moment in inertial.get("diaginertia").split()]
    return axes @ np.diag(moments) @ axes.T


def flipped_products(text: str) -> str:
    root = ET.fromstring(text)
    for inertial in root.iter("inertial"):
        if inertial.get("quat"):
            i = tensor(inertial)
            values = [*np.diag(i), -i[0, 1], -i[0, 2], -i[1, 2]]
            del inertial.attrib["quat"], inertial.attrib["diaginertia"]
            inertial.set("fullinertia", " ".join(str(float(value)) for value in values))
    return ET.tostring(root, encoding="unicode")


def at_the_com(text: str) -> str:
    root = ET.fromstring(text)
    for link in root.iter("body"):
        for child in link.findall("body"):
            if child.get("name") == f"{link.get('name')}_buoyancy":
                child.set("pos", link.find("inertial").get("pos"))
    return ET.tostring(root, encoding="unicode")


def six_digits(text: str) -> str:
    return re.sub(r"\d+\.\d{7,}", lambda m: f"{float(m.group()):.6g}", text)


@pytest.mark.parametrize(
    ("damage", "field", "at_least"),
    [
        (flipped_products, "mass", 1e-5),
        (at_the_com, "acceleration", 1e-3),
        (six_digits, "fk", 1e-8),
        # MuJoCo 3.4.0 loses the force of bodies that weigh nothing
        (lambda text: re.sub(r' gravcomp="[^"]*"', "", text), "acceleration", 0.5),
    ],
    ids=["flipped products", "COM for COB", "six digits", "force lost"],
)
def test_damage_is_seen(text, damage, field, at_least):
    damaged = damage(text)
    assert damaged != text
    assert errors(damaged, count=60)[field] > at_least


def recipe() -> str:
    """The lines of the model's README that change the fluid."""
    readme = mjcf_files()["README.md"].decode()
    return re.search(r"```python\n(.*?)```", readme, re.DOTALL).group(1)


@pytest.mark.parametrize("written_for", [0.0, 1025.0])
def test_the_readmes_lines_change_the_fluid_there_and_back(written_for):
    code = recipe()
    assert code.count("rho = 1000.0") == 1
    model, data = free(mjcf(MjcfOptions(fluid_density=written_for)))
    model.body_gravcomp[model.body("link_1").id] = (
        0.25  # a user's own compensation is not the water's
    )
    weight = model.body("link_1").mass[0]
    q = np.array([1.0, 1.2, 0.7, 2.0])
    data.qpos = q
    for density in (0.0, 1025.0, 1000.0, 0.0, 1025.0, None, 1000.0):
        if density is None:  # the water switched off by hand
            for name in VOLUME:
                model.body_gravcomp[model.body(f"{name}_buoyancy").id] = 0.0
            continue
        exec(code.replace("rho = 1000.0", f"rho = {density}"), {"model": model})
        mujoco.mj_forward(model, data)
        reference = Reference(density)
        jacobian = np.zeros((3, 4))
        mujoco.mj_jacBodyCom(model, data, jacobian, None, model.body("link_1").id)
        carried = jacobian.T @ [0, 0, 0.25 * weight * 9.81]
        np.testing.assert_allclose(
            reference.mass_matrix(q) @ data.qacc + reference.bias(q, np.zeros(4)),
            reference.buoyancy(q) + carried,
            atol=1e-11,
        )


def test_jaws_equal_pinocchio_with_the_fingers_anywhere():
    pin_model = pin.buildModelFromUrdf(str(URDF / "alpha5_jaws.urdf"))
    pin_data = pin_model.createData()
    bodies = {b.name: (b.volume, b.cob) for b in split_link_4(parameters()).bodies}
    bodies |= {link.name: (link.volume, link.cob) for link in parameters().links[:4]}
    model, data = free(mjcf(MjcfOptions(gripper="jaws")))
    order = [model.joint(name).id for name in list(pin_model.names)[1:]]
    rng = np.random.default_rng(5)
    for _ in range(200):
        q, v = rng.uniform(-1, 1, 7), rng.uniform(-1, 1, 7)
        data.qpos[order], data.qvel[order] = q, v
        mujoco.mj_forward(model, data)
        pin.computeJointJacobians(pin_model, pin_data, q)
        pin.updateFramePlacements(pin_model, pin_data)
        force = np.zeros(7)
        for name, (volume, cob) in bodies.items():
            frame = pin_model.getFrameId(name)
            jacobian = pin.getFrameJacobian(
                pin_model, pin_data, frame, pin.LOCAL_WORLD_ALIGNED
            )
            arm = pin_data.oMf[frame].rotation @ cob
            lift = np.array([0, 0, 1025.0 * volume * 9.81])
            force += jacobian.T @ np.concatenate([lift, np.cross(arm, lift)])
        torque = pin.rnea(pin_model, pin_data, q, v, data.qacc[order])
        np.testing.assert_allclose(torque, force, atol=2e-12)


def test_fingers_follow_the_rod():
    model, data = compiled(mjcf(MjcfOptions(gripper="jaws")))
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    joint = parameters().joints[4]
    data.ctrl[4] = joint.upper
    mujoco.mj_step(model, data, nstep=2000)
    rod, *fingers = data.qpos[4:]
    assert rod == pytest.approx(joint.upper, abs=5e-4)
    assert fingers == pytest.approx([51 * (rod - joint.lower)] * 2, abs=5e-3)
    assert min(fingers) > 0.55


@pytest.mark.parametrize(
    ("gripper", "corrections"), [("locked", DEFAULT_CORRECTIONS), ("jaws", ())]
)
def test_pinocchios_own_reader_makes_the_arm_of_the_urdf(
    gripper, corrections, tmp_path
):
    """Without water, and with fingers that follow nothing: it knows neither."""
    ours = pin.buildModelFromXML(
        urdf(Variant(gripper=gripper, corrections=corrections))
    )
    file = tmp_path / "alpha5.xml"
    file.write_text(
        mjcf(MjcfOptions(gripper=gripper, corrections=corrections)), "utf-8"
    )
    theirs = pin.buildModelFromMJCF(str(file))
    assert list(theirs.names) == list(ours.names)
    data, own = theirs.createData(), ours.createData()
    links = ["tcp", *(f"link_{i}" for i in range(5))]
    links += ["finger_1", "finger_2"] if gripper == "jaws" else []
    rng = np.random.default_rng(5)
    for _ in range(25):
        q, v = rng.uniform(-3, 3, (2, ours.nq))
        pin.framesForwardKinematics(theirs, data, q)
        pin.framesForwardKinematics(ours, own, q)
        for name in links:
            found = data.oMf[theirs.getFrameId(name)].homogeneous
            wanted = own.oMf[ours.getFrameId(name)].homogeneous
            # Quaternions have 12 digits.
            assert np.abs(found - wanted).max() < 1e-12
        assert np.abs(pin.crba(theirs, data, q) - pin.crba(ours, own, q)).max() < 1e-12
        torques = (
            pin.nonLinearEffects(m, d, q, v) for m, d in ((theirs, data), (ours, own))
        )
        assert np.abs(np.subtract(*torques)).max() < 5e-12


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_meshes_are_shown_where_the_urdf_shows_them(gripper):
    """The URDF's visuals are written by the xacro, these by the package."""
    root = ET.fromstring(mjcf_files(MjcfOptions(gripper=gripper))["alpha5.xml"])
    shown = {
        (body.get("name"), geom.get("mesh")): geom
        for body in root.iter("body")
        for geom in body.findall("geom[@mesh]")
    }
    wanted = {
        (
            link.get("name"),
            Path(visual.find("geometry/mesh").get("filename")).stem,
        ): visual
        for link in ET.parse(URDF_PATH if gripper == "locked" else JAWS_URDF_PATH).iter(
            "link"
        )
        for visual in link.findall("visual")
    }
    assert len(wanted) == 7
    assert set(shown) == set(wanted)
    for key, visual in wanted.items():
        pos, quat = shown[key].get("pos", "0 0 0"), shown[key].get("quat", "1 0 0 0")
        xyz_rpy = visual.find("origin").attrib
        one = Rotation.from_quat([float(x) for x in quat.split()], scalar_first=True)
        other = Rotation.from_euler("xyz", [float(x) for x in xyz_rpy["rpy"].split()])
        assert (one.inv() * other).magnitude() < 1e-9
        at = [float(x) for x in pos.split()]
        assert at == pytest.approx(
            [float(x) for x in xyz_rpy["xyz"].split()], abs=1e-12
        )


def test_collision_shapes_are_as_large_as_the_urdfs():
    root = ET.fromstring(mjcf())
    found = {
        body.get("name"): [
            (geom.get("type"), *map(float, geom.get("size").split()))
            for geom in body.findall("geom[@class='collision']")
        ]
        for body in root.iter("body")
    }
    for link in ET.parse(URDF_PATH).iter("link"):
        wanted = []
        for shape in link.findall("collision/geometry/*"):
            values = {k: float(x) for k, x in shape.attrib.items() if k != "size"}
            sizes = {
                "box": [float(x) / 2 for x in shape.get("size", "").split()],
                "cylinder": [values.get("radius"), values.get("length", 0.0) / 2],
                "sphere": [values.get("radius")],
            }
            wanted.append((shape.tag, *sizes[shape.tag]))
        if wanted:
            assert found[link.get("name")] == [
                (kind, *map(pytest.approx, size)) for kind, *size in wanted
            ]


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
@pytest.mark.parametrize("posture", ["stow", "home", "reach"])
def test_servos_hold_the_postures_under_water_without_contact(
    tmp_path, gripper, posture
):
    files = mjcf_files(MjcfOptions(gripper=gripper))
    model, data = compiled_folder(files, tmp_path)
    mujoco.mj_resetDataKeyframe(model, data, model.key(posture).id)
    key = data.qpos.copy()
    assert np.all(key[:4] >= LOWER)
    assert np.all(key[:4] <= UPPER)
    mujoco.mj_forward(model, data)
    assert data.ncon == 0
    mujoco.mj_step(model, data, nstep=1000)
    assert np.abs(data.qpos - key).max() < 0.02
    assert np.abs(data.qvel).max() < 1e-3


def compiled_folder(files: dict[str, bytes], folder: Path):
    """Write the files and compile the scene."""
    for name, content in files.items():
        atomic_write(folder / name, content)
    model = mujoco.MjModel.from_xml_path(str(folder / "scene.xml"))
    return model, mujoco.MjData(model)


def test_velocity_servos_move_at_the_speed_asked_for():
    model, data = compiled(mjcf(MjcfOptions(actuators="velocity")))
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    start, speed = data.qpos.copy(), np.array([0.2, 0.1, -0.1, 0.3])
    data.ctrl = speed
    mujoco.mj_step(model, data, nstep=1000)
    np.testing.assert_allclose(data.qpos - start, speed * data.time, atol=0.02)
    np.testing.assert_allclose(data.qvel, speed, atol=2e-3)


@pytest.mark.parametrize("actuators", ["position", "velocity", "motor"])
def test_ten_seconds_of_random_control_without_a_warning(
    tmp_path, monkeypatch, actuators
):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "alpha5"
    arguments = ["mjcf", "--gripper", "jaws", "--actuators", actuators]
    assert main(["generate", *arguments, "--output", str(folder)]) == 0
    model = mujoco.MjModel.from_xml_path(str(folder / "scene.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    low, high = model.actuator_ctrlrange.T
    rng = np.random.default_rng(8)
    while data.time < 10.0:
        if (
            actuators == "motor"
        ):  # a tenth of the placeholder efforts, which no arm here has
            data.ctrl = 0.1 * rng.uniform(low, high)
        else:
            data.ctrl = rng.uniform(low, high)
        mujoco.mj_step(model, data, nstep=50)
    assert np.isfinite(data.qpos).all()
    assert [int(warning.number) for warning in data.warning] == [0] * len(data.warning)


def test_a_scenes_fluid_drags_links_and_no_floats(text):
    """MuJoCo takes a body without a geom of its own for a box, and drags it."""
    in_fluid = text.replace("<option ", '<option density="1025" viscosity="1e-3" ')
    root = ET.fromstring(in_fluid)
    for link in list(root.iter("body")):
        for child in link.findall("body"):
            if child.get("name").endswith("_buoyancy"):
                link.remove(child)
    boxes = re.sub(r'<geom class="no_drag" />', "", in_fluid)
    models = [free(one) for one in (in_fluid, ET.tostring(root, "unicode"), boxes)]
    rng = np.random.default_rng(4)
    for q in configurations(30, seed=2):
        v = rng.uniform(-1, 1, 4)
        drags = []
        for model, data in models:
            data.qpos, data.qvel = q, v
            mujoco.mj_forward(model, data)
            drags.append(data.qfrc_fluid.copy())
        drag, without_floats, with_boxes = drags
        np.testing.assert_allclose(drag, without_floats, atol=1e-9)
        assert v @ drag < 0
    assert np.abs(with_boxes - drag).max() > 1e-4


def test_link_and_float_together_have_the_printed_numbers(text):
    root = ET.fromstring(text)
    for link in parameters().links:
        body = root.find(f".//body[@name='{link.name}']")
        child = root.find(f".//body[@name='{link.name}_buoyancy']")
        own, floating = body.find("inertial"), child.find("inertial")
        cob = np.array(child.get("pos").split(), float)
        moments = np.array(floating.get("diaginertia").split(), float)
        together = pin.Inertia(
            float(own.get("mass")),
            np.array(own.get("pos").split(), float),
            tensor(own),
        ) + pin.Inertia(float(floating.get("mass")), cob, np.diag(moments))
        assert together.mass == pytest.approx(link.mass, rel=1e-14)
        np.testing.assert_allclose(together.lever, link.com, rtol=0, atol=1e-15)
        # Moments and axes are computed, so they have 12 digits.
        size = np.abs(link.inertia).max()
        np.testing.assert_allclose(
            together.inertia, link.inertia, rtol=0, atol=2e-12 * size
        )
        displaced = float(floating.get("mass")) * float(child.get("gravcomp"))
        litres = VOLUME[link.name]
        assert displaced == pytest.approx(1025.0 * litres / 1000, rel=1e-14)


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_without_buoyancy_it_is_the_arm_in_air(gripper):
    """The base's mass is then a geom's: brax melts the base into the world."""
    options = MjcfOptions(
        gripper, fluid_density=0.0, actuators="motor", collision="none"
    )
    dry, dry_data = free(mjcf(options))
    bare_text = mjcf(dataclasses.replace(options, buoyancy="none"))
    bare, bare_data = free(bare_text)
    assert "gravcomp" not in bare_text
    assert bare.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER
    base = parameters().links[0]
    moments = np.linalg.eigvalsh(base.inertia)
    assert sorted(bare.body("link_0").inertia) == pytest.approx(moments, rel=1e-14)
    assert bare.body("link_0").ipos == pytest.approx(base.com, abs=1e-15)
    for q in configurations(20, seed=8):
        for model, data in ((dry, dry_data), (bare, bare_data)):
            data.qpos[:4], data.qvel[:4] = q, q[::-1]
            mujoco.mj_forward(model, data)
        difference = mass_matrix(bare, bare_data) - mass_matrix(dry, dry_data)
        assert np.abs(difference).max() < 1e-12
        np.testing.assert_allclose(bare_data.qfrc_bias, dry_data.qfrc_bias, atol=1e-11)


def test_a_link_that_floats_far_away_gets_a_lighter_float():
    """A float of 250 kg/m^3 would take more inertia than the link with foam has."""
    foam = AttachedBody(
        name="foam",
        mass=0.1,
        com=np.zeros(3),
        inertia=1.5e-4 * np.eye(3),
        volume=1e-3,
        cob=np.zeros(3),
        link="link_4",
        position=np.array([0.2, 0.0, 0.0]),
        rotation=np.eye(3),
    )
    arm = dataclasses.replace(parameters(), name="foamy", attached=(foam,))
    model, data = free(mjcf(MjcfOptions(arm=arm)))
    own = a5.load(arm=arm)
    for q in configurations(20, seed=9):
        data.qpos = q
        mujoco.mj_forward(model, data)
        torque = data.qfrc_bias - data.qfrc_passive
        np.testing.assert_allclose(torque, own.hydrostatic_torque(q), atol=1e-10)
        mass = mass_matrix(model, data)
        np.testing.assert_allclose(mass, own.mass_matrix(q), atol=1e-11)


@pytest.mark.parametrize("parent", ["rov", "world"])
def test_options_mount_the_arm(parent):
    pose = {"xyz": (0.2, 0.1, -0.3), "rpy": (3.0, 0.4, -0.2)}
    model, data = free(mjcf(MjcfOptions(parent=parent, **pose)))
    mujoco.mj_forward(model, data)
    base = data.body("base_link")
    rotation = Rotation.from_euler("xyz", pose["rpy"]).as_matrix()
    np.testing.assert_allclose(base.xpos, pose["xyz"], atol=1e-12)
    np.testing.assert_allclose(base.xmat.reshape(3, 3), rotation, atol=1e-12)
    with pytest.raises(InputError, match="xyz"):
        MjcfOptions(xyz=(0.1, 0.0, 0.0))
    with pytest.raises(InputError, match="parent: expected a name that no link"):
        mjcf(MjcfOptions(parent="link_2"))


def test_axes_are_the_nearest_of_all_principal_ones():
    """Of 24 frames, and the same if two are equally near."""
    moments = np.array([2e-4, 3e-4, 4.5e-4])
    for true in Rotation.random(20, random_state=4).as_matrix():
        inertia = true @ np.diag(moments) @ true.T
        found, (w, x, y, z) = principal_axes(inertia)
        axes = Rotation.from_quat([x, y, z, w])
        back = axes.as_matrix() @ np.diag(found) @ axes.as_matrix().T
        np.testing.assert_allclose(back, inertia, rtol=0, atol=2e-15)
        angles = []
        for turn in Rotation.create_group("O"):
            angles.append((Rotation.from_matrix(true) * turn).magnitude())
        assert axes.magnitude() == pytest.approx(min(angles), abs=1e-9)

    half = Rotation.from_euler("z", 45, degrees=True).as_matrix()
    inertia = half @ np.diag(moments) @ half.T
    noise = 1e-19 * np.random.default_rng(6).normal(size=(20, 3, 3))
    found = [principal_axes(inertia + one + one.T)[1] for one in noise]
    np.testing.assert_allclose(found, found[:1] * 20, atol=1e-9)


@pytest.mark.parametrize("scene", ["scene.xml", "scene_jaws.xml", "scene_mjx.xml"])
def test_the_committed_folder_is_a_menagerie_model(scene):
    """LICENSE, README, change log, picture and a scene that runs from a key frame."""
    folder = Path(MJCF_PATH).parent
    names = {
        "LICENSE",
        "README.md",
        "CHANGELOG.md",
        "alpha5.png",
        "alpha5.xml",
        scene,
        "assets",
    }
    assert names <= {path.name for path in folder.iterdir()}
    readme = (folder / "README.md").read_text("utf-8")
    assert "## MJCF derivation steps" in readme
    assert all(
        (folder / link).is_file() for link in re.findall(r"\]\(([^)]+)\)", readme)
    )
    model = mujoco.MjModel.from_xml_path(str(folder / scene))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, nstep=500)
    assert np.abs(data.qpos[:4] - NAMED_POSES["home"]).max() < 0.02
    assert not data.warning.number.any()
    picture = np.asarray(Image.open(folder / "alpha5.png").convert("L"), dtype=int)
    assert min(picture.shape) >= 600
    assert np.unique(picture).size > 100


@pytest.mark.parametrize(
    ("wrong", "error"),
    [
        ({"gripper": "none"}, UnknownNameError),
        ({"actuators": "muscle"}, UnknownNameError),
        ({"fluid_density": -1.0}, InputError),
        ({"fluid_density": float("nan")}, NonFiniteError),
        ({"fluid_density": "brine"}, InputError),
        ({"collision": "mesh"}, UnknownNameError),
        ({"buoyancy": "net"}, UnknownNameError),
        ({"corrections": ("no_such",)}, UnknownNameError),
        ({"gripper": "jaws", "collision": "capsules"}, InputError),
    ],
)
def test_bad_options_are_refused(wrong, error):
    with pytest.raises(error):
        MjcfOptions(**wrong)


def test_capsules_for_mjx_tell_free_from_colliding_positions():
    """Wrong in about one position of a hundred, either way; named poses are free."""
    model = mujoco.MjModel.from_xml_path(
        str(Path(MJCF_PATH).with_name("scene_mjx.xml"))
    )
    data = mujoco.MjData(model)
    assert np.count_nonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_CAPSULE) == 5
    for key in range(model.nkey):
        mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
        assert data.ncon == 0
    rng = np.random.default_rng(31)
    states = rng.uniform(LOWER, UPPER, (1500, 4))
    touching = []
    for q in states:
        data.qpos[:4] = q
        mujoco.mj_forward(model, data)
        # The sea bed is body 0.
        bodies = model.geom_bodyid[data.contact.geom]
        deep = data.contact.dist < 0.0
        touching.append(bool(np.any(deep & np.all(bodies > 0, axis=-1))))
    exact = a5.load().in_collision(states)
    touching = np.array(touching)
    assert exact.mean() > 0.05
    assert np.mean(exact & ~touching) < 0.015
    assert np.mean(touching & ~exact) < 0.015
