"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

from pathlib import Path

import alpha5_model as a5


def test_a_tensor_that_no_body_has_is_compared_all_the_same(tmp_path):
    text = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(
        text.replace('<inertia ixx="', '<inertia ixx="-', 3)
    )
    assert not a5.compare(tmp_path / "arm.urdf", samples=3).agrees
