"""Each message of ours on the page of troubleshooting is what a reader sees."""

from __future__ import annotations

import re
import shutil
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pages import DOCS, blocks

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.cli import main
from alpha5_model.errors import Alpha5Error, ImplausibleWarning

MESSAGES = [
    block.text.strip()
    for block in blocks((DOCS / "troubleshooting.md").read_text("utf-8"))
    if block.language == "text"
]
REST = np.array([3.0, 1.5, 1.5, 0.0])


def reached(*target: float) -> object:
    return a5.inverse_kinematics(target).best(REST)


def recording(*names: str) -> object:
    """Read a table of seven samples at rest, in degrees."""
    row = ["180", "70", "100", "0"]
    lines = [",".join([f"{k / 10}", *row[: len(names)]]) for k in range(7)]
    text = "\n".join([",".join(["time", *names]), *lines])
    Path("recording.csv").write_text(text, "utf-8")
    return a5.trajectory.read_motion("recording.csv")


def git_lfs_pointer() -> object:
    text = "version https://git-lfs.github.com/spec/v1\noid sha256:abc\nsize 3\n"
    Path("recording.csv").write_text(text, "utf-8")
    return a5.trajectory.read_motion("recording.csv")


def xacro() -> object:
    shutil.copy(Path(REPOSITORY_PATH) / "xacro" / "alpha5.urdf.xacro", ".")
    return a5.compare("alpha5.urdf.xacro")


def five_joints() -> object:
    return a5.load().inverse_dynamics(np.ones(5), np.zeros(4), np.zeros(4))


PROVOKED: list[Callable[[], object]] = [
    lambda: recording(*(f"axis_{x}_pos" for x in "edcb")),
    lambda: reached(250, 100, 100),
    lambda: reached(0.6, 0, 0.1),
    lambda: reached(-0.18379572, 0.09280248, 0.0457493),
    five_joints,
    lambda: a5.load(1.025),
    lambda: a5.load(gravity=(0, 0, 9.81)),
    lambda: recording(*(f"joint_{k}" for k in range(1, 5))),
    git_lfs_pointer,
    xacro,
]


def said(call: Callable[[], object]) -> str:
    """The error or the warning of a call."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ImplausibleWarning)
        try:
            call()
        except Alpha5Error as error:
            return str(error)
    (warning,) = caught
    return str(warning.message)


def parts(message: str) -> tuple[list[str], list[float]]:
    """The words of a message, and its numbers, whose last digits a processor rounds."""
    number = r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?"
    return re.split(number, message), [float(x) for x in re.findall(number, message)]


@pytest.mark.parametrize("k", range(len(PROVOKED)))
def test_a_message_is_what_a_reader_sees(
    k: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words, numbers = parts(said(PROVOKED[k]))
    expected_words, expected_numbers = parts(MESSAGES[k])
    assert words == expected_words
    assert numbers == pytest.approx(expected_numbers, rel=1e-3)


def test_no_display(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER"):
        monkeypatch.delenv(name, raising=False)
    assert main(["view"]) == 2
    assert capsys.readouterr().err == f"alpha5: {MESSAGES[-1]}\n"
    assert len(MESSAGES) == len(PROVOKED) + 1
