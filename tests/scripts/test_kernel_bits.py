"""Kernels that differ in one bit of one number are seen."""

from __future__ import annotations

import numpy as np
import pytest
from checks import kernel_bits

import alpha5_model as a5


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    if a5.backend() != "compiled":
        pytest.skip("the kernels are not compiled here")
    file = tmp_path_factory.mktemp("bits") / "here.npz"
    assert kernel_bits.main(["write", str(file)]) == 0
    return file


def test_the_same_machine_gives_the_same_bits(stored, capsys):
    assert kernel_bits.main(["compare", str(stored)]) == 0
    assert "14 of 14 arrays" in capsys.readouterr().out


def test_the_last_bit_of_one_number_counts(stored, tmp_path, capsys):
    with np.load(stored) as file:
        arrays = {name: file[name] for name in file.files}
    torques = arrays["out/inverse_dynamics/0"]
    torques[17, 2] = np.nextafter(torques[17, 2], np.inf)
    changed = tmp_path / "changed.npz"
    np.savez(changed, **arrays)
    assert kernel_bits.main(["compare", str(changed)]) == 1
    assert "inverse_dynamics/0: other bits" in capsys.readouterr().out


def test_without_compiled_kernels_nothing_is_compared(stored, monkeypatch, capsys):
    monkeypatch.setattr(kernel_bits.a5, "backend", lambda: "numpy")
    assert kernel_bits.main(["compare", str(stored)]) == 1
    assert "expected compiled ones" in capsys.readouterr().out
