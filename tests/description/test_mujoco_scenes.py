"""The model in other people's scenes: included or attached, with their options."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from lazily import Lazy

import alpha5_model as a5
from alpha5_model.description.mjcf import MjcfOptions, mjcf, mjcf_readme

mujoco = Lazy("mujoco", minversion="3.5", reason="MuJoCo 3.5 or later")

#: Where a scene has its options, and the model.
WAYS = ("above the include", "below the include", "attached", "attached in XML")
ATTACH = """
<asset><model name="arm" file="alpha5.xml"/></asset>
<worldbody><attach model="arm" body="base_link" prefix="my_"/></worldbody>
"""
HARMLESS = {
    "": "",
    "boundmass": '<compiler boundmass="{least_mass}"/>',
    "boundinertia": '<compiler boundinertia="{least_moment}"/>',
    "balanceinertia": '<compiler balanceinertia="true"/>',
    "inertiafromgeom": '<compiler inertiafromgeom="true"/>',
    "fusestatic": '<compiler fusestatic="true"/>',
    "discardvisual": '<compiler discardvisual="true"/>',
    "eulerseq": '<compiler eulerseq="zyx"/>',
    "defaults of geoms": '<default><geom density="1000" mass="1"/></default>',
    "joints": (
        '<default><joint damping="1" armature="0.1" frictionloss="1" '
        'range="-1 1"/></default>'
    ),
}
#: Option that harms -> the scene's line, and the ways in which it does.
HARMFUL = {
    "larger ones": ('<compiler boundmass="0.01"/>', WAYS[:2]),
    "settotalmass": ('<compiler settotalmass="5"/>', WAYS),
    "angle": ('<compiler angle="degree"/>', WAYS[1:2]),
    "autolimits": ('<compiler autolimits="false"/>', WAYS[1:2]),
    "<option gravity>": ('<option gravity="0 0 -1.6"/>', WAYS[1:]),
}


@pytest.fixture(autouse=True)
def _elsewhere(monkeypatch, tmp_path) -> None:
    """MuJoCo writes its log of warnings where it stands."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="module", params=["locked", "jaws"])
def arm(request, tmp_path_factory) -> tuple[Path, a5.Arm, str]:
    """The folder of a model, the same arm by Pinocchio, and the folder's README."""
    options = MjcfOptions(gripper=request.param)
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "alpha5.xml").write_text(mjcf(options), "utf-8")
    return folder, a5.load(gripper=request.param), mjcf_readme(options)


def bounds(readme: str) -> dict[str, str]:
    """What the README allows."""
    mass, moment = re.search(
        r"`boundmass` up to (\S+) kg, `boundinertia` up to (\S+) kg m\^2", readme
    ).groups()
    return {"least_mass": mass, "least_moment": moment}


def in_scene(folder: Path, options: str, way: str):
    """The compiled scene."""
    with warnings.catch_warnings():
        # The integrators differ, and `settotalmass` is deprecated.
        warnings.simplefilter("ignore")
        if way == "attached":
            scene = mujoco.MjSpec.from_string(f"<mujoco>{options}</mujoco>")
            child = mujoco.MjSpec.from_file(str(folder / "alpha5.xml"))
            scene.attach(child, prefix="my_", frame=scene.worldbody.add_frame())
            return scene.compile()
        arm = ATTACH if way == "attached in XML" else '<include file="alpha5.xml"/>'
        parts = [options, arm]
        if way == "below the include":
            parts.reverse()
        file = folder / "scene.xml"
        file.write_text(f"<mujoco>{''.join(parts)}</mujoco>", "utf-8")
        return mujoco.MjModel.from_xml_path(str(file))


def harm(model, arm: a5.Arm) -> float:
    """Largest difference in torque, mass matrix and limits; infinite without limits."""
    data = mujoco.MjData(model)
    q = arm.model.lowerPositionLimit.copy()
    q[:4] = [3.1, 1.2, 1.8, 0.5]
    count = arm.model.nq
    driven = [0, 1, 2, 3, 4][: min(count, 5)]
    data.qpos[driven] = q[driven]
    mujoco.mj_forward(model, data)
    matrix = np.zeros((model.nv, model.nv))
    for row, unit in zip(matrix, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    torque = data.qfrc_bias - data.qfrc_passive
    limits = model.jnt_range[driven, 0] - arm.model.lowerPositionLimit[driven]
    differences = [
        torque[:4] - arm.hydrostatic_torque(q)[:4],
        (matrix[:4, :4] - arm.mass_matrix(q)[:4, :4]).ravel(),
        limits,
    ]
    if not model.jnt_limited[driven].all():
        return np.inf
    return float(np.abs(np.concatenate(differences)).max())


def test_what_the_readme_calls_harmless_changes_nothing(arm):
    folder, reference, readme = arm
    rows = [line for line in readme.splitlines() if line.endswith("| nothing |")]
    wrong = {}
    for name, options in HARMLESS.items():
        assert name in " ".join(rows)
        for way in WAYS:
            model = in_scene(folder, options.format(**bounds(readme)), way)
            if (error := harm(model, reference)) > 1e-11:
                wrong[name, way] = error
    assert wrong == {}


def test_what_breaks_the_arm_is_in_the_readme(arm):
    folder, reference, readme = arm
    rows = [line for line in readme.splitlines() if line.startswith("|")]
    for name, (options, ways) in HARMFUL.items():
        (row,) = (line for line in rows if name in line)
        assert not row.endswith("| nothing |")
        for way in WAYS:
            try:
                broken = harm(in_scene(folder, options, way), reference) > 1e-4
            except ValueError:
                broken = True
            assert broken == (way in ways), (name, way)


def test_the_readme_of_the_folder_holds_for_all_its_models():
    folder = Path(a5.paths.MJCF_PATH).parent
    allowed = bounds((folder / "README.md").read_text("utf-8"))
    models = sorted(folder.glob("alpha5*.xml"))
    assert len(models) == 3
    for file in models:
        spec = mujoco.MjSpec.from_file(str(file))
        free = spec.compile()
        spec.compiler.boundmass = float(allowed["least_mass"])
        spec.compiler.boundinertia = float(allowed["least_moment"])
        bound = spec.compile()
        # base_link has no mass, and does not move.
        has_mass = free.body_mass > 0.0
        assert has_mass.sum() > 5
        for name in ("body_mass", "body_inertia"):
            before, after = (getattr(one, name)[has_mass] for one in (free, bound))
            np.testing.assert_array_equal(after, before)
