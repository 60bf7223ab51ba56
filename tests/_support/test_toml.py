"""What a reader of TOML files says about a number with its unit."""

import pytest

from alpha5_model._support.toml import toml_tables
from alpha5_model.errors import FileFormatError


@pytest.mark.parametrize(
    ("line", "instead"),
    [
        ("mass = 0.341 kg", '{value = 0.341, unit = "kg"}'),
        ("mass=341g # on the scales", '{value = 341, unit = "g"}'),
        ("inertia = -1.5e-3 kg m^2", '{value = -1.5e-3, unit = "kg m^2"}'),
    ],
)
def test_a_number_with_its_unit_is_told_how_to_be_written(line, instead):
    with pytest.raises(FileFormatError) as error:
        toml_tables(f"[links.link_2]\n{line}\n", "own.toml")
    assert error.value.place == "line 2"
    assert instead in str(error.value)


@pytest.mark.parametrize(
    "line", ["mass = 0x1F\nmass = 2", "mass = [1, 2] kg", "mass ="]
)
def test_other_mistakes_are_told_as_before(line):
    with pytest.raises(FileFormatError) as error:
        toml_tables(line, "own.toml")
    assert "unit" not in str(error.value)
