"""Input of which a count, a size or a spread is zero: an answer, or an own error."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import ImplausibleWarning, InputError

# Not a number, and no warning of NumPy either.
pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")
TIME = np.arange(0.0, 12.0, 0.05)


def swaying() -> np.ndarray:
    """Joint positions, (240, 4)."""
    phase = TIME[:, None] * [1.0, 1.2, 1.5, 1.1]
    return np.asarray(a5.named_pose("home") + 0.5 * np.sin(phase))


def with_link(number: int, **numbers: Any) -> Any:
    """The catalogue's arm with other numbers of a link."""
    record = a5.parameters()
    links = list(record.links)
    links[number] = replace(links[number], **numbers)
    return replace(record, links=tuple(links))


def test_motors_of_a_joint_without_a_rated_speed() -> None:
    record = a5.parameters()
    joints = (replace(record.joints[0], velocity=0.0), *record.joints[1:])
    arm = a5.load(arm=replace(record, joints=joints))
    current = 0.05 * np.sign(np.gradient(swaying(), axis=0))
    motion = a5.trajectory.motion(TIME, swaying(), current=current)
    with pytest.raises(InputError, match="axis_e"):
        a5.calibrate.motors(motion, arm)


def test_a_link_4_of_which_the_jaws_leave_no_volume() -> None:
    jaws = a5.parameters().jaws
    fingers = jaws.finger_volume + jaws.second_finger_volume
    with pytest.warns(ImplausibleWarning), pytest.raises(InputError, match="link_4"):
        a5.load(arm=with_link(4, volume=fingers))


def test_check_of_a_link_whose_com_is_its_origin(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = with_link(0, com=np.zeros(3), cob=np.zeros(3))
    own = tmp_path / "own.toml"
    own.write_text(a5.arm_file_text(record), encoding="utf-8")
    model = tmp_path / "own.urdf"
    assert main(["generate", "urdf", "--arm", str(own), "--output", str(model)]) == 0
    assert main(["check", str(model), "--arm", str(own)]) == 0

    text = model.read_text(encoding="utf-8")
    moved = re.sub(r'xyz="0\.0 (.*\s*<mass value="0\.234")', r'xyz="0.001 \1', text)
    assert moved != text
    model.write_text(moved, encoding="utf-8")
    assert main(["check", str(model), "--arm", str(own)]) == 1
    assert "link_0" in capsys.readouterr().out
