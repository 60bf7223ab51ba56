"""A named file may hold anything: each reader raises an error of the package's tree.

The command line then prints one line.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.xacro import expand_xacro
from alpha5_model.errors import FileFormatError, InputError, MissingFileError

READERS = {
    "compare": a5.compare,
    "dh": a5.dh.DHChain.from_urdf,
    "xacro": expand_xacro,
}
COMMANDS = (("dh", "--urdf"), ("compare",))
TEXT = Path(a5.URDF_PATH).read_text(encoding="utf-8")


@pytest.mark.parametrize("reader", READERS)
def test_what_is_no_path_is_refused_as_such(reader):
    for path in (None, 5, 2.5, b"arm.urdf", "a\0b", ["arm.urdf"]):
        with pytest.raises(InputError) as caught:
            READERS[reader](path)
        assert (caught.value.name, caught.value.value) == ("path", path)


@pytest.mark.parametrize("reader", READERS)
def test_paths_that_lead_to_no_file(tmp_path, reader):
    read = READERS[reader]
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "file").write_text("")
    for path, error in (
        ("x" * 5000, FileFormatError),
        (tmp_path / "loop", FileFormatError),
        (tmp_path, FileFormatError),
        (tmp_path / "none", MissingFileError),
        (tmp_path / "file" / "below", MissingFileError),
        (tmp_path / "\udcff", MissingFileError),
        (tmp_path / "a\nb\u2028c", MissingFileError),
    ):
        with pytest.raises(error) as caught:
            read(path)
        assert caught.value.path == path
        assert len(str(caught.value)) <= 1000
        assert len(str(caught.value).splitlines()) == 1


def test_commands_refuse_them_in_one_line(capsys):
    for command in COMMANDS:
        for path in ("a\0b", "x" * 5000, "\udcff", "a\nb"):
            assert main([*command, path]) == 2
            out = capsys.readouterr()
            assert out.out == ""
            assert len(out.err.splitlines()) == 1


def test_dh_reads_what_moves_and_says_nothing_else(tmp_path, capfd):
    """urdfdom complains on stderr of a colour; nobody asked for the colour."""
    (tmp_path / "arm.urdf").write_text(TEXT.replace('rgba="', 'rgba="x', 1))
    for command in (["dh", "--urdf"], ["check"]):
        assert main([*command, str(tmp_path / "arm.urdf")]) == 0
        assert capfd.readouterr().err == ""


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig"])
def test_dh_reads_another_encoding_alike(tmp_path, encoding):
    """Pinocchio, which it asks, would not."""
    arm = tmp_path / "arm.urdf"
    arm.write_bytes(f"\n{TEXT}".encode(encoding))
    ours, theirs = (a5.dh.DHChain.from_urdf(path) for path in (a5.URDF_PATH, arm))
    assert [vars(link) for link in theirs.links] == [vars(link) for link in ours.links]


@pytest.mark.parametrize("text", ["\udcff", "a\0b", "a\u2028b", "a\nb"], ids=ascii)
def test_names_that_no_file_can_hold_are_refused(text, capsys):
    for name in ("prefix", "parent", "mesh_prefix"):
        with pytest.raises(InputError) as caught:
            Variant(**{name: text})
        assert caught.value.name == name
    assert main(["generate", "urdf", "--prefix", text]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_a_prefix_may_be_greek():
    assert 'name="άλφα_tcp"' in urdf(Variant(prefix="άλφα_", collision="none"))


@pytest.mark.slow
def test_a_prefix_that_is_not_utf_8_in_a_real_shell():
    """The bytes as the system passes them, which Python turns into lone surrogates."""
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "alpha5_model",
            "generate",
            "urdf",
            "--prefix",
            b"\xff\xfe",
        ],
        capture_output=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
    )
    assert (done.returncode, done.stdout) == (2, b"")
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.slow
def test_output_that_its_encoding_cannot_hold_is_one_line():
    done = subprocess.run(
        [sys.executable, "-m", "alpha5_model", "generate", "urdf", "--prefix", "ά_"],
        capture_output=True,
        check=False,
        env={
            **os.environ,
            "PYTHONPATH": str(Path(__file__).parents[2]),
            "PYTHONIOENCODING": "latin-1",
        },
    )
    assert done.returncode == 2
    assert b"latin-1 output cannot hold '\\u03ac': try PYTHONIOENCODING" in done.stderr
    assert len(done.stderr.splitlines()) == 1
