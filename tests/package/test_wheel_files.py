"""The files that a wheel has in another form than a checkout."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.description import committed

ROOT = Path(REPOSITORY_PATH)


@pytest.mark.slow
def test_a_wheel_has_the_meshes_once_and_mujoco_finds_them(tmp_path, monkeypatch):
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    build = runpy.run_path(str(ROOT / "hatch_build.py"))
    folder = tmp_path / "mjcf"
    folder.mkdir()
    (tmp_path / "meshes").symlink_to(ROOT / "meshes")
    places = build["mjcf_files"](folder)
    assert not any(file.is_dir() for file in folder.iterdir())
    assert {Path(place).name for place in places.values()} == {
        file.name for file in (ROOT / "mjcf").iterdir() if file.is_file()
    }
    for name in ("scene.xml", "scene_jaws.xml", "scene_mjx.xml"):
        assert mujoco.MjModel.from_xml_path(str(folder / name)).nmesh == 7

    # An installed package expects these files, to the byte.
    monkeypatch.setattr(committed, "_in_checkout", lambda: False)
    expected = committed.generated_files()
    for path, content in expected.items():
        if path.startswith("mjcf/"):
            assert (tmp_path / path).read_bytes() == content
    assert not any(path.startswith("mjcf/assets/") for path in expected)
