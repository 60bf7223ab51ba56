"""The kernels' sine, cosine and atan2 in C agree with long doubles."""

from __future__ import annotations

import math
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from compilers import UNDEFINED, builds

ROOT = Path(__file__).resolve().parents[2]
COMPILERS = ("gcc", "clang")
NAMES = ("sin", "cos", "atan2", "floor", "fmin", "fmax", "sqrt")
LONG_DOUBLES = pytest.mark.skipif(
    np.finfo(np.longdouble).nmant < 63, reason="long doubles are doubles here"
)
pytestmark = pytest.mark.tools


@cache
def pairs() -> np.ndarray:
    """Ordinary arguments, all magnitudes, and every pair of special values."""
    rng = np.random.default_rng(3)

    def signs(shape):
        return rng.choice([-1.0, 1.0], shape)

    ordinary = rng.uniform(-10.0, 10.0, (20_000, 2))
    wide = signs((20_000, 2)) * 10.0 ** rng.uniform(-12.0, 5.0, (20_000, 2))
    turns = np.rint(rng.uniform(-60_000, 60_000, (10_000, 2))) * (math.pi / 2)
    turns = np.nextafter(turns, rng.choice([-np.inf, np.inf], turns.shape))
    exponents = rng.uniform(-300.0, 300.0, (40_000, 2))
    all_magnitudes = signs((40_000, 2)) * 10.0**exponents
    numbers = [
        0.0,
        5e-324,
        2.2e-308,
        1e-300,
        0.41421356237309503,
        0.5,
        math.pi / 4,
        1.0,
        math.pi,
        1.5,
        1e5,
        math.nextafter(1e5, 1e6),
        2.0**52,
        1e300,
        1.7e308,
        math.inf,
        math.nan,
    ]
    special = np.array([sign * x for x in numbers for sign in (1.0, -1.0)])
    beside = np.stack(np.meshgrid(special, special), axis=-1).reshape(-1, 2)
    both = np.concatenate([ordinary, wide, turns, all_magnitudes, beside])
    return both[: len(both) // 4 * 4]


@pytest.fixture(scope="module", params=COMPILERS)
def computed(request, tmp_path_factory) -> np.ndarray:
    """Outputs of all pairs, (N, len(NAMES))."""
    if not builds(request.param, UNDEFINED):
        pytest.skip(f"{request.param} has no sanitizers")
    program = tmp_path_factory.mktemp(request.param) / "elementary"
    subprocess.run(
        [
            request.param,
            *("-O3", "-ffp-contract=off", "-fno-math-errno"),
            *("-Wall", "-Wextra", "-Werror", "-Wno-psabi", "-Wno-unused-function"),
            *(UNDEFINED, "-fno-sanitize-recover"),
            f"-I{ROOT / 'alpha5_model' / 'kernels'}",
            *(str(ROOT / "tests" / "support" / "elementary.c"), "-lm"),
            *("-o", str(program)),
        ],
        check=True,
    )
    run = subprocess.run(
        [program], input=pairs().tobytes(), check=True, capture_output=True
    )
    return np.frombuffer(run.stdout).reshape(len(pairs()), len(NAMES))


def column(computed, name: str) -> np.ndarray:
    return computed[:, NAMES.index(name)]


@LONG_DOUBLES
@pytest.mark.parametrize("name", ["sin", "cos"])
def test_sine_and_cosine(computed, name):
    x = pairs()[:, 0]
    with np.errstate(invalid="ignore"):
        exact = getattr(np, name)(x.astype(np.longdouble))
    got = column(computed, name)
    finite = np.isfinite(x)
    assert np.array_equal(np.isnan(got), ~finite)
    off = np.abs(got - exact)[finite]
    assert off.max() < 1.25e-16
    plain = np.abs(exact[finite]) > 1e-3
    assert (off[plain] / np.abs(exact[finite][plain])).max() < 2.3e-16
    assert np.array_equal(np.signbit(got[x == 0.0]), np.signbit(exact[x == 0.0]))


@LONG_DOUBLES
def test_angle_of_a_vector(computed):
    x, y = pairs().T
    exact = np.arctan2(y.astype(np.longdouble), x.astype(np.longdouble))
    got = column(computed, "atan2")
    numbers = ~np.isnan(exact)
    assert np.array_equal(np.isnan(got), ~numbers)
    off = np.abs(got - exact)[numbers]
    assert (off <= 4e-16 * np.abs(exact[numbers]) + 1e-323).all()
    assert np.array_equal(np.signbit(got[numbers]), np.signbit(exact[numbers]))


@LONG_DOUBLES
def test_steep_angles_are_not_biased(computed):
    """Rounding errors cancel in a mean; a wrong low part of pi/4 does not.

    Standard deviation of the mean: 1e-18 from pi/8 to pi/4.
    """
    x, y = pairs()[:20_000].T
    exact = np.arctan2(y.astype(np.longdouble), x.astype(np.longdouble))
    off = column(computed, "atan2")[:20_000] - exact
    for side in (1.0, -1.0):
        steep = (side * exact > np.pi / 8) & (side * exact < np.pi / 4)
        assert np.count_nonzero(steep) > 1000
        assert abs(off[steep].mean()) < 9e-18


@pytest.mark.parametrize("name", ["floor", "sqrt", "fmin", "fmax"])
def test_what_is_exact_is_exact(computed, name):
    x, y = pairs()[~np.isnan(pairs()).any(axis=1)].T
    got = column(computed, name)[~np.isnan(pairs()).any(axis=1)]
    exact = {
        "floor": lambda: np.floor(x),
        "sqrt": lambda: np.sqrt(np.abs(x)),
        "fmin": lambda: np.fmin(x, y),
        "fmax": lambda: np.fmax(x, y),
    }[name]()
    assert np.array_equal(got, exact)
    if name in ("floor", "sqrt"):
        assert np.array_equal(np.signbit(got), np.signbit(exact))
