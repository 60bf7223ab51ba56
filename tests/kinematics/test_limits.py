"""A position on a limit to six digits is on it, wherever it is given."""

from __future__ import annotations

import json

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import JointLimitError


def test_every_door_has_the_same_tolerance(capsys: pytest.CaptureFixture[str]) -> None:
    limits = a5.load().limits
    home = a5.named_pose("home")
    for joint, name in enumerate(a5.load().joint_names):
        for sign, ends in ((-1, limits.lower), (1, limits.upper)):
            for past, is_beyond in ((5e-7, False), (5e-6, True)):
                q = np.array(home)
                q[joint] = ends[joint] + sign * past
                assert limits.beyond(q)[joint] == is_beyond
                assert main(["fk", *map(repr, q.tolist()), "--json"]) == 0
                record = json.loads(capsys.readouterr().out)
                assert record["beyond_limits"] == [name] * is_beyond

    q = np.array(home)
    q[1] = limits.upper[1] + 5e-6
    with pytest.raises(JointLimitError, match="axis_d"):
        a5.plan(home, q)
    q[1] -= 4.5e-6
    np.testing.assert_allclose(a5.plan(q, home).position[0], q, atol=1e-6)
