"""``alpha5 planar``: workspace and dexterous workspace of a planar arm."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from alpha5_model.cli.options import numbers, print_json, words_beside
from alpha5_model.errors import InputError
from alpha5_model.files import check_outputs
from alpha5_model.planar import (
    PlanarArm,
    dexterity_map,
    dexterous_area,
    dexterous_radii,
    lecture_theorem,
    necessary_conditions,
    theorem_radii,
    turns_fully,
)
from alpha5_model.view.figures import FORMATS
from alpha5_model.view.planar_plot import plot_planar, save


def planar(
    lengths: Annotated[list[float], typer.Argument(help="Link lengths, base to tip (m).")],
    joints: Annotated[
        str | None, typer.Option(help="R (turns) or P (slides along its link) per link; all R.")
    ] = None,
    limits: Annotated[
        list[str] | None,
        typer.Option(
            "--limits", "-l", help="'LOWER UPPER' (rad or m) or none, once per joint in order."
        ),
    ] = None,
    radius: Annotated[
        float | None, typer.Option(help="Distance of the pinned tip from the base, l_4 (m).")
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Picture: .png, .pdf or .svg.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Workspace, dexterous workspace and the lecture notes' theorem for a planar arm.

    Example: alpha5 planar 5 4 1 --radius 3 --plot arm.png
    """
    check_outputs((), plot=(plot, FORMATS))
    ranges = None if limits is None else [_range(text) for text in limits]
    arm = PlanarArm(lengths, ranges, joints)
    result = _results(arm, radius)
    if plot is not None:
        save(plot_planar(arm), plot)
    with words_beside(plot):
        if as_json:
            print_json(result)
        else:
            typer.echo("\n".join(_lines(result)))


def _results(arm: PlanarArm, radius: float | None) -> dict[str, Any]:
    space = arm.workspace()
    conditions = necessary_conditions(arm)
    missing = list(conditions.reasons)
    result: dict[str, Any] = {
        "joints": arm.joints,
        "lengths": list(arm.lengths),
        "workspace": {"shape": space.shape, "radii": list(space.radii), "area": space.area},
        "necessary_conditions": {"satisfied": conditions.satisfied, "missing": missing},
        **dict.fromkeys(("dexterous_workspace", "theorem", "at_radius")),
    }
    if arm.length_ranges is not None:
        radii = [list(interval) for interval in dexterous_radii(arm)]
        area = dexterous_area(arm)
        result["dexterous_workspace"] = {"radii": radii, "area": area, "resolution": None}
        three = arm.joints == "RRR"
        if three:
            l_1, l_2, l_3 = arm.lengths
            interval = theorem_radii(l_1, l_2, l_3)
            result["theorem"] = {"l_4": None if interval is None else list(interval)}
        if radius is not None:
            theorem = lecture_theorem(l_1, l_2, l_3, radius) if three else None
            exact = turns_fully(arm, radius)
            result["at_radius"] = {"radius": radius, "theorem": theorem, "exact": exact}
    elif radius is not None:
        raise InputError("--radius", radius, "an arm without limits on its revolute joints")
    elif arm.n == 3 and arm.joints[-1] == "R":
        found = dexterity_map(arm)
        resolution = {"spacing": found.spacing, "orientations": found.orientations}
        dexterous = {"radii": None, "area": found.area, "resolution": resolution}
        result["dexterous_workspace"] = dexterous
    return result


def _lines(result: dict[str, Any]) -> list[str]:
    space, dexterous = result["workspace"], result["dexterous_workspace"]
    low, high = space["radii"]
    area = f", area {space['area']:.6g} m^2" if space["area"] else ""
    whole = f"{space['shape']}, {low:.6g} to {high:.6g} m from the base{area}"
    if dexterous is None:
        text = (
            "not computed for this arm; planar.dexterity_map takes three joints or more, the last R"
        )
    elif dexterous["resolution"] is not None:
        grid = dexterous["resolution"]
        text = (
            f"about {dexterous['area']:.4g} m^2, by enumeration every {grid['spacing']:.3g} m and "
            f"with {grid['orientations']} orientations"
        )
    elif not dexterous["radii"]:
        text = "empty"
    else:
        spans = [f"{a:.6g}" if a == b else f"{a:.6g} to {b:.6g}" for a, b in dexterous["radii"]]
        text = f"{' and '.join(spans)} m from the base, area {dexterous['area']:.6g} m^2"
    missing = result["necessary_conditions"]["missing"]
    lines = [
        f"workspace            {whole}",
        f"dexterous workspace  {text}",
        f"necessary conditions {'; '.join(missing) or 'satisfied'}",
    ]
    if result["theorem"] is not None:
        interval = result["theorem"]["l_4"]
        text = f"{interval[0]:.6g} to {interval[1]:.6g} m" if interval else "no l_4"
        lines.append(f"the notes' theorem   holds for {text} (sufficient, not necessary)")
    at = result["at_radius"]
    if at is not None:
        words = {True: "yes", False: "no", None: "for 3R only"}
        lines.append(
            f"at {at['radius']:.6g} m: turns fully: {words[at['exact']]}; "
            f"theorem: {words[at['theorem']]}"
        )
    return lines


def _range(text: str) -> tuple[float, float] | None:
    if text.strip().lower() == "none":
        return None
    lower, upper = numbers("--limits", text, "'LOWER UPPER' or none", 2)
    return lower, upper
