"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations

import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError


@pytest.mark.parametrize("index", [3, -4, 1 + 2j, "0", None, 0.0, True])
def test_a_set_of_a_sample_has_a_number(index):
    sample = a5.uncertainty.sample(3)
    assert sample.parameters(-1).links[2].mass == sample.parameters(2).links[2].mass
    with pytest.raises(InputError, match="index"):
        sample.parameters(index)


STUDY = """
[axes]
axis_e_pos = 0.1
axis_d_pos = 0.1
axis_c_pos = 0.1
axis_b_pos = 0.1
[outputs.x]
quantity = "torque"
as = "quantile"
levels = LEVELS
"""


@pytest.mark.parametrize(
    ("levels", "says"),
    [
        ("['a', 1]", "levels"),
        ("[]", "levels"),
        ("[" * 900, "brackets"),
    ],
)
def test_levels_and_brackets_of_a_study(levels, says, tmp_path):
    from alpha5_model.errors import FileFormatError
    from alpha5_model.studies.sweep.study import read_study

    path = tmp_path / "study.toml"
    path.write_text(STUDY.replace("LEVELS", "[0.5, 1]"))
    assert read_study(path).outputs["x"].levels == [0.5, 1.0]
    path.write_text(STUDY.replace("LEVELS", levels))
    with pytest.raises(FileFormatError, match=says):
        read_study(path)
