"""The command line in this process: options of every sort, in a folder of its own."""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, NamedTuple, NoReturn

import command_parsers
import oracle
import pytest
from damage import damaged
from good_files import ARM, OBSTACLES, STUDY, table
from hypothesis import given
from hypothesis import strategies as st

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error

pytestmark = pytest.mark.slow

#: In place of any value.
BAD = (
    *("", " ", "x", "nan", "inf", "1e400", "1e308", "-1e308", "1e-320", "-1", "0"),
    *("2**3", "9" * 400, "1e9999999", "0 0 nan", "1 2 3 4", "a,b", "a=b", "=", "é"),
    *("\udcff", "a\0b", "a\nb", "x" * 5000, "--", "-", "[red]", "${1/0}", "../.."),
    "\x1b[31m",
)
NUMBERS = ("0.3", "1", "1.2", "0.5", "0.5", "-0.1")
TRIPLES = ("0 0 -9.81", "0 9.81 0", "0,0,1")
ROBOTS = ("arm.urdf",) * 5 + ("damaged_arm.urdf", "motion.csv", "none", "loop", "-")
RECORDINGS = (
    "motion.csv",
    "motion.csv",
    "damaged_motion.csv",
    "arm.urdf",
    "locked",
    "none",
)
PLACES = ("home", "stow", "1 1 1 1", "0.3 0.1 0.1", "0.3 -0.05 0.2", "x")
#: Where a result goes: an ending is added.
OUTPUTS = ("out",) * 5 + ("new/deep/out", "loop", "folder", "motion.csv/below", "-")
#: Option -> values. Flags have none; an option that is not here takes a number.
VALUES: dict[str, tuple[str, ...]] = {
    "--acceleration": ("0.5", "0", "1e9"),
    "--actuators": ("motor", "position"),
    "--arm": ("arm.toml",) * 4 + ("damaged_arm.toml", "none", "-"),
    "--base": ("base_link", "link_2", "tcp", "none"),
    "--collision": ("none", "shapes"),
    "--constants": ("printed", "torque", "voltage"),
    "--corrections": ("", "base_frame", "link3_cob"),
    "--water-velocity": TRIPLES,
    "--explain": ("body.mass", "tool.offset", ""),
    "--fluid": ("sea", "fresh", "air", "1025", "0", "1.025", "1e5", "-3"),
    "--format": ("text", "json", "junit"),
    "--frame": ("link_2", "tcp"),
    "--gravity": TRIPLES,
    "--gripper": ("auto", "locked", "jaws"),
    "--joints": ("RRR", "RPR"),
    "--level": ("low", "nominal", "high"),
    "--limits": ("0 1", "none"),
    "--link": ("0 0.1 0.2 1.5 0", "0 0 1 0 1"),
    "--map": ("axis_e=axis_e", "axis_e=x", "axis_e=axis_d,axis_d=axis_e", "=,="),
    "--mesh-uri": ("relative", "package", "file"),
    "--motion": RECORDINGS,
    "--mount": TRIPLES,
    "--obstacles": ("obstacles.toml", "damaged_obstacles.toml", "none", "-"),
    "--parent": ("rov",),
    "--payload": ("0.2", "0.2 0 0 0.05", "500", "-1", "250g", "0.2 0 0 20"),
    "--pose": ("home", "stow", "1,1,1,1,0"),
    "--prefix": ("a_", "left_", ""),
    "--q": ("1 1 1 1", "0.3 1.2 0 3"),
    "--rpy": TRIPLES,
    "--samples": ("3",),
    "--sensor": ("scales", "weight", "force_torque", "x"),
    "--show": ("bodies", "frames,com"),
    "--size": ("64x48",),
    "--smoothing": ("spline", "interpolate"),
    "--supply-voltage": ("24", "1e-3"),
    "--screw-efficiency": ("0.2 1", "0.5 0.5", "1 0", "2 3"),
    "--target": ("0.3,0,0.1",),
    "--through": RECORDINGS,
    "--topic": ("/x",),
    "--urdf": ROBOTS,
    "--velocities": ("auto", "file", "positions"),
    "--xyz": TRIPLES,
}
#: Option -> endings of the file that it writes.
WRITTEN = {
    "--bus": (".csv", ".txt"),
    "--output": (".csv", ".json", ".urdf", ".toml", ".txt", ""),
    "--plot": (".png", ".svg", ".bmp"),
    "--html": (".html",),
    "--image": (".png", ".bmp"),
    "--write-arm": (".toml", ".txt"),
}
#: Command -> values of its arguments.
ARGUMENTS: dict[str, tuple[tuple[str, ...], ...]] = {
    **dict.fromkeys(("arm check", "arm show", "arm new"), (VALUES["--arm"],)),
    **{
        f"calibrate {action}": (("readings.toml", *RECORDINGS),)
        for action in ("plan", "fit", "motors")
    },
    "check": (ROBOTS,),
    "compare": (ROBOTS,),
    "dh": (),
    "fk": (NUMBERS,) * 4,
    **{
        f"generate {form}": ()
        for form in (
            "urdf",
            "srdf",
            "moveit",
            "xacro",
            "mjcf",
            "sdf",
            "usd",
            "c",
            "water",
        )
    },
    "ik": (("0.3", "0.25"), ("0.1", "-0.05"), ("0.1", "0")),
    "jaws": (),
    "move": (PLACES, PLACES),
    "planar": (("0.3", "1.2", "3"),) * 3,
    "sweep": (("study.toml", "study.toml", "damaged_study.toml", "arm.urdf", "none"),),
    "torque": (),
    "trajectory": (RECORDINGS,),
    "view": (),
    "workspace": (),
}
#: Options that a command always has here: for speed, or because it would run for ever.
ALWAYS = {
    "compare": ["--samples"],
    "sweep": ["--output"],
    "torque": ["--q"],
    "view": ["--image", "--size"],
}
#: They open ports, start processes, film, sample at length, or write the checkout.
LEFT_OUT = {
    *("--port", "--serve", "--scheduler", "--workers", "--video", "--update"),
    *("--check", "--self-collision", "--help", "--xacro", "--package"),
}


@cache
def options(command: str) -> dict[str, bool]:
    """Long name of each option of a command -> whether it is a flag."""
    leaf = command_parsers.leaves(command.partition(" ")[0])[f"alpha5 {command}"]
    found = {}
    for option in command_parsers.options(leaf):
        if option.option_strings and option.option_strings[-1] not in LEFT_OUT:
            found[option.option_strings[-1]] = option.nargs == 0
    return found


def any_words(rng: Random) -> list[str]:
    """A command with options and arguments."""
    command = rng.choice([*ARGUMENTS])
    known = options(command)
    chosen = rng.sample([*known], min(rng.randrange(4), len(known)))
    words = command.split()
    for name in dict.fromkeys([*ALWAYS.get(command, []), *chosen]):
        words.append(name)
        if not known[name]:
            words.append(a_value(rng, name))
    for place in ARGUMENTS[command]:
        words.append(rng.choice(BAD if rng.random() < 0.03 else place))
    if rng.random() < 0.05:
        words.insert(rng.randint(1, len(words)), rng.choice(BAD))
    return words


def a_value(rng: Random, option: str) -> str:
    if rng.random() < 0.07:
        return rng.choice(BAD)
    if option in WRITTEN:
        return rng.choice(OUTPUTS) + rng.choice(WRITTEN[option])
    return rng.choice(VALUES.get(option, NUMBERS))


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The working directory, two folders deep: ``../..`` is still ours."""
    work = tmp_path_factory.mktemp("commands") / "deep" / "work"
    (work / "folder").mkdir(parents=True)
    (work / "locked").mkdir(mode=0o500)
    for end in ("", ".csv", ".json", ".png", ".svg", ".urdf", ".html", ".toml"):
        (work / f"loop{end}").symlink_to(f"loop{end}")
    return work


#: Name of a good file -> how it is damaged, and its content.
GOOD = {
    "arm.urdf": ("xml", lambda: Path(a5.URDF_PATH).read_text(encoding="utf-8")),
    "motion.csv": ("table", table),
    "study.toml": ("toml", lambda: STUDY),
    "arm.toml": ("toml", lambda: ARM),
    "obstacles.toml": ("toml", lambda: OBSTACLES),
}


class RefusedError(Alpha5Error):
    """Status 2 and one line."""


class Said(NamedTuple):
    """Exit status of a command, and what it says on standard output and error."""

    status: int
    answer: str
    complaint: str


def said(folder: Path, args: list[str]) -> Said:
    from alpha5_model.cli import main

    out = io.TextIOWrapper(io.BytesIO(), "utf-8")
    home = Path.cwd()
    stderr = os.dup(2)
    os.chdir(folder)
    # The descriptor, too: libraries in C++ write there.
    with tempfile.TemporaryFile("w+") as err:
        os.dup2(err.fileno(), 2)
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                status = main(args=args)
        finally:
            os.dup2(stderr, 2)
            os.close(stderr)
            os.chdir(home)
        err.seek(0)
        complaint = err.read()
    out.flush()
    return Said(status, out.buffer.getvalue().decode(), complaint)  # type: ignore[attr-defined]


def without(text: str, start: str) -> str:
    """A text without the lines that start so."""
    lines = text.splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith(start))


def judged(found: Said, args: list[str]) -> Any:
    """Status 0, 1, or 2 with one line that names the program; JSON is JSON."""
    complaint = without(found.complaint, "alpha5: warning: ")
    # What else there is to say makes way for a file on standard output.
    aside = found.status != 2 and "-" in args
    lines = complaint.strip("\n").splitlines()
    refused = found.status == 2
    assert found.status in (0, 1, 2), found
    assert refused == complaint.startswith("alpha5: "), found
    assert aside or len(lines) == refused, found
    assert "Traceback" not in complaint + found.answer, found
    if refused:
        raise RefusedError(complaint.strip())
    others = args[0] == "generate" or {"--explain", "--"} & {*args} or "-" in args
    if "--json" in args and not others:
        json.loads(found.answer, parse_constant=no_number)


def no_number(constant: str) -> NoReturn:
    raise AssertionError(f"{constant} in the JSON")


@oracle.fuzzed
@given(
    args=st.randoms(use_true_random=True).map(any_words),
    data=st.data(),
)
def test_commands(work: Path, args: list[str], data: st.DataObject) -> None:
    for name, (kind, content) in GOOD.items():
        (work / name).write_text(content(), encoding="utf-8")
        if f"damaged_{name}" in args:
            damage = data.draw(damaged(content(), kind))
            (work / f"damaged_{name}").write_bytes(damage)
    oracle.answer(lambda: judged(said(work, args), args))


def test_a_wrong_end_of_a_command_is_seen() -> None:
    for wrong in (
        Said(3, "", ""),
        Said(2, "", "alpha5: one\ntwo\n"),
        Said(2, "", "one\n"),
        Said(0, "", "alpha5: one\n"),
        Said(0, '{"x": NaN}', ""),
    ):
        with pytest.raises(AssertionError):
            judged(wrong, ["ik", "--json"])
