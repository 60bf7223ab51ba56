"""Options that several commands share, and how their text is read."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager, nullcontext, redirect_stdout
from pathlib import Path

from alpha5_model.corrections import DEFAULT_CORRECTIONS
from alpha5_model.errors import InputError
from alpha5_model.files import is_stdout

# Units stand in round brackets: the terminal takes [m] for a style.
#: Beyond any fluid and any ride: a slip of the hand, whose digits would fill the page.
_MOST_DENSITY = 1e5
_MOST_GRAVITY = 1e4
FLUID_HELP = "sea (1025), fresh (1000), air (0) or a density (kg/m^3)."
GRAVITY_HELP = "In base_link, three numbers (m/s^2); tilts the mount."


def fluid_density(text: str) -> float:
    """``sea``, ``fresh``, ``air`` or a number [kg/m^3].

    Raises:
        InputError: Anything else.
    """
    from alpha5_model.checks import real
    from alpha5_model.fluids import AIR, FRESH_WATER, SEA_WATER

    named = {"sea": SEA_WATER, "fresh": FRESH_WATER, "air": AIR}
    if text in named:
        return named[text]
    try:
        density = float(text)
    except ValueError:
        raise InputError("fluid", text, f"{', '.join(named)} or a density [kg/m^3]") from None
    if density > _MOST_DENSITY:
        raise InputError("fluid", text, f"at most {_MOST_DENSITY:g} kg/m^3")
    return real("fluid", density, minimum=0.0)


def correction_names(text: str | None) -> tuple[str, ...]:
    """Names between commas, the default ones for None; whoever takes them says which do not exist."""
    if text is None:
        return DEFAULT_CORRECTIONS
    return tuple(name.strip() for name in text.split(",") if name.strip())


def gravity_vector(text: str) -> tuple[float, float, float]:
    """Three numbers [m/s^2].

    Raises:
        InputError: Anything else, or more than any vehicle or planet gives.
    """
    vector = triple("gravity", text)
    if any(abs(x) > _MOST_GRAVITY for x in vector):
        raise InputError("gravity", text, f"at most {_MOST_GRAVITY:g} m/s^2 along each axis")
    return vector


def triple(name: str, text: str) -> tuple[float, float, float]:
    """Three numbers in one text, separated by spaces or commas.

    Raises:
        InputError: Anything else.
    """
    try:
        x, y, z = (float(part) for part in text.replace(",", " ").split())
    except ValueError:
        raise InputError(name, text, "three numbers, such as '0.2 0 -0.1'") from None
    return x, y, z


def words_beside(*written: Path | None) -> AbstractContextManager[object]:
    """Where a file goes to standard output, what is said goes to standard error."""
    taken = any(path is not None and is_stdout(path) for path in written)
    return redirect_stdout(sys.stderr) if taken else nullcontext()


def spinner(words: str) -> AbstractContextManager[object]:
    """A spinner on a terminal's stderr; nothing where nobody looks."""
    from rich.console import Console

    console = Console(stderr=True)
    return console.status(words) if console.is_terminal else nullcontext()
