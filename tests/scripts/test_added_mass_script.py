"""The script behind the numbers of moving water: bodies, panels and strips.

Added mass has a second calculation here.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from alpha5_model.numbers.hydrodynamics import hydrodynamics

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    from hydrodynamics import added_mass

    return added_mass


def test_the_committed_strips_are_those_of_the_bodies(script: ModuleType) -> None:
    kept = tomllib.loads(script.FILE.read_text("utf-8"))["bodies"]
    assert list(kept) == list(script.solids())
    for name, body in kept.items():
        for strip, (start, end, diameter) in zip(
            body["strips"], script.strips(name), strict=True
        ):
            numbers = np.array(
                [*strip["start"], *strip["end"], strip["diameter"]], dtype=float
            )
            assert numbers == pytest.approx([*start, *end, diameter], abs=0.051), name


def test_the_file_is_what_the_script_writes(script: ModuleType) -> None:
    kept = tomllib.loads(script.FILE.read_text("utf-8"))["bodies"]
    numbers = {
        name: np.array(body["added_mass"], dtype=float) for name, body in kept.items()
    }
    assert script.toml(numbers) == script.FILE.read_text("utf-8")


def test_the_interval_covers_the_whole_arm_but_folded(script: ModuleType) -> None:
    """Low to high is wider than the influence of the bodies on one another.

    That holds along the arm, too, where most is missing.
    """
    kept = tomllib.loads(script.FILE.read_text("utf-8"))["bodies"]
    low, _, high = np.array(
        [body["added_mass_factor"] for body in kept.values()], dtype=float
    ).T
    poses = tomllib.loads(script.COMPARISON.read_text("utf-8"))
    assert {"extended"} <= {*poses} <= {*script.POSES}
    covered = {}
    for name, pose in poses.items():
        ratios = np.array([*pose["base"], *pose["joints"]])
        covered[name] = low.max() <= ratios.min() and ratios.max() <= high.min()
    assert all(covered[name] == (name != "folded") for name in poses)
    along, *others = poses["extended"]["base"] + poses["extended"]["joints"]
    assert (
        along < 0.9
    )  # of the smallest of the three: ends that face one another push no water
    assert others == pytest.approx([1.0] * len(others), abs=0.1)
    assert max(poses["extended"]["missing"]) < 0.1
    whole, parts = np.reshape(poses["extended"]["kg"], (2, 3))
    assert whole / parts == pytest.approx(poses["extended"]["base"][:3], abs=6e-3)


def by_sources(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Added mass by a source on each panel [Hess1967].

    A source is a point as seen from the other panels, and a disc as seen from its own.

    [Hess1967] Hess, Smith: Calculation of potential flow about arbitrary bodies.
    """
    a, b, c = vertices[triangles].swapaxes(0, 1)
    normal = np.cross(b - a, c - a) / 2
    area = np.linalg.norm(normal, axis=1)
    normal, centre = normal / area[:, None], (a + b + c) / 3
    gap = centre[:, None] - centre
    distance = np.linalg.norm(gap, axis=2)
    np.fill_diagonal(distance, 1.0)
    flux = np.einsum("ix,ijx->ij", normal, gap) * area / (4 * np.pi * distance**3)
    # All flux of a source leaves through the body, nearly half of it by its own panel.
    np.fill_diagonal(flux, 0.0)
    np.fill_diagonal(flux, 1.0 - (area[:, None] * flux).sum(axis=0) / area)
    potential = area / (4 * np.pi * distance)
    np.fill_diagonal(potential, np.sqrt(area / np.pi) / 2)
    motions = np.hstack([normal, np.cross(centre, normal)])
    strength = np.linalg.solve(flux, motions)
    return 1000.0 * np.einsum("ia,i,ib->ab", motions, area, potential @ strength)


def test_a_sphere_by_sources(script: ModuleType) -> None:
    pytest.importorskip("pymeshlab", exc_type=ImportError)
    from alpha5_model.geometry.solid import kernel

    ball = kernel().Manifold.sphere(20.0, 96)
    matrix = by_sources(*script.panels(ball, 5.0)) / (1000.0 * ball.volume() * 1e-9)
    assert np.diag(matrix)[:3] == pytest.approx([0.5] * 3, rel=0.03)


@pytest.mark.parametrize(("name", "size"), [("link_2", 4.5), ("wrist", 5.0)])
def test_added_mass_by_sources(script: ModuleType, name: str, size: float) -> None:
    """Within 8 %, but for the turn about the body's own axis, which moves little water.

    Points do not see walls thinner than a panel, which the other bodies have.
    """
    pytest.importorskip("pymeshlab", exc_type=ImportError)
    ours = (
        hydrodynamics("jaws")["link_4"].added_mass
        if name == "wrist"
        else hydrodynamics()[name].added_mass
    )
    other = np.diag(by_sources(*script.panels(script.solids()[name], size)))
    ratio = other / np.diag(ours)
    counted = np.diag(ours) > [0, 0, 0, *[0.05 * np.diag(ours)[3:].max()] * 3]
    assert ratio[counted] == pytest.approx(1.0, abs=0.08)
