"""Compute added mass and drag strips of the arm's bodies.

They go into ``numbers/estimated_hydrodynamics.toml``.

    pip install -e '.[hydrodynamics]'

    # Validate, compute and write: about half an hour on one core.
    python scripts/hydrodynamics/added_mass.py
    # Some parts only; the numbers of other bodies stay.
    python scripts/hydrodynamics/added_mass.py --only validation link_2 whole_arm
    # Compute one body again and compare it with the file.
    python scripts/hydrodynamics/added_mass.py --check link_1
    # Write strips and intervals anew; added mass stays.
    python scripts/hydrodynamics/added_mass.py --intervals

First, the method is validated: a sphere and an ellipsoid against Lamb, and cylinders
against rings of sources, an integral equation along the outline of a body of
revolution, with DNV-RP-H103's figures beside it. Then come the drawn bodies of
``scripts/meshes``, each alone, with three sizes of panels, extrapolated to none.
Last, the whole arm in three poses is compared with its bodies alone. This shows how far
a sum of bodies goes; it is written to ``hydrodynamics/whole_arm.toml``.

The tables do not print shapes. Another set of bodies that they allow,
``hydrodynamics/other_bodies.toml``, widens the interval of each motion.

.. [Hoerner1965] Hoerner: Fluid-dynamic drag, 1965.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.spatial import cross_matrix, pose, rotation_about, transform
from alpha5_model.description.frames import joint_placements
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.numbers.hydrodynamics import centre_of_added_mass
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import parameters

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from hydrodynamics.panels import Array, corners, panels
from hydrodynamics.potential_flow import (
    DENSITY,
    EDGED,
    SMOOTH,
    added_mass,
    extrapolated,
    rigid_motions,
)
from hydrodynamics.revolution import cylinder_across
from meshes.dimensions import drawn_dimensions
from meshes.drawing import DrawnBody, draw, frames_in_links, printed_volumes
from meshes.solid import cylinder, kernel, union

REPOSITORY = Path(__file__).resolve().parents[2]
FILE = REPOSITORY / "alpha5_model" / "numbers" / "estimated_hydrodynamics.toml"
#: Body -> sides of the panels [mm], from which the result is extrapolated to none.
SIZES = {
    "link_0": (4.4, 3.4, 2.7),
    "link_1": (3.2, 2.4, 1.8),
    "link_2": (3.7, 3.0, 2.4),
    "link_4": (5.0, 4.0, 3.4),
    "link_4_open": (5.0, 4.0, 3.4),
    "wrist": (3.6, 2.9, 2.3),
    "finger_1": (1.6, 1.3, 1.05),
    "finger_2": (2.0, 1.5, 1.15),
}
#: Of all other bodies.
OTHERS = (5.0, 3.9, 3.0)
#: Panels of link 4's fingers over those of its wrist.
FINGERS = 0.4
#: Sides of the panels of the whole arm [mm].
WHOLE_ARM = {"link_0": 11.0, "link_1": 7.0, "link_2": 8.0, "link_3": 7.0, "link_4": 7.8}
#: Where the comparison of the whole arm is kept.
COMPARISON = Path(__file__).with_name("whole_arm.toml")
#: Added mass of bodies of other shapes, which the tables allow, too.
OTHER_BODIES = Path(__file__).with_name("other_bodies.toml")
#: Number of random motions in the comparison.
MOTIONS = 100_000
#: Distance from the base [m] at which their turning is as fast as their moving.
DISTANCE = 0.25
#: Link -> link with the same part, in another frame.
TWINS = {"link_3": "link_1"}
#: Largest difference of the extrapolations from the last two sizes and from the two
#: before: an entry over the geometric mean of its diagonal entries.
CONVERGENCE = 0.015
#: A turn about a tube's own axis moves next to no water. Differences are compared with
#: at least this share of the largest turn.
SMALL = 5e-3
#: Largest asymmetry, over the largest entry of the same unit.
ASYMMETRY = 3e-3
#: Largest difference from what others have computed.
TOLERANCE = 0.015
#: Decimals beyond the printed ones that are the same on every computer.
NOISE_DECIMALS = 6
POSES = {
    "extended": NAMED_POSES["reach"],
    "working": NAMED_POSES["home"],
    "folded": NAMED_POSES["stow"],
}


def main(arguments: list[str] | None = None) -> int:
    """Run; 1 if a check fails."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--check", metavar="BODY", help="compute one body and compare")
    parser.add_argument(
        "--only", nargs="+", metavar="PART", help="bodies, validation, whole_arm"
    )
    parser.add_argument(
        "--intervals", action="store_true", help="write strips and intervals anew"
    )
    parser.add_argument("--output", type=Path, default=FILE)
    chosen = parser.parse_args(arguments)
    if chosen.check:
        return check(chosen.check)
    if chosen.intervals:
        chosen.output.write_text(toml(_kept()), encoding="utf-8")
        return 0

    parts = solids()
    names = chosen.only or ["validation", *parts, "whole_arm"]
    wanted = {TWINS.get(name, name) for name in names}
    good = True
    if "validation" in wanted:
        good &= validate()
    found, converged = _computed(parts, wanted)
    good &= converged
    if found:
        chosen.output.write_text(toml({**_kept(), **found}), encoding="utf-8")
    if "whole_arm" in wanted:
        good &= whole_arm()
    return 0 if good else 1


def _computed(parts: dict[str, Any], wanted: set[str]) -> tuple[dict[str, Array], bool]:
    """Added mass of the wanted bodies and their twins; whether all have converged."""
    found: dict[str, Array] = {}
    good = True
    for name, solid in parts.items():
        twin = TWINS.get(name)
        if twin in found:
            found[name] = of_twin(name, twin, found[twin])
        elif name in wanted:
            found[name], converged = converge(name, solid)
            good &= converged
    return found, good


def _kept() -> dict[str, Array]:
    """Added mass of the bodies in the file."""
    return {
        name: np.array(body["added_mass"], dtype=float)
        for name, body in committed().items()
    }


def told(
    what: str, value: float, reference: float, tolerance: float = TOLERANCE
) -> bool:
    """Print a number beside its reference; whether they agree."""
    off = value / reference - 1
    print(f"  {what:48}{value:8.4f}{reference:8.4f}{100 * off:+7.2f} %", flush=True)
    return abs(off) <= tolerance


def validate() -> bool:
    """Compare the method with what others have computed for simple bodies.

    The numbers are shares of the displaced water.
    """
    print("coefficient, reference, difference")
    good = _validate_ellipsoids()
    for ratio, printed in ((1.2, 0.62), (2.5, 0.78), (5.0, 0.90)):
        solid = cylinder(20.0, -20.0 * ratio, 20.0 * ratio)
        share = of_panels(solid, (8.0, 5.6, 4.0)) / mass(solid)
        exact = cylinder_across(ratio)
        good &= told(f"cylinder {ratio}:1, across (rings of sources)", share[0], exact)
        told(f"cylinder {ratio}:1, across (DNV-RP-H103)", share[0], printed)
    return good


def _validate_ellipsoids() -> bool:
    """Compare a sphere and a long ellipsoid with Lamb."""
    ball = kernel().Manifold.sphere(20.0, 128)
    share = of_panels(ball, (8.0, 5.6, 4.0), SMOOTH) / mass(ball)
    good = told("sphere (Lamb)", share[0], 0.5)

    long = kernel().Manifold.sphere(1.0, 256).scale([100.0, 25.0, 25.0])
    share = of_panels(long, (10.0, 7.0, 5.0), SMOOTH) / mass(long)
    inertia = (0.1**2 + 0.025**2) / 5
    good &= told("ellipsoid 4:1, along (Lamb)", share[0], 0.0816)
    good &= told("ellipsoid 4:1, across", share[1], 0.8598)
    good &= told("ellipsoid 4:1, turning across", share[5] / inertia, 0.6078)
    return good


def of_panels(solid: Any, sizes: tuple[float, ...], order: float = EDGED) -> Array:
    """Diagonal of the added mass, extrapolated."""

    def compute(size: float) -> Array:
        return added_mass(*panels(solid, size))

    value, _, _ = extrapolated(compute, sizes, order)
    return np.diag(value)


def mass(solid: Any) -> float:
    """Mass of the water that a solid displaces [kg]."""
    return float(DENSITY * solid.volume() * 1e-9)


def solids() -> dict[str, Any]:
    """The bodies in their links' frames [mm]; link 4 with the jaws closed, open, and in
    parts.
    """
    drawn = without_teeth()
    wrist = drawn["link_4"].solid
    jaws = split_link_4(parameters())
    fingers = {"finger_1": jaws.finger_1, "finger_2": jaws.finger_2}

    def link_4(angle: float) -> Any:
        turn = transform(rotation_about((0.0, 0.0, 1.0), angle))
        posed = (
            moved(drawn[name].solid, pose(body.origin, (body.roll, 0.0, 0.0)) @ turn)
            for name, body in fingers.items()
        )
        return union([wrist, *posed])

    return {
        **{f"link_{i}": drawn[f"link_{i}"].solid for i in range(4)},
        "link_4": link_4(0.0),
        "link_4_open": link_4(jaws.joints[1].upper),
        "wrist": wrist,
        **{name: drawn[name].solid for name in fingers},
    }


@cache
def without_teeth() -> dict[str, DrawnBody]:
    """The drawn bodies with smooth fingers of the same volume.

    The notches between the teeth are narrower than the panels; the water in them moves
    with the finger. Without them, the plates are thinner by as much.
    """
    dimensions = drawn_dimensions()
    start, stop, _ = dimensions.finger.teeth
    dimensions.finger.teeth = (start, stop, 0)
    return draw(dimensions, printed_volumes(parameters(())))


def moved(solid: Any, placement: Array) -> Any:
    """A solid [mm] placed by a homogeneous transform [m]."""
    mm = placement[:3].copy()
    mm[:, 3] *= 1e3
    return solid.transform(mm)


def meshed(solid: Any, size: float) -> tuple[Array, Array]:
    """Panels of a body of one or more parts.

    The size is that of the largest part; the others have `FINGERS` of it.
    """
    parts = sorted(solid.decompose(), key=lambda part: -part.volume())
    meshes = [
        panels(part, size * (FINGERS if i else 1.0)) for i, part in enumerate(parts)
    ]
    return joined([vertices for vertices, _ in meshes], [faces for _, faces in meshes])


def joined(vertices: list[Array], faces: list[Array]) -> tuple[Array, Array]:
    """Meshes as one."""
    starts = np.cumsum([0, *map(len, vertices[:-1])])
    shifted = [mesh + start for mesh, start in zip(faces, starts, strict=True)]
    return np.vstack(vertices), np.vstack(shifted)


def of_twin(name: str, twin: str, matrix: Array) -> Array:
    """Added mass of a part that is another link's, too, from there."""
    to_twin = np.linalg.inv(_frame_of_part(twin))
    x = twist_map(_frame_of_part(name) @ to_twin)
    return np.asarray(x.T @ matrix @ x)


def _frame_of_part(link: str) -> Array:
    """Pose of a drawn part in its link, (4, 4) [m]."""
    frame = np.eye(4)
    drawn_frames = frames_in_links(drawn_dimensions())
    if link in drawn_frames:
        frame[:3] = drawn_frames[link]
        frame[:3, 3] *= 1e-3
    return frame


def converge(name: str, solid: Any) -> tuple[Array, bool]:
    """Added mass from three sizes of panels, made symmetric, and whether it is good."""
    sizes = SIZES.get(name, OTHERS)
    value, found, value_before = extrapolated(
        lambda size: added_mass(*meshed(solid, size)), sizes
    )
    last = found[-1]
    asymmetry = float((np.abs(last - last.T) / by_unit(value)).max())
    matrix = (value + value.T) / 2
    before = (value_before + value_before.T) / 2

    diagonal = np.diag(matrix)
    own = np.sqrt(diagonal)
    each = own.copy()
    each[3:] = np.maximum(each[3:], np.sqrt(SMALL) * each[3:].max())
    rest = float((np.abs(before - matrix) / np.outer(each, each)).max())
    smallest = float(np.linalg.eigvalsh(matrix / np.outer(own, own)).min())

    off_before = _percent(np.diag(before) / own**2 - 1)
    off_last = _percent(np.diag(last) / own**2 - 1)
    print(
        f"{name}: {diagonal}\n"
        f"  from the two sizes before {off_before} off, any entry {100 * rest:.2f} %; "
        f"the last size {off_last}; asymmetry {asymmetry:.1e}, "
        f"least eigenvalue {smallest:.2f}",
        flush=True,
    )
    good = rest <= CONVERGENCE and asymmetry <= ASYMMETRY and smallest > 0
    return matrix, good


def _percent(shares: Iterable[float]) -> str:
    return ", ".join(f"{100 * share:+.2f}" for share in shares) + " %"


def by_unit(matrix: Array) -> Array:
    """The largest entries of the linear and the angular block, and between them their
    geometric mean.
    """
    largest = np.sqrt([np.diag(matrix)[:3].max(), np.diag(matrix)[3:].max()])
    return np.kron(np.outer(largest, largest), np.ones((3, 3)))


def placements(q: Iterable[float]) -> dict[str, Array]:
    """Pose of each link in base_link, (4, 4) [m]."""
    found = {"link_0": np.eye(4)}
    for i, (angle, at) in enumerate(
        zip(q, joint_placements(parameters()), strict=True)
    ):
        turn = transform(rotation_about((0.0, 0.0, 1.0), angle))
        found[f"link_{i + 1}"] = found[at.parent] @ pose(at.xyz, at.rpy) @ turn
    return found


def twist_map(placement: Array) -> Array:
    """From a twist at the origin of the base, in its axes, to the twist of a link in
    its frame, (6, 6).
    """
    back = np.linalg.inv(placement)
    r = back[:3, :3]
    return np.block([[r, cross_matrix(back[:3, 3]) @ r], [np.zeros((3, 3)), r]])


class Part(NamedTuple):
    """A body of the arm, alone.

    Attributes:
        vertices: In its link's frame, (n, 3) [m].
        faces: (m, 3).
        added_mass: In its link's frame, (6, 6).
    """

    vertices: Array
    faces: Array
    added_mass: Array


def whole_arm() -> bool:
    """Compare the arm as one body of five parts with the sum of the parts alone.

    The panels are the same. Writes the comparison; returns whether it is good.
    """
    bodies_of_arm = solids()
    parts = []
    for name, size in WHOLE_ARM.items():
        vertices, faces = meshed(bodies_of_arm[name], size)
        parts.append(Part(vertices, faces, added_mass(vertices, faces)))

    good = True
    kept = COMPARED
    for pose_name, q in POSES.items():
        at = [*placements(q).values()]
        whole, count = _together(parts, at)
        alone = _alone(parts, at)
        moves = _moves(at)
        together = moves.T @ whole @ moves
        apart = moves.T @ alone @ moves

        kept += compared(pose_name, count, together, apart)
        along = np.round(whole[::6, ::6].sum(axis=1), 4)
        along_alone = np.round(np.diag(alone)[::6], 4)
        print(
            f"whole arm / sum of its bodies, {pose_name}, {count} panels:\n"
            f"  along x, share of each body {along} kg, alone {along_alone} kg",
            flush=True,
        )
        if pose_name == "extended":  # along x the ends shield each other: see the file
            ratio = np.diag(together) / np.diag(apart)
            good &= bool((np.abs(ratio[1:] - 1) < 0.10).all())
        COMPARISON.write_text(kept, encoding="utf-8")
    return good


def _together(parts: list[Part], at: list[Array]) -> tuple[Array, int]:
    """Added mass between the motions of the parts, six each, (30, 30); their panels."""
    placed = []
    for part, to in zip(parts, at, strict=True):
        placed.append(part.vertices @ to[:3, :3].T + to[:3, 3])
    vertices, triangles = joined(placed, [part.faces for part in parts])

    owner = np.repeat(range(len(parts)), [len(part.faces) for part in parts])
    centres = vertices[triangles].mean(axis=1)
    motions = []
    for i in range(len(parts)):
        of_part = (owner == i)[:, None]
        motions += [motion * of_part for motion in rigid_motions(centres)]
    return added_mass(vertices, triangles, motions), len(triangles)


def _alone(parts: list[Part], at: list[Array]) -> Array:
    """The same if each part were alone, (30, 30)."""
    alone = np.zeros((30, 30))
    for i, (part, placement) in enumerate(zip(parts, at, strict=True)):
        x = twist_map(placement)
        block = slice(6 * i, 6 * i + 6)
        alone[block, block] = x.T @ part.added_mass @ x
    return alone


def _moves(at: list[Array]) -> Array:
    """Motions of the five parts by the base's six motions and four joints, (30, 10).

    The base moves all parts; joint i moves parts i + 1 and on, about its axis.
    """
    moves = [np.tile(np.eye(6), (5, 1)).T]
    for i in range(1, 5):
        axis = np.linalg.inv(twist_map(at[i]))[:, 5]
        moved_parts = [np.zeros(6 * i), np.tile(axis, 5 - i)]
        moves.append(np.concatenate(moved_parts)[None])
    return np.vstack(moves).T


# The text of a committed file, with lines of its own length.
COMPARED = """# The whole arm's added mass over the sum of its bodies' in three poses, by scripts/hydrodynamics/added_mass.py.
# base: along and about x, y, z of base_link, all joints held; joints: axis_e to axis_b. directions: least and greatest
# of all motions of the base. random: 1, 50 and 99 % of such motions at random. missing: the largest difference of any
# direction over the largest added mass, moving and turning. kg: along x, y, z, the whole arm, then the sum.
"""  # noqa: E501


def compared(what: str, panels: int, together: Array, apart: Array) -> str:
    """The comparison of a pose as a table of TOML.

    Args:
        what: Name of the pose.
        panels: Their number.
        together: Added mass of the arm moved by the base's six motions and the joints.
        apart: The same of its bodies alone.
    """
    parts = apart[:6, :6]
    rigid = (together[:6, :6] + together[:6, :6].T) / 2
    lower = np.linalg.inv(np.linalg.cholesky(parts))
    ratio = np.diag(together) / np.diag(apart)
    figures = {
        "base": ratio[:6],
        "joints": ratio[6:],
        "directions": np.linalg.eigvalsh(lower @ rigid @ lower.T)[[0, -1]],
        "random": np.quantile(_random_ratios(rigid, parts), [0.01, 0.5, 0.99]),
        "missing": [_missing(rigid, parts, at) for at in (slice(3), slice(3, 6))],
        "kg": [*np.diag(rigid)[:3], *np.diag(parts)[:3]],
    }
    lines = []
    for name, row in figures.items():
        lines.append(f"{name} = [{', '.join(f'{x:.3f}' for x in row)}]")
    print("\n".join([what, *lines]), flush=True)
    return "\n".join([f"\n[{what}]", f"panels = {panels}", *lines, ""])


def _random_ratios(rigid: Array, parts: Array) -> Array:
    """Energy of the whole arm over that of its parts, for random motions."""
    scale = [1.0] * 3 + [DISTANCE] * 3
    motions = np.random.default_rng(0).normal(size=(MOTIONS, 6)) / scale
    whole = np.einsum("ni,ij,nj->n", motions, rigid, motions)
    sum_of_parts = np.einsum("ni,ij,nj->n", motions, parts, motions)
    return np.asarray(whole / sum_of_parts)


def _missing(rigid: Array, parts: Array, at: slice) -> float:
    """The largest difference in a block over the block's largest added mass."""
    difference = (rigid - parts)[at, at]
    return float(np.linalg.norm(difference, 2) / np.linalg.norm(parts[at, at], 2))


#: The line of a body's strip: axis of its frame.
STRIP_AXES = {
    "link_0": 0,
    "link_1": 2,
    "link_2": 0,
    "link_3": 1,
    "wrist": 2,
    "finger": 1,
}
ACROSS = ("0.5", "0.8", "1.2")
ALONG = ("0.05", "0.15", "0.3")


#: Drag coefficient of an endless flat plate broadside on [Hoerner1965]_, chapter 3.
PLATE = 2.0


class Strip(NamedTuple):
    """A drag strip.

    Attributes:
        start, end: [mm].
        diameter: Mean width of the outline, seen from two sides [mm].
        across: Drag coefficients: low, nominal, high.
    """

    start: Array
    end: Array
    diameter: float
    across: Sequence[str]


def strip(solid: Any, axis: int, flat: bool = False) -> Strip:
    """The strip of a body along an axis, through the centroid.

    The coefficients of a flat body are for its mean width, as those of others. They go
    from the narrow side in the stream to the wide one as an endless plate.

    Args:
        solid: The body.
        axis: 0, 1 or 2.
        flat: Whether its section is flat.
    """
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    centroid = _centroid(solid)
    start = centroid.copy()
    end = centroid.copy()
    start[axis] = low[axis]
    end[axis] = high[axis]

    areas = []
    for across in {0, 1, 2} - {axis}:
        seen = solid.rotate(_TO_Z[across])
        areas.append(seen.project().area())
    widths = np.array(areas) / (high[axis] - low[axis])
    diameter = float(widths.mean())
    across = ACROSS
    if flat:
        least = float(ACROSS[0]) * widths.min() / diameter
        most = PLATE * widths.max() / diameter
        across = (f"{least:.2f}", ACROSS[1], f"{most:.1f}")
    return Strip(start=start, end=end, diameter=diameter, across=across)


#: Axis -> roll, pitch, yaw [deg] that turn it to z.
_TO_Z = {0: (0.0, 90.0, 0.0), 1: (90.0, 0.0, 0.0), 2: (0.0, 0.0, 0.0)}


def _centroid(solid: Any) -> Array:
    vertices, faces = corners(solid)
    triangles = vertices[faces]
    volumes = np.linalg.det(triangles)
    moment = np.einsum("f,fx->x", volumes, triangles.sum(axis=1))
    return moment / (4 * volumes.sum())


def strips(name: str) -> list[Strip]:
    """The drag strips of a body of `solids`."""
    parts = solids()
    if name.startswith("link_4"):
        wrist = parts["wrist"]
        end = wrist.bounding_box()[2]
        beyond = parts[name].split_by_plane([0.0, 0.0, -1.0], -end)[0]
        return [strip(wrist, 2), strip(beyond, 2, flat=True)]
    is_finger = "finger" in name
    kind = "finger" if is_finger else name
    return [strip(parts[name], STRIP_AXES[kind], flat=is_finger)]


def toml(numbers: dict[str, Array]) -> str:
    """The text of ``estimated_hydrodynamics.toml``."""
    lines = [HEAD]
    for name, matrix in numbers.items():
        lines += [f"\n[bodies.{name}]", "added_mass = ["]
        for i, row in enumerate(matrix):
            entries = [_digits(x, i, j) for j, x in enumerate(row)]
            lines.append(f"  [{', '.join(entries)}],")
        low, high = shape_interval(name, matrix)
        lines += [
            "]",
            'added_mass_factor = ["0.75", "1", "1.25"]',
            f"shape_low = {_list(_quoted(x, 2) for x in low)}",
            f"shape_high = {_list(_quoted(x, 2) for x in high)}",
            "strips = [",
        ]
        lines += [_line_of_strip(strip) for strip in strips(name)]
        lines += [
            "]",
            'status = "estimated"',
            f'source = "{SOURCES.get(name, SOURCE)}"',
            f'method = "{method(name)}"',
        ]
    return "\n".join(lines) + "\n"


def shape_interval(name: str, matrix: Array) -> tuple[Array, Array]:
    """What the shape can make of the added mass of each motion, rounded outwards.

    Args:
        name: Of the body.
        matrix: Its added mass.

    Returns:
        Least and greatest share for the motions along and about the axes at its centre,
        (6,) each.
    """
    to_origin = np.eye(6)
    to_origin[:3, 3:] = cross_matrix(centre_of_added_mass(matrix))
    ours = to_origin.T @ matrix @ to_origin
    others = to_origin.T @ other_added_mass(name) @ to_origin
    share = np.diag(others) / np.diag(ours)
    low = np.floor(100 * np.minimum(share, 1.0)) / 100
    high = np.ceil(100 * np.maximum(share, 1.0)) / 100
    return low, high


def other_added_mass(name: str) -> Array:
    """Added mass of the body of the other set, (6, 6)."""
    bodies_of_file = tomllib.loads(OTHER_BODIES.read_text("utf-8"))
    return np.array(bodies_of_file[name]["added_mass"], dtype=float)


def _line_of_strip(strip_of_body: Strip) -> str:
    values = {
        "start": _list(_quoted(x, 1) for x in strip_of_body.start),
        "end": _list(_quoted(x, 1) for x in strip_of_body.end),
        "diameter": _quoted(strip_of_body.diameter, 1),
        "across": _list(_in_quotes(text) for text in strip_of_body.across),
        "along": _list(_in_quotes(text) for text in ALONG),
    }
    entries = [f"{name} = {value}" for name, value in values.items()]
    return f"  {{ {', '.join(entries)} }},"


def _digits(value: float, row: int, column: int) -> str:
    return _quoted(value, (5, 7, 9)[(row > 2) + (column > 2)])


def _quoted(value: float, decimals: int) -> str:
    # Some values lie half way between two printed ones, as 144.75 does. Without the
    # noise of the last digits every computer prints the same one.
    quiet = round(value, decimals + NOISE_DECIMALS)
    return _in_quotes(f"{round(quiet, decimals) + 0.0:.{decimals}f}")


def _in_quotes(text: str) -> str:
    return f'"{text}"'


def _list(entries: Iterable[str]) -> str:
    return f"[{', '.join(entries)}]"


SOURCE = (
    "our own calculation (scripts/hydrodynamics/added_mass.py) "
    "on our own bodies (scripts/meshes)"
)
SOURCES = {
    "link_4": SOURCE + ", jaws closed",
    "link_4_open": SOURCE + ", jaws fully open, as one body",
    "wrist": SOURCE + ", link 4 without the fingers",
}
STRIPS = "strips: Morison, finite cylinders"


def method(name: str) -> str:
    """How a body's numbers were made."""
    if name in TWINS:
        return f"of {TWINS[name]}, the same part, in this frame; {STRIPS}"
    sizes = ", ".join(f"{size:g}" for size in SIZES.get(name, OTHERS))
    finer = f", its fingers' {FINGERS:g} of that" if name.startswith("link_4") else ""
    return (
        "potential flow without bounds, each body alone (capytaine 3), "
        f"extrapolated from panels of {sizes} mm{finer}; {STRIPS}"
    )


# The text of a committed file, with lines of its own length.
HEAD = '''# ESTIMATED, not published: what the moving water does to each body, off unless asked for. Written by
# scripts/hydrodynamics/added_mass.py; version 7 of the document prints neither added mass nor drag.
#
# added_mass: 6x6, linear before angular, about the origin and in the axes of the link's frame, for water of 1000 kg/m^3
#   [kg, kg m, kg m^2]; another fluid scales it by its density.
# added_mass_factor: low, nominal, high. The stretched arm has 0.96 to 1.06 of what its bodies have alone when it moves
#   across itself, turns, or moves a joint; along itself 0.76: each body alone pushes water before both its ends, but ends
#   that face a neighbour do not, and no numbers of single bodies hold both. What is missing, 0.04 of 0.18 kg, is 8 % of the added mass across, 0.55 kg. A
#   working pose has 0.77 to 1.07; folded it has 0.69 to 1.41, which the interval does not cover.
#   Extrapolations from the last two sizes of panels and from the two before are 0.4 to 1.4 % apart at most (an entry over
#   the geometric mean of its diagonal entries). The fingers are computed without the notches between their teeth.
# shape_low, shape_high: the tables print no shape. Two sets of bodies that both match them differ by these shares, along x,
#   y, z and about them, at the point where moving and turning are least coupled; low and high have them besides the factor.
# strips: the cross-flow principle. A length ds of a strip, from start to end, resists the water's velocity across
#   it with rho / 2 * across * diameter * ds * speed * velocity, and so along it [mm; low, nominal, high].
#   across: 1.0 to 1.2 of an endless cylinder, times 0.58 to 0.7 for its ends. along: 0.05 is the friction of a smooth
#   cylinder at Re 8000, 0.25 to 0.3 a blunt face in the stream. Fingers are flat: from the narrow side (0.5 of its width) to
#   the wide one as an endless plate (2.0 of its width); both over the mean width, the diameter.

[units]
added_mass = "kg, kg.m, kg.m^2"
start = "mm"
end = "mm"
diameter = "mm"'''  # noqa: E501


def committed() -> dict[str, Any]:
    """The bodies of the file."""
    return dict(tomllib.loads(FILE.read_text("utf-8"))["bodies"])


def check(name: str) -> int:
    """Compute one body again; 1 if an entry is further off than half a per cent of its
    scale.
    """
    kept = committed()
    if name not in kept:
        print(f"unknown body {name!r}; choose from {', '.join(kept)}", file=sys.stderr)
        return 2
    old = np.array(kept[name]["added_mass"], dtype=float)
    twin = TWINS.get(name, name)
    solid = solids()[twin]
    of_part, _, _ = extrapolated(
        lambda size: added_mass(*meshed(solid, size)), SIZES.get(twin, OTHERS)
    )
    new = of_twin(name, twin, of_part)
    off = float((np.abs(new - old) / by_unit(old)).max())
    print(f"{name}: {100 * off:.3f} % from the file")
    return 0 if off < 5e-3 else 1


if __name__ == "__main__":
    sys.exit(main())
