"""``alpha5 workspace``, ``dh`` and ``planar``: what arms reach, and how they are described."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from alpha5_model._support.files import check_outputs
from alpha5_model._support.text import table
from alpha5_model.cli import options
from alpha5_model.cli.options import HELP
from alpha5_model.dynamics.collision import without_self_collision
from alpha5_model.errors import InputError
from alpha5_model.kinematics import workspace as space
from alpha5_model.studies.uncertainty.effects import reach, sensitivity
from alpha5_model.theory import planar as library
from alpha5_model.theory.dh import arm_types
from alpha5_model.theory.dh.chain import DHChain, DHLink
from alpha5_model.viewer import figures
from alpha5_model.viewer import workspace_plot as draw

_LINK = "'THETA D A ALPHA SIGMA'"


def workspace(
    plot: options.Plot = None,
    self_collision: Annotated[
        bool, Option("--self-collision", help=HELP["touching"])
    ] = False,
    samples: Annotated[
        int, Option(help="Points that --self-collision tries.")
    ] = 20_000,
    as_json: options.Json = False,
) -> None:
    """The exact workspace, and how much of the published one is wrong.

    Example: alpha5 workspace --self-collision --plot collision.pdf
    """
    check_outputs((), plot=(plot, figures.FORMATS))
    share = None
    if self_collision:
        with options.spinner("trying points for self-collision"):
            share = space.sampled_share(without_self_collision, samples)
    if plot is not None:
        with options.spinner("drawing"):
            page = (
                draw.self_collision_figure(samples=samples)
                if share
                else draw.workspace_figure()
            )
            figures.write_figure(page, plot, dpi=150)
    farthest = sensitivity(reach)
    record: dict[str, Any] = {} if share is None else {"without_self_collision": share}
    record["errors_of_the_published_region"] = space.published_errors()
    record["cross_section_area"] = {
        side: space.cross_section_area(side) for side in space.SIDES
    }
    record["reach"] = {"value": farthest.nominal, "digits": farthest.half_width}
    record["volume"], record["volume_without_limits"] = (
        space.volume(),
        space.volume(limits=False),
    )
    record["boundary"] = {side: space.boundary(side) for side in space.SIDES}
    record["published_tori"] = space.published_tori()
    record["singular_theta_2"] = space.singular_elbow_angles()
    options.show(as_json, record, _regions(record), plot)


def _regions(record: dict[str, Any]) -> options.Lines:
    e, share = (
        record["errors_of_the_published_region"],
        record.get("without_self_collision"),
    )
    words = options.WORDS["workspace"]
    rows = [["region", "half-plane", "volume"], ["", "cm²", "L"]]
    for part, name in words["regions"].items():
        area, volume = vars(e)[f"{part}_area"], vars(e)[f"{part}_volume"]
        rows.append([name, f"{area * 1e4:.2f}", f"{volume * 1e3:.3f}"])
    yield from table(rows)
    area, volume = (
        e.unreachable_area / e.published_area,
        e.unreachable_volume / e.published_volume,
    )
    yield words["outside"].format(area=area, volume=volume)
    value, half = (1e3 * x for x in record["reach"].values())
    yield f"The tcp gets {value:.1f} mm ±{half:.1f} from the shoulder, by the digits of Table 1."
    yield "\nboundary where both poses can turn; R from the axis of axis_e, z above base_link"
    rows = [["pose", "bounded by", "centre R, z", "radius", "from R, z", "to R, z"]]
    rows.append(["", "", "mm", "mm", "mm", "mm"])
    for arc in space.boundary():
        points = [arc.center, *arc.points([arc.start, arc.end])]
        center, start, end = (f"{1e3 * r:z.1f}, {1e3 * z:z.1f}" for r, z in points)
        cause = arc.cause.replace("at its ", "").replace(" limit", "")
        rows.append([arc.side, cause, center, f"{arc.radius * 1e3:.1f}", start, end])
    yield from table(rows, "<<>")
    if share is not None:
        hit, error, litres = 1 - share.share, share.standard_error, 1e3 * share.total
        volumes = {"free": share.share * litres, "litres": hit * litres}
        volumes["error_litres"] = error * litres
        yield words["collision"].format(
            share=hit, error=error, samples=share.samples, **volumes
        )


def dh(
    q: Annotated[
        list[str] | None, Argument(help=HELP["position"], metavar="[Q]...")
    ] = None,
    link: Annotated[list[str] | None, Option("--link", help=HELP["link"])] = None,
    urdf: Annotated[
        Path | None, Option(help="Assign the frames to the arm of this URDF.")
    ] = None,
    frame: Annotated[str | None, Option(help="End effector in the URDF.")] = None,
    as_json: options.Json = False,
) -> None:
    """Standard Denavit-Hartenberg table and frames: of the Alpha 5, or of any serial arm.

    Example: alpha5 dh 0.5 1.2 1 0
    Example: alpha5 dh --link '0 0.1 0.2 1.5708 0' --link '0 0 0.3 0 0' -0.4 0.2
    """
    chain = _chain(link, urdf, frame)
    each = f"one number for each of {', '.join(chain.joint_names)}"
    position = (
        options.numbers("q", " ".join(q), (chain.n,), "rad or m", each)
        if q
        else chain.home
    )
    kind, task = arm_types.classify(chain), arm_types.task_capability(chain)
    names = [*(f"{{{j}}}" for j in range(chain.n + 1)), "tool"]
    links = [
        {"joint": n, **vars(k)}
        for n, k in zip(chain.joint_names, chain.links, strict=True)
    ]
    record: dict[str, Any] = {"name": chain.name, "links": links}
    record |= {
        "base": chain.base,
        "tool": chain.tool,
        "type": kind,
        "tasks": task,
        "q": position,
    }
    record["frames"] = dict(zip(names, chain.frames(position), strict=True))
    options.show(as_json, record, _frames(chain, record))


def _chain(link: list[str] | None, urdf: Path | None, frame: str | None) -> DHChain:
    if link and urdf is not None:
        raise InputError("--link, --urdf", (link, str(urdf)), "one of the two")
    if frame is not None and urdf is None:
        raise InputError("--frame", frame, "--urdf with it")
    if urdf is not None:
        return DHChain.from_urdf(urdf, frame)
    rows = (
        options.numbers("--link", text, (), "rad or m", _LINK) for text in link or ()
    )
    return DHChain(tuple(map(DHLink.from_vector, rows))) if link else DHChain.alpha5()


def _frames(chain: DHChain, record: dict[str, Any]) -> options.Lines:
    rows = [
        [
            "joint",
            "theta (rad)",
            "d (m)",
            "a (m)",
            "alpha (rad)",
            "sigma",
            "lower",
            "upper",
        ]
    ]
    for name, row in zip(chain.joint_names, chain.links, strict=True):
        cells = [
            *(f"{x:.6f}" for x in (row.theta, row.d, row.a, row.alpha)),
            str(row.sigma),
        ]
        cells[0 if row.revolute else 1] = f"q{row.offset:+.6f}" if row.offset else "q"
        rows.append([name, *cells, f"{row.lower:.5g}", f"{row.upper:.5g}"])
    yield from table(rows)
    kind, task, answer = record["type"], record["tasks"], {True: "yes", False: "no"}
    yield f"\n{kind.joints}, type {kind.kind}: {kind.reason}"
    yield f"general tasks: {answer[task.general]}, {task.general_reason}"
    yield f"vertical insertion: {answer[task.vertical_insertion]}, {task.insertion_reason}"
    at = ", ".join(f"{x:.6g}" for x in record["q"])
    yield f"\nframes at q = ({at}): axes x, y, z and origin (m)"
    yield from table(
        ["" if i else name, *(f"{x:z.6f}" for x in row)]
        for name, matrix in record["frames"].items()
        for i, row in enumerate(matrix[:3])
    )


def planar(
    lengths: Annotated[list[float], Argument(help="Link lengths, base to tip (m).")],
    joints: Annotated[
        str | None, Option(help="R (turns) or P (slides) per link; all R.")
    ] = None,
    limits: Annotated[
        list[str] | None, Option("--limits", "-l", help=HELP["limits"])
    ] = None,
    radius: Annotated[float | None, Option(help="Of the pinned tip, l_4 (m).")] = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
) -> None:
    """Workspace, dexterous workspace and the lecture notes' theorem for a planar arm.

    Example: alpha5 planar 5 4 1 --radius 3 --plot arm.png
    """
    check_outputs((), plot=(plot, figures.FORMATS))
    ranges = None if limits is None else [_range(text) for text in limits]
    arm = library.PlanarArm(lengths, ranges, joints)
    result = _result(arm, radius)
    if plot is not None:
        draw.save(draw.plot_planar(arm), plot)
    options.show(as_json, result, _answers(result), plot)


def _result(arm: library.PlanarArm, radius: float | None) -> dict[str, Any]:
    space, needed = arm.workspace(), library.necessary_conditions(arm)
    result: dict[str, Any] = {"joints": arm.joints, "lengths": arm.lengths}
    result["workspace"] = {
        "shape": space.shape,
        "radii": space.radii,
        "area": space.area,
    }
    result["necessary_conditions"] = {
        "satisfied": needed.satisfied,
        "missing": needed.reasons,
    }
    result |= {"dexterous_workspace": None, "theorem": None, "at_radius": None}
    if arm.length_ranges is not None:
        radii, area = library.dexterous_radii(arm), library.dexterous_area(arm)
        result["dexterous_workspace"] = {
            "radii": radii,
            "area": area,
            "resolution": None,
        }
        three = arm.joints == "RRR"
        result["theorem"] = (
            {"l_4": library.theorem_radii(*arm.lengths)} if three else None
        )
        if radius is not None:
            holds = library.lecture_theorem(*(*arm.lengths, radius)) if three else None
            exact = library.turns_fully(arm, radius)
            result["at_radius"] = {"radius": radius, "theorem": holds, "exact": exact}
    elif radius is not None:
        raise InputError(
            "--radius", radius, "an arm without limits on its revolute joints"
        )
    elif arm.n == 3 and arm.joints[-1] == "R":
        found = library.dexterity_map(arm)
        grid = {"spacing": found.spacing, "orientations": found.orientations}
        result["dexterous_workspace"] = {
            "radii": None,
            "area": found.area,
            "resolution": grid,
        }
    return result


def _answers(result: dict[str, Any]) -> options.Lines:
    space, dexterous = result["workspace"], result["dexterous_workspace"]
    low, high = space["radii"]
    area = f", area {space['area']:.6g} m^2" if space["area"] else ""
    yield f"workspace            {space['shape']}, {low:.6g} to {high:.6g} m from the base{area}"
    text = "empty"
    if dexterous is None:
        text = options.WORDS["planar"]["unknown"]
    elif grid := dexterous["resolution"]:
        text = options.WORDS["planar"]["enumerated"].format(
            area=dexterous["area"], **grid
        )
    elif dexterous["radii"]:
        spans = [
            f"{a:.6g}" if a == b else f"{a:.6g} to {b:.6g}"
            for a, b in dexterous["radii"]
        ]
        text = (
            f"{' and '.join(spans)} m from the base, area {dexterous['area']:.6g} m^2"
        )
    yield f"dexterous workspace  {text}"
    missing = result["necessary_conditions"]["missing"]
    yield f"necessary conditions {'; '.join(missing) or 'satisfied'}"
    if theorem := result["theorem"]:
        span = (
            "{:.6g} to {:.6g} m".format(*theorem["l_4"]) if theorem["l_4"] else "no l_4"
        )
        yield f"the notes' theorem   holds for {span} (sufficient, not necessary)"
    if at := result["at_radius"]:
        words = {True: "yes", False: "no", None: "for 3R only"}
        turns, holds = words[at["exact"]], words[at["theorem"]]
        yield f"at {at['radius']:.6g} m: turns fully: {turns}; theorem: {holds}"


def _range(text: str) -> tuple[float, float] | None:
    if text.strip().lower() == "none":
        return None
    lower, upper = options.numbers(
        "--limits", text, (2,), "rad or m", "'LOWER UPPER' or none"
    )
    return lower, upper
