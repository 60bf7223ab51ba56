"""The compiled module: equal widths, refused arrays, threads and processes."""

from __future__ import annotations

import contextlib
import gc
import importlib.util
import inspect
import multiprocessing
import os
import pickle
import platform
import pydoc
import re
import subprocess
import sys
import sysconfig
import threading
import weakref
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from alpha5_model._support.checks import LARGEST
from alpha5_model.codegen.arm_functions import functions
from alpha5_model.codegen.compiled_code import PARAMETERS
from alpha5_model.codegen.instructions import Program, program
from alpha5_model.codegen.kernels import numpy_kernels
from alpha5_model.codegen.sources import UPRIGHT
from alpha5_model.numbers.parameters import parameters

if os.environ.get("ALPHA5_REQUIRE_KERNELS") == "1":
    compiled = importlib.import_module("alpha5_model.codegen.kernels._compiled")
else:
    compiled = pytest.importorskip(
        "alpha5_model.codegen.kernels._compiled", exc_type=ImportError
    )
PROGRAMS = {
    name: program(function) for name, function in functions(parameters()).items()
}
ROOT = Path(__file__).resolve().parents[2]
ROWS = 103  # three panels and a rest
WIDTHS = {1: "scalar", 2: "sse2", 4: "avx2", 8: "avx512"}


@pytest.fixture
def any_width():
    """The function that chooses a width; the test's end chooses the widest again."""
    yield compiled.width
    compiled.width(8)


def case(of: Program, rows: int = ROWS, scale: float = 3.0) -> tuple:
    """Parameters, inputs and empty outputs of random states."""
    rng = np.random.default_rng(7)
    sizes = {slot.name: slot.size for slot in of.inputs}
    parameters = rng.uniform(0.1, 1.0, sizes.pop(PARAMETERS, 0))
    inputs = [rng.uniform(-scale, scale, (rows, size)) for size in sizes.values()]
    return (
        parameters,
        inputs,
        [np.full((rows, *slot.shape), np.nan) for slot in of.outputs],
    )


def by_batch(name: str, parameters: np.ndarray, inputs: list, outputs: list) -> list:
    outputs = [np.full_like(x, np.nan) for x in outputs]
    assert compiled.batch(name, parameters, *inputs, *outputs)
    return outputs


def by_bind(name: str, parameters: np.ndarray, inputs: list) -> list:
    function = compiled.bind(name, parameters)
    rows = [function(*(x.copy() for x in row)) for row in zip(*inputs, strict=True)]
    rows = [row if isinstance(row, tuple) else (row,) for row in rows]
    return [np.array(column) for column in zip(*rows, strict=True)]


@pytest.mark.parametrize("name", PROGRAMS)
@pytest.mark.parametrize("scale", [3.0, 1e6])
def test_every_width_gives_the_same_bits_as_single_calls(name, scale, any_width):
    parameters, inputs, outputs = case(PROGRAMS[name], scale=scale)
    single = by_bind(name, parameters, inputs)
    for width in WIDTHS:
        any_width(width)
        for got, want in zip(by_bind(name, parameters, inputs), single, strict=True):
            assert np.array_equal(got.view(np.int64), want.view(np.int64)), (
                compiled.width(0)
            )
        for got, want in zip(
            by_batch(name, parameters, inputs, outputs), single, strict=True
        ):
            assert np.array_equal(got.view(np.int64), want.view(np.int64)), (
                compiled.width(0)
            )


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_few_rare_rows_do_not_change_the_others(name, any_width):
    parameters, inputs, outputs = case(PROGRAMS[name])
    plain = by_batch(name, parameters, inputs, outputs)
    rare = np.arange(5, ROWS, 17)
    inputs[0][rare] *= 1e40
    once = by_batch(name, parameters, inputs, outputs)
    others = np.setdiff1d(np.arange(ROWS), rare)
    for got, want in zip(once, plain, strict=True):
        assert np.array_equal(got[others], want[others], equal_nan=True)
    any_width(1)
    for got, want in zip(
        by_batch(name, parameters, inputs, outputs), once, strict=True
    ):
        assert np.array_equal(got[rare], want[rare], equal_nan=True)


@pytest.mark.parametrize("name", UPRIGHT)
@pytest.mark.parametrize("gravity", [(0.0, -0.0), (3.0, 0.0), (0.0, 3.0)])
def test_an_arm_that_stands_upright_has_bodies_of_its_own(name, gravity, any_width):
    parameters, inputs, outputs = case(PROGRAMS[name])
    parameters[-3:-1] = gravity
    wanted = [np.full_like(x, np.nan) for x in outputs]
    assert numpy_kernels.batch(name, parameters, *inputs, *wanted)
    single = by_bind(name, parameters, inputs)
    for got, want in zip(single, wanted, strict=True):
        scale = np.abs(want).max(axis=tuple(range(1, want.ndim)), keepdims=True)
        assert (np.abs(got - want) <= 1e-9 * scale).all()
    for width in WIDTHS:
        any_width(width)
        for got, want in zip(
            by_batch(name, parameters, inputs, outputs), single, strict=True
        ):
            assert np.array_equal(got.view(np.int64), want.view(np.int64)), (
                compiled.width(0)
            )


def test_a_width_that_was_chosen_is_in_use(any_width):
    assert [any_width(width) for width in (1, 2)] == ["scalar", any_width(3)]
    assert compiled.width(0) == any_width(2) != "scalar"


CPUINFO = Path("/proc/cpuinfo")


@pytest.mark.skipif(
    not CPUINFO.exists() or platform.machine() != "x86_64",
    reason="asks Linux on x86-64",
)
def test_the_widest_that_this_processor_has_is_chosen(any_width):
    line = re.search(r"^flags\s*: (.*)$", CPUINFO.read_text("utf-8"), re.MULTILINE)
    flags = set(line[1].split())
    has = [1, 2]
    if "avx2" in flags:
        has.append(4)
        if {"avx512dq", "avx512vl"} <= flags:
            has.append(8)
    for most in range(1, 20):
        assert any_width(most) == WIDTHS[max(width for width in has if width <= most)]


def test_a_width_that_is_no_positive_number_changes_nothing(any_width):
    name = any_width(2)
    assert compiled.width(0) == compiled.width(-1) == compiled.width(-5) == name
    with pytest.raises(TypeError):
        compiled.width("8")
    with pytest.raises(OverflowError):
        compiled.width(10**100)
    assert compiled.width(0) == name


def test_a_batch_needs_arrays():
    parameters = case(PROGRAMS["inverse_dynamics"])[0]
    for arguments in ((), ("inverse_dynamics",), ("inverse_dynamics", parameters)):
        with pytest.raises(TypeError, match="a name, parameters and arrays"):
            compiled.batch(*arguments)


Q = np.array([0.5, 0.7, 0.9, 1.1])


class Tagged(np.ndarray):
    """A subclass whose meaning is unknown."""


UNFIT = {
    "list": Q.tolist(),
    "tuple": tuple(Q),
    "None": None,
    "number": 1.0,
    "float32": Q.astype(np.float32),
    "integers": np.arange(4),
    "complex": Q + 0j,
    "objects": Q.astype(object),
    "text": np.array(["a"] * 4),
    "swapped bytes": Q.astype(">f8"),
    "long doubles": Q.astype(np.longdouble),
    "every second": np.tile(Q, 2)[::2],
    "backwards": Q[::-1],
    "broadcast": np.broadcast_to(1.0, 4),
    "unaligned": np.frombuffer(b"\0" * 33, np.uint8)[1:].view(np.float64),
    "short": Q[:3],
    "long": np.arange(5.0),
    "row": Q[None],
    "empty": np.empty(0),
    "scalar": np.array(1.0),
    "masked": np.ma.array(Q),
    "matrix": np.asarray(Q).view(Tagged),
    "NaN": np.array([0.0, np.nan, 0.0, 0.0]),
    "infinity": np.array([0.0, 0.0, 0.0, -np.inf]),
    "large": np.array([0.0, 0.0, np.nextafter(LARGEST, np.inf), 0.0]),
}


@pytest.mark.parametrize("unfit", UNFIT)
@pytest.mark.parametrize("place", range(3))
def test_what_is_not_plainly_a_state_gets_none(unfit, place):
    function = compiled.bind("inverse_dynamics", case(PROGRAMS["inverse_dynamics"])[0])
    given = [Q, Q, Q]
    assert function(*given).shape == (4,)
    given[place] = UNFIT[unfit]
    assert function(*given) is None


def test_what_is_plainly_a_state_is_taken():
    function = compiled.bind("inverse_dynamics", case(PROGRAMS["inverse_dynamics"])[0])
    frozen = Q.copy()
    frozen.flags.writeable = False
    edge = np.full(4, -LARGEST)
    expected = function(Q, Q, Q)
    assert np.array_equal(function(frozen, frozen, frozen), expected)
    assert np.array_equal(function(np.tile(Q, 2)[4:], Q, Q), expected)
    assert np.isfinite(function(edge, edge, edge)).all()
    assert function() is None
    assert function(Q, Q) is None
    assert function(Q, Q, Q, Q) is None
    first = function(Q, Q, Q)
    first[:] = 0.0  # the caller's own
    assert np.array_equal(function(Q, Q, Q), expected)


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 2 * LARGEST])
@pytest.mark.parametrize("row", [0, 33, ROWS - 1])
def test_a_batch_with_an_unfit_number_is_refused(width, value, row, any_width):
    any_width(width)
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"])
    for array in inputs:
        for column in range(4):
            kept = array[row, column]
            array[row, column] = value
            assert not compiled.batch("inverse_dynamics", parameters, *inputs, *outputs)
            array[row, column] = kept
    assert compiled.batch("inverse_dynamics", parameters, *inputs, *outputs)


def test_a_batch_of_unfit_arrays_is_refused():
    parameters, (q, v, a), (tau,) = case(PROGRAMS["inverse_dynamics"])

    def taken(*arrays):
        return compiled.batch("inverse_dynamics", parameters, *arrays)

    assert taken(q, v, a, tau)
    assert taken(q[:0], v[:0], a[:0], tau[:0])
    assert taken(q[1:], v[1:], a[1:], tau[1:])
    frozen = tau.copy()
    frozen.flags.writeable = False
    unfit = (
        q.tolist(),
        np.asfortranarray(q),
        q.astype(np.float32),
        q[:-1],
        q[:, :3],
        q[::2],
        np.tile(q, 2)[:, :4],
        None,
    )
    for array in unfit:
        assert not taken(array, v, a, tau)
        assert not taken(q, v, a, array)
    assert not taken(q, v, a, frozen)
    assert not taken(q, v, a)
    assert not taken(q, v, a, tau, tau)


def test_unfit_parameters_are_refused():
    parameters, (q, v, a), (tau,) = case(PROGRAMS["inverse_dynamics"])
    with pytest.raises(ValueError, match="parameters"):
        compiled.bind("inverse_dynamics")
    for parameter in (
        parameters[:-1],
        parameters.tolist(),
        parameters.astype(np.float32),
        None,
    ):
        with pytest.raises(ValueError, match="parameters"):
            compiled.bind("inverse_dynamics", parameter)
        with pytest.raises(ValueError, match="parameters"):
            compiled.batch("inverse_dynamics", parameter, q, v, a, tau)


def test_what_is_no_name_of_a_kernel_is_refused():
    parameters, _, _ = case(PROGRAMS["inverse_dynamics"])
    with pytest.raises(ValueError, match="no kernel 'none'"):
        compiled.bind("none", parameters)
    for name in (None, 3, b"inverse_dynamics"):
        with pytest.raises(TypeError):
            compiled.bind(name, parameters)
    for arguments in ((), ("inverse_dynamics", parameters, None, 1)):
        with pytest.raises(TypeError):
            compiled.bind(*arguments)


@pytest.mark.parametrize(
    "name", [name for name, of in PROGRAMS.items() if len(of.inputs) > 2]
)
def test_one_row_for_all_is_that_row_again_and_again(name, any_width):
    parameters, inputs, outputs = case(PROGRAMS[name])
    for place in range(len(inputs)):
        given = [*inputs]
        repeated = [*inputs]
        repeated[place] = np.broadcast_to(inputs[place][3], inputs[place].shape)
        given[place] = repeated[place].copy()
        for width in WIDTHS:
            any_width(width)
            for got, want in zip(
                by_batch(name, parameters, repeated, outputs),
                by_batch(name, parameters, given, outputs),
                strict=True,
            ):
                assert np.array_equal(got, want, equal_nan=True)
        by_numpy = [np.full_like(x, np.nan) for x in outputs]
        assert numpy_kernels.batch(name, parameters, *repeated, *by_numpy)
        compiled_results = by_batch(name, parameters, given, outputs)
        pairs = zip(by_numpy, compiled_results, strict=True)
        assert all(np.allclose(x, y, 1e-9, 1e-9, equal_nan=True) for x, y in pairs)
        for wrong in (np.nan, 2 * LARGEST):
            row = inputs[place][3].copy()
            row[-1] = wrong
            repeated[place] = np.broadcast_to(row, inputs[place].shape)
            for kernels in (compiled, numpy_kernels):
                assert not kernels.batch(name, parameters, *repeated, *by_numpy)


#: Both modules refuse the same batches.
BOTH = pytest.mark.parametrize(
    "kernels", [compiled, numpy_kernels], ids=["compiled", "numpy"]
)


@BOTH
@pytest.mark.parametrize("place", range(4))
def test_numbers_in_the_other_byte_order_are_refused(kernels, place):
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"])
    arrays = [*inputs, *outputs]
    # Taken for numbers of this machine's order they are ordinary.
    arrays[place] = arrays[place].view(arrays[place].dtype.newbyteorder())
    assert not kernels.batch("inverse_dynamics", parameters, *arrays)


@BOTH
def test_a_state_in_the_other_byte_order_is_refused(kernels):
    parameters = case(PROGRAMS["inverse_dynamics"])[0]
    function = kernels.bind("inverse_dynamics", parameters)
    for place in range(3):
        given = [Q, Q, Q]
        assert function(*given) is not None
        given[place] = Q.view(Q.dtype.newbyteorder())
        assert function(*given) is None


@BOTH
@pytest.mark.parametrize("place", range(4))
def test_as_many_numbers_in_other_rows_are_refused(kernels, place):
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"], rows=96)
    arrays = [*inputs, *outputs]
    for shape in ((192, 2), (48, 8), (384, 1), (1, 384), (384,)):
        others = [*arrays]
        others[place] = arrays[place].reshape(shape)
        assert not kernels.batch("inverse_dynamics", parameters, *others)


@BOTH
@pytest.mark.parametrize("place", range(3))
def test_one_row_for_all_has_the_right_size_and_is_given_as_often(kernels, place):
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"])
    row = np.arange(5.0)
    for shape in ((ROWS, 5), (ROWS, 3), (ROWS + 1, 4), (ROWS - 1, 4), (1, ROWS, 4)):
        arrays = [*inputs, *outputs]
        arrays[place] = np.broadcast_to(row[: shape[-1]], shape)
        assert not kernels.batch("inverse_dynamics", parameters, *arrays)


@BOTH
@pytest.mark.parametrize("place", range(3))
def test_one_row_for_all_lies_in_one_piece(kernels, place):
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"])
    apart = np.arange(8.0)[::2]
    backwards = np.arange(4.0)[::-1]
    bytes_off = np.frombuffer(b"\0" * 33, np.uint8)[1:].view(np.float64)
    one_for_all = np.broadcast_to(1.0, 4)
    single = np.arange(4.0, dtype=np.float32)
    for row in (apart, backwards, bytes_off, one_for_all, single):
        arrays = [*inputs, *outputs]
        arrays[place] = np.broadcast_to(row, (ROWS, 4))
        assert not kernels.batch("inverse_dynamics", parameters, *arrays)


@BOTH
@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize("unfit", [None, 1.0, np.array(1.0), [[1.0] * 4] * ROWS])
def test_what_is_no_array_of_rows_is_refused(kernels, place, unfit):
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"])
    arrays = [*inputs, *outputs]
    arrays[place] = unfit
    assert not kernels.batch("inverse_dynamics", parameters, *arrays)


@BOTH
def test_outputs_are_not_one_row_for_all(kernels):
    parameters, inputs, _ = case(PROGRAMS["inverse_dynamics"])
    row = np.zeros(4)
    output = np.lib.stride_tricks.as_strided(row, (ROWS, 4), (0, 8))
    read_only = np.zeros((ROWS, 4))
    read_only.flags.writeable = False
    for unfit in (output, read_only):
        assert not kernels.batch("inverse_dynamics", parameters, *inputs, unfit)
        assert not unfit.any()


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, -2 * LARGEST])
def test_an_unfit_row_for_all_is_refused_in_whole_panels(width, value, any_width):
    any_width(width)
    # Without a rest of rows, which would be checked one by one.
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"], rows=64)
    for place in range(3):
        for column in range(4):
            row = inputs[place][0].copy()
            row[column] = value
            arrays = [*inputs, *outputs]
            arrays[place] = np.broadcast_to(row, (64, 4))
            assert not compiled.batch("inverse_dynamics", parameters, *arrays)


def test_a_number_as_large_as_can_be_is_taken_in_panels_and_alone(any_width):
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"], rows=64)
    edge = np.full((64, 4), LARGEST)
    repeated = np.broadcast_to(np.full(4, -LARGEST), (64, 4))
    function = compiled.bind("inverse_dynamics", parameters)
    assert function(*(np.full(4, LARGEST) for _ in range(3))) is not None
    for width in WIDTHS:
        any_width(width)
        for given in (edge, repeated):
            for place in range(3):
                arrays = [*inputs, *outputs]
                arrays[place] = given
                assert compiled.batch("inverse_dynamics", parameters, *arrays)


def test_what_goes_out_may_take_the_place_of_what_came_in():
    parameters, (q, v, a), (tau,) = case(PROGRAMS["inverse_dynamics"])
    assert compiled.batch("inverse_dynamics", parameters, q, v, a, tau)
    assert compiled.batch("inverse_dynamics", parameters, q, v, a, a)
    assert np.array_equal(a, tau)


def test_threads_compute_the_same():
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"], rows=5000)
    (expected,) = by_batch("inverse_dynamics", parameters, inputs, outputs)
    function = compiled.bind("inverse_dynamics", parameters)
    wrong: list[int] = []

    def compute(number: int) -> None:
        for _ in range(5):
            (got,) = by_batch("inverse_dynamics", parameters, inputs, outputs)
            rows = zip(*(x[number::100] for x in inputs), strict=True)
            single = np.array([function(*row) for row in rows])
            if not (
                np.array_equal(got, expected)
                and np.array_equal(single, got[number::100])
            ):
                wrong.append(number)

    threads = [threading.Thread(target=compute, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def _torque(method: str) -> np.ndarray:
    parameters, inputs, outputs = case(PROGRAMS["inverse_dynamics"])
    return by_batch("inverse_dynamics", parameters, inputs, outputs)[0]


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes_compute_the_same(method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip("not on this system")
    with multiprocessing.get_context(method).Pool(1) as pool:
        got = pool.apply(_torque, (method,))
    assert np.array_equal(got, _torque(method))


def test_the_module_was_compiled_of_these_sources():
    spec = importlib.util.spec_from_file_location(
        "hatch_build", ROOT / "hatch_build.py"
    )
    build = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(build)
    assert build.digest() == compiled.SOURCES, "compile again: python hatch_build.py"


@pytest.mark.slow
@pytest.mark.parametrize("found", ["float x = 1; double y = 2.0 * x;", ""])
def test_no_float_becomes_a_double_unseen(found, tmp_path):
    """Users compile with the warning; a line that has one shows that it is on."""
    source = tmp_path / "kernels.c"
    file = ROOT / "alpha5_model/codegen/kernels/_compiled.c"
    source.write_text(f'#include "{file}"\nvoid last(void) {{{found}}}\n')
    python, numpy = sysconfig.get_path("include"), np.get_include()
    words = ["gcc", "-fsyntax-only", "-Werror=double-promotion", '-DSOURCES=""']
    done = subprocess.run(
        [*words, "-isystem", python, "-isystem", numpy, str(source)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert bool(done.returncode) == bool(found), done.stderr
    assert ("double-promotion" in done.stderr) == bool(found)


class Weigher:
    """A class with the method that a kernel falls back to."""

    def weigh(self, q: object, v: object = None, *, more: float = 0.0) -> tuple:
        """The arguments that it was given."""
        if v == "error":
            raise ZeroDivisionError
        return q, v, more


def bound(fallback: object) -> tuple:
    parameters, (q,), _ = case(PROGRAMS["hydrostatic_torque"], rows=1)
    return compiled.bind("hydrostatic_torque", parameters, fallback), q[0], parameters


def test_a_fallback_answers_what_the_kernel_does_not_take():
    weigh = Weigher().weigh
    function, q, parameters = bound(weigh)
    alone = compiled.bind("hydrostatic_torque", parameters)
    assert np.array_equal(function(q), alone(q))
    assert np.array_equal(function(*(q,), **{}), alone(q))
    assert function([1.0]) == ([1.0], None, 0.0)
    assert function(q=q)[0] is q
    assert function(q, 3) == (q, 3, 0.0)
    assert function(q, more=2.0)[2] == 2.0
    assert type(function).__call__(function, "given")[0] == "given"
    assert alone([1.0]) is alone(q=q) is alone() is None
    with pytest.raises(ZeroDivisionError):
        function(q, "error")
    for arguments, named in (((), {}), ((q, q, q), {}), ((q,), {"other": 1})):
        with pytest.raises(TypeError) as caught:
            function(*arguments, **named)
        with pytest.raises(TypeError, match=re.escape(str(caught.value))):
            weigh(*arguments, **named)


def test_a_bound_kernel_looks_like_its_fallback():
    weigh = Weigher().weigh
    function, _, _ = bound(weigh)
    assert function.__doc__ == weigh.__doc__
    assert inspect.signature(function) == inspect.signature(weigh)
    assert "weigh(q: 'object', v: 'object' = None" in pydoc.plaintext.document(function)
    assert function.__self__ is weigh.__self__
    assert pickle.loads(pickle.dumps(function))([1]) == ([1], None, 0.0)
    with pytest.raises(AttributeError, match="other"):
        function.other  # noqa: B018
    with pytest.raises(AttributeError):
        function.name = 1
    for make in (type(function), partial(object.__new__, type(function))):
        with pytest.raises(TypeError):
            make()


def test_references_are_given_back():
    weigh = Weigher().weigh
    function, q, parameters = bound(weigh)
    given = [1.0]
    named = {"more": given}

    def every():
        function(q)
        function(given)
        function(given, **named)
        function.__doc__  # noqa: B018
        bound(weigh)
        with contextlib.suppress(ValueError):
            compiled.bind("hydrostatic_torque", None, weigh)
        with contextlib.suppress(ZeroDivisionError):
            function(q, "error")

    every()
    gc.collect()
    counted = (
        q,
        parameters,
        weigh,
        given,
        named,
        function,
        type(function),
        weigh.__self__,
    )
    before = [*map(sys.getrefcount, counted)]
    for _ in range(100):
        every()
    gc.collect()
    assert [*map(sys.getrefcount, counted)] == before


def test_a_circle_through_a_bound_kernel_is_collected():
    owner = Weigher()
    owner.weigh, _, _ = bound(owner.weigh)
    gone = weakref.ref(owner)
    del owner
    gc.collect()
    assert gone() is None


def test_a_bound_kernel_outlives_who_made_it():
    function, q, _ = bound(Weigher().weigh)
    gc.collect()
    assert function([2.0]) == ([2.0], None, 0.0)
    assert function(q).shape == (4,)


@pytest.mark.parametrize("unfit", UNFIT)
def test_what_is_a_state_is_known(unfit):
    for kernels in (compiled, numpy_kernels):
        assert kernels.is_state(4, 4, Q) is kernels.is_state(4, 4, Q, Q, Q) is True
        assert kernels.is_state(7, 4, np.ones(7), Q)
        assert not kernels.is_state(4, 7, np.ones(7), Q)
        for place in range(3):
            given = [Q, Q, Q]
            given[place] = UNFIT[unfit]
            assert kernels.is_state(4, 4, *given) is False
    with pytest.raises(TypeError):
        compiled.is_state("4", 4, Q)
