"""The kernels: rows of states, compiled and in NumPy, on every processor the same.

That they compute an arm is shown in ``tests/dynamics`` and ``tests/kinematics``, by
Pinocchio and by hand-written equations. Internal names, since both backends run here
side by side.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import sysconfig
import threading
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from compiled_kernels import compiled_kernels

import alpha5_model as a5
from alpha5_model.dynamics.kernel_numbers import kernel_parameters
from alpha5_model.errors import KernelError
from alpha5_model.kernels import choice, numpy_kernels
from alpha5_model.kernels.generated.formulas import KERNELS
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers import plausibility

ROOT = Path(__file__).resolve().parents[2]
#: Those that batches call; the others are JAX's alone.
NAMES = (
    "forward_kinematics",
    "gravity_torque",
    "coriolis_torque",
    "inverse_dynamics",
    "inverse_dynamics_with_base_wrench",
    "forward_dynamics",
    "inverse_kinematics",
)


@pytest.fixture(params=["compiled", "numpy"])
def kernels(request) -> ModuleType:
    return compiled_kernels() if request.param == "compiled" else numpy_kernels


def parameters(name: str) -> np.ndarray:
    """Of the catalogue's arm in sea water."""
    if name == "inverse_kinematics":
        return Geometry.of(a5.parameters()).ik_parameters
    return np.array(kernel_parameters(a5.load()))


def inputs(name: str, rows: int, seed: int = 3) -> list[np.ndarray]:
    """Random states; targets within reach and beyond."""
    rng = np.random.default_rng(seed)
    *shapes, _ = KERNELS[name][1]
    wide = 0.4 if name == "inverse_kinematics" else 3.0
    return [rng.uniform(-wide, wide, (rows, *shape)) for shape in shapes]


@pytest.mark.parametrize("name", NAMES)
def test_compiled_kernels_give_what_numpy_gives(name):
    given = inputs(name, 300)
    # Beyond 1e5 rad both take the sine of libm.
    given[0][7] *= 1e6
    ours = compiled_kernels().rows(name, parameters(name), *given)
    theirs = numpy_kernels.rows(name, parameters(name), *given)
    for one, other in zip(ours, theirs, strict=True):
        assert one.shape == other.shape
        scale = np.nanmax(np.abs(other))
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12 * scale)

    # The comparison sees a millionth in the arm's numbers.
    others = numpy_kernels.rows(name, parameters(name) * (1.0 + 1e-6), *given)
    assert not all(
        np.allclose(one, other, rtol=1e-9, atol=1e-12, equal_nan=True)
        for one, other in zip(ours, others, strict=True)
    )


@pytest.mark.parametrize("name", NAMES)
def test_a_row_does_not_depend_on_the_others(name, kernels):
    """Rows are computed four at a time, and 32 or thousands between two checks."""
    rows = 70 if kernels is not numpy_kernels else numpy_kernels.BLOCK + 3
    given = inputs(name, rows)
    given[0][5] *= 1e6  # takes another way for this row alone
    every = kernels.rows(name, parameters(name), *given)
    for count in (1, 2, 3, 4, 5, 33, 69):
        some = kernels.rows(name, parameters(name), *(x[:count] for x in given))
        for one, all_of_them in zip(some, every, strict=True):
            np.testing.assert_array_equal(one, all_of_them[:count])


def test_no_row_gives_none(kernels):
    given = inputs("inverse_dynamics", 0)
    (tau,) = kernels.rows("inverse_dynamics", parameters("inverse_dynamics"), *given)
    assert tau.shape == (0, 4)


def test_one_row_may_stand_for_all(kernels):
    q, v, a = inputs("inverse_dynamics", 50)
    numbers = parameters("inverse_dynamics")
    same = np.broadcast_to(v[:1], (50, 4))
    (one,) = kernels.rows("inverse_dynamics", numbers, q, same, a)
    (other,) = kernels.rows("inverse_dynamics", numbers, q, same.copy(), a)
    np.testing.assert_array_equal(one, other)


REFUSED = {
    "no such kernel": lambda p, q: ("none", p, q, q, q),
    "too few parameters": lambda p, q: ("inverse_dynamics", p[1:], q, q, q),
    "integer parameters": lambda p, q: ("inverse_dynamics", p.astype(int), q, q, q),
    "too few inputs": lambda p, q: ("inverse_dynamics", p, q, q),
    "too many inputs": lambda p, q: ("inverse_dynamics", p, q, q, q, q),
    "other columns": lambda p, q: ("inverse_dynamics", p, q, q, q[:, :3].copy()),
    "other rows": lambda p, q: ("inverse_dynamics", p, q, q, q[1:]),
    "single precision": lambda p, q: ("inverse_dynamics", p, q, q, q.astype("f4")),
    "Fortran order": lambda p, q: ("inverse_dynamics", p, q, q, np.asfortranarray(q)),
    "every other row": lambda p, q: ("inverse_dynamics", p, q[::2], q[::2], q[::2]),
    "a list": lambda p, q: ("inverse_dynamics", p, q.tolist(), q, q),
    "a number": lambda p, q: ("inverse_dynamics", p, np.float64(1.0), q, q),
    "NaN": lambda p, q: ("inverse_dynamics", p, q, q, np.where(q == q[7], np.nan, q)),
    "infinity": lambda p, q: ("inverse_dynamics", p, q, q, np.where(q > 2, np.inf, q)),
    "a huge number": lambda p, q: ("inverse_dynamics", p, q, q, q * 1e52),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_computed_is_refused(case, kernels):
    given = REFUSED[case](parameters("inverse_dynamics"), inputs("mass_matrix", 40)[0])
    with pytest.raises(KernelError) as caught:
        kernels.rows(*given)
    assert caught.value.kernel == given[0]


def test_is_state(kernels):
    q = np.zeros(4)
    assert kernels.is_state(4, 4, q)
    assert kernels.is_state(5, 4, np.zeros(5), q, q)
    for wrong in (
        (q.tolist(),),
        (q[:3],),
        (np.zeros((1, 4)),),
        (q.astype("f4"),),
        (np.zeros(8)[::2],),
        (np.array([0.0, np.nan, 0.0, 0.0]),),
        (np.array([0.0, 1e60, 0.0, 0.0]),),
        (q, np.zeros(5)),
        (np.ma.masked_array(q),),
    ):
        assert not kernels.is_state(4, 4, *wrong), wrong


def test_a_state_of_more_than_two_turns_is_looked_at(kernels):
    """At the bound of `plausibility.ANGLE`, in C and NumPy; a base may be anywhere."""
    largest = plausibility.ANGLE.ranges[0][1]
    q = np.array([0.0, largest, -largest, 0.0])
    assert kernels.is_state(4, 4, q)
    assert not kernels.is_state(4, 4, q * (1 + 1e-12))
    assert kernels.is_state(4, 4, np.zeros(4), 100.0 * q)
    base = np.array([100.0, -200.0, 300.0, 0.0, 0.0, 0.0, 1.0])
    assert kernels.is_state(11, 10, np.concatenate([base, q]))
    assert not kernels.is_state(11, 10, np.concatenate([base, q * (1 + 1e-12)]))


def test_threads_compute_at_the_same_time(kernels):
    name = "inverse_dynamics"
    wanted = [
        kernels.rows(name, parameters(name), *inputs(name, 500, k))[0] for k in range(4)
    ]
    found: dict[int, np.ndarray] = {}

    def compute(k: int) -> None:
        for _ in range(20):
            (found[k],) = kernels.rows(name, parameters(name), *inputs(name, 500, k))

    threads = [threading.Thread(target=compute, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k in range(4):
        np.testing.assert_array_equal(found[k], wanted[k])


def test_numpy_runs_if_nothing_is_compiled(monkeypatch):
    monkeypatch.setenv("ALPHA5_KERNELS", "numpy")
    choice.module.cache_clear()
    try:
        assert choice.backend() == "numpy"
        (tau,) = choice.rows(
            "inverse_dynamics",
            parameters("inverse_dynamics"),
            *inputs("inverse_dynamics", 3),
        )
        assert tau.shape == (3, 4)
    finally:
        choice.module.cache_clear()


def test_compiled_kernels_of_other_sources_are_refused(monkeypatch):
    """A `git pull` brings other sources; nothing computes with the old module."""
    compiled = compiled_kernels()
    monkeypatch.setattr(compiled, "SOURCES", "0" * 64 + " -O3")
    choice.module.cache_clear()
    try:
        with pytest.raises(a5.MissingDependencyError, match=r"hatch_build\.py"):
            choice.module()
    finally:
        choice.module.cache_clear()


FLAGS = {
    "one processor": ["-DONE_PROCESSOR"],
    "without scheduling": ["-O1"],
    "sanitized": ["-DONE_PROCESSOR", "-fsanitize=undefined", "-fno-sanitize-recover"],
}


@pytest.mark.tools
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("flags", FLAGS)
def test_all_processors_and_compilers_give_the_same_bits(flags, compiler, tmp_path):
    """Compiled without the wider registers, the kernels give the bits of this machine.

    The processor's widest registers run in the module; here the narrowest do, and Clang
    orders the operations in its own way.
    """
    if shutil.which(compiler) is None:
        pytest.skip(f"there is no {compiler}")
    library = tmp_path / f"_compiled{sysconfig.get_config_var('EXT_SUFFIX')}"
    source = ROOT / "alpha5_model" / "kernels" / "_compiled.c"
    include = [sysconfig.get_path("include"), np.get_include()]
    subprocess.run(
        [
            compiler,
            *("-O3", "-ffp-contract=off", "-fno-math-errno", "-Wno-psabi"),
            *(*FLAGS[flags], "-shared", "-fPIC", '-DSOURCES="test"'),
            *(f"-I{folder}" for folder in include),
            *(str(source), "-lm", "-o", str(library)),
        ],
        check=True,
    )
    script = tmp_path / "compute.py"
    names = ", ".join(map(repr, NAMES))
    script.write_text(
        f"""
import sys
sys.path[:0] = [{str(Path(__file__).parent)!r}, {str(ROOT)!r}, {str(tmp_path)!r}]
sys.path.insert(0, {str(ROOT / "tests" / "support")!r})
import numpy as np
import _compiled
from test_rows import inputs, parameters
answers = {{}}
for name in ({names}):
    given = inputs(name, 333)
    given[0][7] *= 1e6
    for k, out in enumerate(_compiled.rows(name, parameters(name), *given)):
        answers[f"{{name}} {{k}}"] = out
np.savez(sys.argv[1], **answers)
"""
    )
    answers = tmp_path / "answers.npz"
    environment = {"PATH": "/usr/bin:/bin", "UBSAN_OPTIONS": "halt_on_error=1"}
    subprocess.run(
        [sys.executable, str(script), str(answers)], check=True, env=environment
    )
    found = np.load(answers)
    for name in NAMES:
        given = inputs(name, 333)
        given[0][7] *= 1e6
        ours = compiled_kernels().rows(name, parameters(name), *given)
        for k, out in enumerate(ours):
            np.testing.assert_array_equal(out, found[f"{name} {k}"], err_msg=name)
