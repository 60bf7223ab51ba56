"""The command line, in this process: options of every sort, its own folder."""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from fuzzing import folders, hostile, own_arms
from fuzzing.cases import Case, Target
from fuzzing.damage import damage
from fuzzing.readers import STUDY
from fuzzing.values import Rng, pick

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import Alpha5Error

#: In place of any value.
BAD = (
    "",
    " ",
    "x",
    "nan",
    "inf",
    "-inf",
    "1e400",
    "1e308",
    "-1e308",
    "1e-320",
    "-1",
    "0",
    "1.5",
    "2**3",
    "9" * 400,
    "1e9999999",
    "0 0",
    "0 0 nan",
    "1 2 3 4",
    "a,b",
    "a=b",
    "=",
    "\udcff",
    "é",
    "a\0b",
    "a\nb",
    "x" * 5000,
    "--",
    "-",
    "[red]",
    "${1/0}",
    "true",
    "None",
    "../..",
    "\x1b[31m",
)
#: Paths below the working directory, which `_furnish` makes in the fuzz's own folder.
URDFS = (
    "arm.urdf",
    "arm.urdf",
    "damaged.urdf",
    "trapped.urdf",
    "trapped.xacro",
    "motion.csv",
    "none",
    "folder",
    "loop",
    "empty",
)
RECORDINGS = (
    "motion.csv",
    "motion.csv",
    "link.csv",
    "damaged.csv",
    "trapped.csv",
    "torques.csv",
    "arm.urdf",
    "dangling",
    "locked",
)


def _out(*endings: str) -> tuple[str, ...]:
    names = (
        "out",
        "out",
        "new/deep/out",
        "loop",
        "dangling",
        "folder",
        "motion.csv/below",
        "locked/out",
    )
    return tuple(name + ending for name in names for ending in endings)


_TABLE = _out(".csv", ".json", ".csv", ".txt")
_PICTURE = _out(".png", ".svg", ".png", ".bmp")
_NUMBER = ("0.3", "-0.1", "1.2", "0", "3")
_TRIPLE = ("0 0 -9.81", "0 9.81 0", "0,0,1")
_FLUID = ("sea", "fresh", "air", "1025", "0", "1.025", "1e5", "-3")
_PAYLOAD = ("0.2", "0.2 0 0 0.05", "500", "-1", "250g", "0.2 0 0 20")
_ARMS = ("arm.toml", "arm.toml", "damaged_arm.toml", "trapped_arm.toml", "none", "-")
_MAPS = (
    "axis_e=axis_e",
    "axis_e=x",
    "axis_e=axis_e,axis_d=axis_d,axis_c=axis_c,axis_b=axis_b",
    "axis_e=axis_d,axis_d=axis_e",
    "axis_e=axis_e,axis_e=axis_d",
    "axis_e=axis_e,axis_d=axis_e",
    "axis_a=axis_e",
    "axis_e=axis_e_pos",
    "axis_e==x",
    "axis_e=",
    "=,=",
    "axis_e=[red]x[/red]",
    "axis_e=a\nb",
    "axis_z=axis_e",
    ",".join(f"j{k}=k{k}" for k in range(300)),
)
_JSON: dict[str, tuple[str, ...]] = {"--json": ()}
_ARM: dict[str, tuple[str, ...]] = {"--arm": _ARMS}
#: An option and its values; the empty name stands for an argument.
Option = tuple[str, tuple[str, ...]]
#: Command -> options that are always there, and options that may be there; flags have
#: no values.
COMMANDS: dict[str, tuple[tuple[Option, ...], dict[str, tuple[str, ...]]]] = {
    "ik": (
        (("", ("0.3", "0.25")), ("", ("0.1", "-0.05")), ("", ("0.1", "0"))),
        {"--wrist": _NUMBER, **_ARM, **_JSON},
    ),
    "torque": (
        (("--q", _NUMBER), ("", _NUMBER), ("", _NUMBER), ("", _NUMBER)),
        {
            "--fluid": _FLUID,
            "--gravity": _TRIPLE,
            "--constants": ("printed", "torque", "voltage"),
            "--degrees": (),
            "--payload": _PAYLOAD,
            "--mount": _TRIPLE,
            **_ARM,
            **_JSON,
        },
    ),
    "fk": (
        (("", _NUMBER), ("", _NUMBER), ("", _NUMBER), ("", _NUMBER)),
        {**_ARM, **_JSON},
    ),
    "arm": (
        (("", ("check", "show", "show", "new", "x")), ("", _ARMS)),
        {**_JSON},
    ),
    "move": (
        (
            ("", ("home", "stow", "reach", "1 1 1 1")),
            ("", ("stow", "home", "0.3", "0.1", "x")),
            ("", ("0.1", "-0.05")),
            ("", ("0.1", "0.2")),
        ),
        {
            "--output": _out(".csv", ".txt"),
            "--obstacles": ("obstacles.toml", "damaged_obstacles.toml", "none", "-"),
            "--speed": ("0.2", "0", "1e-9", "9"),
            "--acceleration": ("0.5", "0", "1e9"),
            "--margin": ("0", "0.02", "9", "20mm"),
            "--wrist": _NUMBER,
            "--fluid": _FLUID,
            "--payload": _PAYLOAD,
            "--mount": _TRIPLE,
            "--supply-voltage": ("24", "1e-3"),
            "--current-limit": ("1", "1e-6"),
            **_ARM,
            **_JSON,
        },
    ),
    "sweep": (
        (
            ("", ("study.toml", "study.toml", "damaged.toml", "arm.urdf", "none")),
            ("--output", _out("")),
        ),
        {"--yes": (), **_ARM, **_JSON},
    ),
    "workspace": ((), {"--plot": _PICTURE, **_ARM, **_JSON}),
    "dh": (
        (),
        {
            "--urdf": URDFS,
            "--frame": ("link_2", "tcp"),
            "--link": ("0 0.1 0.2 1.5 0", "0 0 1 0 1"),
            "--": _NUMBER,
            **_JSON,
        },
    ),
    "planar": (
        (("", _NUMBER), ("", _NUMBER), ("", _NUMBER)),
        {
            "--joints": ("RRR", "RPR"),
            "--limits": ("0 1", "none"),
            "--radius": _NUMBER,
            "--plot": _PICTURE,
            **_JSON,
        },
    ),
    "trajectory": (
        (("", RECORDINGS),),
        {
            "--output": _TABLE,
            "--plot": _PICTURE,
            "--fluid": _FLUID,
            "--gravity": _TRIPLE,
            "--gripper": ("auto", "locked", "jaws"),
            "--payload": _PAYLOAD,
            "--prefix": ("left_", ""),
            "--topic": ("/x",),
            "--map": _MAPS,
            "--degrees": (),
            "--smoothing": ("spline", "savgol", "interpolate"),
            "--bandwidth": ("2", "0.1", "1e-100"),
            "--velocities": ("auto", "file", "positions"),
            "--constants": ("printed", "torque"),
            "--supply-voltage": ("24",),
            "--current-limit": ("1",),
            "--screw-lead": ("0.001",),
            **_ARM,
            **_JSON,
        },
    ),
    "generate": (
        (),
        {
            "--output": _out(".urdf", "", ".xml"),
            "--format": (
                "urdf",
                "srdf",
                "xacro",
                "mjcf",
                "sdf",
                "usd",
                "c",
                "water",
                "lighthill",
            ),
            "--gripper": ("locked", "jaws"),
            "--prefix": ("a_",),
            "--parent": ("rov",),
            "--xyz": _TRIPLE,
            "--rpy": _TRIPLE,
            "--mesh-uri": ("relative", "package", "file"),
            "--collision": ("none",),
            "--corrections": ("", "base_frame"),
            "--fluid": _FLUID,
            "--actuators": ("motor",),
            "--level": ("low", "nominal", "high"),
            **_ARM,
            "--dh-frames": (),
            "--ros2-control": (),
            "--drag": (),
        },
    ),
    "compare": (
        (("", URDFS), ("--samples", ("3",))),
        {
            "--map": _MAPS,
            "--base": ("base_link", "link_2", "tcp", "none"),
            "--write-arm": _out(".toml", ".toml", ".txt"),
            "--explain": ("body.mass", "tool.offset", "body", ""),
            **_ARM,
            "--plot": _PICTURE,
            "--format": ("text", "json", "junit"),
            **_JSON,
        },
    ),
    "check": (
        (("--urdf", URDFS),),
        {"--corrections": ("", "base_frame", "link3_cob"), **_ARM, **_JSON},
    ),
    "view": (
        (("--image", _PICTURE), ("--size", ("64x48",))),
        {
            "--pose": ("home", "stow", "1,1,1,1,0"),
            "--target": ("0.3,0,0.1",),
            "--motion": RECORDINGS,
            "--show": ("bodies", "frames,com"),
            "--gripper": ("locked", "jaws"),
            "--fluid": _FLUID,
            "--html": _out(".html"),
            **_ARM,
        },
    ),
}


def _furnish(folder: Path, rng: Rng) -> Path:
    """The working directory with what the paths lead to.

    It is two folders deep, so that ``../..`` is still ours.
    """
    work = folder / "deep" / "work"
    if not work.exists():
        _make_folders_and_links(work)

    arm = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    motion = _motion()
    good = {"arm.urdf": arm, "motion.csv": motion, "study.toml": STUDY}
    for name, text in good.items():
        ending = name.partition(".")[2]
        (work / name).write_text(text, encoding="utf-8")
        (work / f"damaged.{ending}").write_bytes(damage(rng, text))
    tables = {"arm.toml": own_arms.ARM, "obstacles.toml": folders.OBSTACLES}
    for name, text in tables.items():
        (work / name).write_text(text, encoding="utf-8")
        (work / f"damaged_{name}").write_bytes(damage(rng, text))
    (work / "frame.stl").write_bytes(folders.stl(rng))

    trapped = hostile.trapped_xml(rng, arm)
    bad = {
        "trapped.urdf": trapped,
        "trapped.xacro": trapped,
        "trapped.csv": hostile.table_of_anything(rng),
        "trapped_arm.toml": hostile.study_of_anything(rng, own_arms.ARM),
        "torques.csv": motion.replace("axis", "tau_axis"),
    }
    for name, text in bad.items():
        (work / name).write_text(text, encoding="utf-8", errors="replace")
    return work


def _make_folders_and_links(work: Path) -> None:
    (work / "folder").mkdir(parents=True)
    (work / "locked").mkdir(mode=0o500)
    (work / "empty").touch()
    (work / "link.csv").symlink_to("motion.csv")
    for end in ("", ".csv", ".json", ".png", ".svg", ".urdf", ".html", ".toml"):
        (work / f"loop{end}").symlink_to(f"loop{end}")
        (work / f"dangling{end}").symlink_to(f"nowhere{end}")


def _motion() -> str:
    """A recording of two seconds."""
    lines = ["time_secs,axis_e_pos,axis_d_pos,axis_c_pos,axis_b_pos"]
    for k in range(40):
        lines.append(f"{k * 0.05:.2f},{3 + 0.01 * k},1.{k:02d},1,0.5")
    return "\n".join(lines) + "\n"


def _of(command: str) -> Target:
    always, sometimes = COMMANDS[command]
    few = 2 / (len(sometimes) + 1)

    def target(rng: Rng, folder: Path) -> Case:
        chosen = [option for option in sometimes.items() if rng.random() < few]
        arguments = [command]
        for name, values in (*always, *chosen):
            arguments += _written(rng, name, values)
        if rng.integers(20) == 0:
            place = int(rng.integers(1, len(arguments) + 1))
            arguments.insert(place, pick(rng, BAD))
        work = _furnish(folder, rng)
        return Case(_run(work), {"args": arguments})

    return target


def _written(rng: Rng, option: str, values: tuple[str, ...]) -> list[str]:
    """An option with drawn values; some options are repeated."""
    repetitions = {"--limits": 3, "--": 4}.get(option, 1)
    words = [option] if option else []
    for k in range(repetitions if values else 0):
        if k and option != "--":
            words.append(option)
        known = BAD if rng.integers(15) == 0 else values
        words.append(str(pick(rng, known)))
    return words


class RefusedError(Alpha5Error):
    """Status 2 and one line."""


def _run(folder: Path) -> Callable[[list[str]], Any]:
    """Runs a command in a folder and judges what it says."""

    def call(args: list[str]) -> Any:
        said = _said(folder, args)
        complaint = _without_lines(said.complaint, "alpha5: warning: ")
        # What else there is to say makes way for a file on standard output.
        aside = said.status != 2 and "-" in args
        _check_what_it_says(said, complaint, aside)
        # After -- there are no options.
        options = args[: args.index("--")] if "--" in args else args
        others = args[0] == "generate" or "--explain" in options
        if said.status < 2 and "--json" in options and not others:
            text = _without_lines(complaint, "wrote ") if aside else said.answer
            return json.loads(text, parse_constant=_refuse)
        if said.status == 2:
            raise RefusedError(complaint.strip())
        return None

    return call


class _Said(NamedTuple):
    """What a command says.

    Attributes:
        status: Its exit status.
        answer: On standard output.
        complaint: On standard error.
    """

    status: int
    answer: str
    complaint: str


def _said(folder: Path, args: list[str]) -> _Said:
    """What a command says in a folder."""
    out = io.TextIOWrapper(io.BytesIO(), "utf-8")
    home = Path.cwd()
    stderr = os.dup(2)
    os.chdir(folder)
    # The descriptor too: libraries in C++ write there.
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
    answer = out.buffer.getvalue().decode()  # type: ignore[attr-defined]
    return _Said(status=status, answer=answer, complaint=complaint)


def _without_lines(text: str, start: str) -> str:
    """A text without the lines that start so."""
    lines = text.splitlines(keepends=True)
    return "".join(line for line in lines if not line.startswith(start))


def _check_what_it_says(said: _Said, complaint: str, aside: bool) -> None:
    """Raise an error unless status and complaint fit: one line if it is 2, else none.

    Args:
        said: By the command.
        complaint: Without warnings.
        aside: Whether other lines may be on standard error.
    """
    refused = said.status == 2
    lines = complaint.strip("\n").splitlines()
    is_known = said.status in (0, 1, 2)
    is_named = refused == complaint.startswith("alpha5: ")
    is_short = aside or len(lines) == refused
    if not (is_known and is_named and is_short):
        raise RuntimeError(f"status {said.status} with {complaint!r}")
    if "Traceback" in complaint + said.answer:
        raise RuntimeError("a traceback")


def _refuse(constant: str) -> None:
    raise RuntimeError(f"{constant} in the JSON")


TARGETS: dict[str, Target] = {f"alpha5 {command}": _of(command) for command in COMMANDS}
