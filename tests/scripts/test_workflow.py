"""The workflow of GitHub Actions calls what CI calls anywhere, and builds every wheel.

It cannot run here; `scripts/checks/check_workflow.sh` lints it by actionlint.
"""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
WORKFLOW = yaml.safe_load((ROOT / ".github/workflows/checks.yml").read_text("utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def commands(job: str) -> list[str]:
    steps = WORKFLOW["jobs"][job]["steps"]
    return [step["run"] for step in steps if "run" in step]


def test_it_runs_ci_as_it_is() -> None:
    assert commands("checks") == [".ci/run"]
    assert os.access(ROOT / ".ci" / "run", os.X_OK)


def test_wheels_are_built_on_each_system_and_tried() -> None:
    assert commands("wheels")[-1].startswith("python -m cibuildwheel")
    systems = WORKFLOW["jobs"]["wheels"]["strategy"]["matrix"]["os"]
    assert {name.partition("-")[0] for name in systems} == {"ubuntu", "macos"}
    settings = PROJECT["tool"]["cibuildwheel"]
    assert settings["environment"] == {"ALPHA5_REQUIRE_KERNELS": "1"}
    script = settings["test-command"].removeprefix("python {project}/")
    assert (ROOT / script).is_file()


def test_one_wheel_of_the_stable_interface_fits_every_python() -> None:
    oldest = PROJECT["project"]["requires-python"].removeprefix(">=")
    build = PROJECT["tool"]["cibuildwheel"]["build"]
    assert build == f"cp{oldest.replace('.', '')}-*"
