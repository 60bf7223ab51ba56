"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError


def test_points_far_beyond_a_planar_arm_are_outside_without_a_word():
    arm = a5.planar.PlanarArm((2, 1), limits=[(-1, 1), None])
    far = np.array([[1e300, 1e300], [3.0, 0.0], [0.0, -3.1]])
    assert arm.workspace().contains(far).tolist() == [False, True, False]


def test_angles_of_a_planar_arm_that_overflow_are_refused():
    with pytest.raises(InputError, match="q"):
        a5.planar.PlanarArm((1, 1)).poses([1.7e308, 1.7e308])


def test_a_limit_without_effort_moves(tmp_path, capfd):
    text = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(text.replace(' effort="', ' force="'))
    chain = a5.dh.DHChain.from_urdf(tmp_path / "arm.urdf")
    assert chain.links == a5.dh.DHChain.from_urdf(a5.URDF_PATH).links
    assert capfd.readouterr().err == ""
