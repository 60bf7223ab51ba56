"""The compiled module: equal widths, refused arrays, threads and processes."""

from __future__ import annotations

import contextlib
import gc
import importlib.util
import inspect
import itertools
import multiprocessing
import pickle
import platform
import pydoc
import re
import subprocess
import sys
import sysconfig
import threading
import weakref
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from compiled_kernels import compiled_kernels

from alpha5_model._support.checks import LARGEST
from alpha5_model.codegen.kernels import numpy_kernels
from alpha5_model.codegen.kernels.generated.formulas import KERNELS
from alpha5_model.codegen.regrouping import BASE_PARAMETERS

compiled = compiled_kernels()
ROOT = Path(__file__).resolve().parents[2]
ROWS = 103  # three panels and a rest
#: The most numbers of a state are fewer: a pose of a vehicle has seven.
LEAST_PARAMETERS = 10
WIDTHS = {1: "scalar", 2: "sse2", 4: "avx2", 8: "avx512"}


@pytest.fixture
def any_width():
    """The function that chooses a width; the test's end chooses the widest again."""
    yield compiled.width
    compiled.width(8)


def case(name: str, rows: int = ROWS, scale: float = 3.0) -> tuple:
    """Parameters, inputs and empty outputs of random states."""
    rng = np.random.default_rng(7)
    _, sizes, shapes = KERNELS[name]
    inputs = [size for (size,) in sizes if size < LEAST_PARAMETERS]
    parameters = rng.uniform(0.1, 1.0, sizes[-1][0] * (len(inputs) < len(sizes)))
    return (
        parameters,
        [rng.uniform(-scale, scale, (rows, size)) for size in inputs],
        [np.full((rows, *shape), np.nan) for shape in shapes],
    )


def same_bits(one: list, other: list) -> bool:
    pairs = zip(one, other, strict=True)
    return all(np.array_equal(x.view(np.int64), y.view(np.int64)) for x, y in pairs)


def by_batch(name: str, parameters: np.ndarray, inputs: list, outputs: list) -> list:
    outputs = [np.full_like(x, np.nan) for x in outputs]
    assert compiled.batch(name, parameters, *inputs, *outputs)
    return outputs


def by_bind(name: str, parameters: np.ndarray, inputs: list) -> list:
    function = compiled.bind(name, parameters)
    rows = [function(*(x.copy() for x in row)) for row in zip(*inputs, strict=True)]
    rows = [row if isinstance(row, tuple) else (row,) for row in rows]
    return [np.array(column) for column in zip(*rows, strict=True)]


def test_every_width_gives_the_same_bits_as_single_calls(any_width):
    different = []
    for name, scale in itertools.product(KERNELS, (3.0, 1e6)):
        parameters, inputs, outputs = case(name, scale=scale)
        single = by_bind(name, parameters, inputs)
        for width in WIDTHS:
            any_width(width)
            alone = by_bind(name, parameters, inputs)
            together = by_batch(name, parameters, inputs, outputs)
            if not (same_bits(alone, single) and same_bits(together, single)):
                different.append((name, scale, width))
    assert not different


def test_a_few_rare_rows_do_not_change_the_others(any_width):
    rare = np.arange(5, ROWS, 17)
    others = np.setdiff1d(np.arange(ROWS), rare)
    different = []
    for name in KERNELS:
        parameters, inputs, outputs = case(name)
        any_width(8)
        plain = by_batch(name, parameters, inputs, outputs)
        inputs[0][rare] *= 1e40
        once = by_batch(name, parameters, inputs, outputs)
        any_width(1)
        narrow = by_batch(name, parameters, inputs, outputs)
        for got, before, one_by_one in zip(once, plain, narrow, strict=True):
            if not np.array_equal(got[others], before[others], equal_nan=True):
                different.append((name, "others"))
            if not np.array_equal(got[rare], one_by_one[rare], equal_nan=True):
                different.append((name, "rare"))
    assert not different


@pytest.mark.parametrize("gravity", [(0.0, -0.0), (3.0, 0.0), (0.0, 3.0)])
def test_an_arm_that_stands_upright_has_bodies_of_its_own(gravity, any_width):
    from alpha5_model.codegen.sources import UPRIGHT

    at = [*BASE_PARAMETERS].index("gravity.x")
    for name in UPRIGHT:
        parameters, inputs, outputs = case(name)
        parameters[at : at + 2] = gravity
        wanted = [np.full_like(x, np.nan) for x in outputs]
        assert numpy_kernels.batch(name, parameters, *inputs, *wanted)
        single = by_bind(name, parameters, inputs)
        for got, want in zip(single, wanted, strict=True):
            scale = np.abs(want).max(axis=tuple(range(1, want.ndim)), keepdims=True)
            assert (np.abs(got - want) <= 1e-9 * scale).all(), name
        for width in WIDTHS:
            any_width(width)
            together = by_batch(name, parameters, inputs, outputs)
            assert same_bits(together, single), (name, width)


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


def test_what_is_not_plainly_a_state_gets_none():
    function = compiled.bind("inverse_dynamics", case("inverse_dynamics")[0])
    assert function(Q, Q, Q).shape == (4,)
    taken = []
    for unfit, place in itertools.product(UNFIT, range(3)):
        given = [Q, Q, Q]
        given[place] = UNFIT[unfit]
        if function(*given) is not None:
            taken.append((unfit, place))
        for kernels in (compiled, numpy_kernels):
            if kernels.is_state(4, 4, *given):
                taken.append((unfit, place, kernels))
    assert not taken
    for kernels in (compiled, numpy_kernels):
        assert (
            kernels.is_state(4, 4, Q) is kernels.is_state(7, 4, np.ones(7), Q) is True
        )
        assert not kernels.is_state(4, 7, np.ones(7), Q)


def test_what_is_plainly_a_state_is_taken():
    function = compiled.bind("inverse_dynamics", case("inverse_dynamics")[0])
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


@pytest.mark.parametrize("rows", [64, ROWS])
def test_a_batch_with_an_unfit_number_is_refused(rows, any_width):
    """In panels, in a rest of rows, and in one row for all."""
    name = "inverse_dynamics"
    parameters, inputs, outputs = case(name, rows)
    values = (np.nan, np.inf, -np.inf, 2 * LARGEST)
    taken = []
    for width, value in itertools.product(WIDTHS, values):
        any_width(width)
        for place, column in itertools.product(range(3), range(4)):
            array = inputs[place]
            for row in (0, 33, rows - 1):
                kept = array[row, column]
                array[row, column] = value
                if compiled.batch(name, parameters, *inputs, *outputs):
                    taken.append((width, value, place, column, row))
                array[row, column] = kept
            one = array[0].copy()
            one[column] = value
            arrays = [*inputs, *outputs]
            arrays[place] = np.broadcast_to(one, (rows, 4))
            if compiled.batch(name, parameters, *arrays):
                taken.append((width, value, place, column, "all"))
        assert compiled.batch(name, parameters, *inputs, *outputs)
    assert not taken


def unfit_batches(inputs: list, outputs: list) -> Iterator[tuple[str, list]]:
    """What of 96 rows no kernel may read or write."""
    arrays = [*inputs, *outputs]

    def with_one(place: int, array: object) -> list:
        return [*arrays[:place], array, *arrays[place + 1 :]]

    for place, array in enumerate(arrays):
        # Taken for numbers of this machine's order they are ordinary.
        swapped = array.view(array.dtype.newbyteorder())
        anywhere = {
            "a list": array.tolist(),
            "nothing": None,
            "a number": 1.0,
            "no rows": np.array(1.0),
            "columns": np.asfortranarray(array),
            "single precision": array.astype(np.float32),
            "too few": array[:-1],
            "too narrow": array[:, :3],
            "every second": array[::2],
            "apart": np.tile(array, 2)[:, :4],
            "the other byte order": swapped,
            **{
                f"the shape {shape}": array.reshape(shape)
                for shape in ((192, 2), (48, 8), (384, 1), (1, 384), (384,))
            },
        }
        for what, unfit in anywhere.items():
            yield f"{what} at {place}", with_one(place, unfit)
    five = np.arange(5.0)
    rows = {
        "apart": np.arange(8.0)[::2],
        "backwards": np.arange(4.0)[::-1],
        "bytes off": np.frombuffer(b"\0" * 33, np.uint8)[1:].view(np.float64),
        "one for all": np.broadcast_to(1.0, 4),
        "single": np.arange(4.0, dtype=np.float32),
    }
    for place in range(3):
        for shape in ((96, 5), (96, 3), (97, 4), (95, 4), (1, 96, 4)):
            one_row = np.broadcast_to(five[: shape[-1]], shape)
            yield f"one row as {shape} at {place}", with_one(place, one_row)
        for what, row in rows.items():
            one_row = np.broadcast_to(row, (96, 4))
            yield f"one row, {what}, at {place}", with_one(place, one_row)
    frozen = np.zeros((96, 4))
    frozen.flags.writeable = False
    overlapping = np.lib.stride_tricks.as_strided(np.zeros(4), (96, 4), (0, 8))
    yield "read only", with_one(3, frozen)
    yield "one row to write", with_one(3, overlapping)
    yield "one too few", arrays[:-1]
    yield "one too many", [*arrays, outputs[0]]


@pytest.mark.parametrize(
    "kernels", [compiled, numpy_kernels], ids=["compiled", "numpy"]
)
def test_a_batch_of_unfit_arrays_is_refused(kernels):
    name = "inverse_dynamics"
    parameters, inputs, outputs = case(name, rows=96)
    assert kernels.batch(name, parameters, *inputs, *outputs)
    none = [x[:0] for x in (*inputs, *outputs)]
    assert kernels.batch(name, parameters, *none)
    outputs[0][:] = 0.0
    taken = [
        what
        for what, arrays in unfit_batches(inputs, outputs)
        if kernels.batch(name, parameters, *arrays)
    ]
    assert not taken
    assert not outputs[0].any()


def test_unfit_parameters_and_names_are_refused():
    name = "inverse_dynamics"
    parameters, inputs, outputs = case(name)
    for unfit in (parameters[:-1], parameters.tolist(), None):
        with pytest.raises(ValueError, match="parameters"):
            compiled.bind(name, unfit)
        with pytest.raises(ValueError, match="parameters"):
            compiled.batch(name, unfit, *inputs, *outputs)
    with pytest.raises(ValueError, match="none"):
        compiled.bind("none", parameters)
    for arguments in ((), (None, parameters), (name, parameters, None, 1)):
        with pytest.raises(TypeError):
            compiled.bind(*arguments)
    for arguments in ((), (name,), (name, parameters)):
        with pytest.raises(TypeError):
            compiled.batch(*arguments)


def test_one_row_for_all_is_that_row_again_and_again(any_width):
    different = []
    for name in KERNELS:
        parameters, inputs, outputs = case(name)
        for place in range(len(inputs) * (len(inputs) > 1)):
            given = [*inputs]
            repeated = [*inputs]
            repeated[place] = np.broadcast_to(inputs[place][3], inputs[place].shape)
            given[place] = repeated[place].copy()
            for width in WIDTHS:
                any_width(width)
                one = by_batch(name, parameters, repeated, outputs)
                other = by_batch(name, parameters, given, outputs)
                if not same_bits(one, other):
                    different.append((name, place, width))
            by_numpy = [np.full_like(x, np.nan) for x in outputs]
            assert numpy_kernels.batch(name, parameters, *repeated, *by_numpy)
            for x, y in zip(by_numpy, other, strict=True):
                if not np.allclose(x, y, 1e-9, 1e-9, equal_nan=True):
                    different.append((name, place, "NumPy"))
    assert not different


def test_a_number_as_large_as_can_be_is_taken_in_panels_and_alone(any_width):
    parameters, inputs, outputs = case("inverse_dynamics", rows=64)
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
    parameters, (q, v, a), (tau,) = case("inverse_dynamics")
    assert compiled.batch("inverse_dynamics", parameters, q, v, a, tau)
    assert compiled.batch("inverse_dynamics", parameters, q, v, a, a)
    assert np.array_equal(a, tau)


def test_threads_compute_the_same():
    parameters, inputs, outputs = case("inverse_dynamics", rows=5000)
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
    parameters, inputs, outputs = case("inverse_dynamics")
    return by_batch("inverse_dynamics", parameters, inputs, outputs)[0]


@pytest.mark.parametrize(
    "method", ["fork", pytest.param("spawn", marks=pytest.mark.slow)]
)
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


@pytest.mark.tools
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
    parameters, (q,), _ = case("hydrostatic_torque", rows=1)
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
