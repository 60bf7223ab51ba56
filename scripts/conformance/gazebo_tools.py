"""Checks of `real_tools` by libsdformat, ignition-physics, Drake, and placo.

placo needs a Python of its own.
"""

from __future__ import annotations

import json
import os
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from conformance.conformance import installed
from conformance.own_python import bare, own_python
from conformance.ros_tools import NotThereError, Result, Workspace

import alpha5_model as a5
from alpha5_model._support.paths import URDF_PATH
from alpha5_model._support.writing import atomic_write
from alpha5_model.description.sdf import SdfOptions, sdf, sdf_files
from alpha5_model.numbers.parameters import parameters

PLUGIN = "/usr/lib/x86_64-linux-gnu/libignition-physics5-dartsim-plugin.so"
_SOURCE = Path(__file__).with_name("ignition_dart.cpp")
_LIBRARIES = [
    "ignition-physics5",
    "ignition-physics5-sdf",
    "ignition-plugin1-loader",
    "sdformat12",
]
#: With its own Pinocchio: placo's wheels are built for one below 4.
_PLACO = "placo==0.10.2"
_ASK_PLACO = """
import json, sys
import numpy as np, placo
arm = placo.RobotWrapper(sys.argv[1])
asked = json.load(sys.stdin)
rows = []
for q in asked["q"]:
    for name, angle in zip(asked["joints"], q):
        arm.set_joint(name, angle)
    arm.update_kinematics()
    order = [arm.get_joint_v_offset(name) for name in asked["joints"]]
    rows.append([
        arm.get_T_world_frame("tcp").tolist(),
        arm.mass_matrix()[np.ix_(order, order)].tolist(),
        arm.generalized_gravity()[order].tolist(),
        arm.get_T_world_frame("base_link").tolist(),
    ])
print("answer", json.dumps(rows))
"""


def validate(work: Workspace) -> Result:
    """``ign sdf`` on every file, and on one whose joint has an unknown parent."""
    complaints, count = [], 0
    for gripper in ("locked", "jaws"):
        for name, content in sdf_files(SdfOptions(gripper)).items():
            file = atomic_write(work.folder / gripper / name, content)
            if name.endswith(".sdf"):
                count += 1
                if said := _complaint(file):
                    complaints.append(f"{gripper}/{name}: {said}")
    broken = sdf().replace("<parent>link_2</parent>", "<parent>link_9</parent>")
    if not _complaint(atomic_write(work.folder / "broken.sdf", broken)):
        complaints.append("a broken file is valid")
    return Result(f"{count} files valid", complaints=tuple(complaints))


def _complaint(file: Path) -> str:
    """What libsdformat says of a file beside that it is valid."""
    configured = {"IGN_CONFIG_PATH": "/usr/share/ignition", **os.environ}
    done = subprocess.run(
        ["ign", "sdf", "-k", str(file)],
        capture_output=True,
        text=True,
        check=False,
        env=configured,
    )
    said = [
        line
        for line in (done.stdout + done.stderr).splitlines()
        if "backward.so" not in line
    ]
    return "" if "Valid." in said[-1:] and len(said) == 1 else " ".join(said)


def step(work: Workspace) -> Result:
    """Fall freely in air for a tenth of a millisecond, from each of 100 states."""
    program, world, states = (
        work.folder / name for name in ("dart", "dart.sdf", "states.txt")
    )
    flags = subprocess.run(
        ["pkg-config", "--cflags", "--libs", *_LIBRARIES],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.split()
    subprocess.run(
        ["g++", "-std=c++17", str(_SOURCE), "-o", str(program), *flags],
        capture_output=True,
        text=True,
        check=True,
    )
    world.write_text(_world(), encoding="utf-8")
    joints, rng = parameters().joints[:4], np.random.default_rng(2022)
    q = rng.uniform([j.lower for j in joints], [j.upper for j in joints], (100, 4))
    # DART keeps speeds within their limits: ours stay away from these
    v = rng.uniform(-0.5, 0.5, (100, 4)) * [j.velocity for j in joints]
    np.savetxt(states, np.hstack([q, v]), fmt="%.17g")
    done = subprocess.run(
        [str(program), PLUGIN, str(world), str(states)],
        capture_output=True,
        text=True,
        check=True,
    )
    found = np.array([line.split() for line in done.stdout.splitlines()], dtype=float)
    arm, still = a5.load(fluid_density=0.0), np.zeros(4)
    expected = [
        [
            *arm.forward_dynamics(x, speed, still),
            *arm.forward_kinematics(x, frame="link_4").homogeneous.ravel(),
        ]
        for x, speed in zip(q, v, strict=True)
    ]
    errors = np.abs(found - expected)
    largest = np.abs(expected)[:, :4].max()
    text = (
        f"{errors[:, :4].max():.0e} of up to {largest:.0f}; {errors[:, 4:].max():.0e}"
    )
    said = tuple(
        line
        for line in done.stderr.splitlines()
        if "robot" not in line and "at line" not in line
    )
    return Result(text, float(errors.max()), said)


def _world() -> str:
    """Our model, its base fixed in a world without water."""
    model = ET.fromstring(sdf()).find("model")
    assert model is not None
    mount = ET.SubElement(model, "joint", name="mount", type="fixed")
    for tag, name in (("parent", "world"), ("child", "link_0")):
        ET.SubElement(mount, tag).text = name
    return (
        '<?xml version="1.0"?><sdf version="1.9"><world name="air">'
        '<gravity>0 0 -9.81</gravity><physics name="step" type="ignored">'
        "<max_step_size>0.0001</max_step_size></physics>"
        f"{ET.tostring(model, encoding='unicode')}</world></sdf>"
    )


def follow(work: Workspace) -> Result:
    """Drake's libsdformat, the newest to be had: SDF 1.11 with what 1.9 has not."""
    if not installed("pydrake"):
        raise NotThereError("pydrake is not installed")
    from importlib.metadata import version

    texts = {
        f"{gripper} {hydrodynamics}": sdf(
            SdfOptions(gripper, hydrodynamics=hydrodynamics, sdf_version="1.11")
        )
        for gripper in ("locked", "jaws")
        for hydrodynamics in (False, True)
    }
    complaints = [
        f"{name}: {said}" for name, text in texts.items() if (said := _refused(text))
    ]
    wrong = texts["jaws False"].replace(
        '<mimic joint="axis_a"', '<mimic joint="axis_z"'
    )
    if not _refused(wrong):
        complaints.append("a mimic of a joint that is not there is taken")
    return Result(
        f"{len(texts)} files taken",
        complaints=tuple(complaints),
        version=version("drake"),
    )


def _refused(text: str) -> str:
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.0)  # the parser does not keep it
    try:
        Parser(plant).AddModelsFromString(text, "sdf")
    except RuntimeError as error:
        return str(error)
    return ""


def placo(work: Workspace) -> Result:
    """In an environment of its own."""
    python = own_python(work.folder / "placo", _PLACO)
    joints = parameters().joints[:4]
    q = np.random.default_rng(2022).uniform(
        [j.lower for j in joints], [j.upper for j in joints], (100, 4)
    )
    done = subprocess.run(
        [python, "-c", _ASK_PLACO, URDF_PATH],
        input=json.dumps({"q": q.tolist(), "joints": [j.name for j in joints]}),
        capture_output=True,
        text=True,
        check=True,
        env=bare(),
    )
    (answer,) = (line for line in done.stdout.splitlines() if line.startswith("answer"))
    arm, worst = a5.load(fluid_density=0.0), np.zeros(3)
    for x, (tip, mass, gravity, base) in zip(q, json.loads(answer[6:]), strict=True):
        pose = np.linalg.inv(base) @ tip
        expected = (
            arm.forward_kinematics(x).homogeneous,
            arm.mass_matrix(x),
            arm.gravity_torque(x),
        )
        found = pose, np.array(mass), np.array(gravity)
        errors = [np.abs(a - b).max() for a, b in zip(found, expected, strict=True)]
        worst = np.maximum(worst, errors)
    text = ", ".join(f"{error:.0e}" for error in worst)
    # At zero the arm does touch itself.
    printed = " ".join((done.stdout.partition("answer")[0] + done.stderr).split())
    pairs = f", {printed.count(' collides with ')} pairs of shapes"
    said = (printed.partition(": -")[0] + pairs,) if "WARNING" in printed else ()
    version = f"{_PLACO.partition('==')[2]}, own Pinocchio"
    return Result(text, float(worst.max()), version=version, warnings=said)
