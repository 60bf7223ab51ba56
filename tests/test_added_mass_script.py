"""The script behind the numbers of moving water: its bodies, panels and strips, and a second calculation of added mass."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from alpha5_model.hydrodynamics import hydrodynamics

SCRIPTS = Path(__file__).resolve().parent.parent / "scripts"


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    monkeypatch.setitem(sys.modules, "capytaine", SimpleNamespace())  # a development tool
    import added_mass

    return added_mass


def test_the_committed_strips_are_those_of_the_bodies(script: ModuleType) -> None:
    kept = tomllib.loads(script.FILE.read_text("utf-8"))["bodies"]
    assert list(kept) == list(script.solids())
    for name, body in kept.items():
        for strip, (start, end, diameter) in zip(body["strips"], script.strips(name), strict=True):
            numbers = np.array([*strip["start"], *strip["end"], strip["diameter"]], dtype=float)
            assert numbers == pytest.approx([*start, *end, diameter], abs=0.051), name


def test_the_file_is_what_the_script_writes(script: ModuleType) -> None:
    kept = tomllib.loads(script.FILE.read_text("utf-8"))["bodies"]
    numbers = {name: np.array(body["added_mass"], dtype=float) for name, body in kept.items()}
    assert script.toml(numbers) == script.FILE.read_text("utf-8")


def test_carried_water_is_a_rigid_body(script: ModuleType) -> None:
    """A box of 20 x 40 x 60 mm, whose inertia is known, off the origin."""
    from alpha5_model.meshing.solid import box

    inertia = script.carried_water(box((10, -20, 0), (30, 20, 60)))
    mass, (x, y, z) = 0.048, np.array([0.02, 0.0, 0.03])
    own = mass / 12 * np.diag([0.04**2 + 0.06**2, 0.02**2 + 0.06**2, 0.02**2 + 0.04**2])
    c = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    expected = np.block([[mass * np.eye(3), -mass * c], [mass * c, own - mass * c @ c]])
    assert inertia == pytest.approx(expected, abs=1e-12)


def by_sources(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Added mass by a source on each panel [Hess1967], seen as a point from others, as a disc from itself.

    [Hess1967] Hess, Smith: Calculation of potential flow about arbitrary bodies.
    """
    a, b, c, d = vertices[quads].swapaxes(0, 1)
    normal = np.cross(c - a, d - b) / 2
    area = np.linalg.norm(normal, axis=1)
    normal, centre = normal / area[:, None], (a + b + c + d) / 4
    gap = centre[:, None] - centre
    distance = np.linalg.norm(gap, axis=2)
    np.fill_diagonal(distance, 1.0)
    flux = np.einsum("ix,ijx->ij", normal, gap) * area / (4 * np.pi * distance**3)
    # All that a source sends out leaves through the body: half of it from its own panel, nearly.
    np.fill_diagonal(flux, 0.0)
    np.fill_diagonal(flux, 1.0 - (area[:, None] * flux).sum(axis=0) / area)
    potential = area / (4 * np.pi * distance)
    np.fill_diagonal(potential, np.sqrt(area / np.pi) / 2)
    motions = np.hstack([normal, np.cross(centre, normal)])
    strength = np.linalg.solve(flux, motions)
    return 1000.0 * np.einsum("ia,i,ib->ab", motions, area, potential @ strength)


def test_a_sphere_by_sources(script: ModuleType) -> None:
    from alpha5_model.meshing.solid import kernel

    ball = kernel().Manifold.sphere(20.0, 96)
    vertices, quads = script.panels(ball, 5.0)
    matrix = by_sources(vertices, quads) / (1000.0 * ball.volume() * 1e-9)
    assert np.diag(matrix)[:3] == pytest.approx([0.5] * 3, rel=0.03)


@pytest.mark.parametrize(("name", "size"), [("link_1", 3.5), ("link_2", 4.5), ("wrist", 5.0)])
def test_added_mass_by_sources(script: ModuleType, name: str, size: float) -> None:
    """Within 8 % on each diagonal but the turn about the body's own axis, which moves next to no water."""
    ours = (
        hydrodynamics("jaws")["link_4"].added_mass
        if name == "wrist"
        else hydrodynamics()[name].added_mass
    )
    other = np.diag(by_sources(*script.panels(script.solids()[name], size)))
    ratio = other / np.diag(ours)
    print(name, ratio.round(3))
    counted = np.diag(ours) > [0, 0, 0, *[0.05 * np.diag(ours)[3:].max()] * 3]
    assert ratio[counted] == pytest.approx(1.0, abs=0.08)
