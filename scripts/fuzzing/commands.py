"""The command line, in this process: options of every sort, output in a folder of its own."""

from __future__ import annotations

import contextlib
import io
import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fuzzing import hostile
from fuzzing.cases import Case, Target
from fuzzing.readers import STUDY, damage
from fuzzing.values import Rng, pick

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import Alpha5Error

#: In place of any value.
BAD = (
    "", " ", "x", "nan", "inf", "-inf", "1e400", "1e308", "-1e308", "1e-320", "-1", "0", "1.5", "2**3", "9" * 400, "1e9999999", "0 0", "0 0 nan",
    "1 2 3 4", "a,b", "a=b", "=", "\udcff", "é", "a\0b", "a\nb", "x" * 5000, "--", "-", "[red]", "${1/0}", "true", "None", "../..", "\x1b[31m",
)  # fmt: skip
#: Paths below the working directory, which lies in the fuzz's own folder; made in `_furnish`.
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


_TABLE, _PICTURE = (
    _out(".csv", ".json", ".csv", ".txt"),
    _out(".png", ".svg", ".png", ".bmp"),
)
_NUMBER = ("0.3", "-0.1", "1.2", "0", "3")
_TRIPLE = ("0 0 -9.81", "0 9.81 0", "0,0,1")
_FLUID = ("sea", "fresh", "air", "1025", "0", "1.025", "1e5", "-3")
_PAYLOAD = ("0.2", "0.2 0 0 0.05", "500", "-1", "250g", "0.2 0 0 20")
_JSON: dict[str, tuple[str, ...]] = {"--json": ()}
#: Command -> options that are always there, the empty name for arguments, each once per tuple of values; then
#: options that may be there, flags with no values.
COMMANDS: dict[str, tuple[tuple[tuple[str, tuple[str, ...]], ...], dict[str, tuple[str, ...]]]] = {
    "ik": ((("", ("0.3", "0.25")), ("", ("0.1", "-0.05")), ("", ("0.1", "0"))), {"--wrist": _NUMBER, **_JSON}),
    "torque": (
        (("--q", _NUMBER), ("", _NUMBER), ("", _NUMBER), ("", _NUMBER)),
        {"--fluid": _FLUID, "--gravity": _TRIPLE, "--constants": ("printed", "torque", "voltage"), "--degrees": (), "--payload": _PAYLOAD, "--mount": _TRIPLE, **_JSON},
    ),
    "fk": ((("", _NUMBER), ("", _NUMBER), ("", _NUMBER), ("", _NUMBER)), {**_JSON}),
    "sweep": ((("", ("study.toml", "study.toml", "damaged.toml", "arm.urdf", "none")), ("--output", _out(""))), {**_JSON}),
    "workspace": ((), {"--plot": _PICTURE, **_JSON}),
    "dh": ((), {"--urdf": URDFS, "--frame": ("link_2", "tcp"), "--link": ("0 0.1 0.2 1.5 0", "0 0 1 0 1"), "--": _NUMBER, **_JSON}),
    "planar": ((("", _NUMBER), ("", _NUMBER), ("", _NUMBER)), {"--joints": ("RRR", "RPR"), "--limits": ("0 1", "none"), "--radius": _NUMBER, "--plot": _PICTURE, **_JSON}),
    "trajectory": (
        (("", RECORDINGS),),
        {"--output": _TABLE, "--plot": _PICTURE, "--fluid": _FLUID, "--gravity": _TRIPLE, "--gripper": ("auto", "locked", "jaws"),
         "--payload": _PAYLOAD, "--prefix": ("left_", ""), "--topic": ("/x",), "--smoothing": ("spline", "savgol", "interpolate"), "--bandwidth": ("2", "0.1", "1e-100"), "--velocities": ("auto", "file", "positions"),
         "--constants": ("printed", "torque"), "--supply-voltage": ("24",), "--current-limit": ("1",), "--screw-lead": ("0.001",), **_JSON},
    ),
    "generate": (
        (),
        {"--output": _out(".urdf", "", ".xml"), "--format": ("urdf", "mjcf", "sdf"), "--gripper": ("locked", "jaws"), "--prefix": ("a_",), "--parent": ("rov",),
         "--xyz": _TRIPLE, "--rpy": _TRIPLE, "--mesh-uri": ("relative", "package", "file"), "--collision": ("none",), "--corrections": ("", "base_frame"),
         "--fluid": _FLUID, "--actuators": ("motor",), "--dh-frames": (), "--ros2-control": (), "--drag": ()},
    ),
    "compare": ((("", URDFS), ("--samples", ("3",))), {"--map": ("axis_e=axis_e", "axis_e=x"), "--plot": _PICTURE, **_JSON}),
    "check": ((("--urdf", URDFS),), {"--corrections": ("", "base_frame", "link3_cob"), **_JSON}),
    "view": (
        (("--image", _PICTURE), ("--size", ("64x48",))),
        {"--pose": ("home", "stow", "1,1,1,1,0"), "--target": ("0.3,0,0.1",), "--motion": RECORDINGS, "--show": ("bodies", "frames,com"), "--gripper": ("locked", "jaws"),
         "--fluid": _FLUID, "--html": _out(".html")},
    ),
}  # fmt: skip


def _furnish(folder: Path, rng: Rng) -> Path:
    """The working directory with what the paths lead to, two folders deep: ``../..`` is still ours."""
    work = folder / "deep" / "work"
    if not work.exists():
        (work / "folder").mkdir(parents=True)
        (work / "locked").mkdir(mode=0o500)
        (work / "empty").touch()
        (work / "link.csv").symlink_to("motion.csv")
        for end in ("", ".csv", ".json", ".png", ".svg", ".urdf", ".html"):
            (work / f"loop{end}").symlink_to(f"loop{end}")
            (work / f"dangling{end}").symlink_to(f"nowhere{end}")
    arm = Path(a5.URDF_PATH).read_text(encoding="utf-8")
    rows = "".join(
        f"{k * 0.05:.2f},{3 + 0.01 * k},1.{k:02d},1,0.5\n" for k in range(40)
    )
    motion = "time_secs,axis_e_pos,axis_d_pos,axis_c_pos,axis_b_pos\n" + rows
    for name, text in (
        ("arm.urdf", arm),
        ("motion.csv", motion),
        ("study.toml", STUDY),
    ):
        (work / name).write_text(text, encoding="utf-8")
        (work / f"damaged.{name.partition('.')[2]}").write_bytes(damage(rng, text))
    trapped = hostile.trapped_xml(rng, arm)
    tables = {
        "trapped.csv": hostile.table_of_anything(rng),
        "torques.csv": motion.replace("axis", "tau_axis"),
    }
    texts = {"trapped.urdf": trapped, "trapped.xacro": trapped, **tables}
    for name, text in texts.items():
        (work / name).write_text(text, encoding="utf-8", errors="replace")
    return work


def _of(command: str) -> Target:
    always, sometimes = COMMANDS[command]
    few = 2 / (len(sometimes) + 1)

    def target(rng: Rng, folder: Path) -> Case:
        arguments = [command]
        for option, values in (
            *always,
            *((o, v) for o, v in sometimes.items() if rng.random() < few),
        ):
            repeated = {"--limits": 3, "--": 4}.get(option, 1)
            arguments += [option] if option else []
            for k in range(repeated if values else 0):
                arguments += [option] if k and option != "--" else []
                arguments.append(
                    str(pick(rng, BAD if rng.integers(15) == 0 else values))
                )
        if rng.integers(20) == 0:
            arguments.insert(int(rng.integers(1, len(arguments) + 1)), pick(rng, BAD))
        return Case(_run(_furnish(folder, rng)), {"args": arguments})

    return target


class RefusedError(Alpha5Error):
    """Status 2 and one line."""


def _run(folder: Path) -> Callable[[list[str]], Any]:
    def call(args: list[str]) -> Any:
        out = io.TextIOWrapper(io.BytesIO(), "utf-8")
        home, stderr = Path.cwd(), os.dup(2)
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
        shown = out.buffer.getvalue().decode()  # type: ignore[attr-defined]
        said = complaint.splitlines(keepends=True)
        complaint = "".join(
            line for line in said if not line.startswith("alpha5: warning: ")
        )
        lines = complaint.strip("\n").splitlines()
        # What else there is to say makes way for a file on standard output.
        aside = status != 2 and "-" in args
        if (
            status not in (0, 1, 2)
            or (status == 2) != complaint.startswith("alpha5: ")
            or (not aside and len(lines) != (status == 2))
        ):
            raise RuntimeError(f"status {status} with {complaint!r}")
        if "Traceback" in complaint + shown:
            raise RuntimeError("a traceback")
        if status < 2 and "--json" in args and args[0] != "generate":
            text = "".join(
                x for x in complaint.splitlines(True) if not x.startswith("wrote ")
            )
            return json.loads(text if aside else shown, parse_constant=_refuse)
        if status == 2:
            raise RefusedError(complaint.strip())
        return None

    return call


def _refuse(constant: str) -> None:
    raise RuntimeError(f"{constant} in the JSON")


TARGETS: dict[str, Target] = {f"alpha5 {command}": _of(command) for command in COMMANDS}
