"""Added mass and drag strips of the arm's bodies, into ``numbers/estimated_hydrodynamics.toml``.

    pip install -e '.[hydrodynamics]'
    python scripts/hydrodynamics/added_mass.py                 # validates, computes, writes; about half an hour on one core
    python scripts/hydrodynamics/added_mass.py --only validation link_2 whole_arm   # some of it; other bodies' numbers stay
    python scripts/hydrodynamics/added_mass.py --check link_1  # computes one body again and compares with the file

What comes first validates the method: a sphere and an ellipsoid against Lamb, cylinders against rings of sources, an
integral equation along the outline of a body of revolution, with DNV-RP-H103's two figures beside it. Then the drawn
bodies of `alpha5_model.geometry` over three sizes of panels, each alone, extrapolated to none; and the whole arm in
three poses against its bodies alone, which says how far a sum of bodies goes, into ``hydrodynamics/whole_arm.toml``.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.spatial import cross_matrix, pose, rotation_about, transform
from alpha5_model.description.frames import joint_placements
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.geometry.dimensions import drawn_dimensions
from alpha5_model.geometry.drawing import bodies, frames_in_links
from alpha5_model.geometry.solid import cylinder, kernel, union
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

FILE = (
    Path(__file__).resolve().parents[2]
    / "alpha5_model"
    / "numbers"
    / "estimated_hydrodynamics.toml"
)
#: Sides of the panels [mm], from which to none is extrapolated; of link 4's fingers, `FINGERS` of the wrist's.
SIZES = {
    "link_1": (3.2, 2.4, 1.8),
    "link_2": (4.3, 3.5, 2.8),
    "link_4": (5.0, 4.0, 3.4),
    "link_4_open": (5.0, 4.0, 3.4),
    "wrist": (4.4, 3.4, 2.6),
    "finger_1": (2.0, 1.5, 1.15),
    "finger_2": (2.0, 1.5, 1.15),
}
OTHERS = (5.0, 3.9, 3.0)
FINGERS = 0.4
#: Of the whole arm; and where its comparison is kept, with motions at random that move a point so far from the base [m]
#: as fast by turning as by moving.
WHOLE_ARM = {"link_0": 10.0, "link_1": 6.0, "link_2": 8.0, "link_3": 6.0, "link_4": 9.5}
COMPARISON = Path(__file__).with_name("whole_arm.toml")
MOTIONS, DISTANCE = 100_000, 0.25
#: Links of which both have the same part, in frames of their own.
TWINS = {"link_3": "link_1"}
#: Largest difference of the extrapolations from the last two sizes and from the two before, an entry over the
#: geometric mean of its diagonal entries; and asymmetry, over the largest entry of the same unit. A turn about a tube's
#: own axis moves next to no water: below `SMALL` of the largest turn, it is held against that much.
CONVERGENCE = 0.015
SMALL = 5e-3
ASYMMETRY = 3e-3
#: Of what others have computed.
TOLERANCE = 0.015
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
    parser.add_argument("--output", type=Path, default=FILE)
    chosen = parser.parse_args(arguments)
    if chosen.check:
        return check(chosen.check)
    parts = solids()
    wanted = {
        TWINS.get(x, x) for x in chosen.only or ["validation", *parts, "whole_arm"]
    }
    good, found = True, {}
    if "validation" in wanted:
        good &= validate()
    for name, solid in parts.items():
        if (twin := TWINS.get(name)) in found:
            found[name] = of_twin(name, twin, found[twin])
        elif name in wanted:
            found[name], converged = converge(name, solid)
            good &= converged
    if found:
        kept = {
            name: np.array(x["added_mass"], dtype=float)
            for name, x in committed().items()
        }
        chosen.output.write_text(toml({**kept, **found}), encoding="utf-8")
    if "whole_arm" in wanted:
        good &= whole_arm()
    return 0 if good else 1


def told(
    what: str, value: float, reference: float, tolerance: float = TOLERANCE
) -> bool:
    off = value / reference - 1
    print(f"  {what:48}{value:8.4f}{reference:8.4f}{100 * off:+7.2f} %", flush=True)
    return abs(off) <= tolerance


def validate() -> bool:
    """The method on bodies that others have computed, as shares of what the displaced water has."""
    print("coefficient, reference, difference")
    ball = kernel().Manifold.sphere(20.0, 128)
    long = kernel().Manifold.sphere(1.0, 256).scale([100.0, 25.0, 25.0])
    good = True
    m = of_panels(ball, (8.0, 5.6, 4.0), SMOOTH) / mass(ball)
    good &= told("sphere (Lamb)", m[0], 0.5)
    m = of_panels(long, (10.0, 7.0, 5.0), SMOOTH) / mass(long)
    good &= told("ellipsoid 4:1, along (Lamb)", m[0], 0.0816)
    good &= told("ellipsoid 4:1, across", m[1], 0.8598)
    good &= told(
        "ellipsoid 4:1, turning across", m[5] / ((0.1**2 + 0.025**2) / 5), 0.6078
    )
    for ratio, printed in ((1.2, 0.62), (2.5, 0.78), (5.0, 0.90)):
        solid = cylinder(20.0, -20.0 * ratio, 20.0 * ratio)
        m, exact = (
            of_panels(solid, (8.0, 5.6, 4.0)) / mass(solid),
            cylinder_across(ratio),
        )
        good &= told(f"cylinder {ratio}:1, across (rings of sources)", m[0], exact)
        told(f"cylinder {ratio}:1, across (DNV-RP-H103)", m[0], printed)
    return good


def of_panels(solid: Any, sizes: tuple[float, ...], order: float = EDGED) -> Array:
    """Diagonal of the added mass, extrapolated."""
    return np.diag(
        extrapolated(lambda size: added_mass(*panels(solid, size)), sizes, order)[0]
    )


def mass(solid: Any) -> float:
    """Of the water in a solid's place [kg]."""
    return float(DENSITY * solid.volume() * 1e-9)


def solids() -> dict[str, Any]:
    """The bodies in their links' frames [mm]; link 4 with the jaws closed, open, and in parts."""
    drawn = bodies()
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


def moved(solid: Any, placement: Array) -> Any:
    """A solid [mm] placed by a homogeneous transform [m]."""
    mm = placement[:3].copy()
    mm[:, 3] *= 1e3
    return solid.transform(mm)


def meshed(solid: Any, size: float) -> tuple[Array, Array]:
    """Panels of a body that may be of several parts, those beside the largest of `FINGERS` of the size."""
    parts = sorted(solid.decompose(), key=lambda part: -part.volume())
    meshes = [
        panels(part, size * (FINGERS if i else 1.0)) for i, part in enumerate(parts)
    ]
    return joined([vertices for vertices, _ in meshes], [faces for _, faces in meshes])


def joined(vertices: list[Array], faces: list[Array]) -> tuple[Array, Array]:
    """Meshes as one."""
    starts = np.cumsum([0, *map(len, vertices[:-1])])
    return np.vstack(vertices), np.vstack(
        [f + at for f, at in zip(faces, starts, strict=True)]
    )


def of_twin(name: str, twin: str, matrix: Array) -> Array:
    """Added mass of a part that is another link's, too, from there."""
    frames = {link: np.eye(4) for link in (name, twin)}
    drawn_frames = frames_in_links(drawn_dimensions())
    for link in {*frames} & {*drawn_frames}:
        frames[link][:3] = drawn_frames[link]
        frames[link][:3, 3] *= 1e-3
    x = twist_map(frames[name] @ np.linalg.inv(frames[twin]))
    return np.asarray(x.T @ matrix @ x)


def converge(name: str, solid: Any) -> tuple[Array, bool]:
    """Added mass from three sizes of panels, made symmetric, and whether it is good."""
    matrix, found, before = extrapolated(
        lambda size: added_mass(*meshed(solid, size)), SIZES.get(name, OTHERS)
    )
    asymmetry = float((np.abs(found[-1] - found[-1].T) / by_unit(matrix)).max())
    matrix, before = (matrix + matrix.T) / 2, (before + before.T) / 2
    each = np.sqrt(np.diag(matrix))
    each[3:] = np.maximum(each[3:], np.sqrt(SMALL) * each[3:].max())
    rest = np.abs(before - matrix) / np.outer(each, each)
    own = np.sqrt(np.diag(matrix))
    smallest = float(np.linalg.eigvalsh(matrix / np.outer(own, own)).min())
    print(
        f"{name}: {np.diag(matrix)}\n  from the two sizes before {_percent(np.diag(before) / own**2 - 1)} off, any "
        f"entry {100 * rest.max():.2f} %; the last size {_percent(np.diag(found[-1]) / own**2 - 1)}; asymmetry "
        f"{asymmetry:.1e}, least eigenvalue {smallest:.2f}",
        flush=True,
    )
    return matrix, rest.max() <= CONVERGENCE and asymmetry <= ASYMMETRY and smallest > 0


def _percent(shares: Iterable[float]) -> str:
    return ", ".join(f"{100 * share:+.2f}" for share in shares) + " %"


def by_unit(matrix: Array) -> Array:
    """The largest entries of the linear and the angular block, and between them their geometric mean."""
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
    """From a twist at the origin of the base, in its axes, to the twist of a link in its frame, (6, 6)."""
    back = np.linalg.inv(placement)
    r = back[:3, :3]
    return np.block([[r, cross_matrix(back[:3, 3]) @ r], [np.zeros((3, 3)), r]])


def whole_arm() -> bool:
    """The arm as one body of five parts in three poses, against the sum of the parts alone, panels alike."""
    good, parts, kept = True, solids(), COMPARED
    meshes = [meshed(parts[name], size) for name, size in WHOLE_ARM.items()]
    numbers = [added_mass(*mesh) for mesh in meshes]
    owner = np.repeat(range(5), [len(faces) for _, faces in meshes])
    for what, q in POSES.items():
        at = [*placements(q).values()]
        vertices, triangles = joined(
            [
                p @ to[:3, :3].T + to[:3, 3]
                for (p, _), to in zip(meshes, at, strict=True)
            ],
            [faces for _, faces in meshes],
        )
        centres = vertices[triangles].mean(axis=1)
        motions = [
            motion * (owner == i)[:, None]
            for i in range(5)
            for motion in rigid_motions(centres)
        ]
        whole = added_mass(vertices, triangles, motions)
        alone = np.zeros((30, 30))
        for i, (placement, matrix) in enumerate(zip(at, numbers, strict=True)):
            x = twist_map(placement)
            alone[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] = x.T @ matrix @ x
        # The base's six motions move all parts; joint i moves parts i + 1 and on, about its axis.
        moves = [np.tile(np.eye(6), (5, 1)).T]
        for i in range(1, 5):
            axis = np.linalg.inv(twist_map(at[i]))[:, 5]
            moves.append(np.concatenate([np.zeros(6 * i), np.tile(axis, 5 - i)])[None])
        j = np.vstack(moves).T
        together, apart = j.T @ whole @ j, j.T @ alone @ j
        ratio = np.diag(together) / np.diag(apart)
        along = whole[::6, ::6].sum(axis=1), np.diag(alone)[::6]
        kept += compared(what, len(triangles), together, apart)
        print(
            f"whole arm / sum of its bodies, {what}, {len(triangles)} panels:\n"
            f"  along x, share of each body {np.round(along[0], 4)} kg, alone {np.round(along[1], 4)} kg",
            flush=True,
        )
        if what == "extended":  # along x the ends shield each other: see the file
            good &= bool((np.abs(ratio[1:] - 1) < 0.10).all())
        COMPARISON.write_text(kept, encoding="utf-8")
    return good


COMPARED = """# The whole arm's added mass over the sum of its bodies' in three poses, by scripts/hydrodynamics/added_mass.py.
# base: along and about x, y, z of base_link, all joints held; joints: axis_e to axis_b. directions: least and greatest
# of all motions of the base. random: 1, 50 and 99 % of such motions at random. missing: the largest difference of any
# direction over the largest added mass, moving and turning. kg: along x, y, z, the whole arm, then the sum.
"""


def compared(what: str, panels: int, together: Array, apart: Array) -> str:
    """The comparison of a pose, moved by the base's six motions and the joints, as a table of TOML."""
    rigid, parts = together[:6, :6], apart[:6, :6]
    rigid = (rigid + rigid.T) / 2
    lower = np.linalg.inv(np.linalg.cholesky(parts))
    motions = np.random.default_rng(0).normal(size=(MOTIONS, 6)) / (
        [1.0] * 3 + [DISTANCE] * 3
    )
    energies = (np.einsum("ni,ij,nj->n", motions, m, motions) for m in (rigid, parts))
    missing = [
        np.linalg.norm((rigid - parts)[at, at], 2) / np.linalg.norm(parts[at, at], 2)
        for at in (slice(3), slice(3, 6))
    ]
    ratio = np.diag(together) / np.diag(apart)
    figures = {
        "base": ratio[:6],
        "joints": ratio[6:],
        "directions": np.linalg.eigvalsh(lower @ rigid @ lower.T)[[0, -1]],
        "random": np.quantile(np.divide(*energies), [0.01, 0.5, 0.99]),
        "missing": missing,
        "kg": [*np.diag(rigid)[:3], *np.diag(parts)[:3]],
    }
    lines = [
        f"{name} = [{', '.join(f'{x:.3f}' for x in row)}]"
        for name, row in figures.items()
    ]
    print("\n".join([what, *lines]), flush=True)
    return "\n".join([f"\n[{what}]", f"panels = {panels}", *lines, ""])


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


def strip(solid: Any, axis: int) -> tuple[Array, Array, float]:
    """Ends and diameter [mm]: along an axis through the centroid, of the outline's area seen across it."""
    low, high = np.array(solid.bounding_box()).reshape(2, 3)
    centroid = _centroid(solid)
    start, end = centroid.copy(), centroid.copy()
    start[axis], end[axis] = low[axis], high[axis]
    areas = []
    for across in {0, 1, 2} - {axis}:
        turn = {0: (0.0, 90.0, 0.0), 1: (90.0, 0.0, 0.0), 2: (0.0, 0.0, 0.0)}[across]
        areas.append(solid.rotate(turn).project().area())
    return start, end, float(np.mean(areas) / (high[axis] - low[axis]))


def _centroid(solid: Any) -> Array:
    vertices, triangles = corners(solid)
    volumes = np.linalg.det(vertices[triangles])
    return np.einsum("f,fx->x", volumes, vertices[triangles].sum(axis=1)) / (
        4 * volumes.sum()
    )


def strips(name: str) -> list[tuple[Array, Array, float]]:
    """The drag strips of a body of `solids`."""
    parts = solids()
    if name.startswith("link_4"):
        wrist = parts["wrist"]
        end = wrist.bounding_box()[2]
        beyond = parts[name].split_by_plane([0.0, 0.0, -1.0], -end)[0]
        return [strip(wrist, 2), strip(beyond, 2)]
    return [
        strip(
            parts[name],
            STRIP_AXES[name.partition("_")[0] if "finger" in name else name],
        )
    ]


def toml(numbers: dict[str, Array]) -> str:
    """The file of published/."""
    lines = [HEAD]
    for name, matrix in numbers.items():
        lines += [f"\n[bodies.{name}]", "added_mass = ["]
        lines += [
            f"  [{', '.join(_digits(x, i, j) for j, x in enumerate(row))}],"
            for i, row in enumerate(matrix)
        ]
        lines += ["]", 'added_mass_factor = ["0.75", "1", "1.25"]', "strips = ["]
        for start, end, diameter in strips(name):
            ends = (
                f"[{', '.join(_quoted(x, 1) for x in point)}]" for point in (start, end)
            )
            lines.append(
                "  {{ start = {}, end = {}, diameter = {}, across = {}, along = {} }},".format(
                    *ends, _quoted(diameter, 1), _list(ACROSS), _list(ALONG)
                )
            )
        lines += [
            "]",
            'status = "estimated"',
            f'source = "{SOURCES.get(name, SOURCE)}"',
            f'method = "{method(name)}"',
        ]
    return "\n".join(lines) + "\n"


def _digits(value: float, row: int, column: int) -> str:
    return _quoted(value, (5, 7, 9)[(row > 2) + (column > 2)])


def _quoted(value: float, decimals: int) -> str:
    return f'"{round(value, decimals) + 0.0:.{decimals}f}"'


def _list(texts: Iterable[str]) -> str:
    return "[" + ", ".join(f'"{text}"' for text in texts) + "]"


SOURCE = "our own calculation (scripts/hydrodynamics/added_mass.py) on our own bodies (alpha5_model/geometry)"
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
        "potential flow without bounds, each body alone (capytaine 3), extrapolated from panels of "
        f"{sizes} mm{finer}; {STRIPS}"
    )


HEAD = '''# ESTIMATED, not published: what the moving water does to each body, off unless asked for. Written by
# scripts/hydrodynamics/added_mass.py; version 7 of the document prints neither added mass nor drag.
#
# added_mass: 6x6, linear before angular, about the origin and in the axes of the link's frame, for water of 1000 kg/m^3
#   [kg, kg m, kg m^2]; another fluid scales it by its density.
# added_mass_factor: low, nominal, high. The stretched arm has 0.94 to 1.04 of what its bodies have alone when it moves
#   across itself, turns, or moves a joint; along itself 0.78: each body alone pushes water before both its ends, but ends
#   that face a neighbour do not, and no numbers of single bodies hold both. What is missing, 0.04 of 0.20 kg, is 7 % of the added mass across, 0.63 kg. A
#   working pose has 0.80 to 1.08; folded it has 0.71 to 1.41, which the interval does not cover.
#   Extrapolations from the last two sizes of panels and from the two before are 0.5 to 1.3 % apart at most (an entry over
#   the geometric mean of its diagonal entries); link_4's and link_4_open's by their fingers, which need the finest panels.
# strips: the cross-flow principle. A length ds of a strip, from start to end, resists the water's velocity across
#   it with rho / 2 * across * diameter * ds * speed * velocity, and so along it [mm; low, nominal, high].
#   across: 1.0 to 1.2 of an endless cylinder, times 0.58 to 0.7 for its ends. along: 0.05 is the friction of a smooth
#   cylinder at Re 8000, 0.25 to 0.3 a blunt face in the stream.

[units]
added_mass = "kg, kg.m, kg.m^2"
start = "mm"
end = "mm"
diameter = "mm"'''


def committed() -> dict[str, Any]:
    """The bodies of the file."""
    return dict(tomllib.loads(FILE.read_text("utf-8"))["bodies"])


def check(name: str) -> int:
    """Compute one body again; 1 if an entry is further off than half a per cent of its scale."""
    kept = committed()
    if name not in kept:
        print(f"unknown body {name!r}; choose from {', '.join(kept)}", file=sys.stderr)
        return 2
    old = np.array(kept[name]["added_mass"], dtype=float)
    twin = TWINS.get(name, name)
    new, *_ = extrapolated(
        lambda size: added_mass(*meshed(solids()[twin], size)), SIZES.get(twin, OTHERS)
    )
    new = of_twin(name, twin, new)
    off = float((np.abs(new - old) / by_unit(old)).max())
    print(f"{name}: {100 * off:.3f} % from the file")
    return 0 if off < 5e-3 else 1


if __name__ == "__main__":
    sys.exit(main())
