"""The errors: one tree, fitting built-ins, one line of given, expected and choices."""

from __future__ import annotations

import array
import copy
import inspect
import pickle
import re
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse

import alpha5_model as a5
from alpha5_model import errors
from alpha5_model._support import checks
from alpha5_model.numbers import inertia


def pickled(error: Any) -> Any:
    return pickle.loads(pickle.dumps(error))


def instances() -> list[errors.Alpha5Error]:
    return [
        errors.InputError("mass", "heavy", "one real number"),
        errors.ShapeError("q", (3,), "shape (..., 4)"),
        errors.NonFiniteError("q", float("nan"), (1, 2)),
        errors.UnknownNameError("frame", "tpc", ("tcp", "base_link")),
        errors.JointLimitError("axis_d", 4.0, 3.4),
        errors.UnreachableError((1.0, 0.0, 0.0), 0.25, (0.75, 0.0, 0.0)),
        errors.SelfCollisionError(
            (0.1, 0.0, 0.0), links=("link_0", "link_2"), depth=0.003, yaw=0.5
        ),
        errors.DiscontinuousPathError(3, (1.0, 0.0, 0.0), 3.1, 0.5),
        errors.BlockedMotionError(
            "no free way", ("post", "link_3"), (1.0, 1.0, 1.0, 1.0), -0.001
        ),
        errors.MotionLimitError("axis_d", "current", 0.4, 0.3, "A"),
        errors.NoPlacementError(
            tried=100,
            reaching=7,
            beyond=0.0,
            needed=0.1,
            possible=0.04,
            touching={"arm and an obstacle": 0},
        ),
        errors.MissingParameterError("rotor_inertia", "reflected inertia"),
        errors.MissingFileError("arm.urdf", "a URDF"),
        errors.FileFormatError("log.csv", "not a number", "line 3"),
        errors.KernelError("inverse_dynamics", "rows"),
        errors.OutputError("out.urdf", "no space left"),
        errors.ViewerError("the viewer is closed"),
        errors.MissingDependencyError(
            "matplotlib", "plotting", "pip install 'alpha5-model[plot]'"
        ),
    ]


def test_every_class_of_the_tree_is_tested() -> None:
    defined = {
        c
        for _, c in inspect.getmembers(errors, inspect.isclass)
        if c.__module__ == errors.__name__
    }
    others = {errors.Alpha5Error, errors.ImplausibleWarning}
    assert {type(e) for e in instances()} == defined - others


def test_one_tree_and_a_fitting_builtin() -> None:
    for error in instances():
        assert isinstance(error, ValueError | OSError | ImportError | RuntimeError)
        message = str(error)
        assert message
        assert "\n" not in message


def test_attributes_and_messages() -> None:
    unknown = errors.UnknownNameError("frame", "tpc", iter(["tcp", "base_link"]))
    assert (unknown.kind, unknown.name, unknown.choices) == (
        "frame",
        "tpc",
        ("tcp", "base_link"),
    )
    assert str(unknown) == "unknown frame 'tpc'; choose from tcp, base_link"
    limit = errors.JointLimitError("axis_d", -1.0, 0.01745)
    assert str(limit) == "axis_d: -1 rad is below the lower limit 0.01745 rad"
    reach = errors.UnreachableError((1.0, 0.0, 0.0), 0.25, (0.75, 0.0, 0.0))
    assert reach.distance == 0.25
    assert "250 mm away" in str(reach)
    near = errors.UnreachableError((1.0, 0.0, 0.0), 0.0995, (0.9005, 0.0, 0.0))
    assert "is 99.5 mm away" in str(near)
    assert str(errors.NonFiniteError("q", float("nan"), (1, 2))).startswith(
        "q[1, 2]: expected finite"
    )
    assert len(str(errors.InputError("q", "x" * 500, "a number"))) < 150


def test_a_value_that_prints_over_several_lines_leaves_the_message_on_one() -> None:
    value = np.eye(2) * 1j
    assert "\n" in repr(value)
    assert "\n" not in str(errors.InputError("q", value, "an array of real numbers"))


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickled])
def test_an_error_survives_copying_and_pickling(copied: Any) -> None:
    for error in instances():
        survives(error, copied)


def survives(error: errors.Alpha5Error, copied: Any) -> None:
    error.add_note("while testing")
    twin = copied(error)
    assert twin is not error
    assert type(twin) is type(error)
    assert (str(twin), repr(twin), twin.args) == (str(error), repr(error), error.args)
    assert vars(twin).keys() == vars(error).keys()
    assert str(vars(twin)) == str(vars(error))
    builtin = {"msg", "errno", "strerror", "filename"}
    assert all(getattr(twin, x, 0) == getattr(error, x, 0) for x in builtin)
    assert pickled(twin).args == error.args


def test_an_attribute_that_cannot_be_pickled_arrives_printed() -> None:
    twin = pickled(errors.InputError("q", (x for x in ()), "numbers"))
    assert twin.name == "q"
    assert twin.value.startswith("<generator object")
    unprintable = type("Odd", (), {"__repr__": lambda self: 1 / 0})()
    assert (
        str(errors.InputError("q", unprintable, "numbers"))
        == "q: expected numbers, got an object of the class Odd"
    )


# --- the checks that raise them -------------------------------------------------------


@pytest.mark.parametrize(
    "value", ["abc", None, [1j], [[1], [1, 2]], [None], {}, [True], object()]
)
def test_what_is_not_real_is_refused(value: object) -> None:
    with pytest.raises(errors.InputError):
        checks.float_array("q", value, (1,))
    with pytest.raises(errors.InputError, match="q: expected"):
        checks.real("q", value)


class Tracked(np.ndarray):
    """An array of another package, as trimesh's, whose numbers are all it says."""


class Quantity:
    """Numbers with a unit, as pint and astropy have them; NumPy reads the numbers."""

    def __init__(self, unit: str) -> None:
        setattr(self, unit, "deg")

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return np.array([1.0, 2.0])

    def __len__(self) -> int:
        return 2

    def __getitem__(self, index: int) -> float:
        return [1.0, 2.0][index]


class Failing:
    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        raise RuntimeError("still on the graph")


MASKED = np.ma.masked_array([1.0, 2.0], mask=[False, True])
ENDLESS: list[Any] = []
ENDLESS.append(ENDLESS)


def test_arrays_of_other_packages_are_read() -> None:
    array = np.array([1.0, 2.0]).view(Tracked)
    checked = checks.float_array("x", array, (2,))
    assert type(checked) is np.ndarray
    assert checked.tolist() == [1.0, 2.0]


@pytest.mark.parametrize(
    "value",
    [
        MASKED,
        np.ma.masked_array([1.0, 2.0]),
        [MASKED, MASKED],
        [1.0, np.ma.masked],
        [1.0, True],
        (1.0, np.bool_(False)),
        [[1.0, 2.0], [1.0, False]],
        ["1", "2"],
        [1.0, "2"],
        bytearray(b"12"),
        b"12",
        [1.0 + 0j, 2.0],
        np.array([1, 2], dtype=object),
        np.array([(1.0, 2.0)], dtype=[("x", float), ("y", float)]),
        np.array(["2020-01-01", "2020-01-02"], dtype="datetime64[D]"),
        np.array([1, 2], dtype="timedelta64[s]"),
        [Fraction(1), Decimal(2)],
        Quantity("unit"),
        Quantity("units"),
        [Quantity("unit")],
        scipy.sparse.csr_matrix([[1.0, 2.0]]),
        scipy.sparse.csr_array([[1.0, 2.0]]),
        Failing(),
        ENDLESS,
        {1.0, 2.0},
        (x for x in (1.0, 2.0)),
        [10**400, 1],
    ],
    ids=lambda value: type(value).__name__,
)
def test_what_says_more_than_its_numbers_is_refused(value: object) -> None:
    for read in (
        lambda x: checks.float_array("q", x, ()),
        lambda x: checks.shaped("q", x, (2,)),
    ):
        with pytest.raises(errors.InputError):
            read(value)


@pytest.mark.parametrize(
    "value",
    [
        [1, 2.0],
        (np.float32(1.0), np.int8(2)),
        range(1, 3),
        array.array("f", [1.0, 2.0]),
        np.array([1, 2], dtype=np.uint8),
        np.array([1.0, 2.0], dtype=">f4"),
        np.array([1.0, 2.0], dtype=np.longdouble),
        [np.array(1.0), np.array([2.0])[0]],
    ],
    ids=lambda value: type(value).__name__,
)
def test_plain_numbers_of_every_kind_are_read(value: Any, tmp_path: Path) -> None:
    read = checks.float_array("q", value, (2,))
    assert type(read) is np.ndarray
    assert read.dtype is np.dtype(np.float64)
    assert read.tolist() == [1.0, 2.0]
    mapped = np.memmap(tmp_path / "q", dtype=np.float64, mode="w+", shape=(2,))
    mapped[:] = 1.0, 2.0
    assert checks.float_array("q", mapped, (2,)).tolist() == [1.0, 2.0]


def test_a_number_beyond_float_is_not_finite() -> None:
    big = np.full(2, np.finfo(np.longdouble).max)
    if np.finfo(np.longdouble).max > np.finfo(np.float64).max:
        with pytest.raises(errors.NonFiniteError, match=r"q\[0\]"):
            checks.float_array("q", big, (2,))


def test_one_tolerance_for_rotations_everywhere() -> None:
    """Seven printed digits are a rotation, five are none, for whoever asks."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    target = np.eye(4)

    def posed(r: Any) -> Any:
        target[:3, :3], target[:3, 3] = r, (0.25, 0.1, 0.1)
        return target

    takers = [
        a5.gravity_in_base,
        lambda r: inertia.rotate_tensor(r, np.eye(3)),
        lambda r: checks.rigid_transform("base", posed(r)),
        lambda r: a5.inverse_kinematics_pose(posed(r)),
    ]
    edge = np.eye(3) * np.sqrt(1 + 0.99 * checks.ROTATION_TOLERANCE)
    for take in takers:
        for good in (turn, turn.round(7), edge):
            take(good)
        beyond = np.eye(3) * np.sqrt(1 + 1.01 * checks.ROTATION_TOLERANCE)
        for bad in (
            turn.round(5),
            -turn,
            np.diag([1.0, -1.0, 1.0]),
            beyond,
            1e300 * turn,
            0 * turn,
        ):
            with pytest.raises(errors.InputError):
                take(bad)


@pytest.mark.parametrize("shape", [(), (3,), (4, 3), (4, 0)])
def test_wrong_trailing_shape(shape: tuple[int, ...]) -> None:
    with pytest.raises(errors.ShapeError, match=r"shape \(\.\.\., 4\)") as caught:
        checks.float_array("q", np.zeros(shape), (4,))
    assert caught.value.value == shape


@pytest.mark.parametrize("shape", [(4,), (0, 4), (2, 3, 4)])
def test_leading_axes_are_free(shape: tuple[int, ...]) -> None:
    assert checks.float_array("q", np.zeros(shape, dtype=int), (4,)).shape == shape


def test_first_bad_place_is_named() -> None:
    q = np.zeros((3, 4))
    q[1, 2], q[2, 3] = np.nan, np.inf
    with pytest.raises(errors.NonFiniteError, match=r"q\[1, 2\]") as caught:
        checks.float_array("q", q, (4,))
    assert caught.value.index == (1, 2)


def test_real_and_its_bounds() -> None:
    assert checks.real("mass", np.float32(0.5)) == 0.5
    assert checks.real("mass", 0, minimum=0) == 0.0
    with pytest.raises(errors.InputError):
        checks.real("mass", 0, minimum=0, strict=True)
    with pytest.raises(errors.InputError):
        checks.real("mass", -1, minimum=0)
    with pytest.raises(errors.InputError):
        checks.real("mass", [1.0])
    with pytest.raises(errors.NonFiniteError):
        checks.real("mass", float("nan"))
    for far in (2e51, -2e51):
        assert checks.real("mass", far) == far
        with pytest.raises(errors.InputError):
            checks.real("mass", 2 * far)


@pytest.mark.parametrize("name", ["b", None, 3, ["a"]])
def test_choice(name: object) -> None:
    assert checks.choice("format", "a", ("a",)) == "a"
    with pytest.raises(errors.UnknownNameError):
        checks.choice("format", name, ("a",))


def test_frozen_is_a_read_only_copy() -> None:
    mine = np.zeros(3)
    theirs = checks.frozen(mine)
    mine[0] = 1.0
    assert theirs[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        theirs[0] = 1.0


def test_a_long_message_is_shortened() -> None:
    assert len(str(errors.Alpha5Error(5000 * "x"))) < 1100


#: Of errors with numbers: each number has three digits that any other unit changes.
SAID = [
    (
        errors.UnreachableError((1.0, 0.0, -0.25), 0.997, (0.003, 0.0, -0.25)),
        "(1, 0, -0.25) m cannot be reached: the nearest reachable point "
        "(0.003, 0, -0.25) m is 997 mm away",
    ),
    (
        errors.UnreachableError((1.0, 0.0, 0.0), float("nan"), (0.0, 0.0, 0.0), " so"),
        "(1, 0, 0) m cannot be reached so",
    ),
    (
        errors.SelfCollisionError(
            (0.1, 0.0, 0.0), links=("link_0", "link_2"), depth=0.997, wrist=0.9973
        ),
        "(0.1, 0, 0) m cannot be reached without self-collision: "
        "link_0 and link_2 overlap by 997 mm; theta_3 = 0.9973 rad is free",
    ),
    (
        errors.SelfCollisionError(
            (0.1, 0.0, 0.0),
            links=("link_0", "link_2"),
            depth=0.003,
            yaw=0.9973,
            place=" there",
        ),
        "(0.1, 0, 0) m cannot be reached without self-collision there: "
        "link_0 and link_2 overlap by 3 mm; "
        "turned by 0.9973 rad about the yaw axis it is free",
    ),
    (
        errors.DiscontinuousPathError(7, (0.1, 0.2, 0.3), 0.997, 0.0997),
        "positions[7] = (0.1, 0.2, 0.3) m has no allowed continuation: "
        "a joint would have to jump by 0.997 rad, allowed are 0.0997 rad",
    ),
    (
        errors.BlockedMotionError("no way", ("hull", "link_2"), (1, 0.5, 2, 3), 0.997),
        "no way: hull and link_2 are 997 mm apart at (1, 0.5, 2, 3) rad",
    ),
    (
        errors.BlockedMotionError("no way", ("hull", "link_2"), (1, 0.5, 2, 3), -0.997),
        "no way: hull and link_2 are 997 mm deep in each other at (1, 0.5, 2, 3) rad",
    ),
    (
        errors.MotionLimitError("axis_e", "torque", 9.973, 8.997, "N m"),
        "axis_e: the motion needs a torque of 9.973 N m at any speed, "
        "its limit is 8.997 N m",
    ),
    (
        errors.JointLimitError("axis_d", 0.0, 0.00997, "N m"),
        "axis_d: 0 N m is below the lower limit 0.00997 N m",
    ),
    (
        errors.JointLimitError("axis_d", 4.0, 3.4),
        "axis_d: 4 rad is above the upper limit 3.4 rad",
    ),
]


def quantities(text: str) -> list[str]:
    """The numbers of a message with their units; of a point, its coordinates."""
    return re.findall(r"\([^()]*\) m|\([^()]*\) rad|-?[\d.]+ (?:mm|m|rad|N m)\b", text)


def test_numbers_are_said_in_the_units_that_are_said() -> None:
    for error, said in SAID:
        assert quantities(said)
        assert quantities(str(error)) == quantities(said), said
