"""Options that several commands share, how their text is read, and how results are printed."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from contextlib import AbstractContextManager, nullcontext, redirect_stdout, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from typer import Option, echo

from alpha5_model.checks import real
from alpha5_model.corrections import DEFAULT_CORRECTIONS
from alpha5_model.errors import InputError
from alpha5_model.files import is_stdout
from alpha5_model.fluids import AIR, FRESH_WATER, SEA_WATER

if TYPE_CHECKING:
    from rich.console import RenderableType

    from alpha5_model.dynamics.arm import Arm

#: What a command prints to be read: strings, and what Rich fits to the terminal.
Lines: TypeAlias = "Iterable[RenderableType]"
# Units stand in round brackets: the terminal takes [m] for a style.
FLUID_HELP = "sea (1025), fresh (1000), air (0) or a density (kg/m^3)."
Fluid = Annotated[str, Option(help=FLUID_HELP)]
Gravity = Annotated[str, Option(help="In base_link, three numbers (m/s^2); tilts the mount.")]
Current = Annotated[
    str | None,
    Option(
        help="Velocity of the water in base_link, three numbers (m/s): adds drag and added mass, which are "
        "estimated, not published."
    ),
]
Constants = Annotated[
    str,
    Option(
        help="Table 4's K_t and K_v of one motor should agree and do not (`alpha5 trajectory` shows their "
        "ratios). printed: K_t for torque, K_v for voltage, powers do not balance; torque: K_t for "
        "both; voltage: K_v for both."
    ),
]
#: Larger than any fluid or vehicle has: a typing error.
_MOST_DENSITY = 1e5
_MOST_GRAVITY = 1e4
_MOST_CURRENT = 100.0
_FLUIDS = {"sea": SEA_WATER, "fresh": FRESH_WATER, "air": AIR}


def fluid_density(text: str) -> float:
    """``sea``, ``fresh``, ``air`` or a number [kg/m^3].

    Raises:
        InputError: Anything else.
    """
    if text in _FLUIDS:
        return _FLUIDS[text]
    (density,) = numbers("fluid", text, f"{', '.join(_FLUIDS)} or a density [kg/m^3]", 1)
    if density > _MOST_DENSITY:
        raise InputError("fluid", text, f"at most {_MOST_DENSITY:g} kg/m^3")
    return real("fluid", density, minimum=0.0)


def correction_names(text: str | None) -> tuple[str, ...]:
    """Names of corrections, not checked; the default ones for None."""
    return DEFAULT_CORRECTIONS if text is None else names(text)


def names(text: str) -> tuple[str, ...]:
    """The parts between commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def gravity_vector(text: str) -> tuple[float, float, float]:
    """Three numbers [m/s^2].

    Raises:
        InputError: Anything else, or more than any vehicle or planet gives.
    """
    return _limited("gravity", text, _MOST_GRAVITY, "m/s^2")


def current_vector(text: str | None) -> tuple[float, float, float] | None:
    """Three numbers [m/s]; None for none.

    Raises:
        InputError: Anything else, or more than any water has.
    """
    return None if text is None else _limited("current", text, _MOST_CURRENT, "m/s")


def _limited(name: str, text: str, most: float, unit: str) -> tuple[float, float, float]:
    vector = triple(name, text)
    if any(abs(x) > most for x in vector):
        raise InputError(name, text, f"at most {most:g} {unit} along each axis")
    return vector


def triple(name: str, text: str) -> tuple[float, float, float]:
    """Three numbers in one text; see `numbers`."""
    x, y, z = numbers(name, text, "three numbers, such as '0.2 0 -0.1'", 3)
    return x, y, z


def numbers(name: str, text: str, expected: str, count: int | None = None) -> list[float]:
    """Numbers in one text, separated by spaces or commas; any number of them without a count.

    Raises:
        InputError: Anything else.
    """
    with suppress(ValueError):
        values = [float(part) for part in text.replace(",", " ").split()]
        if count in (None, len(values)):
            return values
    raise InputError(name, text, expected)


def arm_in(fluid: str, gravity: str = "0 0 -9.81", gripper: str = "locked") -> Arm:
    """The arm, from the text of the options."""
    from alpha5_model.dynamics import load

    return load(fluid_density(fluid), gripper, gravity=gravity_vector(gravity))


def show(as_json: bool, record: Any, text: Lines, *written: Path | None) -> None:
    """Print a result for scripts or for people.

    Args:
        as_json: Print the record, and nothing else.
        record: The result in types that JSON has.
        text: The same to read; strings are printed as they are.
        written: Files of this result, each named in a line of its own; None is skipped.
    """
    with messages_beside(*written):
        if as_json:
            echo(json.dumps(record, indent=2, allow_nan=False))
            return
        for part in text:
            if isinstance(part, str):
                echo(part)
            else:
                from rich.console import Console

                Console(highlight=False).print(part)
        print_written(*written)


def print_written(*written: Path | None) -> None:
    """One line for each file that was asked for."""
    for path in written:
        if path is not None:
            echo(f"wrote {path}")


def messages_beside(*written: Path | None) -> AbstractContextManager[object]:
    """Messages go to standard error where a file goes to standard output."""
    taken = any(path is not None and is_stdout(path) for path in written)
    return redirect_stdout(sys.stderr) if taken else nullcontext()


def spinner(words: str) -> AbstractContextManager[object]:
    """A spinner on stderr, on a terminal only."""
    from rich.console import Console

    console = Console(stderr=True)
    return console.status(words) if console.is_terminal else nullcontext()
