"""The example in C++ of the closed form, compiled and compared with Python."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from fk import fk
from reference import LOWER, UPPER

from alpha5_model.cli import main

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
pytestmark = pytest.mark.tools
PROGRAM = r"""
#include <cstdio>
#include "nearest_ik.hpp"

int main() {
  std::array<double, 3> tcp;
  alpha5::Joints seed;
  while (std::scanf("%lf %lf %lf %lf %lf %lf %lf", &tcp[0], &tcp[1], &tcp[2], &seed[0],
                    &seed[1], &seed[2], &seed[3]) == 7) {
    const auto q = alpha5::nearest(tcp, seed);
    if (q) std::printf("%.17g %.17g %.17g %.17g\n", (*q)[0], (*q)[1], (*q)[2], (*q)[3]);
    else std::printf("none\n");
  }
}
"""


@pytest.fixture(scope="module")
def program(tmp_path_factory) -> Path:
    if shutil.which("g++") is None or shutil.which("gcc") is None:
        pytest.skip("no compiler here")
    pytest.importorskip("casadi", reason="CasADi writes the C library")
    folder = tmp_path_factory.mktemp("cpp")
    assert main(["generate", "c", "--output", str(folder)]) == 0
    (folder / "main.cpp").write_text(PROGRAM, encoding="utf-8")
    strict = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    for command in (
        ["gcc", "-std=c99", "-O1", "-c", "alpha5.c", "-o", "alpha5.o"],
        [
            *("g++", "-std=c++17", "-O1", *strict, "-I.", f"-I{EXAMPLES}"),
            *("main.cpp", "alpha5.o", "-lm", "-o", "main"),
        ],
    ):
        subprocess.run(command, check=True, capture_output=True, cwd=folder)
    return folder / "main"


def answers(program: Path, targets: np.ndarray, seeds: np.ndarray) -> list[str]:
    rows = np.hstack([targets, seeds])
    text = "\n".join(" ".join(repr(float(x)) for x in row) for row in rows)
    done = subprocess.run(
        [str(program)], input=text, capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()


def test_from_a_seed_nearby_it_comes_back_to_where_the_arm_was(program):
    """Forward kinematics of the printed table is the other route."""
    rng = np.random.default_rng(3)
    margin = 0.02
    q = rng.uniform(np.add(LOWER, margin), np.subtract(UPPER, margin), (300, 4))
    seeds = q + rng.uniform(-0.01, 0.01, q.shape)
    seeds[:, 3] = q[:, 3]
    found = answers(program, fk(q)[:, :3, 3], seeds)
    solutions = np.array([[float(x) for x in row.split()] for row in found])
    reached = fk(solutions)[:, :3, 3]
    np.testing.assert_allclose(reached, fk(q)[:, :3, 3], atol=1e-12)
    # Another branch can be nearer only at the edge of reach, where two meet.
    same = np.abs(solutions - q).max(axis=1) < 1e-6
    assert same.mean() > 0.98
    moved = np.abs(solutions - seeds).max(axis=1)
    assert np.all(moved <= 0.01 + 1e-9)


def test_every_solution_is_within_the_limits_and_none_is_nearer(program):
    rng = np.random.default_rng(4)
    q = rng.uniform(LOWER, UPPER, (200, 4))
    seeds = rng.uniform(LOWER, UPPER, (200, 4))
    seeds[:, 3] = q[:, 3]
    found = answers(program, fk(q)[:, :3, 3], seeds)
    solutions = np.array([[float(x) for x in row.split()] for row in found])
    assert np.all(solutions >= np.subtract(LOWER, 1e-9))
    assert np.all(solutions <= np.add(UPPER, 1e-9))
    own = np.abs(q - seeds).max(axis=1)
    assert np.all(np.abs(solutions - seeds).max(axis=1) <= own + 1e-9)


def test_a_target_out_of_reach_has_none(program):
    targets = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.6]])
    assert answers(program, targets, np.ones((2, 4))) == ["none", "none"]
