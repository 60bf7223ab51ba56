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


@pytest.mark.slow
def test_the_committed_strips_are_those_of_the_bodies(script: ModuleType) -> None:
    kept = tomllib.loads(script.FILE.read_text("utf-8"))["bodies"]
    assert list(kept) == list(script.solids())
    for name, body in kept.items():
        for strip, drawn in zip(body["strips"], script.strips(name), strict=True):
            numbers = np.array(
                [*strip["start"], *strip["end"], strip["diameter"]], dtype=float
            )
            expected = [*drawn.start, *drawn.end, drawn.diameter]
            assert numbers == pytest.approx(expected, abs=0.051), name
            assert strip["across"] == list(drawn.across)


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_sphere_by_sources(script: ModuleType) -> None:
    pytest.importorskip("pymeshlab", exc_type=ImportError)
    from meshes.solid import kernel

    ball = kernel().Manifold.sphere(20.0, 96)
    matrix = by_sources(*script.panels(ball, 5.0)) / (1000.0 * ball.volume() * 1e-9)
    assert np.diag(matrix)[:3] == pytest.approx([0.5] * 3, rel=0.03)


@pytest.mark.slow
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


#: Body of the file -> link and gripper that have it.
BODIES = {
    **{f"link_{i}": (f"link_{i}", "locked") for i in range(5)},
    "wrist": ("link_4", "jaws"),
    "finger_1": ("finger_1", "jaws"),
    "finger_2": ("finger_2", "jaws"),
}


@pytest.mark.parametrize("name", BODIES)
def test_the_interval_covers_another_shape(script: ModuleType, name: str) -> None:
    """Energy of each motion along and about the axes at the centre.

    Bodies of another shape match the tables as well. Their energy is between low and
    high, without the margin that is there for what the bodies do to one another.
    """
    link, gripper = BODIES[name]
    low, ours, high = (
        hydrodynamics(gripper, level)[link].added_mass
        for level in ("low", "nominal", "high")
    )
    other = script.other_added_mass(name)
    centre = script.centre_of_added_mass(ours)
    for k in range(6):
        axis = np.eye(3)[k % 3]
        spin = axis if k > 2 else np.zeros(3)
        velocity = np.cross(centre, spin) if k > 2 else axis
        motion = np.concatenate([velocity, spin])
        energy = motion @ other @ motion
        assert motion @ low @ motion / 0.75 <= energy + 1e-15
        assert energy <= motion @ high @ motion / 1.25 + 1e-15


def test_the_two_shapes_differ_by_what_is_documented(script: ModuleType) -> None:
    links = hydrodynamics()
    along = script.other_added_mass("link_0")[0, 0] / links["link_0"].added_mass[0, 0]
    assert along == pytest.approx(2.36, abs=0.05)
    axial = script.other_added_mass("link_4")[5, 5] / links["link_4"].added_mass[5, 5]
    assert axial == pytest.approx(0.54, abs=0.03)


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_low_is_below_nominal_below_high_in_every_motion(gripper: str) -> None:
    low, ours, high = (
        hydrodynamics(gripper, level) for level in ("low", "nominal", "high")
    )
    for name in ours:
        for less, more in ((low, ours), (ours, high)):
            difference = more[name].added_mass - less[name].added_mass
            scale = np.sqrt(np.diag(more[name].added_mass))
            relative = difference / np.outer(scale, scale)
            assert np.linalg.eigvalsh(relative).min() > 0


def test_a_flat_section_resists_by_its_sides(script: ModuleType) -> None:
    """From the narrow side to the wide one as a plate, of a box of 20 by 4 mm."""
    box = script.kernel().Manifold.cube([20.0, 80.0, 4.0], True)
    found = script.strip(box, 1, flat=True)
    assert found.diameter == pytest.approx(12.0)
    low, _, high = (float(text) for text in found.across)
    assert low * 12.0 == pytest.approx(0.5 * 4.0, abs=0.06)
    assert high * 12.0 == pytest.approx(2.0 * 20.0, abs=0.6)
    assert script.strip(box, 1).across == script.ACROSS
