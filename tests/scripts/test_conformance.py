"""The conformance run: tools agree, are not run if missing, and differ if damaged."""

from __future__ import annotations

import dataclasses
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conformance import conformance
from water_reference import Reference

pytestmark = pytest.mark.slow
BY_NAME = {(tool.name, tool.file): tool for tool in conformance.TOOLS}
COUNT = 40


def needs(tool: conformance.Tool) -> None:
    if not conformance.installed(tool.module):
        pytest.skip(f"{tool.name} is not installed")


@pytest.fixture(scope="module")
def states() -> conformance.States:
    return conformance.random_states(COUNT)


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("generated")
    conformance.write_files(folder)
    return folder


@pytest.fixture(scope="module")
def expected(files, states):
    return conformance.reference(files, states)


def test_the_reference_is_the_typed_table_3(expected, states):
    typed = Reference()
    for i, (q, v) in enumerate(states):
        np.testing.assert_allclose(expected["fk"][i], typed.tcp(q), atol=1e-14)
        np.testing.assert_allclose(
            expected["mass"][i], typed.mass_matrix(q), atol=1e-15
        )
        np.testing.assert_allclose(expected["bias"][i], typed.bias(q, v), atol=1e-14)
        np.testing.assert_allclose(
            expected["buoyancy"][i], typed.buoyancy(q), atol=1e-14
        )
    end, _ = typed.free_motion(*states.start, states.duration, 2 * states.steps)
    np.testing.assert_allclose(expected["trajectory"], end, atol=1e-11)


@pytest.mark.parametrize(
    "tool", conformance.TOOLS, ids=lambda tool: f"{tool.name} {tool.file}"
)
def test_every_installed_tool_agrees(files, states, expected, tool):
    needs(tool)
    row = conformance.measure(tool, files, states, expected)
    if row.status.startswith("not run"):
        pytest.skip(row.status)
    assert row.status == "agrees", row


def test_a_missing_tool_is_not_run_never_passed(files, states, expected):
    ghost = dataclasses.replace(
        BY_NAME["Drake", "URDF"], module="no_such_module.inside"
    )
    row = conformance.measure(ghost, files, states, expected)
    assert row.status == "not run"
    assert row.version == ""


def flip_products(text: str) -> str:
    return re.sub(
        r'(i(?:xy|xz|yz)=")([^"]*)', lambda m: f"{m[1]}{-float(m[2])!r}", text
    )


def round_to(digits: int, text: str) -> str:
    """The text with its long numbers rounded to significant digits."""
    return re.sub(r"-?\d+\.\d{7,}", lambda m: f"{float(m.group()):.{digits}g}", text)


def six_digits(text: str) -> str:
    """A damage that tools in double precision must show."""
    return round_to(6, text)


def three_digits(text: str) -> str:
    """A damage that tools in single precision must show, too."""
    return round_to(3, text)


def lose_the_force(text: str) -> str:
    return re.sub(r' gravcomp="[^"]*"', "", text)


def zero_moments(text: str) -> str:
    """Buoyancy bodies without inertia: Newton raises zeros to 1e-6 kg m^2."""
    return re.sub(r'diaginertia="(\S+) \1 \1"', 'diaginertia="0 0 0"', text)


def lose_the_axes(text: str) -> str:
    """Principal moments about the axes of the link."""
    return re.sub(r"(principalAxes = ).*", r"\1(1, 0, 0, 0)", text)


def turn_a_joint(text: str) -> str:
    return re.sub(r"(localRot0 = ).*", r"\1(1, 0, 0, 0)", text)


def without_zero_inertials(text: str) -> str:
    return re.sub(
        r'<inertial>\s*<origin[^>]*/>\s*<mass value="0"/>.*?</inertial>',
        "",
        text,
        flags=re.S,
    )


DAMAGES = [
    ("MuJoCo", "URDF", "alpha5.urdf", flip_products, {"mass", "bias"}),
    ("MuJoCo", "URDF", "alpha5.urdf", six_digits, {"fk", "mass", "bias"}),
    ("MuJoCo", "MJCF", "mjcf/alpha5.xml", lose_the_force, {"buoyancy"}),
    ("yourdfpy", "URDF", "alpha5.urdf", six_digits, {"fk"}),
    # PyBullet gives a link without <inertial> a mass of 1 kg: here the tcp
    ("PyBullet", "URDF", "alpha5.urdf", without_zero_inertials, {"mass", "bias"}),
    ("Drake", "URDF", "alpha5.urdf", flip_products, {"mass", "bias"}),
    ("Drake", "MJCF", "mjcf/alpha5.xml", six_digits, {"fk"}),
    ("Pinocchio", "MJCF", "mjcf/alpha5.xml", six_digits, {"fk"}),
    ("Newton", "MJCF", "mjcf/alpha5.xml", zero_moments, {"mass"}),
    ("mujoco_warp", "MJCF", "mjcf/alpha5.xml", lose_the_force, {"buoyancy"}),
    ("brax", "MJCF, no buoyancy", "mjcf_brax/alpha5.xml", three_digits, {"fk"}),
    ("DART", "URDF", "alpha5.urdf", flip_products, {"mass", "bias"}),
    ("adam", "URDF", "alpha5.urdf", flip_products, {"mass", "bias"}),
    ("urdf2casadi", "URDF", "alpha5.urdf", flip_products, {"mass", "bias"}),
    ("frax", "URDF", "alpha5.urdf", flip_products, {"mass", "bias"}),
    ("SAPIEN", "URDF, no visuals", "alpha5.urdf", flip_products, {"mass"}),
    ("mink", "MJCF", "mjcf/alpha5.xml", six_digits, {"fk"}),
    ("UsdPhysics", "USD", "alpha5.usda", lose_the_axes, {"mass"}),
    ("UsdPhysics", "USD", "alpha5.usda", turn_a_joint, {"fk", "mass", "bias"}),
    ("Newton", "USD", "alpha5.usda", turn_a_joint, {"fk", "mass", "bias"}),
]


def write_damaged(
    files: Path, folder: Path, path: str, damage: Callable[[str], str]
) -> None:
    """Copy the generated files into a folder and damage one of them."""
    shutil.copytree(files, folder, dirs_exist_ok=True)
    text = (folder / path).read_text("utf-8")
    assert damage(text) != text
    (folder / path).write_text(damage(text), "utf-8")


@pytest.mark.parametrize(
    ("name", "file", "path", "damage", "wrong"),
    DAMAGES,
    ids=[f"{d[0]} {d[1]} {d[3].__name__}" for d in DAMAGES],
)
def test_damage_differs(
    tmp_path, files, states, expected, name, file, path, damage, wrong
):
    tool = BY_NAME[name, file]
    needs(tool)
    write_damaged(files, tmp_path, path, damage)
    row = conformance.measure(tool, tmp_path, states, expected)
    assert row.status == "differs"
    assert wrong <= {
        name for name, error in row.errors.items() if error > tool.bounds[name]
    }


@pytest.mark.parametrize("file", ["mjcf", "mjcf_brax"])
def test_three_digits_exceed_the_bounds_of_every_tool(
    tmp_path, files, states, expected, file
):
    """MuJoCo measures the damage that brax must show; both read the same elements."""
    tool = BY_NAME["MuJoCo", "MJCF"]
    needs(tool)
    sound = tmp_path / "sound"
    damaged = tmp_path / "damaged"
    shutil.copytree(files, sound)
    shutil.copy(files / file / "alpha5.xml", sound / "mjcf")
    write_damaged(sound, damaged, "mjcf/alpha5.xml", three_digits)
    row = conformance.measure(tool, damaged, states, expected)
    loosest = max(tool.bounds["fk"] for tool in conformance.TOOLS)
    assert row.errors["fk"] > 5 * loosest


def nan(files: Path, states: conformance.States) -> dict[str, np.ndarray]:
    return {"fk": np.full((len(states.q), 4, 4), np.nan)}


def nothing(files: Path, states: conformance.States) -> dict[str, np.ndarray]:
    return {}


def wrong_shape(files: Path, states: conformance.States) -> dict[str, np.ndarray]:
    return {"mass": np.zeros(1)}


def crash(files: Path, states: conformance.States) -> dict[str, np.ndarray]:
    raise RuntimeError("two\nlines")


@pytest.mark.parametrize(
    ("compute", "status"),
    [
        (nan, "differs"),
        (nothing, "differs"),
        (wrong_shape, "differs"),
        (crash, "failed"),
    ],
)
def test_nothing_slips_through_as_agreement(files, states, expected, compute, status):
    tool = conformance.Tool("odd", "URDF", "numpy", "numpy", compute)
    row = conformance.measure(tool, files, states, expected)
    assert row.status.startswith(status)
    assert "\n" not in row.status


@pytest.mark.parametrize(
    ("status", "passes", "passes_complete"),
    [
        ("agrees", True, True),
        ("not run", True, False),
        ("not run: built without SDFormat", True, True),
        ("differs", False, False),
        ("failed: out of memory", False, False),
    ],
)
def test_a_complete_run_needs_every_tool(
    status: str, passes: bool, passes_complete: bool
) -> None:
    row = conformance.Row("tool", "URDF", "1.0", {}, status)
    assert conformance.passed(row, complete=False) is passes
    assert conformance.passed(row, complete=True) is passes_complete
