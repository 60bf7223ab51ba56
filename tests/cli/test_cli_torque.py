"""``alpha5 torque``."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from newton_euler import newton_euler
from torque_command import torque, words

import alpha5_model as a5
from alpha5_model.cli import main

Q = (3.1, 1.2, 1.8, 0.4)
V = (0.1, 0.2, -0.3, 0.4)
A = (-1.0, 0.5, 0.7, 2.0)


@pytest.mark.parametrize(
    ("fluid", "density"),
    [("sea", 1025.0), ("fresh", 1000.0), ("air", 0.0), ("1340", 1340.0)],
)
def test_json_equals_own_newton_euler(capsys, fluid, density):
    arguments = [
        "--q",
        *words(Q),
        "--v",
        *words(V),
        "--a",
        *words(A),
        "--fluid",
        fluid,
        "--json",
    ]
    result = json.loads(torque(capsys, *arguments))
    q, v, a = (np.array([x]) for x in (Q, V, A))
    tau, force, moment = newton_euler(q, v, a, density)
    still = newton_euler(q, 0 * v, 0 * a, 0.0)[0]
    terms = {
        "torque": tau,
        "weight": still,
        "buoyancy": newton_euler(q, 0 * v, 0 * a, density)[0] - still,
        "coriolis": newton_euler(q, v, 0 * a, 0.0)[0] - still,
        "inertia": newton_euler(q, v, a, 0.0)[0] - newton_euler(q, v, 0 * a, 0.0)[0],
    }
    assert [joint["joint"] for joint in result["joints"]] == [
        "axis_e",
        "axis_d",
        "axis_c",
        "axis_b",
    ]
    for name, expected in terms.items():
        ours = [joint[name] for joint in result["joints"]]
        assert np.abs(ours - expected[0]).max() < 1e-12
    ends = a5.uncertainty.bounds(Q, V, A, a5.load(density)).torque
    for joint, low, high in zip(result["joints"], *ends, strict=True):
        assert joint["torque_range"] == pytest.approx([low, high], rel=1e-9, abs=1e-12)
        assert low < joint["torque"] < high
    assert np.abs(result["mount"]["force"] - force[0]).max() < 1e-12
    assert np.abs(result["mount"]["moment"] - moment[0]).max() < 1e-12


def test_current_is_table_4(capsys):
    """Actuator 1: i = (tau / (Gr eta^(+-1)) + F sign(v)) / K_t, F within 10 %."""
    k_t = 0.0134
    friction = 3.752e-3
    eta = 0.86
    gear = 1754.4
    for speed in (0.2, -0.2):
        arguments = ["--q", *words(Q), "--v", "0", repr(speed), "0", "0", "--json"]
        joint = json.loads(torque(capsys, *arguments))["joints"][1]
        tau = joint["torque"]
        loss = eta if tau * speed > 0 else 1 / eta

        def current(f, tau=tau, loss=loss, speed=speed):
            return (tau / (gear * loss) + f * np.sign(speed)) / k_t

        assert joint["current"] == pytest.approx(current(friction), rel=1e-12)
        ends = sorted((current(0.9 * friction), current(1.1 * friction)))
        assert joint["current_range"] == pytest.approx(ends, rel=1e-12)


def test_text_is_the_json_rounded(capsys):
    arguments = ["--q", "3.1", "1.2", "1.8", "-0.4", "--v", "0", *words(V[1:])]
    printed = torque(capsys, *arguments)
    assert "-0.0000" not in printed
    torques, load, currents, warnings = [
        part.splitlines() for part in printed.split("\n\n")
    ]
    result = json.loads(torque(capsys, *arguments, "--json"))
    joints = result["joints"]
    keys = ("inertia", "coriolis", "weight", "buoyancy", "torque")
    for row, joint in zip(torques[2:], joints, strict=True):
        low, high = joint["torque_range"]
        same_numbers(
            row, joint["joint"], [joint[key] for key in keys] + [(high - low) / 2]
        )
    for row, part in zip(load[1:], ("force", "moment"), strict=True):
        same_numbers(row, part, result["mount"][part])
    for row, joint in zip(currents[1:], joints, strict=True):
        same_numbers(row, joint["joint"], [joint["current"], *joint["current_range"]])
        assert ("moving" in row) == (joint["velocity"] != 0)
        assert ("at rest" in row) == (joint["velocity"] == 0)
    assert torques[5].startswith("axis_b *")
    assert warnings[0] == "* position beyond the joint's limits"
    assert [joint["within_limits"] for joint in joints] == [True, True, True, False]


def same_numbers(row, name, expected):
    """A row of a table: its name, the numbers to four decimals, and words."""
    cells = row.replace(" *", "").replace(" to ", " ").split()
    assert cells[0] == name
    numbers = [float(cell) for cell in cells[1 : len(expected) + 1]]
    assert numbers == pytest.approx(expected, abs=5.1e-5)
    words = " ".join(cells[len(expected) + 1 :])
    assert not re.search(r"\d", words), "a column that this test does not know"


@pytest.mark.parametrize(("acceleration", "powers"), [("1e5", False), ("1e8", True)])
def test_the_numbers_of_a_table_have_one_format(capsys, acceleration, powers):
    printed = torque(capsys, "--q", *words(Q), "--a", acceleration, "1", "0", "0")
    table = printed.split("\n\n")[0].splitlines()[2:]
    numbers = " ".join(row.partition(" ")[2] for row in table).split()
    assert {"e" in number for number in numbers} == {powers}
    assert len({len(number.partition(".")[2]) for number in numbers}) == 1


def test_degrees_and_tilt(capsys):
    radians = json.loads(
        torque(capsys, "--q", *words(np.deg2rad([170, 60, 100, 20])), "--json")
    )
    degrees = json.loads(
        torque(capsys, "--q", "170", "60", "100", "20", "deg", "--json")
    )
    torques = [[joint["torque"] for joint in r["joints"]] for r in (radians, degrees)]
    assert torques[0] == pytest.approx(torques[1], abs=1e-15)
    tilted = json.loads(
        torque(capsys, "--q", *words(Q), "--gravity", "-9.81 0 0", "--json")
    )
    still = np.zeros((1, 4))
    expected = newton_euler(np.array([Q]), still, still, 1025.0, (-9.81, 0.0, 0.0))[0][
        0
    ]
    assert [j["torque"] for j in tilted["joints"]] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("efficiency", ["gearbox", "motor"])
def test_the_currents_follow_the_choice_of_efficiency(capsys, efficiency):
    state = ["--q", *words(Q), "--v", "0.1", "0.2", "-0.3", "0.1", "--json"]
    assert main(["torque", *state, "--efficiency", efficiency]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["efficiency"] == efficiency
    for joint in found["joints"]:
        motor = a5.actuators.actuator(joint["joint"], efficiency=efficiency)
        expected = motor.current(joint["torque"], joint["velocity"])
        assert joint["current"] == pytest.approx(float(expected), rel=1e-12)


@pytest.mark.parametrize(
    ("words", "angles"),
    [("reach", "180 90 180 90 deg"), ("home", "180 45 135 90 deg")],
)
@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_a_named_pose_is_its_angles(capsys, words, angles, gripper):
    answers = []
    for q in (words, angles):
        call = ["torque", "--q", *q.split(), "--gripper", gripper, "--json"]
        assert main(call) == 0
        answers.append(json.loads(capsys.readouterr().out))
    named, numbers = (
        [(joint["position"], joint["torque"]) for joint in answer["joints"]]
        for answer in answers
    )
    assert np.array(named) == pytest.approx(np.array(numbers), abs=1e-12)


def test_a_named_pose_keeps_the_limits_of_your_own_arm(capsys, tmp_path):
    file = tmp_path / "arm.toml"
    limits = "[joint_limits.axis_d]\nmax_position = 1.2\n"
    file.write_text(f"format = 1\n{limits}", encoding="utf-8")
    for command in (["torque", "--q", "reach"], ["fk", "reach"]):
        assert main([*command, "--arm", str(file), "--json"]) == 0
        answer = json.loads(capsys.readouterr().out)
        q = answer["q"] if "q" in answer else [j["position"] for j in answer["joints"]]
        assert q == pytest.approx(np.array([np.pi, 1.2, np.pi, np.pi / 2]))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--q", "1", "2", "nan", "0"], "q[2]"),
        (["--q", "1", "2"], "four or five numbers"),
        ([], "--q"),
        (["--q", "1", "2", "x", "0"], "--q"),
        (["--q", *words(Q), "--fluid", "mercury"], "sea, fresh, air"),
        (["--q", *words(Q), "--fluid", "-5"], "fluid"),
        (["--q", *words(Q), "--gravity", "down"], "gravity"),
        (["--q", *words(Q), "--constants", "best"], "printed, torque, voltage"),
        (["--q", *words(Q), "--efficiency", "best"], "gearbox, motor"),
        (["--q", *words(Q), "--v", "0", "0", "0", "inf"], "v[3]"),
    ],
)
def test_bad_input_is_one_line_and_status_2(capsys, arguments, message):
    assert main(["torque", *arguments]) == 2
    out = capsys.readouterr()
    assert out.out == ""
    assert len(out.err.strip().splitlines()) == 1
    assert message in out.err


def test_a_position_that_touches_itself_is_named(capsys):
    folded = ["--q", "0", "0", "0", "0"]
    printed = torque(capsys, *folded)
    place = json.loads(torque(capsys, *folded, "--json"))["self_collision"]
    assert place["depth"] == pytest.approx(-a5.load().collision_distance(np.zeros(4)))
    links = " and ".join(place["links"])
    millimetres = f"{place['depth'] * 1e3:.3g} mm"
    assert f"\nself-collision: {links} overlap by {millimetres}\n" in printed
    assert "self_collision" not in json.loads(
        torque(capsys, "--q", *words(Q), "--json")
    )
    jaws = torque(capsys, "--q", "0 0 0 0 0.01", "--gripper", "jaws")
    assert "self-collision: link_0 and" in jaws
