"""The files that a wheel has in another form than a checkout."""

from __future__ import annotations

import importlib.util
import re
import runpy
import sysconfig
from pathlib import Path
from typing import Any

import pytest

from alpha5_model._support.paths import REPOSITORY_PATH

ROOT = Path(REPOSITORY_PATH)


@pytest.mark.slow
def test_a_wheel_has_the_meshes_once_and_mujoco_finds_them(tmp_path: Path) -> None:
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


def built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compiler: bool
) -> dict[str, Any]:
    """What the build hook tells hatchling; nothing is compiled here."""
    place = ROOT / "hatch_build.py"
    spec = importlib.util.spec_from_file_location("hatch_build", place)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)

    def compiled() -> Path:
        if not compiler:
            raise RuntimeError("no compiler")
        return tmp_path / "_compiled.abi3.so"

    class App:
        def display_warning(self, text: str) -> None:
            assert text

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
    return [place for place in places if "kernels" in place]


def test_a_wheel_fits_one_platform_only_if_it_holds_compiled_kernels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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
