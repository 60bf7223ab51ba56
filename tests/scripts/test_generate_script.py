"""The generated files of the repository: none is stale, every processor writes them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
#: Drawn by another script.
PICTURES = {"mjcf/alpha5.png"}


def test_the_descriptions_are_fresh() -> None:
    from generate import descriptions, menagerie, stale_files

    texts = descriptions() | menagerie()
    fresh = {path: text.encode() for path, text in texts.items()}
    assert stale_files(REPOSITORY, fresh) == {}


@pytest.mark.slow
def test_every_file_is_fresh_and_generated() -> None:
    """A file that nothing generates any more would become stale unseen."""
    from generate import generated_files, stale_files

    fresh = generated_files()
    assert stale_files(REPOSITORY, fresh) == {}
    found = {
        path.relative_to(REPOSITORY).as_posix()
        for folder in ("meshes", "mjcf", "urdf")
        for path in (REPOSITORY / folder).rglob("*")
        if path.is_file()
    }
    assert found - PICTURES <= set(fresh)


def test_a_stale_file_is_named_and_written(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    import generate

    fresh = {"arm.urdf": b"mass 0.355\nend\n", "b/new.urdf": b"x", "arm.glb": b"\xff"}
    monkeypatch.setattr(generate, "generated_files", lambda: fresh)
    (tmp_path / "arm.urdf").write_text("mass 0.9\nend\n")
    (tmp_path / "arm.glb").write_bytes(b"\xfe\xff")
    assert generate.main(["--check"], tmp_path) == 1
    printed = capsys.readouterr().out
    assert "-mass 0.9\n+mass 0.355\n" in printed
    assert "0 of 3 generated files are fresh" in printed
    assert generate.main([], tmp_path) == 0
    assert {path: (tmp_path / path).read_bytes() for path in fresh} == fresh
    assert generate.main(["--check"], tmp_path) == 0


def test_a_glb_is_stale_if_it_shows_something_else() -> None:
    """Other bytes of JSON do not count, as another trimesh may write them."""
    import trimesh
    from generate import same_content

    def glb(shift: float = 0.0, color: float = 0.5, pose: float = 0.0) -> bytes:
        box = trimesh.creation.box((1.0, 2.0, 3.0))
        box.vertices[0] += shift
        material = trimesh.visual.material.PBRMaterial(
            name="grey", baseColorFactor=[color, color, color, 1.0]
        )
        box.visual = trimesh.visual.TextureVisuals(material=material)
        scene = trimesh.Scene()
        at = trimesh.transformations.translation_matrix((pose, 0.0, 0.0))
        scene.add_geometry(box, node_name="link_0", geom_name="link_0", transform=at)
        return bytes(scene.export(file_type="glb", include_normals=True))

    ours = glb()
    assert same_content(ours, ours.replace(b"mikedh/trimesh", b"mikedh/another"))
    for other in (glb(shift=1e-3), glb(color=0.6), glb(pose=1e-3)):
        assert not same_content(ours, other)


#: Two texts -> whether they are the same content.
PAIRS = {
    ("a 0.0043523456789012", "a 0.0043523456789013"): True,
    ("a 0.0043523456789012", "a 0.0043523567890123"): False,
    ("a 0.00435234568", "a 0.0043523456789"): True,
    ("m 0.355", "m 0.356"): False,
    ("m 0.355", "m 0.35500000000000004"): True,
    ("m 0.35", "m 0.350"): False,
    ("m 1.23456789012", "m -1.23456789012"): False,
    ("link_1 1.5", "link_2 1.5"): False,
    ("1.5 1.5", "1.5"): False,
    ("\xff", "\xfe"): False,
}


def test_only_the_last_digits_of_computed_numbers_may_differ() -> None:
    from generate import same_content

    wrong = [
        pair
        for pair, same in PAIRS.items()
        if same_content(*(text.encode("latin-1") for text in pair)) != same
    ]
    assert wrong == []


DIGESTS = """
from hashlib import sha256
import sys
sys.path.insert(0, sys.argv[1])
from generate import generated_files
for path, content in generated_files().items():
    print(path, sha256(content).hexdigest())
"""


@pytest.mark.slow
def test_every_processor_writes_the_same_bytes() -> None:
    """OpenBLAS and NumPy take other instructions on other processors."""
    features = "AVX512F AVX512CD AVX512_SKX AVX2 FMA3"
    machines = [
        {},
        {"OPENBLAS_CORETYPE": "Haswell"},
        {"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": features},
    ]
    printed = []
    for machine in machines:
        done = subprocess.run(
            [sys.executable, "-W", "ignore", "-c", DIGESTS, REPOSITORY / "scripts"],
            env={**os.environ, **machine},
            capture_output=True,
            text=True,
            check=True,
        )
        printed.append(done.stdout.splitlines())
    assert len(printed[0]) > 30
    for lines in printed[1:]:
        assert lines == printed[0]
