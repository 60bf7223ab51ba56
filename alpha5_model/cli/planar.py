"""``alpha5 planar``: the lecture notes' planar arms."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from alpha5_model._support.outputs import check_outputs
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import ANGLE_OR_LENGTH, SIZE, Scalar, Vector
from alpha5_model.errors import InputError
from alpha5_model.theory import planar as library
from alpha5_model.viewer import figures
from alpha5_model.viewer.planar_plot import plot_planar, save

_ANSWER = {True: "yes", False: "no", None: "for 3R only"}


HELP = """
The theorem is that of the lecture notes "Describing Robot Arms". It is
sufficient for a full turn of the last link, not necessary.

Example: alpha5 planar 5 4 1 --radius 3 --plot arm.png
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "lengths",
        type=Vector(SIZE, counts=None),
        metavar="LENGTHS",
        help="link lengths, base to tip (m)",
    )
    parser.add_argument(
        "--joints", help="R (turns) or P (slides) for each link. Default: all R"
    )
    parser.add_argument(
        "-l",
        "--limits",
        action="append",
        type=Vector(
            ANGLE_OR_LENGTH,
            ANGLE_OR_LENGTH,
            named=["none"],
            expected="LOWER UPPER or none",
        ),
        metavar="LIMITS",
        help="'LOWER UPPER' (rad or m) or none, once per joint in order",
    )
    parser.add_argument(
        "--radius",
        type=Scalar(SIZE),
        help="distance of the tip from the base (m), l_4 of the lecture notes: can the "
        "last link turn fully there?",
    )
    common.plot(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    check_outputs((), plot=(given.plot, figures.FORMATS))
    if given.radius is not None and given.radius < 0:
        raise InputError("--radius", given.radius, "a distance of at least 0")
    limits = given.limits and [
        None if limits == "none" else tuple(limits) for limits in given.limits
    ]
    arm = library.PlanarArm(given.lengths, limits, given.joints)

    record = _record(arm, given.radius)
    if given.plot is not None:
        save(plot_planar(arm), given.plot)
    printing.show(given.json, record, _text(record), given.plot)


def _record(arm: library.PlanarArm, radius: float | None) -> dict[str, Any]:
    space = arm.workspace()
    needed = library.necessary_conditions(arm)
    exact = arm.length_ranges is not None
    if radius is not None and not exact:
        expected = "an arm without limits on its revolute joints"
        raise InputError("--radius", radius, expected)

    return {
        "joints": arm.joints,
        "lengths": arm.lengths,
        "workspace": {"shape": space.shape, "radii": space.radii, "area": space.area},
        "necessary_conditions": {
            "satisfied": needed.satisfied,
            "missing": needed.reasons,
        },
        "dexterous_workspace": _dexterous_workspace(arm),
        "theorem": _theorem(arm) if exact else None,
        "at_radius": None if radius is None else _at_radius(arm, radius),
    }


def _dexterous_workspace(arm: library.PlanarArm) -> dict[str, Any] | None:
    """Exact without limits; else by enumeration, if the last of three joints turns."""
    if arm.length_ranges is not None:
        return {
            "radii": library.dexterous_radii(arm),
            "area": library.dexterous_area(arm),
            "resolution": None,
        }
    if arm.n == 3 and arm.joints[-1] == "R":
        found = library.dexterity_map(arm)
        return {
            "radii": None,
            "area": found.area,
            "resolution": {
                "spacing": found.spacing,
                "orientations": found.orientations,
            },
        }
    return None


def _theorem(arm: library.PlanarArm) -> dict[str, Any] | None:
    """The radii l_4 for which the notes' theorem holds, if all three joints turn."""
    if arm.joints != "RRR":
        return None
    return {"l_4": library.theorem_radii(*arm.lengths)}


def _at_radius(arm: library.PlanarArm, radius: float) -> dict[str, Any]:
    holds = None
    if arm.joints == "RRR":
        l_1, l_2, l_3 = arm.lengths
        holds = library.lecture_theorem(l_1, l_2, l_3, radius)
    exact = library.turns_fully(arm, radius)
    return {"radius": radius, "theorem": holds, "exact": exact}


def _text(record: dict[str, Any]) -> printing.Lines:
    space = record["workspace"]
    low, high = space["radii"]
    area = f", area {space['area']:.6g} m^2" if space["area"] else ""
    span = f"{low:.6g} to {high:.6g} m from the base"
    yield f"workspace            {space['shape']}, {span}{area}"
    yield f"dexterous workspace  {_dexterous_text(record['dexterous_workspace'])}"
    missing = record["necessary_conditions"]["missing"]
    yield f"necessary conditions {'; '.join(missing) or 'satisfied'}"

    theorem = record["theorem"]
    if theorem:
        radii = theorem["l_4"]
        span = "{:.6g} to {:.6g} m".format(*radii) if radii else "no l_4"
        yield f"the notes' theorem   holds for {span} (sufficient, not necessary)"
    at = record["at_radius"]
    if at:
        turns = _ANSWER[at["exact"]]
        holds = _ANSWER[at["theorem"]]
        yield f"at {at['radius']:.6g} m: turns fully: {turns}; theorem: {holds}"


def _dexterous_text(dexterous: dict[str, Any] | None) -> str:
    if dexterous is None:
        return (
            "not computed for this arm; planar.dexterity_map takes three joints or "
            "more, the last R"
        )
    grid = dexterous["resolution"]
    if grid:
        return (
            f"about {dexterous['area']:.4g} m^2, by enumeration every "
            f"{grid['spacing']:.3g} m and with {grid['orientations']} orientations"
        )
    if not dexterous["radii"]:
        return "empty"
    spans = [_span(low, high) for low, high in dexterous["radii"]]
    return f"{' and '.join(spans)} m from the base, area {dexterous['area']:.6g} m^2"


def _span(low: float, high: float) -> str:
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
