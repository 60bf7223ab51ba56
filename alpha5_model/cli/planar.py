"""``alpha5 planar``: the lecture notes' planar arms."""

from __future__ import annotations

from typing import Annotated, Any

from typer import Argument, Option

from alpha5_model._support.outputs import check_outputs
from alpha5_model.cli import options, printing, values
from alpha5_model.cli.words import WORDS
from alpha5_model.errors import InputError
from alpha5_model.theory import planar as library
from alpha5_model.viewer import figures
from alpha5_model.viewer.planar_plot import plot_planar, save

_ANSWER = {True: "yes", False: "no", None: "for 3R only"}


def planar(
    lengths: Annotated[list[float], Argument(help="Link lengths, base to tip (m).")],
    joints: Annotated[
        str | None,
        Option(help="R (turns) or P (slides) for each link. Default: all R."),
    ] = None,
    limits: Annotated[
        list[str] | None, Option("--limits", "-l", help=options.HELP["limits"])
    ] = None,
    radius: Annotated[float | None, Option(help=options.HELP["radius"])] = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> None:
    """Workspace and dexterous workspace of a planar arm, and the notes' theorem.

    The theorem is that of the lecture notes "Describing Robot Arms". It is
    sufficient for a full turn of the last link, not necessary.

    Example: alpha5 planar 5 4 1 --radius 3 --plot arm.png
    """
    check_outputs((), plot=(plot, figures.FORMATS))
    ranges = None if limits is None else [_range(text) for text in limits]
    arm = library.PlanarArm(lengths, ranges, joints)

    record = _record(arm, radius)
    if plot is not None:
        save(plot_planar(arm), plot)
    printing.show(as_json, record, _text(record), plot)


def _range(text: str) -> tuple[float, float] | None:
    if text.strip().lower() == "none":
        return None
    expected = "'LOWER UPPER' or none"
    lower, upper = values.numbers("--limits", text, (2,), "rad or m", expected)
    return lower, upper


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
    words = WORDS["planar"]
    if dexterous is None:
        return str(words["unknown"])
    if dexterous["resolution"]:
        enumerated: str = words["enumerated"]
        return enumerated.format(area=dexterous["area"], **dexterous["resolution"])
    if not dexterous["radii"]:
        return "empty"
    spans = [_span(low, high) for low, high in dexterous["radii"]]
    return f"{' and '.join(spans)} m from the base, area {dexterous['area']:.6g} m^2"


def _span(low: float, high: float) -> str:
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
