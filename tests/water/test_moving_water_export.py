"""Added mass and drag in SDF and MJCF agree with the file of numbers and its strips."""

from __future__ import annotations

import itertools
import json
import shutil
import subprocess
import xml.etree.ElementTree as ET

import current_load
import numpy as np
import pytest
import reference
from own_drag import own_torque, wrench

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.mjcf import MjcfOptions, mjcf, mjcf_files
from alpha5_model.description.mjcf_drag import ellipsoids
from alpha5_model.description.sdf import SdfOptions, sdf, sdf_files, sdf_world
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import GRIPPERS

#: Name of the link in the file of a gripper -> name of the body in the data.
LINKS = {f"link_{i}": f"link_{i}" for i in range(5)}
JAWS = {**LINKS, "link_4": "wrist", "finger_1": "finger_1", "finger_2": "finger_2"}
NAMES = {"locked": LINKS, "jaws": JAWS}


def coefficients(model: ET.Element) -> dict[str, np.ndarray]:
    """Quadratic damping of each link as gz-sim's system reads it, (6, 6, 6)."""
    found = {}
    for plugin in model.findall("plugin"):
        assert plugin.get("filename") == "gz-sim-hydrodynamics-system"
        assert plugin.find("disable_added_mass").text == "true"
        assert not [e.tag for e in plugin if "Dot" in e.tag]
        found[plugin.find("link_name").text] = quadratic_damping(plugin)
    return found


def quadratic_damping(plugin: ET.Element) -> np.ndarray:
    out = np.zeros((6, 6, 6))
    velocities = "UVWPQR"
    for i, j, k in itertools.product(range(6), repeat=3):
        force = "xyzkmn"[i]
        element = plugin.find(f"{force}{velocities[j]}abs{velocities[k]}")
        out[i, j, k] = 0.0 if element is None else float(element.text)
    return out


def gazebo_drag(coefficient: np.ndarray, nu: np.ndarray) -> np.ndarray:
    """``f_i = sum c_ijk |nu_k| nu_j``, as the system subtracts twice.

    Source: gz-sim, Hydrodynamics.cc, PreUpdate.
    """
    return np.einsum("ijk,j,k->i", coefficient, nu, np.abs(nu))


@pytest.mark.parametrize("gripper", GRIPPERS)
@pytest.mark.parametrize("density", [1025.0, 1000.0])
def test_added_mass_in_sdf_is_the_files_about_the_links_origin(gripper, density):
    options = SdfOptions(gripper=gripper, fluid_density=density, hydrodynamics=True)
    root = ET.fromstring(sdf(options))
    rows = current_load.bodies()
    assert root.get("version") == "1.11"
    seen = {}
    for link in root.iter("link"):
        matrix = link.find("inertial/fluid_added_mass")
        if matrix is None:
            continue
        row = rows[NAMES[gripper][link.get("name")]]
        expected = np.array(row["added_mass"], dtype=float) * density / 1000
        for i, j in itertools.combinations_with_replacement(range(6), 2):
            value = float(matrix.find("xyzpqr"[i] + "xyzpqr"[j]).text)
            assert value == pytest.approx(expected[i, j], rel=1e-15)
        assert len(matrix) == 21
        # The inertial's pose has no rotation, so its axes are the link's.
        assert link.find("inertial/pose").text.endswith(" 0.0 0.0 0.0")
        seen[link.get("name")] = matrix
    assert set(seen) == set(NAMES[gripper])
    assert set(coefficients(root.find("model"))) == set(seen)


@pytest.mark.parametrize("gripper", GRIPPERS)
def test_neither_mass_nor_inertia_nor_volume_changes(gripper):
    roots = [
        ET.fromstring(
            sdf(SdfOptions(gripper=gripper, hydrodynamics=x, sdf_version="1.11"))
        )
        for x in (True, False)
    ]
    model = roots[0].find("model")
    for plugin in model.findall("plugin"):
        model.remove(plugin)
    for inertial in model.iter("inertial"):
        for matrix in inertial.findall("fluid_added_mass"):
            inertial.remove(matrix)
    ours, plain = (
        [(e.tag, e.attrib, (e.text or "").strip()) for e in r.iter()] for r in roots
    )
    assert ours == plain


@pytest.mark.parametrize("gripper", GRIPPERS)
def test_drag_in_sdf_is_the_strips_for_each_component_alone(gripper):
    rows = current_load.bodies()
    options = SdfOptions(gripper=gripper, hydrodynamics=True)
    model = ET.fromstring(sdf(options)).find("model")
    for name, coefficient in coefficients(model).items():
        for unit, speed in itertools.product(np.eye(6), (0.7, -0.3)):
            nu = speed * unit
            expected = wrench(rows[NAMES[gripper][name]], nu)
            off = np.abs(gazebo_drag(coefficient, nu) - expected).max()
            # Eight Gauss points are not exact if a strip passes the origin. Strips
            # resist almost no rotation about themselves, so some loads are about 0.
            assert off <= 5e-3 * np.abs(expected).max() + 1e-9


def test_drag_in_sdf_stays_near_the_strips_and_takes_energy():
    """The drag is within 12 % in a current from anywhere and 35 % in any motion.

    Both are root mean squares.
    """
    rows = current_load.bodies()
    rng = np.random.default_rng(3)
    model = ET.fromstring(sdf(SdfOptions(hydrodynamics=True))).find("model")
    for name, coefficient in coefficients(model).items():
        for spin, share in ((0.0, 0.12), (5.0, 0.35)):
            error = []
            size = []
            for _ in range(60):
                nu = np.concatenate([rng.normal(size=3), spin * rng.normal(size=3)])
                drag = gazebo_drag(coefficient, nu)
                expected = wrench(rows[name], nu)
                assert nu @ drag < 0
                error.append((drag - expected)[:3])
                size.append(expected[:3])
            assert np.linalg.norm(error) < share * np.linalg.norm(size)


def test_the_worlds_arm_is_the_models_and_its_folder_says_the_version():
    options = SdfOptions(hydrodynamics=True)
    world = ET.fromstring(sdf_world(options))
    assert len(world.findall("./world/model/model/plugin")) == 5
    assert '<sdf version="1.11">' in sdf_files(options)["model.config"].decode()
    assert '<sdf version="1.9">' in sdf_files()["model.config"].decode()
    assert "estimated, not published" in sdf(options)


@pytest.mark.skipif(shutil.which("gz") is None, reason="libsdformat's gz is not there")
def test_libsdformat_takes_it(tmp_path):
    (tmp_path / "model.sdf").write_text(sdf(SdfOptions(hydrodynamics=True)))
    subprocess.run(["gz", "sdf", "-k", str(tmp_path / "model.sdf")], check=True)


# --- MJCF -----------------------------------------------------------------------------


def moving(gripper: str = "locked", **options):
    """MuJoCo's model without weight or contact, and its data."""
    mujoco = pytest.importorskip("mujoco")
    text = mjcf(
        MjcfOptions(gripper=gripper, hydrodynamics=True, collision="none", **options)
    )
    model = mujoco.MjModel.from_xml_string(text)
    return mujoco, model, mujoco.MjData(model)


def mass_matrix(model, data) -> np.ndarray:
    import mujoco

    columns = np.zeros((model.nv, model.nv))
    for column, unit in zip(columns, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, column, unit)
    return columns


def test_mujocos_drag_on_a_moving_joint_is_the_strips():
    """If one joint moves, the torque about its axis is within 5 %.

    axis_b is left out: it turns links about themselves.
    """
    mujoco, model, data = moving()
    rng = np.random.default_rng(6)
    for k in range(3):
        error = []
        size = []
        for _ in range(8):
            q = rng.uniform(reference.LOWER, reference.UPPER)
            v = rng.choice([-1, 1]) * np.eye(4)[k]
            data.qpos = q
            data.qvel = v
            mujoco.mj_forward(model, data)
            expected = own_torque(q, v, np.zeros(3))[k]
            assert data.qfrc_fluid[k] * v[k] < 0
            error.append(data.qfrc_fluid[k] - expected)
            size.append(expected)
        assert np.linalg.norm(error) < 0.05 * np.linalg.norm(size)


def test_mujocos_wind_is_a_current():
    """Torques of drag at rest are within 15 %, as a root mean square.

    MuJoCo leaves out Munk moments, so these have none; see
    ``test_statements_proof.py``.
    """
    mujoco, model, data = moving()
    rng = np.random.default_rng(8)
    error = []
    size = []
    for _ in range(25):
        q = rng.uniform(reference.LOWER, reference.UPPER)
        u = rng.normal(size=3)
        data.qpos = q
        model.opt.wind = u
        mujoco.mj_forward(model, data)
        expected = own_torque(q, np.zeros(4), u)[:3]
        error.append(data.qfrc_fluid[:3] - expected)
        size.append(expected)
    assert np.linalg.norm(error) < 0.15 * np.linalg.norm(size)


def test_the_needles_lift_is_nearest_to_the_strips():
    """The needle's lift is the least-squares fit to the strip's over all directions.

    A strip lifts with sin^2 x cos x, a needle with sin x cos x.
    """
    x = (np.arange(20_000) + 0.5) * np.pi / 20_000
    strip = np.sin(x) ** 2 * np.cos(x)
    needle = np.sin(x) * np.cos(x)
    sphere = np.sin(x)
    share = (sphere * strip * needle).sum() / (sphere * needle**2).sum()
    length, across, along = 0.2, 1.1, 0.3
    pieces = [*ellipsoids(a5.DragStrip([0, 0, 0], [0, 0, length], 0.03, across, along))]
    needles = [piece for piece in pieces if piece["fluidcoef"][3]]
    # MuJoCo's lift is density times this coefficient times the ellipsoid's largest
    # section, across the needle.
    sections = 0.0
    for piece in needles:
        half_length = np.ptp(piece["fromto"].reshape(2, 3)[:, 2]) / 2
        sections += piece["fluidcoef"][3] * np.pi * piece["size"] * half_length
    expected = share * (across - along) * 0.03 * length / 2
    assert sections == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("gripper", GRIPPERS)
def test_mass_matrix_and_still_torques_stay(gripper):
    """What moves water has no mass here; what has none in the data feels no drag."""
    mujoco, model, data = moving(gripper)
    text = mjcf(MjcfOptions(gripper=gripper, collision="none"))
    plain = mujoco.MjModel.from_xml_string(text)
    other = mujoco.MjData(plain)
    data.qpos[:4] = other.qpos[:4] = (3.0, 1.2, 1.7, 0.4)
    for m, d in ((model, data), (plain, other)):
        mujoco.mj_forward(m, d)
    np.testing.assert_array_equal(mass_matrix(model, data), mass_matrix(plain, other))
    np.testing.assert_allclose(data.qfrc_bias, other.qfrc_bias, rtol=0, atol=1e-15)
    assert not data.qfrc_fluid.any()
    np.testing.assert_array_equal(model.body_mass, plain.body_mass)
    without = {
        model.body(i).name for i in range(model.nbody) if model.body_geomnum[i] == 0
    }
    assert without <= {"world", "base_link"}
    assert model.opt.viscosity == 0.0
    assert model.opt.density == 1025.0


def test_the_readme_says_what_is_estimated_and_what_is_missing():
    said = mjcf_files(MjcfOptions(hydrodynamics=True))["README.md"].decode()
    assert "Moving water is **estimated**, not published" in said
    assert "What MuJoCo cannot carry" in said
    assert "no mass matrix" in said
    assert "oving water" not in mjcf_files()["README.md"].decode()


def test_hydrodynamics_is_a_flag():
    for options in (MjcfOptions, SdfOptions):
        with pytest.raises(InputError, match="hydrodynamics"):
            options(hydrodynamics="yes")


# --- command line ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "file"), [("sdf", "model.sdf"), ("mjcf", "alpha5.xml")]
)
def test_the_option_is_the_librarys(tmp_path, capsys, kind, file):
    out = tmp_path / "out"
    assert main(["generate", kind, "--hydrodynamics", "--output", str(out)]) == 0
    text = (out / file).read_text("utf-8")
    assert ("fluid_added_mass" in text, "fluidcoef" in text) == (
        kind == "sdf",
        kind == "mjcf",
    )
    assert json.dumps(capsys.readouterr().err) == '""'


def test_urdf_has_no_place_for_it(capsys):
    assert main(["generate", "urdf", "--hydrodynamics"]) == 2
    out = capsys.readouterr()
    assert out.out == ""
    assert len(out.err.splitlines()) == 1
    assert "--hydrodynamics" in out.err
