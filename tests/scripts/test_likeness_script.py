"""The script that compares silhouettes: shapes with known areas, and our own arm."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from alpha5_model._support.paths import REPOSITORY_PATH, URDF_PATH

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
MESHES = Path(REPOSITORY_PATH) / "meshes"


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    pytest.importorskip("manifold3d")
    monkeypatch.syspath_prepend(str(SCRIPTS))
    from checks import likeness

    return likeness


def cube(at: tuple[float, float, float]) -> np.ndarray:
    """Triangles of a cube of 10 mm, some of them turned inwards, (12, 3, 3) [m]."""
    import trimesh

    box = trimesh.creation.box(extents=(0.01, 0.01, 0.01))
    corners = np.array(box.triangles) + at
    corners[::3] = corners[::3, ::-1]
    return corners


def test_silhouettes_of_cubes_have_known_areas(script: ModuleType) -> None:
    one = cube((0.0, 0.0, 0.0))
    along_z = script.silhouette(one, (0.0, 0.0, 1.0))
    assert along_z.area() == pytest.approx(100.0)
    along_diagonal = script.silhouette(one, (1.0, 1.0, 1.0))
    # A regular hexagon, sqrt(3) of a face.
    assert along_diagonal.area() == pytest.approx(100.0 * np.sqrt(3.0))


def test_overlap_of_cubes(script: ModuleType) -> None:
    one = script.silhouette(cube((0.0, 0.0, 0.0)), (0.0, 0.0, 1.0))
    half_aside = script.silhouette(cube((0.005, 0.0, 0.3)), (0.0, 0.0, 1.0))
    apart = script.silhouette(cube((0.02, 0.0, 0.0)), (0.0, 0.0, 1.0))
    assert script.overlap(one, one) == pytest.approx(1.0)
    assert script.overlap(one, half_aside) == pytest.approx(1 / 3)
    assert script.overlap(one, apart) == 0.0


def test_our_own_meshes_are_alike_and_swapped_ones_are_not(
    script: ModuleType,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    two_views = {name: script.VIEWS[name] for name in ("side", "top")}
    monkeypatch.setattr(script, "VIEWS", two_views)
    assert script.main([URDF_PATH, "--meshes", str(MESHES)]) == 0
    assert "1.000, wanted 0.88" in capsys.readouterr().out

    for path in MESHES.glob("*.obj"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    wrist = (MESHES / "link_1.obj").read_bytes()
    (tmp_path / "link_4.obj").write_bytes(wrist)
    assert script.main([URDF_PATH, "--meshes", str(tmp_path)]) == 1


def test_a_missing_mesh_is_named(script: ModuleType, tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"link_\d\.obj|finger_\d\.obj"):
        script.likeness(Path(URDF_PATH), tmp_path)
