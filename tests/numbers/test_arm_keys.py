"""What each kind of key of an arm file changes, changed alone: one table.

One key stands for its kind; a new key needs no row unless it is a new kind.
"""

from __future__ import annotations

import dataclasses
import re
import tempfile
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import alpha5_model as a5
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.parameters import Alpha5Parameters

#: An attached body with every key.
BODY = """[[attached]]
name = "s"
link = "link_4"
at = [0, 0, 0]
rpy = [0.1, 0.2, 0.3]
mass = 0.5
com = [0.002, 0.001, 0.003]
inertia = [[2e-4, 0, 0], [0, 2.5e-4, 0], [0, 0, 3e-4]]
volume = 1e-4
cob = [0.003, 0.002, 0.001]
spacer = 0.01
"""
#: Torques and forces, and what is made of them.
_DYNAMICS = "dynamics kernels moving_water c_code trajectory sweep viewer"
#: Descriptions that have masses and joints.
_ROBOTS = "urdf xacro mjcf sdf"
#: Poses of links and of the tool, and so all that depends on them.
_GEOMETRY = f"kinematics inverse_kinematics {_DYNAMICS} {_ROBOTS}"
_BODIES = f"{_DYNAMICS} {_ROBOTS} water"
#: URDF and xacro have no displaced water.
_WATER = f"{_DYNAMICS} mjcf sdf water"
#: Kind of key -> what is written, and the products that it changes. Every key changes
#: the record and the arm file that is written of it.
KINDS = {
    "name": ('name = "other"', "urdf xacro mjcf sdf srdf"),
    "corrections": ("corrections = []", f"{_DYNAMICS} {_ROBOTS} srdf"),
    "mount.parent": ('[mount]\nparent = "rov"', _ROBOTS),
    "mount.xyz": ("[mount]\nxyz = [0.1, 0, 0]", _ROBOTS),
    "mount.rpy": ("[mount]\nrpy = [0.1, 0.2, 0]", f"{_DYNAMICS} {_ROBOTS}"),
    "lengths": ("[lengths]\na_1 = 0.152", f"{_GEOMETRY} srdf"),
    "zeros": ("[zeros]\naxis_c = 0.05", f"{_GEOMETRY} srdf"),
    "min_position": (
        "[joint_limits.axis_c]\nmin_position = 0.1",
        f"limits inverse_kinematics c_code srdf trajectory viewer {_ROBOTS}",
    ),
    "max_velocity": (
        "[joint_limits.axis_c]\nmax_velocity = 0.12",
        f"limits trajectory viewer {_ROBOTS}",
    ),
    "max_acceleration": ("[joint_limits.axis_c]\nmax_acceleration = 0.5", "xacro"),
    "max_jerk": ("[joint_limits.axis_c]\nmax_jerk = 5", "xacro"),
    "signs": ("[signs]\naxis_c = -1", "devices recordings"),
    "max_effort": (
        "[joint_limits.axis_c]\nmax_effort = 1.5",
        f"limits trajectory sweep {_ROBOTS}",
    ),
    "range of the jaws": (
        "[joint_limits.axis_a]\nmax_position = 0.0132",
        f"srdf trajectory viewer {_ROBOTS}",
    ),
    "mass": ("[links.link_2]\nmass = 0.39", _BODIES),
    "com": ("[links.link_2]\ncom = [0.074, 0.001, 0]", _BODIES),
    "inertia": (
        "[links.link_2]\ninertia = [[9e-5, 0, 0], [0, 9e-4, 0], [0, 0, 9e-4]]",
        # An arm at rest, as a page shows it, has no moments of inertia.
        f"{_DYNAMICS} {_ROBOTS}".replace("viewer", ""),
    ),
    "volume": ("[links.link_2]\nvolume = 2e-4", _WATER),
    "cob": ("[links.link_2]\ncob = [0.074, 0.001, 0]", _WATER),
    "tool.xyz": (
        "[tool]\nxyz = [0.004, 0, -0.2]",
        "kinematics inverse_kinematics c_code trajectory sweep viewer " + _ROBOTS,
    ),
    # Paths are those of the tool point.
    "tool.rpy": (
        "[tool]\nrpy = [0.1, 0, 0]",
        f"kinematics c_code viewer {_ROBOTS}",
    ),
    "attached.name": (BODY.replace('"s"', '"t"'), "viewer"),
    "attached.at": (BODY.replace("[0, 0, 0]\nrpy", "[0, 0.01, 0]\nrpy"), _BODIES),
    "attached.mass": (BODY.replace("mass = 0.5", "mass = 0.6"), _BODIES),
    "attached.volume": (BODY.replace("volume = 1e-4", "volume = 2e-4"), _WATER),
    "attached.spacer": (
        BODY.replace("spacer = 0.01", "spacer = 0.02"),
        f"{_GEOMETRY} water",
    ),
    "supply_voltage": ("[motors]\nsupply_voltage = 23", "trajectory"),
    "constants": ('[motors]\nconstants = "torque"', "motors trajectory sweep"),
    "current_limit": ("[motors]\ncurrent_limit = {axis_c = 1.2}", "trajectory"),
    "rotor_inertia": (
        "[motors]\nrotor_inertia = {axis_c = 5e-7}",
        "motors trajectory sweep urdf xacro mjcf sdf",
    ),
    "friction": (
        "[motors]\nfriction = {axis_c = 0.003}",
        "motors trajectory sweep urdf xacro mjcf sdf",
    ),
    "resistance": ("[motors]\nresistance = {axis_c = 1.1}", "motors trajectory sweep"),
}

Q = np.array([2.9, 1.1, 1.7, 2.0])
V = np.array([0.3, -0.2, 0.4, 0.5])
A = np.array([0.5, 0.4, -0.3, 0.2])


def plain(value: Any) -> Any:
    """A product as lists and numbers without the last bits."""
    if dataclasses.is_dataclass(value):
        return {k: plain(v) for k, v in vars(value).items()}
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, tuple | list):
        return [plain(x) for x in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, float | np.floating):
        return float(f"{value:.10g}") if abs(value) > 1e-13 else 0.0
    return value


def record(arm: Alpha5Parameters) -> Any:
    names = [field.name for field in dataclasses.fields(arm)]
    return {name: getattr(arm, name) for name in names if name != "measurements"}


def written(arm: Alpha5Parameters) -> Any:
    return arm_file_text(arm)


def limits(arm: Alpha5Parameters) -> Any:
    return a5.load(arm=arm).limits


def devices(arm: Alpha5Parameters) -> Any:
    return a5.devices_from_q(Q, arm)


def recordings(arm: Alpha5Parameters) -> Any:
    lines = ["time_secs," + ",".join(f"axis_{x}_pos" for x in "edcb")]
    lines += [f"{k / 10},{2 + k / 100},1.1,1.7,2.0" for k in range(9)]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "motion.csv")
        file.write_text("\n".join(lines), encoding="utf-8")
        # The driver of a joint with another sign is out of range, which is a warning.
        return a5.trajectory.read_motion(file, arm=arm).position


def inverse_kinematics(arm: Alpha5Parameters) -> Any:
    rng = np.random.default_rng(2)
    targets = rng.uniform(-0.35, 0.35, (60, 3))
    wrists = np.resize([0.05, 2.0, 6.2], len(targets))
    solved = a5.inverse_kinematics(targets, wrists, arm=arm)
    return [solved.q, solved.within_limits]


def dynamics(arm: Alpha5Parameters) -> Any:
    loaded = a5.load(arm=arm)
    return [loaded.inverse_dynamics(Q, V, A), loaded.base_wrench(Q, V, A).vector]


def kinematics(arm: Alpha5Parameters) -> Any:
    return a5.load(arm=arm).forward_kinematics(Q).homogeneous


def kernels(arm: Alpha5Parameters) -> Any:
    loaded = a5.load(arm=arm)
    state = [np.array([x]) for x in (Q, V, A)]
    return [loaded.inverse_dynamics_batch(*state), loaded.base_wrench_batch(*state)]


def moving_water(arm: Alpha5Parameters) -> Any:
    wet = a5.load(arm=arm).with_hydrodynamics()
    return [wet.inverse_dynamics(Q, V, A), wet.base_wrench(Q, V, A).vector]


def motors(arm: Alpha5Parameters) -> Any:
    motor = a5.actuators.actuator("axis_c", arm=arm)
    turning = None if motor.rotor_inertia is None else 2.0
    current = motor.current(0.5, 0.2, turning)
    return [current, motor.voltage(current, 0.2, 3.0)]


def c_code(arm: Alpha5Parameters) -> Any:
    from alpha5_model.codegen.c_library import COptions, c_files

    files = c_files(COptions(arm=arm))
    return re.sub(rb"/\*.*?\*/", b"", files["alpha5.c"], flags=re.DOTALL)


def urdf(arm: Alpha5Parameters) -> Any:
    from alpha5_model.description.urdf import Variant, urdf

    return ET.canonicalize(urdf(Variant(arm=arm, gripper="jaws")))


def xacro(arm: Alpha5Parameters) -> Any:
    from alpha5_model.description.xacro_parameters import parameter_yaml

    content = yaml.safe_load(parameter_yaml(arm))
    del content["provenance"]
    return content


def srdf(arm: Alpha5Parameters) -> Any:
    from alpha5_model.description.srdf import srdf

    return srdf("jaws", arm)


def mjcf(arm: Alpha5Parameters) -> Any:
    from alpha5_model.description.mjcf import MjcfOptions, mjcf

    options = MjcfOptions(arm=arm, gripper="jaws", actuators="velocity")
    return ET.canonicalize(mjcf(options))


def sdf(arm: Alpha5Parameters) -> Any:
    from alpha5_model.description.sdf import SdfOptions, sdf

    return ET.canonicalize(sdf(SdfOptions(arm=arm, gripper="jaws")))


def water(arm: Alpha5Parameters) -> Any:
    from alpha5_model.description.water_table import WaterOptions, water_table

    return water_table(WaterOptions(arm=arm))["links"]


def trajectory(arm: Alpha5Parameters) -> Any:
    time = np.linspace(0.0, 8.0, 81)
    q = 3.0 + 4.5 * np.sin(np.outer(time, [0.5, 0.7, 0.9, 1.1]))
    rod = 0.005 + 0.02 * np.sin(time)
    motion = a5.trajectory.motion(time, np.column_stack([q, rod]), arm=arm)
    lead = a5.actuators.actuator("axis_a", screw_lead=1e-3, arm=arm)
    loaded = a5.load(gripper="jaws", arm=arm)
    analysis = a5.trajectory.analyse(motion, loaded, actuators={"axis_a": lead})
    return {**a5.trajectory.summary(analysis), "model": None}


def sweep(arm: Alpha5Parameters) -> Any:
    import pyarrow.parquet

    joints = "".join(
        f"axis_{x}_pos = [1.1, 2.0]\naxis_{x}_vel = 0.1\naxis_{x}_acc = 1\n"
        for x in "edcb"
    )
    outputs = "".join(
        f'[outputs.{name}]\nquantity = "{name}"\nas = "table"\n'
        for name in ("torque", "current", "power", "margin", "mount_moment", "reach")
    )
    with tempfile.TemporaryDirectory() as folder:
        study = Path(folder, "study.toml")
        study.write_text(f"[axes]\n{joints}{outputs}", encoding="utf-8")
        a5.sweep(study, Path(folder, "out"), arm=arm)
        rows = pyarrow.parquet.read_table(Path(folder, "out", "rows"))
        return {name: rows[name].to_numpy().sum() for name in rows.column_names}


def viewer(arm: Alpha5Parameters) -> Any:
    from alpha5_model.viewer.build import build_scene
    from alpha5_model.viewer.page import page_data

    data = page_data(build_scene(a5.load(gripper="jaws", arm=arm)))
    return {**data, "notes": None}


#: Products that need no URDF, and no more than 20 ms an arm.
QUICK = (record, written, devices, recordings, inverse_kinematics, motors, sdf)
OTHERS = (
    limits,
    kinematics,
    dynamics,
    kernels,
    moving_water,
    urdf,
    xacro,
    srdf,
    mjcf,
    water,
    trajectory,
    sweep,
    viewer,
)


@pytest.fixture(scope="module")
def arms(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Alpha5Parameters]:
    """The arm of each kind's file, and what the other files differ from."""
    file = tmp_path_factory.mktemp("arms") / "arm.toml"
    texts = {kind: text for kind, (text, _) in KINDS.items()}
    read = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", a5.errors.ImplausibleWarning)
        for kind, text in {**texts, "nothing": "", "attached": BODY}.items():
            # Products name an arm that is not the catalogue's.
            own = "" if kind == "name" else 'name = "mine"'
            file.write_text(f"format = 1\n{own}\n{text}", encoding="utf-8")
            read[kind] = a5.arm_file(file)
    return read


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@pytest.mark.parametrize(
    "product",
    [
        *QUICK,
        *(pytest.param(other, marks=pytest.mark.slow) for other in OTHERS),
        pytest.param(c_code, marks=pytest.mark.tools),
    ],
    ids=lambda product: product.__name__,
)
def test_a_key_changes_what_it_concerns(
    product: Callable[[Alpha5Parameters], Any], arms: dict[str, Alpha5Parameters]
) -> None:
    before = {kind: plain(product(arms[kind])) for kind in ("nothing", "attached")}
    name = product.__name__
    wrong = []
    for kind, (_, concerned) in KINDS.items():
        base = "attached" if kind.startswith("attached") else "nothing"
        changes = plain(product(arms[kind])) != before[base]
        if changes != (name in ("record", "written", *concerned.split())):
            wrong.append(f"{kind}: {changes=}")
    assert wrong == []


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
def test_every_arm_comes_back_from_the_file_that_is_written_of_it(
    arms: dict[str, Alpha5Parameters], tmp_path: Path
) -> None:
    file = tmp_path / "arm.toml"
    wrong = []
    for kind, arm in arms.items():
        file.write_text(arm_file_text(arm), encoding="utf-8")
        if plain(record(a5.arm_file(file))) != plain(record(arm)):
            wrong.append(kind)
    assert wrong == []
