"""A slice of the fuzz, what it found before, and that it sees what is wrong."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, InputError

SCRIPTS = Path(__file__).resolve().parents[1] / "scripts"


@pytest.fixture(scope="module")
def fuzz():
    sys.path.insert(0, str(SCRIPTS))
    try:
        import fuzz

        yield fuzz
    finally:
        sys.path.remove(str(SCRIPTS))


#: Inputs of each target: a few seconds in all.
EACH = {"api": 3, "readers": 12, "commands": 2}


@pytest.mark.parametrize("part", EACH)
def test_a_slice_of_the_fuzz(fuzz, part, tmp_path):
    failures: list[str] = []
    for name, target in fuzz.PARTS[part].items():
        fuzz.fuzz(target, name, 20261121, range(EACH[part]), tmp_path, failures.append)
    assert failures == []


def raising():
    raise KeyError("raw")


def long_winded():
    error = InputError("x", 1, "two")
    error.args = ("one\ntwo",)
    raise error


class UnpicklableError(Alpha5Error):
    def __reduce__(self):
        raise TypeError("no")


def unpicklable():
    raise UnpicklableError("x")


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (raising, "KeyError"),
        (long_winded, "not one line"),
        (unpicklable, "does not pickle"),
        (lambda: {"a": (1.0, np.array([1.0, np.nan]))}, "not finite: .a[1]"),
        (lambda: a5.dh.DHLink(0, 0, 0, 0), "not finite: .lower, .upper"),
        (lambda: sys.exit(3), "SystemExit"),
        (lambda: warnings.warn("odd", stacklevel=2), "UserWarning"),
    ],
)
def test_the_fuzz_sees_it(fuzz, call, says, tmp_path):
    from fuzzing import cases

    failures: list[str] = []
    case = cases.Case(call, {})
    counts = fuzz.fuzz(lambda rng, folder: case, "x", 1, range(1), tmp_path, failures.append)
    assert counts == {"failed": 1}
    assert len(failures) == 1
    assert says in failures[0]


def test_an_answer_to_what_has_no_meaning_is_a_failure(fuzz):
    from fuzzing import cases

    assert fuzz.outcome(cases.Case(lambda: 1.0, {}, hopeless=True)) == (
        "accepted what has no meaning"
    )
    assert fuzz.outcome(cases.Case(lambda: 1.0, {})) == "ok"


def test_an_input_is_repeated_by_its_number(fuzz, tmp_path):
    target = fuzz.PARTS["readers"]["recording"]
    drawn = []
    for _ in range(2):
        target(np.random.default_rng([1, 2, 3]), tmp_path)
        drawn.append((tmp_path / "damaged.csv").read_bytes())
    assert drawn[0] == drawn[1]


# --- found by it -------------------------------------------------------------------------------


def test_a_batch_of_no_states_with_one_row_for_all():
    for gripper, n in (("locked", 4), ("jaws", 5)):
        arm, empty = a5.load(gripper=gripper), np.zeros((0, n))
        assert arm.forward_dynamics_batch(empty, empty, np.ones((1, n))).shape == (0, n)


def test_points_far_beyond_a_planar_arm_are_outside_without_a_word():
    arm = a5.planar.PlanarArm((2, 1), limits=[(-1, 1), None])
    far = np.array([[1e300, 1e300], [3.0, 0.0], [0.0, -3.1]])
    assert arm.workspace().contains(far).tolist() == [False, True, False]


@pytest.mark.parametrize("method", ["voltage", "torque", "holding_torque"])
def test_currents_that_overflow_are_refused(method):
    with pytest.raises(InputError, match="current"):
        getattr(a5.actuators.actuator("axis_b"), method)(1.7e308)


def test_what_almost_vanishes_is_no_rotation_and_no_mass():
    from alpha5_model import inertia

    for nothing in (np.eye(3) * 5e-324, np.full((3, 3), 5e-324)):
        with pytest.raises(InputError, match="rotation"):
            a5.gravity_in_base(nothing)
    with pytest.raises(InputError, match="masses above 0"):
        inertia.radii_of_gyration(5e-324, np.eye(3))


@pytest.mark.parametrize("accept", ["é", False, [], np.eye(3)])
def test_what_accepts_is_a_function(accept):
    with pytest.raises(InputError, match="accept: expected a function"):
        a5.reachable((0.3, 0, 0.1), accept=accept)


def test_a_printed_number_has_no_thousand_digits():
    from alpha5_model.errors import PublishedDataError
    from alpha5_model.published.quantity import Quantity

    assert Quantity.parse("9" * 20, "mm", "x").si == pytest.approx(1e17)
    with pytest.raises(PublishedDataError, match="printed decimal number"):
        Quantity.parse("9" * 400, "mm", "x")


def test_a_tensor_that_no_body_has_is_compared_all_the_same(tmp_path):
    text = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(text.replace('<inertia ixx="', '<inertia ixx="-', 3))
    assert not a5.compare(tmp_path / "arm.urdf", samples=3).agrees


def test_angles_of_a_planar_arm_that_overflow_are_refused():
    with pytest.raises(InputError, match="q: expected numbers of at most"):
        a5.planar.PlanarArm((1, 1)).jacobian([1.7e308, 1.7e308])


def test_a_distance_beyond_all_numbers_is_refused():
    assert a5.distance_to_reach((1.7e308, 0, 0)) == pytest.approx(1.7e308)
    with pytest.raises(InputError, match="a distance that is a number"):
        a5.distance_to_reach(np.full((2, 3), 1.7e308))
    with pytest.raises(InputError, match="gravity"):
        a5.gravity_in_base(np.eye(3), np.full(3, 1.7e308))


def test_a_limit_without_effort_moves(tmp_path, capfd):
    text = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(text.replace(' effort="', ' force="'))
    chain = a5.dh.DHChain.from_urdf(tmp_path / "arm.urdf")
    assert chain.links == a5.dh.DHChain.from_urdf(a5.URDF_PATH).links
    assert capfd.readouterr().err == ""


def test_a_mount_is_three_numbers_not_rows_of_them():
    from alpha5_model.description.variants import Variant

    with pytest.raises(InputError, match="three numbers"):
        Variant(parent="rov", xyz=np.zeros((2, 3)))
    for name in ("dh_frames", "ros2_control"):
        with pytest.raises(InputError, match=name):
            Variant(**{name: np.zeros(4)})


def test_a_table_with_an_endless_integer_is_refused():
    from alpha5_model.errors import PublishedDataError
    from alpha5_model.published.reading import parse

    with pytest.raises(PublishedDataError, match="4300 digits"):
        parse(f"x = {'9' * 5000}", "")
