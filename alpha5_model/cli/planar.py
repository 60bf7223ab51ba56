"""``alpha5 planar``: workspace and dexterous workspace of a planar arm."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from alpha5_model import planar as library
from alpha5_model.cli.options import Lines, numbers, show
from alpha5_model.errors import InputError
from alpha5_model.files import check_outputs
from alpha5_model.view.figures import FORMATS
from alpha5_model.view.planar_plot import plot_planar, save


def planar(
    lengths: Annotated[list[float], Argument(help="Link lengths, base to tip (m).")],
    joints: Annotated[
        str | None, Option(help="R (turns) or P (slides along its link) per link; all R.")
    ] = None,
    limits: Annotated[
        list[str] | None,
        Option("--limits", "-l", help="'LOWER UPPER' (rad or m) or none, once per joint in order."),
    ] = None,
    radius: Annotated[
        float | None, Option(help="Distance of the pinned tip from the base, l_4 (m).")
    ] = None,
    plot: Annotated[Path | None, Option(help="Picture: .png, .pdf or .svg.")] = None,
    as_json: Annotated[bool, Option("--json", help="Print JSON.")] = False,
) -> None:
    """Workspace, dexterous workspace and the lecture notes' theorem for a planar arm.

    Example: alpha5 planar 5 4 1 --radius 3 --plot arm.png
    """
    check_outputs((), plot=(plot, FORMATS))
    ranges = None if limits is None else [_range(text) for text in limits]
    arm = library.PlanarArm(lengths, ranges, joints)
    result = _result(arm, radius)
    if plot is not None:
        save(plot_planar(arm), plot)
    show(as_json, result, _text(result), plot)


def _result(arm: library.PlanarArm, radius: float | None) -> dict[str, Any]:
    space, needed = arm.workspace(), library.necessary_conditions(arm)
    dexterous: dict[str, Any] | None = None
    theorem = at_radius = None
    if arm.length_ranges is not None:
        radii, area = library.dexterous_radii(arm), library.dexterous_area(arm)
        dexterous = {"radii": radii, "area": area, "resolution": None}
        three = arm.joints == "RRR"
        if three:
            theorem = {"l_4": library.theorem_radii(*arm.lengths)}
        if radius is not None:
            holds = library.lecture_theorem(*(*arm.lengths, radius)) if three else None
            exact = library.turns_fully(arm, radius)
            at_radius = {"radius": radius, "theorem": holds, "exact": exact}
    elif radius is not None:
        raise InputError("--radius", radius, "an arm without limits on its revolute joints")
    elif arm.n == 3 and arm.joints[-1] == "R":
        found = library.dexterity_map(arm)
        grid = {"spacing": found.spacing, "orientations": found.orientations}
        dexterous = {"radii": None, "area": found.area, "resolution": grid}
    return {
        "joints": arm.joints,
        "lengths": arm.lengths,
        "workspace": {"shape": space.shape, "radii": space.radii, "area": space.area},
        "necessary_conditions": {"satisfied": needed.satisfied, "missing": needed.reasons},
        "dexterous_workspace": dexterous,
        "theorem": theorem,
        "at_radius": at_radius,
    }


def _text(result: dict[str, Any]) -> Lines:
    space, dexterous = result["workspace"], result["dexterous_workspace"]
    low, high = space["radii"]
    area = f", area {space['area']:.6g} m^2" if space["area"] else ""
    yield f"workspace            {space['shape']}, {low:.6g} to {high:.6g} m from the base{area}"
    if dexterous is None:
        text = (
            "not computed for this arm; planar.dexterity_map takes three joints or more, the last R"
        )
    elif grid := dexterous["resolution"]:
        text = (
            f"about {dexterous['area']:.4g} m^2, by enumeration every {grid['spacing']:.3g} m and "
            f"with {grid['orientations']} orientations"
        )
    elif not dexterous["radii"]:
        text = "empty"
    else:
        spans = [f"{a:.6g}" if a == b else f"{a:.6g} to {b:.6g}" for a, b in dexterous["radii"]]
        text = f"{' and '.join(spans)} m from the base, area {dexterous['area']:.6g} m^2"
    yield f"dexterous workspace  {text}"
    missing = result["necessary_conditions"]["missing"]
    yield f"necessary conditions {'; '.join(missing) or 'satisfied'}"
    if theorem := result["theorem"]:
        span = "{:.6g} to {:.6g} m".format(*theorem["l_4"]) if theorem["l_4"] else "no l_4"
        yield f"the notes' theorem   holds for {span} (sufficient, not necessary)"
    if at := result["at_radius"]:
        words = {True: "yes", False: "no", None: "for 3R only"}
        turns, holds = words[at["exact"]], words[at["theorem"]]
        yield f"at {at['radius']:.6g} m: turns fully: {turns}; theorem: {holds}"


def _range(text: str) -> tuple[float, float] | None:
    if text.strip().lower() == "none":
        return None
    lower, upper = numbers("--limits", text, "'LOWER UPPER' or none", 2)
    return lower, upper
