"""Check of `real_tools` by Newton's converter of MuJoCo models to USD.

It has a Python of its own; what it writes is read by `usd_reading`. The converter of
URDFs writes our USD files.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from conformance.conformance import installed
from conformance.own_python import bare, own_python
from conformance.ros_tools import NotThereError, Result, Workspace

import alpha5_model as a5
from alpha5_model._support.paths import MJCF_PATH
from alpha5_model.numbers.parameters import parameters

_VERSION = "0.8.0"
_CONVERT = """
import sys
from mujoco_usd_converter import Converter
print(Converter(layer_structure=False).convert(*sys.argv[1:]).path)
"""
#: Words of the attribute in which MuJoCo's converter keeps buoyancy.
GRAVCOMP = "mjc:body:gravcomp"


def mujoco_converter(work: Workspace) -> Result:
    """Convert the MuJoCo model, read the file, and compare with Pinocchio."""
    if not installed("pxr"):
        raise NotThereError("OpenUSD not there")
    package = f"mujoco-usd-converter=={_VERSION}"
    python = own_python(work.folder / "converters", package)
    folder = work.folder / "mujoco_usd_converter"
    done = subprocess.run(
        [python, "-c", _CONVERT, MJCF_PATH, str(folder)],
        capture_output=True,
        text=True,
        check=True,
        env=bare(),
    )
    (file,) = folder.glob("*.usd*")
    errors, mass = compare(file)
    text = ", ".join(f"{error:.0e}" for error in errors)
    text += f"; {mass:.3f} kg; {water_in(file)}"
    said = [
        line.partition("Warning: ")[2].rpartition(" -- ")[2]
        for line in done.stderr.splitlines() + done.stdout.splitlines()
        if line.startswith("Warning: ")
    ]
    version = f"{_VERSION}, own OpenUSD"
    return Result(text, max(errors), version=version, warnings=tuple(said))


def compare(file: Path) -> tuple[list[float], float]:
    """Largest differences of FK, mass matrix and gravity torque, and the mass [kg]."""
    from conformance.usd_reading import usd_model

    model = usd_model(str(file))
    data = model.createData()
    arm = a5.load(fluid_density=0.0)
    joints = parameters().joints[:4]
    lower, upper = [j.lower for j in joints], [j.upper for j in joints]
    order = [model.joints[model.getJointId(joint.name)].idx_v for joint in joints]
    tip = model.getFrameId("tcp")
    worst = np.zeros(3)
    for q in np.random.default_rng(2022).uniform(lower, upper, (100, 4)):
        position = np.zeros(4)
        position[order] = q
        pin.framesForwardKinematics(model, data, position)
        half = np.triu(pin.crba(model, data, position))
        mass = (half + np.triu(half, 1).T)[np.ix_(order, order)]
        weight = pin.computeGeneralizedGravity(model, data, position)[order]
        pairs: list[tuple[Any, Any]] = [
            (data.oMf[tip].homogeneous, arm.forward_kinematics(q).homogeneous),
            (mass, arm.mass_matrix(q)),
            (weight, arm.gravity_torque(q)),
        ]
        errors = [np.abs(found - expected).max() for found, expected in pairs]
        worst = np.maximum(worst, errors)
    total = sum(body.mass for body in model.inertias)
    return worst.tolist(), float(total)


def water_in(file: Path) -> str:
    """What a stage says of water."""
    from pxr import Usd

    bodies = []
    stage = Usd.Stage.Open(str(file))
    for prim in stage.Traverse():
        attribute = prim.GetAttribute(GRAVCOMP)
        if attribute and attribute.Get():
            bodies.append(prim)
    if not bodies:
        return "no water"
    return f"buoyancy as `{GRAVCOMP}` of {len(bodies)} bodies"
