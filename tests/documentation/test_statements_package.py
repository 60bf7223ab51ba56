"""Numbers of README, guides and docstrings about the package itself, computed again."""

from __future__ import annotations

import importlib.util
import math
import re
import sysconfig
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from statement_registry import (
    REPOSITORY,
    AtMost,
    Figure,
    Near,
    Statement,
    one_line,
    parameters_of,
    statement,
    text_of,
)
from test_audit import dexterous_cells
from test_statements_proof import (
    along_the_stretched_arm,
    folded_arm,
    stretched_arm,
    working_arm,
)

import alpha5_model as a5
from alpha5_model.description import mjcf_drag
from alpha5_model.geometry import solid
from alpha5_model.studies.sweep.histograms import QUANTILE_EDGES

PROJECT = tomllib.loads(text_of("pyproject.toml"))["project"]
START = "docs/start.md"


# --- installation --------------------------------------------------------------------


@statement("README.md", "They need only Python {} or later, make and the network")
def python_of_the_readme() -> Sequence[Figure]:
    return [Near(float(PROJECT["requires-python"].removeprefix(">=")))]


@statement(START, "It needs Python {} or later")
def python() -> Sequence[Figure]:
    return [Near(float(PROJECT["requires-python"].removeprefix(">=")))]


def built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compiler: bool
) -> dict[str, Any]:
    """What the build hook tells hatchling, with a compiler and without; nothing is
    compiled here.
    """
    spec = importlib.util.spec_from_file_location(
        "hatch_build", REPOSITORY / "hatch_build.py"
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)

    def compiled(output: Path) -> Path:
        if not compiler:
            raise RuntimeError("no compiler")
        return Path(output) / "_compiled.abi3.so"

    class App:
        def display_warning(self, text: str) -> None:
            assert "NumPy will compute" in text

    monkeypatch.setattr(module, "compiled", compiled)
    monkeypatch.setattr(module.tempfile, "mkdtemp", lambda: str(tmp_path))
    monkeypatch.delenv("ALPHA5_REQUIRE_KERNELS", raising=False)
    monkeypatch.setattr(module.KernelHook, "app", App(), raising=False)
    hook = object.__new__(module.KernelHook)
    data: dict[str, Any] = {"pure_python": True, "tag": None, "force_include": {}}
    hook.initialize("standard", data)
    return data


def kernels_of(wheel: dict[str, Any]) -> list[str]:
    """The compiled kernels among the files that a wheel is given."""
    places = wheel["force_include"].values()
    return [place for place in places if "codegen/kernels" in place]


def test_a_wheel_fits_one_platform_only_if_it_holds_compiled_kernels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = (
        "its name says which: `cp311-abi3-linux_x86_64`. Without a compiler the "
        "wheel is `py3-none-any`"
    )
    assert Statement(START, words, list).found()
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    with_kernels = built(tmp_path, monkeypatch, compiler=True)
    assert with_kernels["tag"] == f"cp311-abi3-{platform}"
    assert not with_kernels["pure_python"]
    assert len(kernels_of(with_kernels)) == 1
    # Left as it was, hatchling's own: py3-none-any.
    without = built(tmp_path, monkeypatch, compiler=False)
    assert without["pure_python"]
    assert without["tag"] is None
    assert kernels_of(without) == []
    for page in ("README.md", START):
        assert "installs anywhere" not in one_line(text_of(page))


def names(requirements: Sequence[str]) -> set[str]:
    """Names of packages, without extras and versions."""
    return {re.split(r"[\[<>=!~ ]", text)[0].lower() for text in requirements}


def test_the_steps_for_windows_install_every_requirement() -> None:
    """Pip has no Pinocchio there: it and what conda brings with it come from
    conda-forge.
    """
    section = text_of(START).partition("## Windows")[2].partition("\n## ")[0]
    (conda,) = re.findall(r"^conda create .* (python=.*)$", section, re.MULTILINE)
    (pip,) = re.findall(
        r"^python -m pip install (?!--no-deps)(.*)$", section, re.MULTILINE
    )
    installed = names(conda.split()) | names(pip.split())
    installed = (installed - {"python", "pinocchio"}) | {"pin"}
    assert installed == names(PROJECT["dependencies"])
    assert "python -m pip install --no-deps ." in section
    assert "docs/start.md#windows" in text_of("README.md")
    assert "Scripts" not in text_of("README.md")


def test_every_extra_has_its_line() -> None:
    table = text_of(START).partition("| extra | for |")[2].partition("\n\n")[0]
    listed = set(
        re.findall(
            r"`([\w-]+)`", re.sub(r"\|[^|\n]*\|$", "|", table, flags=re.MULTILINE)
        )
    )
    assert listed == set(PROJECT["optional-dependencies"])


# --- guides --------------------------------------------------------------------------


@statement(
    "docs/guides/studies.md",
    "the two ends of its bin, which are at most {} % apart",
)
def bins_of_quantiles() -> Sequence[Figure]:
    edges = QUANTILE_EDGES
    return [Near(100 * float((edges[1:] / edges[:-1] - 1).max()))]


@statement("docs/examples.md", "### {} targets and the torque to spare")
def targets_of_the_example() -> Sequence[Figure]:
    text = text_of("examples/torque_margins.py")
    (count,) = re.findall(r"\[:(\d+_\d{3})\]", text)
    return [Near(int(count))]


@statement(
    "docs/guides/recordings.md",
    "frequencies below `--bandwidth` (−3 dB, {} Hz by default)",
)
def bandwidth() -> Sequence[Figure]:
    from alpha5_model.trajectory import smoothing

    return [Near(smoothing.DEFAULT_BANDWIDTH)]


@statement(
    "docs/guides/recordings.md",
    "a bag that expands to more than {} times its size, as no recording does",
)
def expansion_of_bags() -> Sequence[Figure]:
    """How far an arm at rest expands: tests/trajectory/test_trajectory_limits.py."""
    from alpha5_model.trajectory import file_table

    return [Near(file_table.EXPANSION)]


@statement(
    "docs/public-models.md",
    "- Dummy links of {} g with {} kg·m², which is a radius of gyration of one metre",
)
def dummies() -> Sequence[Figure]:
    mass, inertia = 1e-4, 1e-4
    assert math.sqrt(inertia / mass) == 1.0
    return [Near(1e3 * mass), Near(inertia)]


def test_bus_addresses() -> None:
    found = re.findall(
        r"^\| (\d) \| `(axis_\w)` \| (\d) \|$",
        text_of("docs/guides/ros.md"),
        re.MULTILINE,
    )
    joints = a5.published().supplementary.joints
    assert [(int(i), name, int(bus)) for i, name, bus in found] == [
        (i, joint.name, joint.device_id) for i, joint in enumerate(joints)
    ]


# --- docstrings and data -------------------------------------------------------------


@statement(
    "alpha5_model/theory/planar/turning.py",
    "the notes' arm (5, 4, 1) has a dexterous workspace of {}.",
)
def dexterous_area_with_limits() -> Sequence[Figure]:
    return [Near(dexterous_cells(2.967, 0.1), 0.6)]


@statement(
    "alpha5_model/dynamics/actuators.py",
    "K_t is about {} % above K_v for actuators 0 to 2 and half of it for 3 and 4",
)
def constants_of_a_motor() -> Sequence[Figure]:
    motors = a5.parameters().actuators
    ratios = [m.torque_constant / m.voltage_constant for m in motors]
    assert ratios[3:] == pytest.approx([0.5, 0.5], abs=0.01)
    assert ratios[0] == pytest.approx(2 / math.sqrt(3), abs=0.001)
    return [Near(100 * (ratios[0] - 1), 0.5)]


@statement(
    "alpha5_model/dynamics/actuators.py",
    "A gearbox of {}:1 with {} % beside one of {}:1 with {} % speaks for this",
)
def efficiencies() -> Sequence[Figure]:
    first, other = (a5.published().table_4.rows[i] for i in (1, 3))
    return [
        Near(int(first.gear_ratio.value)),
        Near(float(first.efficiency.value)),
        Near(int(other.gear_ratio.value)),
        Near(float(other.efficiency.value)),
    ]


@statement(
    "alpha5_model/description/mjcf_drag.py",
    "With k = {}, its slender drag agrees with that of the strip, ``sin^3 x``, "
    "within {}",
)
def flat_ellipsoid() -> Sequence[Figure]:
    """MuJoCo's slender drag is of what the largest section has beyond the shadow."""
    k = mjcf_drag._FLATNESS
    x = np.linspace(0, np.pi / 2, 2001)
    cos, sin = np.cos(x) ** 2, np.sin(x) ** 2
    shadow = np.sqrt((cos + k**4 * sin) / (cos + k**2 * sin))
    return [
        Near(k),
        AtMost(float(np.abs((1 - shadow) / (1 - k) - np.sin(x) ** 3).max())),
    ]


@statement(
    "alpha5_model/geometry/solid.py",
    "Corners of a full circle of {} mm radius; the chord stays within {} mm of the arc",
)
def chords() -> Sequence[Figure]:
    return [Near(20), AtMost(20 * (1 - math.cos(math.pi / solid.SEGMENTS)))]


HEAD = "alpha5_model/numbers/estimated_hydrodynamics.toml"


@statement(
    HEAD,
    "The stretched arm has {} to {} of what its bodies have alone when it moves # "
    "across itself, turns, or moves a joint; along itself {}: each body",
)
def stretched_arm_in_the_data() -> Sequence[Figure]:
    return [*stretched_arm()[:2], along_the_stretched_arm()[0]]


@statement(
    HEAD,
    "What is missing, {} of {} kg, is {} % of the added mass across, {} kg. A # "
    "working pose has {} to {}; folded it has {} to {}, which the interval does not "
    "cover",
)
def other_poses_in_the_data() -> Sequence[Figure]:
    text = (REPOSITORY / "scripts" / "hydrodynamics" / "whole_arm.toml").read_text(
        "utf-8"
    )
    across = tomllib.loads(text)["extended"]["kg"][4]
    return [
        *along_the_stretched_arm()[1:4],
        Near(across, 0.005),
        *working_arm(),
        *folded_arm(),
    ]


# --- the statements ------------------------------------------------------------------


@pytest.mark.parametrize("item", parameters_of(__name__))
def test_the_page_says_what_is_computed(item: Statement) -> None:
    item.check()
