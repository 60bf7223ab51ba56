"""Options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Option

from alpha5_model.cli.words import WORDS

HELP: dict[str, str] = WORDS["help"]
# Units stand in round brackets: the terminal takes [m] for a style.
FLUID = "sea (1025), fresh (1000), air (0) or a density (kg/m^3)."
DOWN = "0 0 -9.81"

Arm = Annotated[Path | None, Option("--arm", help=HELP["arm"])]
Fluid = Annotated[str, Option(help=FLUID)]
Gravity = Annotated[
    str, Option(help="Gravity in base_link (m/s^2); with --mount, in the world.")
]
Gripper = Annotated[
    str, Option(help="locked (4 joints) or jaws (adds the jaw rod axis_a).")
]
Mount = Annotated[str | None, Option(help=HELP["mount"])]
Payload = Annotated[str | None, Option(help=HELP["payload"])]
Current = Annotated[str | None, Option(help=HELP["current"])]
Constants = Annotated[str | None, Option(help=HELP["constants"])]
Efficiency = Annotated[str, Option(help=HELP["efficiency"])]
Plot = Annotated[Path | None, Option(help="Write a picture: .png, .pdf or .svg.")]
Json = Annotated[bool, Option("--json", help="Print everything as JSON, in SI units.")]
