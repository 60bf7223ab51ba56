"""Options that commands share, how numbers are read, and how results are printed."""

from __future__ import annotations

import json
import math
import re
import sys
import tomllib
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext, redirect_stdout
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import numpy as np
from typer import BadParameter, Option, echo, style

from alpha5_model._support.checks import real
from alpha5_model._support.files import is_stdout
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model._support.text import plain, printable, readable, wrapped
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import AIR, FRESH_WATER, SEA_WATER, gravity_in_base

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: What commands print, by command, and the longer helps of their options.
WORDS: Any = tomllib.loads(Path(__file__).with_name("words.toml").read_text("utf-8"))
HELP = WORDS["help"]
#: What a command prints to be read.
Lines: TypeAlias = Iterable[str]
# Units stand in round brackets: the terminal takes [m] for a style.
FLUID = "sea (1025), fresh (1000), air (0) or a density (kg/m^3)."
Fluid = Annotated[str, Option(help=FLUID)]
DOWN = "0 0 -9.81"
Gravity = Annotated[
    str, Option(help="In base_link (m/s^2); with --mount in the world.")
]
Gripper = Annotated[
    str, Option(help="locked (4 joints) or jaws (adds the jaw rod axis_a).")
]
Mount = Annotated[
    str, Option(help="Roll, pitch, yaw of base_link in the world, z up (rad).")
]
Payload = Annotated[str | None, Option(help=HELP["payload"])]
Current = Annotated[str | None, Option(help=HELP["current"])]
Constants = Annotated[str, Option(help=HELP["constants"])]
Efficiency = Annotated[str, Option(help=HELP["efficiency"])]
Plot = Annotated[Path | None, Option(help="Write a picture: .png, .pdf or .svg.")]
Json = Annotated[bool, Option("--json", help="Everything as JSON, in SI units.")]
_FLUIDS = {"sea": SEA_WATER, "fresh": FRESH_WATER, "air": AIR}
#: What is larger is a typing error.
_MOST = {"current": 100.0, "gravity": 1e4, "fluid": 1e5}
_COUNTS = {2: "two", 3: "three", 4: "four", 5: "five"}
#: Unit behind a number -> what it measures, and its size in SI units.
_UNITS = {
    "deg": ("rad", math.pi / 180),
    "mm": ("m", 1e-3),
    "rad": ("rad", 1.0),
    "m": ("m", 1.0),
}
#: Unit -> what is plausible of a number in it.
_PLAUSIBLE = {
    "m": plausibility.POSITION,
    "rad": plausibility.ANGLE,
    "rad/s": plausibility.ANGLE,
    "rad/s^2": plausibility.ANGLE,
}
_NUMBER = rf"[-+−]?(?:\d+\.?\d*|\.\d+|inf|nan)(?:e[-+]?\d+)?(?:{'|'.join(_UNITS)})?"
_NUMBERS = re.compile(rf"\s*{_NUMBER}(?:[\s,]+{_NUMBER})*[\s,]*", re.IGNORECASE)
#: Options with vectors -> how many numbers they take at most; those with 0 take whatever stands
#: before the next option, since their commands have no arguments.
_VECTORS = {
    "--link": 5,
    "--limits": 2,
    "-l": 2,
    "--gravity": 9,
    "--current": 9,
    "--mount": 9,
}
_VECTORS |= {"--payload": 9, "--q": 0, "--v": 0, "--a": 0, "--xyz": 0, "--rpy": 0}
_VECTORS |= {"--target": 0, "--pose": 0}
_COLOURS = {
    "agrees": "green",
    "passed": "green",
    "differs": "yellow",
    "not run": "yellow",
}
_COLOURS |= {"impossible": "red", "failed": "red", "✗": "red", "·": "yellow"}
_FIRST = re.compile(rf"( *)({'|'.join(_COLOURS)})(?= )")
#: Where another unit seems meant: said beside the error or after the result.
hints: list[str] = []


def one_syntax(words: Iterable[str]) -> list[str]:
    """Arguments as the parser takes them: each vector one word, each other number one word.

    ``--q 1 2 3 4``, ``--q 1,2,3,4`` and ``--q 57 115 172 229 deg`` are the same, as are ``1 2`` and
    ``1,2`` without an option.
    """
    left, out = list(words), []
    while left:
        most = _VECTORS.get(left[0])
        if most is not None:
            out.append(left.pop(0))
        run: list[str] = []
        while left and (
            _NUMBERS.fullmatch(left[0]) or (most == 0 and left[0][:1] != "-")
        ):
            run.append(left.pop(0))
            if most and (len(run) == most or len(_split(run[0])) > 1):
                break
        if run and left and left[0] in _UNITS:
            run.append(left.pop(0))
        parts = _split(" ".join(run))
        out += [" ".join(parts)] if parts and most is not None else parts
        if most is None and not run:
            out.append(left.pop(0))
    return out


def _split(text: str) -> list[str]:
    """The parts between commas and spaces; a unit apart behind them is that of all without one."""
    parts = text.replace("−", "-").replace(",", " ").split()
    unit = parts.pop() if parts and parts[-1] in _UNITS else ""
    return [part if part.endswith(tuple(_UNITS)) else part + unit for part in parts]


def numbers(
    name: str, text: str, counts: Sequence[int] = (), unit: str = "", expected: str = ""
) -> list[float]:
    """Numbers in one text, separated by spaces or commas, in SI units.

    Args:
        counts: How many there may be; empty for any.
        unit: What they measure: ``m`` and ``rad`` may have ``mm`` and ``deg`` behind them.
        expected: For the message; from counts and unit if left out.

    Raises:
        InputError: Anything else.
    """
    kinds = ("rad", "m") if " m" in unit else (unit.partition("/")[0],)
    allowed = {u: size for u, (kind, size) in _UNITS.items() if kind in kinds}
    words = " or ".join(
        f"{_COUNTS.get(n, n)} numbers" if n > 1 else "one number" for n in counts
    )
    values = []
    try:
        for part in _split(text):
            own = next((u for u in allowed if part.endswith(u)), "")
            values.append(float(part.removesuffix(own)) * allowed.get(own, 1.0))
            if not own and unit in _PLAUSIBLE:
                hints.extend(plausibility.hints(part, values[-1], _PLAUSIBLE[unit]))
    except ValueError:
        counts = (-1,)
    if counts and len(values) not in counts:
        raise InputError(name, text, expected or f"{words} ({unit})")
    if any(abs(x) > (most := _MOST.get(name, math.inf)) for x in values):
        raise InputError(name, text, f"at most {most:g} {unit}")
    return values


def joint_numbers(
    name: str, text: str, unit: str, counts: Sequence[int]
) -> list[float]:
    """One number for each joint, base to tip; a unit apart behind them is not the jaw rod's."""
    words = " or ".join(_COUNTS[n] for n in sorted({*counts}))
    expected = f"{words} numbers ({unit}{', jaw rod m' if 5 in counts else ''})"
    parts = _split(text)
    if len(parts) not in counts:
        raise InputError(name, text, expected)
    rod = " ".join(part.removesuffix("deg") for part in parts[4:])
    turning = numbers(name, " ".join(parts[:4]), (4,), unit, expected)
    return turning + numbers(name, rod, (), unit.replace("rad", "m"), expected)


def current_vector(text: str | None) -> list[float] | None:
    """Three numbers [m/s]; None for none."""
    return None if text is None else numbers("current", text, (3,), "m/s")


def metres(text: Any, unit: str = "m") -> float:
    """A length as the parser of one argument."""
    try:
        return numbers("", str(text), (1,), unit)[0]
    except InputError as error:
        raise BadParameter(f"expected {error.expected}, got {text!r}") from None


def radians(text: Any) -> float:
    """An angle as the parser of one argument or option."""
    return metres(text, "rad")


def fluid_density(text: str) -> float:
    """``sea``, ``fresh``, ``air`` or a number [kg/m^3].

    Raises:
        InputError: Anything else.
    """
    if text in _FLUIDS:
        return _FLUIDS[text]
    expected = f"{', '.join(_FLUIDS)} or a density [kg/m^3]"
    (density,) = numbers("fluid", text, (1,), "kg/m^3", expected)
    return real("fluid", density, minimum=0.0)


def correction_names(text: str | None) -> tuple[str, ...]:
    """Names of corrections, not checked; the default ones for None."""
    return DEFAULT_CORRECTIONS if text is None else names(text)


def names(text: str) -> tuple[str, ...]:
    """The parts between commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def arm_in(
    fluid: str, gravity: str, gripper: str, mount: str, payload: str | None
) -> Arm:
    """The arm, from the text of the options."""
    from alpha5_model.dynamics.load import load

    rotation = rotation_from_rpy(numbers("mount", mount, (3,), "rad"))
    g: Any = numbers("gravity", gravity, (3,), "m/s^2")
    if not np.array_equal(rotation, np.eye(3)):
        g = gravity_in_base(rotation, g)
    arm = load(fluid_density(fluid), gripper, gravity=g)
    if payload is None:
        return arm
    expected = "MASS, MASS X Y Z or MASS X Y Z VOLUME (kg, m, m^3)"
    mass, *more = numbers("payload", payload, (1, 4, 5), "kg, m", expected)
    com = more[:3] or [0.0, 0.0, 0.0]
    return arm.with_payload(mass, com, volume=sum(more[3:]), cob=com)


def show(as_json: bool, record: Any, text: Lines, *written: Path | None) -> None:
    """Print a result for scripts or for people.

    Args:
        as_json: Print the record, and nothing else.
        record: The result: numbers, texts, arrays, records and collections of them.
        text: The same to read, see `say`.
        written: Files of this result, each named in a line of its own; None is skipped.
    """
    files = [path for path in written if path is not None]
    # Messages go to standard error where a file goes to standard output.
    with redirect_stdout(sys.stderr) if any(map(is_stdout, files)) else nullcontext():
        if as_json:
            echo(json.dumps(plain(record), indent=2, allow_nan=False))
            return
        if text:
            say(*text)
        for path in files:
            echo(f"wrote {path}")


def say(*lines: str) -> None:
    """Print lines to be read, wrapped; a terminal shows a true minus, and verdicts in colour."""
    for line in "\n".join(lines).split("\n"):
        shown = readable(printable(line))
        if sys.stdout.isatty():
            shown = re.sub(r"(?<![\w.,=-])-(?=[\d.])", "−", shown)
        for part in wrapped(shown, width()):
            echo(
                _FIRST.sub(
                    lambda m: m[1] + style(m[2], fg=_COLOURS[m[2]]), part, count=1
                )
            )


def width() -> int:
    """Columns of the terminal, or those that the environment asks for."""
    return get_terminal_size().columns


def spinner(words: str) -> AbstractContextManager[object]:
    """A spinner on stderr, on a terminal only."""
    from rich.console import Console

    console = Console(stderr=True)
    return console.status(words) if console.is_terminal else nullcontext()
