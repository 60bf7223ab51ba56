"""``alpha5 jaws``: opening, gap between the blades, what fits, and grip force."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.text import table
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import CURRENT, LENGTH, NUMBER, Scalar, Vector
from alpha5_model.errors import InputError, MissingParameterError

if TYPE_CHECKING:
    from alpha5_model.dynamics.jaw_tool import JawTool

#: Places between throat and ends of the blades that are printed.
_PLACES = 9
#: Places between tcp and ends among which the narrowest is looked for.
_SAMPLES = 200
#: The last place is so far before the ends, for rounding [m].
_INSIDE = 1e-9

HELP = """
Widths are across the wrist axis, in x of link_4; --at is the distance of a
place beyond the tcp, towards the tips. The curve of the blades is a drawing:
a real gap may be larger by up to 6 mm. Force needs the lead of the rod's
screw, which is not published; its interval covers what the documents leave
open.

Example: alpha5 jaws --opening 40mm --motor-current 0.05 --screw-lead 1mm
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "--rod",
        type=Scalar(LENGTH),
        help="position of axis_a (m), within its limits. Default: open",
    )
    parser.add_argument(
        "--opening",
        type=Scalar(LENGTH),
        help="distance between the tips (m), in place of --rod",
    )
    parser.add_argument(
        "--at",
        type=Scalar(LENGTH),
        help="place of the object, beyond the tcp (m). Default: 0, if between the "
        "blades",
    )
    parser.add_argument(
        "--motor-current",
        type=Scalar(CURRENT),
        help="current that closes the jaws, in A, for the force",
    )
    parser.add_argument(
        "--screw-lead",
        type=Scalar(LENGTH),
        help="lead of the rod's screw (m per turn)",
    )
    parser.add_argument(
        "--screw-efficiency",
        type=Vector(NUMBER, NUMBER),
        metavar="LEAST GREATEST",
        help="share of the screw's work that reaches the rod. Default: 0.2 1",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    from alpha5_model.dynamics.jaw_tool import jaws

    tool = jaws(common.record_of(given))
    if given.rod is not None and given.opening is not None:
        raise InputError("opening", given.opening, "no value beside --rod")
    rod = tool.open if given.rod is None else given.rod
    if given.opening is not None:
        rod = float(tool.rod(given.opening))

    end = tool.end(rod) - _INSIDE
    tcp = min(max(0.0, tool.throat), end)
    at = tcp if given.at is None else given.at
    places = np.linspace(tool.throat, end, _PLACES)
    to_tips = np.linspace(tcp, end, _SAMPLES)
    gaps = tool.gap(rod, to_tips)
    least = int(gaps.argmin())
    record: dict[str, Any] = {
        "rod_m": rod,
        "rod_limits_m": [tool.closed, tool.open],
        "opening_m": tool.opening(rod),
        "greatest_opening_m": tool.opening(tool.open),
        "places_m": places,
        "gap_m": tool.gap(rod, places),
        "narrowest_at_m": to_tips[least],
        "narrowest_gap_m": gaps[least],
        "at_m": at,
        "widest_m": tool.widest(rod, at),
        "force": _force(tool, given, rod, at),
    }
    printing.show(given.json, record, _text(record))


def _force(
    tool: JawTool, given: Namespace, rod: float, at: float
) -> dict[str, Any] | None:
    """The interval of the force at a place; None if no current is given.

    Raises:
        MissingParameterError: A current without a lead.
        InputError: A lead without a current.
    """
    if given.motor_current is None:
        for name in ("screw_lead", "screw_efficiency"):
            if getattr(given, name) is not None:
                expected = "no value without --motor-current"
                raise InputError(name, getattr(given, name), expected)
        return None
    if given.screw_lead is None:
        raise MissingParameterError("--screw-lead", "the force of the jaws")
    more = {}
    if given.screw_efficiency is not None:
        more["screw_efficiency"] = given.screw_efficiency
    force = tool.force(given.motor_current, given.screw_lead, at, rod=rod, **more)
    return {"current_A": given.motor_current, "lower_N": force[0], "upper_N": force[1]}


def _text(record: dict[str, Any]) -> printing.Lines:
    closed, opened = record["rod_limits_m"]
    yield (
        f"rod (axis_a): {1e3 * record['rod_m']:.2f} mm, closed at {1e3 * closed:g}, "
        f"open at {1e3 * opened:g} mm"
    )
    yield (
        f"between the tips: {1e3 * record['opening_m']:.1f} mm, "
        f"at most {1e3 * record['greatest_opening_m']:.1f} mm"
    )

    yield "\nclear gap between the blades (mm)"
    rows = [["", "beyond the tcp", "gap"]]
    names = ["throat", *[""] * (_PLACES - 2), "end"]
    for name, place, gap in zip(
        names, record["places_m"], record["gap_m"], strict=True
    ):
        rows.append([name, f"{1e3 * place:.1f}", f"{1e3 * gap:.1f}"])
    yield from table(rows, "<>>")
    yield (
        f"narrowest from the tcp on: {1e3 * record['narrowest_gap_m']:.1f} mm, "
        f"{1e3 * record['narrowest_at_m']:.1f} mm beyond the tcp"
    )

    yield (
        f"\nwidest round object {1e3 * record['at_m']:g} mm beyond the tcp: "
        f"{1e3 * record['widest_m']:.1f} mm"
    )
    force = record["force"]
    if force is not None:
        yield (
            f"grip force there at {force['current_A']:g} A: "
            f"{force['lower_N']:.3g} to {force['upper_N']:.3g} N"
        )
