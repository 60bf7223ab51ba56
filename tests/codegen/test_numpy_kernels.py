"""The kernels in NumPy refuse what they cannot take; rows and single states agree."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from kernel_inputs import kernel_inputs
from loops import each

from alpha5_model._support.checks import LARGEST
from alpha5_model.codegen.kernels import choice, numpy_kernels
from alpha5_model.codegen.kernels.generated.formulas import KERNELS
from alpha5_model.errors import MissingDependencyError
from alpha5_model.numbers.parameters import parameters

PARAMETERS = kernel_inputs(parameters().links)


def arrays(name: str, n: int) -> tuple[list[np.ndarray], list[np.ndarray], np.ndarray]:
    """Inputs and empty outputs of n states, and the parameters."""
    _, inputs, outputs = KERNELS[name]
    water = inputs[-1][0] - len(PARAMETERS)
    own = np.append(PARAMETERS, np.full(water, 0.01)) if water >= 0 else np.empty(0)
    rng = np.random.default_rng(5)
    given = [
        rng.uniform(-0.3, 0.3, (n, *s)) for s in inputs[: len(inputs) - bool(len(own))]
    ]
    return given, [np.full((n, *s), np.nan) for s in outputs], own


@each("name", KERNELS)
def test_rows_over_several_blocks_are_the_single_states(name: str) -> None:
    n = 2 * numpy_kernels.BLOCK + 3
    given, out, own = arrays(name, n)
    assert numpy_kernels.batch(name, own, *given, *out)
    one = numpy_kernels.bind(name, own)
    for k in (0, numpy_kernels.BLOCK - 1, numpy_kernels.BLOCK, n - 1):
        single = one(*(x[k] for x in given))
        for rows, result in zip(
            out, single if isinstance(single, tuple) else (single,), strict=True
        ):
            assert result.shape == rows.shape[1:]
            scale = max(1.0, np.nanmax(np.abs(result), initial=0.0))
            expected = pytest.approx(result, abs=1e-13 * scale, nan_ok=True)
            assert rows[k] == expected


def test_what_is_no_plain_state_is_refused() -> None:
    one = numpy_kernels.bind("inverse_dynamics", PARAMETERS)
    (q, v, a), (out,), _ = arrays("inverse_dynamics", 3)
    assert one(q[0], v[0], a[0]) is not None
    wrong = [
        [0.0] * 4,
        np.zeros(4, np.float32),
        np.zeros(5),
        np.zeros(8)[::2],
        np.zeros((1, 4)),
    ]
    wrong += [np.array([0.0, x, 0.0, 0.0]) for x in (math.nan, math.inf, -2 * LARGEST)]
    for bad in (*wrong, None, "q", np.ma.array(np.zeros(4))):
        assert one(q[0], bad, a[0]) is None
    assert one(q[0], v[0]) is None
    for bad in (
        v.tolist(),
        v[:2],
        v.astype(np.float32),
        v[:, ::-1],
        v + math.nan,
        v + 2 * LARGEST,
    ):
        assert not numpy_kernels.batch("inverse_dynamics", PARAMETERS, q, bad, a, out)
    assert not numpy_kernels.batch("inverse_dynamics", PARAMETERS, q, v, out)
    assert numpy_kernels.batch("inverse_dynamics", PARAMETERS, q, v, a, out)
    assert numpy_kernels.batch(
        "inverse_dynamics", PARAMETERS, q[:0], v[:0], a[:0], out[:0]
    )


def test_parameters_are_copied() -> None:
    own = PARAMETERS.copy()
    one = numpy_kernels.bind("hydrostatic_torque", own)
    before = one(np.ones(4))
    own[:] = 0.0
    assert np.array_equal(one(np.ones(4)), before)


def test_they_run_if_none_are_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "alpha5_model.codegen.kernels._compiled", None)
    choose_anew = choice.module.__wrapped__
    for wanted in ("", "numpy"):
        monkeypatch.setenv("ALPHA5_KERNELS", wanted)
        assert choose_anew() is numpy_kernels
    monkeypatch.setenv("ALPHA5_KERNELS", "compiled")
    with pytest.raises(MissingDependencyError, match="where a C compiler is"):
        choose_anew()
