"""A slice of the fuzz, what it found before, and that it sees what is wrong."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import socket
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, InputError

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.fixture(scope="module")
def fuzz():
    from fuzzing import fuzz

    return fuzz


#: Inputs of each target: a few seconds in all.
EACH = {"api": 2, "forms": 3, "texts": 8, "commands": 2}


@pytest.mark.slow
@pytest.mark.parametrize("part", EACH)
def test_a_slice_of_the_fuzz(fuzz, part, tmp_path):
    failures: list[str] = []
    for name, target in fuzz.PARTS[part].items():
        if name.startswith(
            "forms jax."
        ):  # compiled for seconds; see test_array_layouts.py
            continue
        numbers = range(1 if fuzz.weight(name) < 1 else EACH[part])
        fuzz.fuzz(target, name, 20261121, numbers, tmp_path, failures.append)
    assert failures == []


#: Public functions that take arrays and have no target, and why.
WITHOUT = {
    "Alignment.theirs": "of a comparison with a file",
    "ArmVisualizer.display": "a screen",
    "ArmVisualizer.on_change": "a screen",
    "ArmVisualizer.place": "a screen",
    "ArmVisualizer.play": "a screen",
    "ArmVisualizer.setCameraPosition": "a screen",
    "ArmVisualizer.setCameraTarget": "a screen",
    "a5.view": "a screen",
    "a5.actuators.ActuatorPower": "a record",
    "a5.actuators.Interval": "a record",
    "a5.calibrate.Calibration": "a record",
    "a5.calibrate.Excitation": "a record",
    "a5.calibrate.Sensor": "a record",
    "a5.calibrate.Session": "a record",
    "a5.calibrate.with_readings": "NaN is a missing reading",
    "a5.planar.DexterityMap": "a record",
    "a5.trajectory.Analysis": "a record",
    "a5.trajectory.Motion": "a record",
    "a5.trajectory.SmoothMotion": "a record",
    "a5.TiltFit": "a record",
    "a5.TiltRecording": "a record",
    "a5.fit_tilt": "takes recordings, which are fuzzed as files",
    "a5.uncertainty.FittedNumbers": "a record",
    "a5.uncertainty.FittedNumbers.torque": "of a fit, which takes a second",
    "a5.uncertainty.Prediction": "a record",
    "Unknowns.base_parameters": "inside of identify",
    "Unknowns.by_geometry": "inside of identify",
    "Unknowns.parameter_set": "inside of identify",
    "a5.uncertainty.Identification": "a record",
    "a5.uncertainty.Problem": "a record",
    "a5.uncertainty.Sample": "a record",
    "a5.uncertainty.Sensitivity": "a record",
    "a5.uncertainty.Spread": "a record",
    "a5.workspace.Singularities": "a record",
    "jax.Solutions": "a record",
    "a5.uncertainty.identify": "a5.identify",
    "a5.uncertainty.arm": "a5.load",
}


def test_every_public_function_that_takes_arrays_has_a_target(fuzz):
    from array_functions import taking_arrays
    from fuzzing import api

    public = {*taking_arrays()}
    assert len(public) > 100
    assert public - {*api.DRAWS} - {*WITHOUT} == set()
    assert {*WITHOUT} <= public


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
    counts = fuzz.fuzz(
        lambda rng, folder: case, "x", 1, range(1), tmp_path, failures.append
    )
    assert counts == {"failed": 1}
    assert len(failures) == 1
    assert says in failures[0]


def misreading(value):
    """As code that takes the memory of an array for aligned."""
    return float(value.flat[0]) if value.flags.aligned else 6.9e-310


def unwritten(value):
    """As code that hands out memory which nobody wrote."""
    return np.empty(3)


def overwriting(value):
    if value.flags.writeable:
        value[...] = 0.0


@pytest.mark.parametrize(
    ("function", "says"),
    [
        (misreading, "DifferentError: expected"),
        (unwritten, "DifferentError: expected"),
        (overwriting, "changed its argument value"),
    ],
)
def test_the_forms_see_it(fuzz, function, says, tmp_path):
    from fuzzing import api, forms

    draw = api.of(lambda rng: function, value=lambda rng: rng.normal(size=4))
    target = forms.in_forms(draw, {"misaligned": forms.misaligned}, {})
    result = fuzz.outcome(target(np.random.default_rng(1), tmp_path))
    assert says in result


@pytest.mark.parametrize(
    "name", ["misaligned", "memory-mapped", "packed field", "odd strides"]
)
def test_a_form_is_what_it_says_and_holds_the_same_numbers(fuzz, name, tmp_path):
    from fuzzing import forms

    rng = np.random.default_rng(3)
    given = rng.normal(size=(5, 4))
    drawn = [forms.PLAIN[name](rng, given, tmp_path) for _ in range(30)]
    assert not all(array.flags.aligned for array in drawn)
    for array in drawn:
        assert np.array_equal(array, given)


@pytest.mark.parametrize(
    ("act", "says"),
    [
        (lambda canary: Path(canary).read_text("utf-8"), "open"),
        (lambda canary: os.system(f"true {canary}"), "os.system"),
        (lambda canary: subprocess.run(["true"], check=False), "subprocess.Popen"),
        (lambda canary: eval(f"'{canary}'"), "compile"),
        (lambda canary: socket.socket().connect(("127.0.0.1", 9)), "socket.connect"),
    ],
)
def test_what_a_file_makes_it_do_is_seen(fuzz, act, says):
    from fuzzing import cases, watch

    def call():
        with contextlib.suppress(OSError):
            act(watch.CANARY)

    assert fuzz.outcome(cases.Case(call, {})).startswith(
        f"did what no file may make it do: {says}"
    )
    assert (
        fuzz.outcome(cases.Case(lambda: len(Path(os.devnull).read_bytes()), {})) == "ok"
    )


def test_a_file_that_takes_long_and_a_silent_answer_are_failures(fuzz, monkeypatch):
    from fuzzing import cases

    monkeypatch.setattr(cases, "LIMIT_OF_FILES", 0.001)
    slow = cases.Case(lambda: sum(range(10**6)), {}, size=10)
    assert "s for 10 bytes" in fuzz.outcome(slow)
    assert fuzz.outcome(cases.Case(lambda: 1.0, {}, told=True)) == (
        "accepted what is not plausible without a word"
    )


def test_a_column_read_as_what_it_is_not_is_a_failure(fuzz, tmp_path, monkeypatch):
    from fuzzing import names

    monkeypatch.setattr(names, "OTHERS", ("pos",))
    found = [
        fuzz.outcome(names.target(np.random.default_rng([k]), tmp_path))
        for k in range(40)
    ]
    assert any(result.startswith("MisreadError") for result in found)


def test_the_work_is_split_without_loss(fuzz):
    every = fuzz.jobs(["forms"], 5000, 1, 0)
    numbers: dict[str, list[int]] = {}
    for job in every:
        numbers.setdefault(job.name, []).extend(job.numbers)
    assert {*numbers} == {*fuzz.PARTS["forms"]}
    assert all(sorted(found) == [*range(len(found))] for found in numbers.values())
    assert {job.kernels for job in every} == {"", "numpy"}


def test_an_answer_to_what_has_no_meaning_is_a_failure(fuzz):
    from fuzzing import cases

    assert fuzz.outcome(cases.Case(lambda: 1.0, {}, hopeless=True)) == (
        "accepted what has no meaning"
    )
    assert fuzz.outcome(cases.Case(lambda: 1.0, {})) == "ok"


def test_an_input_is_repeated_by_its_number(fuzz, tmp_path):
    target = fuzz.PARTS["texts"]["recording"]
    drawn = []
    for _ in range(2):
        target(np.random.default_rng([1, 2, 3]), tmp_path)
        drawn.append((tmp_path / "damaged.csv").read_bytes())
    assert drawn[0] == drawn[1]


# --- found by it ----------------------------------------------------------------------


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
    from alpha5_model.numbers import inertia

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
    from alpha5_model.numbers.quantity import Quantity

    assert Quantity.parse("9" * 20, "mm", "x").si == pytest.approx(1e17)
    with pytest.raises(PublishedDataError, match="printed decimal number"):
        Quantity.parse("9" * 400, "mm", "x")


def test_a_tensor_that_no_body_has_is_compared_all_the_same(tmp_path):
    text = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    (tmp_path / "arm.urdf").write_text(
        text.replace('<inertia ixx="', '<inertia ixx="-', 3)
    )
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
    from alpha5_model.description.urdf import Variant

    with pytest.raises(InputError, match="three numbers"):
        Variant(parent="rov", xyz=np.zeros((2, 3)))
    for name in ("dh_frames", "ros2_control"):
        with pytest.raises(InputError, match=name):
            Variant(**{name: np.zeros(4)})


def test_a_table_with_an_endless_integer_is_refused():
    from alpha5_model.errors import PublishedDataError
    from alpha5_model.numbers.reading import parse

    with pytest.raises(PublishedDataError, match="4300 digits"):
        parse(f"x = {'9' * 5000}", "")


def test_ragged_lists_of_states_are_refused():
    ragged = [[1.0], "a"]
    with pytest.raises(InputError, match="v: expected an array"):
        a5.load().regressor(np.zeros(4), ragged, np.zeros(4))
    with pytest.raises(InputError, match="a: expected an array"):
        a5.uncertainty.bounds(np.zeros(4), np.zeros(4), ragged)


@pytest.mark.parametrize("tensor", [[[1.0, 2.0]], "x", np.full((3, 3), np.nan)])
def test_a_possible_body_is_made_of_numbers(tensor):
    from alpha5_model.numbers import inertia

    inertia.check_possible("x", 0.0, [0.0, 0.0, 0.0], np.zeros((3, 3)).tolist())
    with pytest.raises(InputError, match="inertia_com"):
        inertia.check_possible("x", 1.0, [0.0, 0.0, 0.0], tensor)


@pytest.mark.parametrize("index", [3, -4, 1 + 2j, "0", None, 0.0, True])
def test_a_set_of_a_sample_has_a_number(index):
    sample = a5.uncertainty.sample(3)
    assert sample.parameters(-1).links[2].mass == sample.parameters(2).links[2].mass
    with pytest.raises(InputError, match="index: expected a whole number from 0 to 2"):
        sample.parameters(index)


def test_the_joints_of_a_motion_are_names():
    time, position = np.arange(6.0), np.ones((6, 4))
    with pytest.raises(InputError, match="joints: expected names of joints"):
        a5.trajectory.motion(time, position, joints=4)


def test_drive_limits_are_kept_as_plain_numbers():
    position = np.linspace(0.5, 1.0, 24).reshape(6, 4)
    motion = a5.trajectory.motion(np.arange(6) * 0.1, position)
    given = {"supply_voltage": np.longdouble(24), "current_limit": np.float32(1.5)}
    analysis = a5.trajectory.analyse(motion, **given)
    assert (type(analysis.supply_voltage), type(analysis.current_limit)) == (
        float,
        float,
    )


STUDY = """
[axes]
axis_e_pos = 0.1
axis_d_pos = 0.1
axis_c_pos = 0.1
axis_b_pos = 0.1
[outputs.x]
quantity = "torque"
as = "quantile"
levels = LEVELS
"""


@pytest.mark.parametrize(
    ("levels", "says"),
    [
        ("['a', 1]", "levels: expected"),
        ("[]", "numbers above 0"),
        ("[" * 900, "fewer brackets inside one another"),
    ],
)
def test_levels_and_brackets_of_a_study(levels, says, tmp_path):
    from alpha5_model.errors import FileFormatError
    from alpha5_model.studies.sweep.study import read_study

    path = tmp_path / "study.toml"
    path.write_text(STUDY.replace("LEVELS", "[0.5, 1]"))
    assert read_study(path).outputs["x"].levels == [0.5, 1.0]
    path.write_text(STUDY.replace("LEVELS", levels))
    with pytest.raises(FileFormatError, match=says):
        read_study(path)


def test_a_table_of_brackets_inside_brackets_is_refused():
    from alpha5_model.errors import PublishedDataError
    from alpha5_model.numbers.reading import parse

    with pytest.raises(PublishedDataError, match="fewer brackets"):
        parse("x = " + "[" * 900, "")


def test_an_empty_number_is_refused_in_one_line(capsys):
    from alpha5_model.cli import main

    assert main(["torque", "--q", "3", "1", "1", ""]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_a_masked_added_mass_is_no_added_mass():
    masked = np.ma.MaskedArray(np.ones(6), [True] + [False] * 5)
    with pytest.raises(InputError, match="added_mass: expected an array"):
        a5.Vehicle(1, np.zeros(3), np.eye(3), 1e-3, np.zeros(3), added_mass=masked)


def test_lengths_whose_sum_overflows_are_refused():
    with pytest.raises(InputError, match="length_ranges"):
        a5.planar.annulus([(1.7e308, 1.7e308)] * 3)


def test_an_arm_file_of_another_arm_is_a_failure(fuzz, tmp_path, monkeypatch):
    """What is written is heavier than what was asked for, or cannot be read."""
    from fuzzing import own_arms

    monkeypatch.setattr(own_arms, "_WAYS", (lambda rng, text: text,))

    def found():
        return fuzz.outcome(own_arms.model_file(np.random.default_rng(1), tmp_path))

    assert found() == "ok"
    whole = own_arms.arm_text
    monkeypatch.setattr(
        own_arms, "arm_text", lambda *args: whole(*args) + "[links.link_1]\nmass = 2\n"
    )
    assert found().startswith("WrongArmError: 2.0 instead of")
    monkeypatch.setattr(own_arms, "arm_text", lambda *args: "mass = 2")
    assert found().startswith("WrongArmError: the file cannot be read")


def test_other_results_of_a_sweep_are_a_failure(fuzz, tmp_path, monkeypatch):
    from fuzzing import folders

    files, outputs = folders._results()
    column = {name: value + 1 for name, value in outputs["peak"].items()}
    wrong = (files, {**outputs, "peak": column})
    monkeypatch.setattr(folders, "_results", lambda: wrong)
    rng = np.random.default_rng(2)
    found = fuzz.outcome(folders.sweep_folder(rng, tmp_path))
    assert found.startswith("WrongAnswerError: peak.")


def test_a_column_of_lists_that_no_file_has_is_a_failure(fuzz, tmp_path, monkeypatch):
    from fuzzing import folders

    def turned(path):
        motion = read(path)
        return dataclasses.replace(motion, position=motion.position + 1)

    def found(number):
        rng = np.random.default_rng(number)
        return fuzz.outcome(folders.lerobot(rng, tmp_path))

    good = [number for number in range(12) if found(number) == "ok"]
    assert len(good) > 1
    read = a5.trajectory.read_motion
    monkeypatch.setattr(a5.trajectory, "read_motion", turned)
    assert {found(number)[:22] for number in good} == {"WrongAnswerError: read"}


def test_the_package_may_unpickle_its_records_and_nothing_else(fuzz):
    import pickle

    from fuzzing import cases

    own = pickle.dumps(a5.parameters())
    other = pickle.dumps(os.getcwd)
    assert fuzz.outcome(cases.Case(lambda: pickle.loads(own).name, {})) == "ok"
    found = fuzz.outcome(cases.Case(lambda: len(str(pickle.loads(other))), {}))
    assert found.startswith("did what no file may make it do: pickle.find_class")


def test_good_inputs_that_are_all_refused_are_a_failure(fuzz, monkeypatch, capsys):
    from fuzzing import cases

    from alpha5_model.errors import InputError

    def refuse() -> None:
        raise InputError("q", 0, "another")

    def target(rng, folder):
        return cases.Case(refuse, {})

    monkeypatch.setitem(fuzz.PARTS["forms"], "forms nothing", target)
    monkeypatch.setattr(fuzz.sys, "argv", ["fuzz.py", "forms nothing", "--count", "60"])
    monkeypatch.setattr(fuzz, "NUMPY_SHARE", 0.0)
    assert fuzz.main() == 1
    assert "forms nothing: every good input was refused" in capsys.readouterr().out
