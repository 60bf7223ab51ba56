"""The table ``[covariance]`` of an arm file."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.numbers.covariance import Covariance, key_of

GOOD = """format = 1
[zeros]
axis_d = {value = 0.01, half_width = 0.002}
[links.link_2]
com = {value = [0.0736, 0.0, -0.0007], half_width = 0.001}
[covariance]
names = ["zeros.axis_d", "links.link_2.com.x"]
deviation = [0.0175, 0.005]
factor = [[0.6, 0.0], [0.3, 0.4]]
"""
#: What is replaced, by what, and the key that the error names.
WRONG = (
    ("names = [", "nams = [", "covariance"),
    ("factor = [[0.6, 0.0], [0.3, 0.4]]", "", "covariance.factor"),
    ("com.x", "com.w", "covariance.names"),
    ('["zeros.axis_d", ', '[3, "zeros.axis_d", ', "covariance.names"),
    ('"links.link_2.com.x"', '"zeros.axis_d"', "covariance.names"),
    (", half_width = 0.001", "", "covariance.names"),
    ("[0.0175, 0.005]", "[0.0175]", "covariance.deviation"),
    ("[0.0175, 0.005]", "[0.0175, 0]", "covariance.deviation"),
    ("[0.0175, 0.005]", "[0.0175, nan]", "covariance.deviation"),
    ("[0.0175, 0.005]", "3", "covariance.deviation"),
    ("[0.3, 0.4]]", "[0.3]]", "covariance.factor"),
    ("[0.3, 0.4]]", "[0.3, true]]", "covariance.factor"),
    ("[0.3, 0.4]]", "[0.9, 0.9]]", "covariance.factor"),
    ("[[0.6, 0.0], [0.3, 0.4]]", "[[0.6, 0.0]]", "covariance.factor"),
    ("[0.3, 0.4]]", "[0.3, 0.4], [0, 0]]", "covariance.factor"),
    ("[[0.6, 0.0], [0.3, 0.4]]", "[3, 3]", "covariance.factor"),
    ("[0.0175, 0.005]", "[0.1, 0.1, 0.1]", "covariance.deviation"),
    ('["zeros.axis_d", ', f"[{'3, ' * 80}", "covariance.names"),
    ("[covariance]\n", "[[covariance]]\n", "covariance"),
)


def test_what_a_file_says(tmp_path: Path) -> None:
    found = a5.arm_file(written(tmp_path, GOOD)).covariance
    assert found is not None
    by_hand = np.array(
        [
            [0.0175**2 * (1 - 0.36), -0.0175 * 0.005 * 0.18],
            [-0.0175 * 0.005 * 0.18, 0.005**2 * (1 - 0.09 - 0.16)],
        ]
    )
    assert np.allclose(found.matrix, by_hand, rtol=1e-12)
    scaled = found.deviation[:, None] * found.root
    assert np.allclose(scaled @ scaled.T, by_hand, rtol=1e-9)
    assert np.allclose(found.standard_deviation**2, np.diag(by_hand))
    widths = np.sqrt(3 * np.diag(by_hand))
    assert np.allclose([*found.half_widths.values()], widths)
    assert [*found.half_widths] == ["zeros.axis_d", "links.link_2.com"]
    assert key_of("links.link_2.mass") == "links.link_2.mass"


def test_it_is_written_and_read_again(tmp_path: Path) -> None:
    arm = a5.arm_file(written(tmp_path, GOOD))
    again = a5.arm_file(written(tmp_path, a5.arm_file_text(arm))).covariance
    assert arm.covariance is not None
    assert again is not None
    assert again.names == arm.covariance.names
    assert np.array_equal(again.deviation, arm.covariance.deviation)
    assert np.allclose(again.factor, arm.covariance.factor, rtol=0, atol=1e-13)
    copied = pickle.loads(pickle.dumps(arm)).covariance
    assert np.array_equal(copied.factor, arm.covariance.factor)


def written(folder: Path, text: str) -> Path:
    path = folder / "arm.toml"
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize(("old", "new", "place"), WRONG)
def test_a_wrong_table_gets_one_line(
    old: str, new: str, place: str, tmp_path: Path
) -> None:
    assert old in GOOD
    path = written(tmp_path, GOOD.replace(old, new, 1))
    with pytest.raises(FileFormatError) as caught:
        a5.arm_file(path)
    assert str(caught.value).startswith(f"{path}, ")
    assert caught.value.place == place
    assert "\n" not in str(caught.value)


def test_a_record_is_checked() -> None:
    names = ("zeros.axis_d", "zeros.axis_c")
    one = np.eye(2)[:, :1]
    assert Covariance(names=names, deviation=[1, 2], factor=one).matrix[0, 0] == 0.0
    with pytest.raises(InputError, match="names, each once"):
        Covariance(names=names[:1] * 2, deviation=[1, 2], factor=one)
    with pytest.raises(InputError, match=r"covariance\.deviation"):
        Covariance(names=names, deviation=[1], factor=one)
    with pytest.raises(InputError, match="singular value"):
        Covariance(names=names, deviation=[1, 2], factor=2 * one)
    with pytest.raises(InputError, match=r"covariance\.factor"):
        Covariance(names=names, deviation=[1, 2], factor=[1, 2])
    with pytest.raises(InputError, match="names, each once"):
        Covariance(names=(3, 4), deviation=[1, 2], factor=one)  # type: ignore[arg-type]


@pytest.mark.parametrize("rank", [0, 1, 2, 3])
def test_the_root_of_a_factor_of_any_rank(rank: int) -> None:
    """A rank of 0 is a calibration that has told nothing."""
    rng = np.random.default_rng(rank)
    factor = rng.normal(size=(3, rank))
    if rank:
        factor *= 0.9 / np.linalg.norm(factor, 2)
    names = ("zeros.axis_e", "zeros.axis_d", "lengths.a_1")
    found = Covariance(names=names, deviation=[0.1, 0.2, 0.3], factor=factor)
    left = np.eye(3) - factor @ factor.T
    assert found.root @ found.root.T == pytest.approx(left, abs=1e-15)
    expected = np.outer(found.deviation, found.deviation) * left
    assert found.matrix == pytest.approx(expected, abs=1e-17)
    assert found.standard_deviation**2 == pytest.approx(np.diag(expected), rel=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_a_number_that_is_known_exactly(seed: int) -> None:
    """Its singular value is 1, above or below by rounding."""
    direction = np.random.default_rng(seed).normal(size=(3, 1))
    direction /= np.linalg.norm(direction)
    names = ("zeros.axis_e", "zeros.axis_d", "lengths.a_1")
    found = Covariance(names=names, deviation=[1, 1, 1], factor=direction)
    assert np.abs(found.root @ direction).max() < 1e-7
    alone = Covariance(names=names[:1], deviation=[1], factor=[[1.0 + 1e-15]])
    assert alone.standard_deviation[0] == 0.0


def test_no_numbers_at_all() -> None:
    empty = Covariance(names=(), deviation=[], factor=np.empty((0, 0)))
    assert empty.matrix.shape == empty.root.shape == (0, 0)
    assert empty.half_widths == {}
