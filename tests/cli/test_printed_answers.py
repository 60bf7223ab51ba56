"""Every command prints what `tests/printed/` has, piped or on a terminal.

After a change that you meant, run this and read the difference:
``ALPHA5_UPDATE_PRINTED=1 python -m pytest tests/cli/test_printed_answers.py``.
"""

from __future__ import annotations

import fcntl
import io
import json
import os
import pty
import re
import struct
import subprocess
import sys
import termios
from contextlib import redirect_stderr, redirect_stdout, suppress
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from demo_run import demo_run
from urdf_edits import with_mass

import alpha5_model as a5
from alpha5_model.cli import COMMANDS, generate, main, workspace
from alpha5_model.cli.program import parser_of
from alpha5_model.proofs.comparison import comparing

ROOT = Path(__file__).resolve().parents[2]

FOLDER = Path(__file__).parents[1] / "printed"
POSE = ("--q", "3.1", "1.2", "1.8", "0")
#: Name -> arguments; every command, and each kind of answer that it has.
ANSWERS = {
    "arm-show": ("arm", "show", "my_arm.toml"),
    "calibrate": ("calibrate", "fit", "weighed.toml", "--output", "weighed_arm.toml"),
    "check": ("check",),
    "compare": ("compare", "other.urdf", "--samples", "5"),
    "dh": ("dh", "0.5", "1.2", "1", "0"),
    "fk": ("fk", "180", "70", "100", "0", "deg"),
    "gains": (
        *("gains", "--bandwidth", "12", "--rate", "200", "--delay", "0.01"),
        *("--rotor-inertia", "5e-8", "--current-limit", "0.6", "--friction", "1"),
    ),
    "generate": ("generate", "urdf", "--gripper", "jaws", "--output", "made/arm.urdf"),
    "ik": ("ik", "0.25", "-0.1", "0.05", "--wrist", "90deg"),
    "jaws": (
        *("jaws", "--opening", "40mm"),
        *("--motor-current", "0.05", "--screw-lead", "1mm"),
    ),
    "move": ("move", "home", "0.2", "0.1", "0.1", "--output", "planned.csv"),
    "park": ("park", "0.45", "0.1", "0.1", "--spacing", "0.2", "--output", "p.csv"),
    "planar": ("planar", "5", "4", "1", "--radius", "3"),
    "sweep": ("sweep", "study.toml", "--output", "results"),
    "torque": ("torque", *POSE),
    "torque-water": (
        "torque",
        "--q",
        "3.1,1.2,1.8,7",
        "--water-velocity",
        "0",
        "1",
        "0",
    ),
    "trajectory": ("trajectory", "motion.csv"),
    "workspace": ("workspace",),
    "view": ("view", "--pose", "reach", "--html", "arm.html"),
}
#: Answers that say no: they end with status 1, all others with 0.
NO = ("compare",)
VIEWS = [(columns, terminal) for columns in (80, 120) for terminal in (False, True)]
#: The one view whose text is kept; in the others it fits, and nothing is cut.
KEPT = (80, False)
MY_ARM = (ROOT / "examples" / "my_arm.toml").read_text("utf-8")
#: A row of a table: three cells or more, with two spaces between them at least.
ROW = re.compile(r"\S {2,}\S.*? {2,}\S")
#: Its tables have sentences, which are continued under their column.
SENTENCES = ("check",)
COLOUR = re.compile(r"\x1b\[\d*m")


class Terminal(io.StringIO):
    """What is printed on a terminal."""

    def isatty(self) -> bool:
        return True


def folder_of_a_user() -> None:
    """Write the files that the commands read into the current folder."""
    ours = Path(a5.URDF_PATH).read_text("utf-8")
    Path("arm.urdf").write_text(ours, "utf-8")
    Path("other.urdf").write_text(with_mass(ours, "0.5"), "utf-8")
    axes = "".join(f"axis_{x}_pos = [0, 1]\n" for x in "edcb")
    map_by = '"axis_d_pos", "axis_c_pos", "axis_b_pos"'
    forms = (
        'as = "peak"',
        'as = "quantile"\nlevels = [0.5, 1]',
        f'as = "maximum"\nby = [{map_by}]',
    )
    outputs = "".join(
        f'[outputs.{n}]\nquantity = "torque"\n{f}\n'
        for n, f in zip("abc", forms, strict=True)
    )
    Path("my_arm.toml").write_text(MY_ARM, "utf-8")
    Path("weighed.toml").write_text(weighed_arm(), "utf-8")
    Path("study.toml").write_text(f"[axes]\nmount_roll = 0.3\n{axes}{outputs}", "utf-8")
    time = np.arange(0, 12, 0.02)
    q = [1.5 + swing * np.sin(time) for swing in (0.8, 0.3, 0.2, 0.5)] + [
        0.007 + 0.0 * time
    ]
    effort = 0.2 * np.cos(time)
    head = [
        "time_secs",
        *(f"axis_{x}_pos" for x in "edcba"),
        "axis_d_effort",
    ]
    rows = np.column_stack([time, *q, effort])
    rows[300:, 0] += 1.0
    np.savetxt(
        "motion.csv",
        rows,
        delimiter=",",
        header=",".join(head),
        comments="",
        fmt="%.9g",
    )


@cache
def weighed_arm() -> str:
    """A plan whose readings, whole grams, are filled in."""
    planned = a5.calibrate.plan_poses(a5.calibrate.scales(), 6)
    still = np.zeros((6, 4))
    loads = a5.load(a5.AIR).base_wrench_batch(planned.q, still, still)
    readings = np.round(loads @ planned.sensor.matrix[:, 4:].T, 3)
    return a5.calibrate.session_text(a5.calibrate.with_readings(planned, readings))


def printed(arguments: tuple[str, ...], terminal: bool, status: int = 0) -> str:
    """What a command prints, with 0 for numbers of about 1e-16, which are rounding.

    Args:
        status: With which it must end.
    """
    out = Terminal() if terminal else io.StringIO()
    errors = io.StringIO()
    with redirect_stdout(out), redirect_stderr(errors):
        assert main(arguments) == status
    return re.sub(r"\b\d(\.\d+)?e-1\d\b", "0", out.getvalue() + errors.getvalue())


#: A number of an answer.
NUMBER = re.compile(r"[-−]?\d+(?:\.\d+)?(?:e[-+]\d+)?")


def check_answer(path: Path, text: str) -> None:
    """Compare with the kept answer: words as they are, numbers to their last digit.

    A processor may round the last digit the other way.
    """
    if os.environ.get("ALPHA5_UPDATE_PRINTED"):
        path.write_text(text, "utf-8")
    kept = path.read_text("utf-8")
    assert NUMBER.split(text) == NUMBER.split(kept)
    for ours, theirs in zip(NUMBER.findall(text), NUMBER.findall(kept), strict=True):
        mantissa, _, exponent = theirs.partition("e")
        decimals = len(mantissa.partition(".")[2])
        unit = 10.0 ** (int(exponent or 0) - decimals) if decimals else 0.0
        numbers = [float(number.replace("−", "-")) for number in (ours, theirs)]
        assert numbers[0] == pytest.approx(numbers[1], rel=1e-12, abs=1.01 * unit)


def fits(text: str, columns: int) -> None:
    """No line is longer than the terminal, nothing is cut, and units have one form."""
    lines = COLOUR.sub("", text).splitlines()
    assert max(map(len, lines)) <= columns
    assert not re.search(r"…|\bN m\b|kg m|\^[23]|(?<!\w)nan\b|None", text)


@pytest.mark.slow
@pytest.mark.parametrize("name", ANSWERS)
def test_what_is_printed(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder_of_a_user()
    once: dict[str, Any] = {}

    def kept(module: Any, function: str) -> None:
        """Keep what a function returns for the first answer."""
        compute = getattr(module, function)

        def given(*words: Any, **more: Any) -> Any:
            if function not in once:
                once[function] = compute(*words, **more)
            return once[function]

        monkeypatch.setattr(module, function, given)

    for module, function in (
        (comparing, "compare"),
        (generate, "urdf"),
        (workspace, "_record"),
    ):
        kept(module, function)
    for columns, terminal in VIEWS:
        monkeypatch.setenv("COLUMNS", str(columns))
        text = printed(ANSWERS[name], terminal, int(name in NO))
        fits(text, columns)
        assert terminal or "\x1b" not in text
        if terminal:
            assert not re.search(r"(?<![\w.,=-])-\d", text)
        if (columns, terminal) == KEPT:
            check_answer(FOLDER / f"{name}.txt", text)
            narrow = text.splitlines()
        elif not terminal and name not in SENTENCES:
            rows = [line for line in text.splitlines() if ROW.search(line)]
            assert not set(rows) - set(narrow), "rows in two lines at 80 columns"


@pytest.mark.slow
def test_the_demo() -> None:
    folder, said = demo_run()
    text = re.sub(r"\d\.\d MB|\d(\.\d)?e-1\d", "0", said.replace(str(folder), "demo"))
    fits(text, KEPT[0])
    check_answer(FOLDER / "demo.txt", text)


def test_every_command_is_looked_at() -> None:
    assert {words[0] for words in ANSWERS.values()} | {"demo"} == set(COMMANDS)
    assert {path.stem for path in FOLDER.iterdir()} == {*ANSWERS, "demo"}


def test_the_help_fits_80_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    wrong = []
    for name in COMMANDS:
        status, text, said = answer(name, "--help")
        widest = max(map(len, text.splitlines()))
        if (status, said) != (0, "") or widest > 80 or "…" in text:
            wrong.append((name, status, said, widest))
    assert wrong == []


@pytest.mark.slow
@pytest.mark.parametrize("columns", [80, 120])
def test_on_a_real_terminal(columns: int) -> None:
    """A real terminal's width, minus sign and colours are used without options."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    words = [sys.executable, "-m", "alpha5_model", "dh", "0.5", "1.2", "1", "-0.25"]
    clean = {
        k: v for k, v in os.environ.items() if k not in ("COLUMNS", "LINES", "NO_COLOR")
    }
    subprocess.run(
        words, stdout=theirs, check=True, env={**clean, "TERM": "xterm"}, cwd=ROOT
    )
    os.close(theirs)
    text = b""
    with suppress(OSError):  # the end of a terminal
        while block := os.read(ours, 65536):
            text += block
    os.close(ours)
    lines = text.decode().split("\r\n")
    assert max(map(len, lines)) <= columns
    assert "−0.180000" in text.decode()
    assert "-0.180000" not in text.decode()
    general = next(line for line in lines if line.startswith("general tasks"))
    assert general.endswith("rank 4") == (columns == 120)


# --- one syntax -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("command", "given", "meant"),
    [
        ("torque", "--q 1 2 -3 .4 --json", {"q": [1.0, 2.0, -3.0, 0.4], "json": True}),
        ("torque", "--q 1,2,-3,.4", {"q": [1.0, 2.0, -3.0, 0.4]}),
        ("torque", "--q 1, 2, -3, .4 --a 0 1 0 0", {"a": [0.0, 1.0, 0.0, 0.0]}),
        ("torque", "--q 180 0 0 0 0.01m deg", {"q": [np.pi, 0.0, 0.0, 0.0, 0.01]}),
        ("torque", "--q=-1,2,3,4", {"q": [-1.0, 2.0, 3.0, 4.0]}),
        ("torque", "--q home --payload 500 g", {"q": "home", "payload": [0.5]}),
        (
            "ik",
            "−250,-1e2 50 mm --wrist 90 deg",
            {"point": [-0.25, -0.1, 0.05], "wrist": np.pi / 2},
        ),
        (
            "ik",
            "--wrist 1 -.25 -1 -1e-3",
            {"point": [-0.25, -1.0, -0.001], "wrist": 1.0},
        ),
        (
            "dh",
            "--link 0 1 2 3 0 -0.4 2",
            {"link": [[0.0, 1.0, 2.0, 3.0, 0.0]], "q": [-0.4, 2.0]},
        ),
        (
            "dh",
            "--link 0,1,2,3,0 -0.4 2",
            {"link": [[0.0, 1.0, 2.0, 3.0, 0.0]], "q": [-0.4, 2.0]},
        ),
        (
            "planar",
            "5,4 -l -1 1 -l none --radius 3",
            {"lengths": [5.0, 4.0], "limits": [[-1.0, 1.0], "none"], "radius": 3.0},
        ),
        (
            "trajectory",
            "--payload 1 --current 0 1 0 1.csv",
            {
                "payload": [1.0],
                "water_velocity": [0.0, 1.0, 0.0],
                "file": Path("1.csv"),
            },
        ),
    ],
)
def test_vectors_and_units_have_one_syntax(
    command: str, given: str, meant: dict[str, Any]
) -> None:
    found = vars(parser_of(command).parse_args(given.split()))
    for name, value in meant.items():
        assert repr(found[name]) == repr(value), name


def answer(*arguments: str) -> tuple[int, str, str]:
    out = io.StringIO()
    errors = io.StringIO()
    with redirect_stdout(out), redirect_stderr(errors):
        status = main(arguments)
    return status, out.getvalue(), errors.getvalue()


def test_the_same_vector_in_each_form_gives_the_same_answer() -> None:
    q = [170.0, 60.0, -10.0, 20.0]
    forms = (
        [*map(repr, np.deg2rad(q).tolist())],
        [",".join(map(repr, np.deg2rad(q).tolist()))],
        [*(f"{x}deg" for x in q)],
        [*map(str, q), "deg"],
        [",".join(map(str, q)).replace("-", "−") + " deg"],
    )
    first, *others = (answer("fk", *form, "--json") for form in forms)
    assert first[0] == 0
    assert first[2] == ""
    for other in others:
        np.testing.assert_allclose(
            json.loads(other[1])["q"], json.loads(first[1])["q"], rtol=1e-15
        )
    arm = a5.load()
    frames = json.loads(first[1])["frames"]
    for name in ("tcp", "link_4", "base_link"):
        np.testing.assert_allclose(
            frames[name], arm.forward_kinematics(np.deg2rad(q), name), atol=1e-15
        )
    assert {"tcp", *(f"link_{i}" for i in range(5))} <= set(frames)


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        ("ik 250 -100 50", 2, "if 250 is in mm, write 250mm"),
        ("ik .25 -.1 .05 --wrist 90", 0, "if 90 is in deg, write 90deg"),
        (
            "torque --q 170 60 100 20",
            0,
            "alpha5: warning: if 170 is in deg, write 170deg",
        ),
        ("fk 170 60 100 20", 0, "alpha5: warning: if 170 is in deg, write 170deg"),
        ("torque --q 3 1 1 0 --v 30 0 0 0", 0, "if 30 is in deg, write 30deg"),
        ("torque --q 3 1 1 0", 0, ""),
        (
            "fk 1 2 3",
            2,
            "argument Q: expected",
        ),
        ("fk 1 2 3 4mm", 2, "four or five numbers"),
        (
            "torque --q 1 2 3",
            2,
            "--q: expected",
        ),
        ("torque --q streach", 2, "--q: expected"),
        ("torque --q reach --v home", 2, "--v: expected"),
        ("torque --q 1 2 3 4 --payload heavy", 2, "MASS X Y Z VOLUME (kg, m, m^3)"),
        ("torque --q 1 2 3 4 --payload -1", 2, "mass"),
        (
            "torque --q 1 2 3 4 --mount 1 2",
            2,
            "mount: expected",
        ),
        ("torque --q 1 2 3 4 --gripper open", 2, "locked, jaws"),
        ("generate urdf --rpy 1 2", 2, "rpy: expected"),
        ("view --target 1", 2, "target: expected"),
    ],
)
def test_what_is_wrong_or_seems_to_be_is_one_line(
    arguments: str, status: int, words: str
) -> None:
    got, out, said = answer(*arguments.split())
    assert got == status
    errors = [line for line in said.splitlines() if "warning" not in line]
    assert len(errors) == (status == 2)
    assert words in said
    assert bool(out) == (status == 0)


def test_torque_of_jaws_payload_and_mount_is_the_arms() -> None:
    arm = a5.load(gripper="jaws", gravity=(0.0, 9.81, 0.0))  # base_link's y points down
    loaded = arm.with_payload(0.5, (0.01, 0, 0.02), volume=1e-4)
    assert repr(loaded) == repr(arm).replace(")", ", payload 0.5 kg)")
    text = (
        "torque --q 3.1 1.2 1.8 0.3 --gripper jaws --payload 0.5 10mm 0 20mm 1e-4 "
        "--mount -90 0 0 deg --json"
    )
    status, out, said = answer(*text.split())
    assert (status, said) == (0, "")
    result = json.loads(out)
    q = [3.1, 1.2, 1.8, 0.3, a5.parameters().joints[4].lower]
    assert [joint["position"] for joint in result["joints"]] == q
    torque = [joint["torque"] for joint in result["joints"]]
    assert np.abs(torque - loaded.hydrostatic_torque(q)).max() < 1e-12
    assert np.abs(torque - arm.hydrostatic_torque(q)).max() > 0.01
    still = np.zeros(5)
    force = loaded.base_wrench(q, still, still)
    np.testing.assert_allclose(result["mount"]["force"], force.linear, atol=1e-12)
    assert result["joints"][4]["current"] is None


def test_limits_of_an_arm_are_those_of_its_joints() -> None:
    joints = a5.parameters().joints
    jaws = a5.load(gripper="jaws").with_payload(0.5, (0.01, 0, 0.02), volume=1e-4)
    assert jaws.limits.lower.tolist() == [joint.lower for joint in joints]
    assert jaws.limits.upper.tolist() == [joint.upper for joint in joints]
    floating = a5.load(floating_base=True)
    np.testing.assert_array_equal(floating.limits.lower, jaws.limits.lower[:4])


def test_branches_that_meet_are_marked() -> None:
    """Only if the arm is stretched, both elbows of a side are the same branch."""
    far = a5.nearest_reachable([1.0, 0.3, 0.2])
    for scale, meet in ((1.0, True), (0.9, False)):
        status, out, _ = answer("ik", *map(repr, (scale * far).tolist()), "--json")
        assert status == 0
        branches = {branch["name"]: branch for branch in json.loads(out)["branches"]}
        for side in ("underarm", "overarm"):
            flipped = branches[f"{side}_flipped"]
            if flipped["exists"] and branches[side]["exists"]:
                assert (flipped["same_as"] == side) == meet
        assert branches["underarm"]["same_as"] is None


def test_generate_names_all_that_it_wrote(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for words in (
        "urdf --output new/arm.urdf",
        "sdf --output new",
        "c --output c",
    ):
        before = {*tmp_path.rglob("*")}
        status, out, _ = answer("generate", *words.split())
        assert status == 0
        named = set()
        lists = re.findall(r"^wrote in (\S+): (.*(?:\n  .*)*)", out, re.MULTILINE)
        for folder, names in lists:
            named |= {tmp_path / folder / name for name in re.split(r",\s+", names)}
        made = {path for path in tmp_path.rglob("*") if path.is_file()} - before
        assert made <= named
        assert all(path.is_file() for path in named)


def test_the_documentation_shows_answers_of_these_commands() -> None:
    from pages import generated_text

    for command, words in generated_text.ANSWERS.items():
        name = generated_text.ANSWER_NAMES.get(command, command)
        expected = "demo" if name == "demo" else " ".join(ANSWERS[name])
        assert words == expected
        assert generated_text.answer_file(command) == FOLDER / f"{name}.txt"
