"""The errors: one tree, built-ins that fit, one line that names given, expected and choices."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

from alpha5_model import checks, errors


def instances() -> list[errors.Alpha5Error]:
    return [
        errors.InputError("mass", "heavy", "one real number"),
        errors.ShapeError("q", (3,), "shape (..., 4)"),
        errors.NonFiniteError("q", float("nan"), (1, 2)),
        errors.UnknownNameError("frame", "tpc", ("tcp", "base_link")),
        errors.PublishedDataError("table_2.rows[0].mass", "missing"),
        errors.JointLimitError("axis_d", 4.0, 3.4),
        errors.UnreachableError((1.0, 0.0, 0.0), 0.25, (0.75, 0.0, 0.0)),
        errors.DiscontinuousPathError(3, (1.0, 0.0, 0.0), 3.1, 0.5),
        errors.MissingParameterError("rotor_inertia", "reflected inertia"),
        errors.MissingFileError("arm.urdf", "a URDF"),
        errors.FileFormatError("log.csv", "not a number", "line 3"),
        errors.OutputError("out.urdf", "no space left"),
        errors.PortInUseError(7000),
        errors.NoDisplayError("give --html FILE"),
        errors.MissingDependencyError("matplotlib", "plotting", "pip install 'alpha5-model[plot]'"),
    ]


def test_every_class_of_the_tree_is_tested() -> None:
    defined = {
        c for _, c in inspect.getmembers(errors, inspect.isclass) if c.__module__ == errors.__name__
    }
    assert {type(e) for e in instances()} == defined - {errors.Alpha5Error}


@pytest.mark.parametrize("error", instances(), ids=lambda e: type(e).__name__)
def test_one_tree_and_a_fitting_builtin(error: errors.Alpha5Error) -> None:
    assert isinstance(error, ValueError | OSError | ImportError)
    message = str(error)
    assert message
    assert "\n" not in message


def test_attributes_and_messages() -> None:
    unknown = errors.UnknownNameError("frame", "tpc", iter(["tcp", "base_link"]))
    assert (unknown.kind, unknown.name, unknown.choices) == ("frame", "tpc", ("tcp", "base_link"))
    assert str(unknown) == "unknown frame 'tpc'; choose from tcp, base_link"
    limit = errors.JointLimitError("axis_d", -1.0, 0.01745)
    assert str(limit) == "axis_d: -1 rad is below the lower limit 0.01745 rad"
    reach = errors.UnreachableError((1.0, 0.0, 0.0), 0.25, (0.75, 0.0, 0.0))
    assert reach.distance == 0.25
    assert "250 mm away" in str(reach)
    assert str(errors.NonFiniteError("q", float("nan"), (1, 2))).startswith(
        "q[1, 2]: expected finite"
    )
    assert len(str(errors.InputError("q", "x" * 500, "a number"))) < 150


def test_a_value_that_prints_over_several_lines_leaves_the_message_on_one() -> None:
    value = np.eye(2) * 1j
    assert "\n" in repr(value)
    assert "\n" not in str(errors.InputError("q", value, "an array of real numbers"))


# --- the checks that raise them ---------------------------------------------------------------


@pytest.mark.parametrize("value", ["abc", None, [1j], [[1], [1, 2]], [None], {}, [True], object()])
def test_what_is_not_real_is_refused(value: object) -> None:
    with pytest.raises(errors.InputError, match="q: expected an array of real numbers"):
        checks.float_array("q", value, (1,))
    with pytest.raises(errors.InputError, match="q: expected"):
        checks.real("q", value)


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
    with pytest.raises(errors.InputError, match="above 0"):
        checks.real("mass", 0, minimum=0, strict=True)
    with pytest.raises(errors.InputError, match="at least 0"):
        checks.real("mass", -1, minimum=0)
    with pytest.raises(errors.InputError, match="one real number"):
        checks.real("mass", [1.0])
    with pytest.raises(errors.NonFiniteError):
        checks.real("mass", float("nan"))


@pytest.mark.parametrize("name", ["b", None, 3, ["a"]])
def test_choice(name: object) -> None:
    assert checks.choice("format", "a", ("a",)) == "a"
    with pytest.raises(errors.UnknownNameError, match=r"choose from a$"):
        checks.choice("format", name, ("a",))


def test_frozen_is_a_read_only_copy() -> None:
    mine = np.zeros(3)
    theirs = checks.frozen(mine)
    mine[0] = 1.0
    assert theirs[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        theirs[0] = 1.0
