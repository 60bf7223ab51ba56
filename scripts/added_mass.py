"""Added mass and drag strips of the arm's bodies, into ``published/estimated_hydrodynamics.toml``.

    pip install -e '.[hydrodynamics]'
    python scripts/added_mass.py                 # validates, computes, writes; about half an hour on one core
    python scripts/added_mass.py --check link_1  # computes one body again and compares with the file

What comes first validates the method: a sphere and an ellipsoid against Lamb, cylinders against DNV-RP-H103.
Then the drawn bodies of `alpha5_model.meshing` over three sizes of panels, each alone; and the whole arm in three
poses against its bodies alone, which says how far a sum of bodies goes.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from hydrodynamics.panels import Array, panels
from hydrodynamics.potential_flow import DENSITY, added_mass, rigid_motions

from alpha5_model.description.bodies import joint_placements
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.jaws import split_link_4
from alpha5_model.meshing import bodies
from alpha5_model.meshing.dimensions import BASE
from alpha5_model.meshing.solid import cylinder, kernel, union
from alpha5_model.parameters import parameters
from alpha5_model.spatial import cross_matrix, pose, rotation_about, transform

FILE = (
    Path(__file__).resolve().parent.parent
    / "alpha5_model"
    / "published"
    / "estimated_hydrodynamics.toml"
)
#: Sides of the panels [mm]: three sizes, the last one counts.
SIZES = {
    "link_1": (3.2, 2.5, 2.0),
    "link_3": (3.2, 2.5, 2.0),
    "link_4": (2.8, 2.3, 1.9),
    "link_4_open": (2.8, 2.3, 1.9),
    "finger_1": (1.3, 1.05, 0.8),
}
OTHERS = (4.0, 3.2, 2.6)
WHOLE_ARM = 4.2
#: Largest change from the second size to the third, and asymmetry, relative to the largest entry of the same unit.
CONVERGENCE = 0.015
#: The holes of the fingers leave walls of 2 mm, for which no panels are small enough here.
PERFORATED = {"link_4": 0.07, "link_4_open": 0.07, "finger_1": 0.03}
ASYMMETRY = 3e-3
POSES = {
    "extended": NAMED_POSES["reach"],
    "working": NAMED_POSES["home"],
    "folded": NAMED_POSES["stow"],
}


def main(arguments: list[str] | None = None) -> int:
    """Run; 1 if a check fails."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--check", metavar="BODY", help="compute one body and compare")
    parser.add_argument("--output", type=Path, default=FILE)
    chosen = parser.parse_args(arguments)
    if chosen.check:
        return check(chosen.check)
    good = validate()
    numbers = {}
    turned = np.kron(np.eye(2), np.diag([-1.0, -1.0, 1.0]))
    for name, solid in solids().items():
        if name == "finger_2":  # the same part, half a turn about its hinge
            numbers[name] = turned @ numbers["finger_1"] @ turned
            continue
        numbers[name], converged = converge(name, solid)
        good &= converged
        chosen.output.write_text(toml(numbers), encoding="utf-8")
    good &= whole_arm()
    return 0 if good else 1


def told(what: str, value: float, reference: float, tolerance: float) -> bool:
    off = value / reference - 1
    print(f"  {what:44}{value:8.4f}{reference:8.4f}{100 * off:+7.2f} %", flush=True)
    return abs(off) <= tolerance


def validate() -> bool:
    """The method on bodies that others have computed, as shares of what the displaced water has."""
    print("coefficient, reference, difference")
    ball = kernel().Manifold.sphere(20.0, 128)
    long = kernel().Manifold.sphere(1.0, 128).scale([100.0, 25.0, 25.0])
    good = True
    m = np.diag(added_mass(*panels(ball, 3.5))) / (DENSITY * ball.volume() * 1e-9)
    good &= told("sphere (Lamb)", m[0], 0.5, 0.015)
    m = np.diag(added_mass(*panels(long, 4.0))) / (DENSITY * long.volume() * 1e-9)
    good &= told("ellipsoid 4:1, along (Lamb)", m[0], 0.0816, 0.015)
    good &= told("ellipsoid 4:1, across", m[1], 0.8598, 0.015)
    good &= told("ellipsoid 4:1, turning across", m[5] / ((0.1**2 + 0.025**2) / 5), 0.6078, 0.015)
    # Two figures in the table; panels refined towards the edges come to 0.625, 0.779 and 0.879.
    for ratio, reference in ((1.2, 0.62), (2.5, 0.78), (5.0, 0.90)):
        solid = cylinder(20.0, -20.0 * ratio, 20.0 * ratio)
        m = np.diag(added_mass(*panels(solid, 4.0))) / (DENSITY * solid.volume() * 1e-9)
        good &= told(f"cylinder {ratio}:1, across (DNV-RP-H103)", m[0], reference, 0.025)
    return good


def solids() -> dict[str, Any]:
    """The bodies in their links' frames [mm]; link 4 with the jaws closed, open, and in parts.

    They are the drawn ones but for the connector's recess in link 0, whose wall is 2 mm thin: it is closed, and its
    water moves with the link (`recess`).
    """
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
        "link_0": drawn["link_0"].solid + recess(),
        **{name: drawn[name].solid for name in ("link_1", "link_2", "link_3")},
        "link_4": link_4(0.0),
        "link_4_open": link_4(jaws.joints[1].upper),
        "wrist": wrist,
        **{name: drawn[name].solid for name in fingers},
    }


def recess() -> Any:
    """What the connector's recess in link 0 holds, connector included [mm]."""
    depth = bodies()["link_0"].value
    hole = cylinder(BASE.recess_radius, BASE.rear, BASE.rear + depth, axis="x")
    return hole.translate([0, BASE.recess_offset, 0])


def carried_water(solid: Any) -> Array:
    """Inertia of water that moves with a body, about the origin, (6, 6)."""
    mesh = solid.to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts).astype(int)] * 1e-3
    mass = DENSITY * np.linalg.det(corners) / 6  # of tetrahedra from the origin
    sums = corners.sum(axis=1)
    first = np.einsum("f,fx->x", mass, sums) / 4
    second = np.einsum("f,fcx,fcy->xy", mass, corners, corners) + np.einsum(
        "f,fx,fy->xy", mass, sums, sums
    )
    second /= 20
    turning = np.trace(second) * np.eye(3) - second
    coupling = cross_matrix(first)
    return np.block([[mass.sum() * np.eye(3), -coupling], [coupling, turning]])


def water_with(name: str) -> Array:
    """Inertia of the water that a body carries beside what flows around it, (6, 6)."""
    if name != "link_0":
        return np.zeros((6, 6))
    inertia = carried_water(recess() - bodies()["link_0"].solid)
    # A turn about the recess's own axis leaves its water behind.
    inertia[3, 3] = (inertia[0, 4] ** 2 + inertia[0, 5] ** 2) / inertia[0, 0]
    return inertia


def moved(solid: Any, placement: Array) -> Any:
    """A solid [mm] placed by a homogeneous transform [m]."""
    mm = placement[:3].copy()
    mm[:, 3] *= 1e3
    return solid.transform(mm)


def converge(name: str, solid: Any) -> tuple[Array, bool]:
    """Added mass over three sizes of panels; the last one made symmetric."""
    results, counts = [], []
    for size in SIZES.get(name, OTHERS):
        mesh = panels(solid, size)
        results.append(added_mass(*mesh) + water_with(name))
        counts.append(len(mesh[1]))
    matrix = results[-1]
    scale = by_unit(matrix)
    asymmetry = float((np.abs(matrix - matrix.T) / scale).max())
    changes = [float(np.abs(a / scale - b / scale).max()) for a, b in pairwise(results)]
    matrix = (matrix + matrix.T) / 2
    each = np.sqrt(np.diag(matrix))
    smallest = float(np.linalg.eigvalsh(matrix / np.outer(each, each)).min())
    diagonal = [
        f"{100 * (b[i, i] / a[i, i] - 1):+.1f}" for a, b in [results[-2:]] for i in range(6)
    ]
    print(
        f"{name}: panels {counts}, changes {[f'{100 * c:.2f} %' for c in changes]}, "
        f"asymmetry {asymmetry:.1e}, least eigenvalue {smallest:.2f}\n  {np.diag(matrix)}, last change {diagonal} %",
        flush=True,
    )
    return matrix, changes[-1] <= PERFORATED.get(
        name, CONVERGENCE
    ) and asymmetry <= ASYMMETRY and smallest > 0


def by_unit(matrix: Array) -> Array:
    """The largest entries of the linear and the angular block, and between them their geometric mean."""
    largest = np.sqrt([np.diag(matrix)[:3].max(), np.diag(matrix)[3:].max()])
    return np.kron(np.outer(largest, largest), np.ones((3, 3)))


def placements(q: Iterable[float]) -> dict[str, Array]:
    """Pose of each link in base_link, (4, 4) [m]."""
    found = {"link_0": np.eye(4)}
    for i, (angle, at) in enumerate(zip(q, joint_placements(parameters()), strict=True)):
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
    good, parts = True, solids()
    names = [f"link_{i}" for i in range(5)]
    numbers = {
        name: added_mass(*panels(parts[name], WHOLE_ARM)) + water_with(name) for name in names
    }
    for what, q in POSES.items():
        at = placements(q)
        posed = [moved(parts[name], at[name]) for name in names]
        # The recess's water counts with the bodies; it moves with link 0 here, too.
        vertices, quads = panels(union(posed), WHOLE_ARM)
        centres = vertices[quads].mean(axis=1)
        owner = _owners(centres * 1e3, posed)
        motions = [
            motion * (owner == i)[:, None] for i in range(5) for motion in rigid_motions(centres)
        ]
        whole = added_mass(vertices, quads, motions)
        whole[:6, :6] += water_with("link_0")
        alone = np.zeros((30, 30))
        for i, name in enumerate(names):
            x = twist_map(at[name])
            alone[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] = x.T @ numbers[name] @ x
        # The base's six motions move all parts; joint i moves parts i + 1 and on, about its axis.
        moves = [np.tile(np.eye(6), (5, 1)).T]
        for i in range(1, 5):
            axis = np.linalg.inv(twist_map(at[f"link_{i}"]))[:, 5]
            moves.append(np.concatenate([np.zeros(6 * i), np.tile(axis, 5 - i)])[None])
        j = np.vstack(moves).T
        ratio = np.diag(j.T @ whole @ j) / np.diag(j.T @ alone @ j)
        print(
            f"whole arm / sum of its bodies, {what}, {len(quads)} panels:\n"
            f"  moved as one {np.round(ratio[:6], 3)}, joints {np.round(ratio[6:], 3)}",
            flush=True,
        )
        if what == "extended":  # along x, where the ends shield each other: see the file
            good &= bool((np.abs(ratio[[1, 2, 4, 5, 6, 7, 8]] - 1) < 0.10).all())
    return good


def _owners(points: Array, posed: list[Any]) -> Array:
    """Which solid each point [mm] lies on: the one whose drawn surface is nearest."""
    from scipy.spatial import cKDTree

    trees = []
    for solid in posed:
        mesh = solid.refine_to_length(2.0).to_mesh64()
        vertices = np.asarray(mesh.vert_properties)[:, :3]
        corners = vertices[np.asarray(mesh.tri_verts).astype(int)]
        trees.append(cKDTree(np.vstack([vertices, corners.mean(axis=1)])))
    return np.argmin([tree.query(points)[0] for tree in trees], axis=0)


#: The line of a body's strip: axis of its frame.
STRIP_AXES = {"link_0": 0, "link_1": 2, "link_2": 0, "link_3": 1, "wrist": 2, "finger": 1}
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
    mesh = solid.to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts).astype(int)]
    volumes = np.linalg.det(corners)
    return np.einsum("f,fx->x", volumes, corners.sum(axis=1)) / (4 * volumes.sum())


def strips(name: str) -> list[tuple[Array, Array, float]]:
    """The drag strips of a body of `solids`."""
    parts = solids()
    if name.startswith("link_4"):
        wrist = parts["wrist"]
        end = wrist.bounding_box()[2]
        beyond = parts[name].split_by_plane([0.0, 0.0, -1.0], -end)[0]
        return [strip(wrist, 2), strip(beyond, 2)]
    return [strip(parts[name], STRIP_AXES[name.partition("_")[0] if "finger" in name else name])]


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
            ends = (f"[{', '.join(_quoted(x, 1) for x in point)}]" for point in (start, end))
            lines.append(
                "  {{ start = {}, end = {}, diameter = {}, across = {}, along = {} }},".format(
                    *ends, _quoted(diameter, 1), _list(ACROSS), _list(ALONG)
                )
            )
        lines += [
            "]",
            'status = "estimated"',
            f'source = "{SOURCES.get(name, SOURCE)}"',
            f'method = "{METHOD}"',
        ]
    return "\n".join(lines) + "\n"


def _digits(value: float, row: int, column: int) -> str:
    return _quoted(value, (5, 7, 9)[(row > 2) + (column > 2)])


def _quoted(value: float, decimals: int) -> str:
    return f'"{round(value, decimals) + 0.0:.{decimals}f}"'


def _list(texts: Iterable[str]) -> str:
    return "[" + ", ".join(f'"{text}"' for text in texts) + "]"


SOURCE = "our own calculation (scripts/added_mass.py) on our own bodies (alpha5_model/meshing)"
SOURCES = {
    "link_4": SOURCE + ", jaws closed",
    "link_4_open": SOURCE + ", jaws fully open, as one body",
    "wrist": SOURCE + ", link 4 without the fingers",
}
METHOD = "potential flow without bounds, each body alone (capytaine 3); strips: Morison, finite cylinders"
HEAD = '''# ESTIMATED, not published: what the moving water does to each body, off unless asked for. Written by
# scripts/added_mass.py; version 7 of the document prints neither added mass nor drag.
#
# added_mass: 6x6, linear before angular, about the origin and in the axes of the link's frame, for water of 1000 kg/m^3
#   [kg, kg m, kg m^2]; another fluid scales it by its density.
# added_mass_factor: low, nominal, high. Moved across itself and about axis_e, axis_d, axis_c, the stretched arm has 0.97 to
#   1.09 of what its bodies have alone, along itself 0.83; a working pose 0.80 to 1.11; folded it has 0.72 to 1.56, which the
#   interval does not cover. The last refinement of the panels changes 0.3 to 1.3 %, link 4 with its perforated fingers 4 %.
# strips: the cross-flow principle. A length ds of a strip, from start to end, resists the water's velocity across
#   it with rho / 2 * across * diameter * ds * speed * velocity, and so along it [mm; low, nominal, high].
#   across: 1.0 to 1.2 of an endless cylinder, times 0.58 to 0.7 for its ends. along: 0.05 is the friction of a smooth
#   cylinder at Re 8000, 0.25 to 0.3 a blunt face in the stream.

[units]
added_mass = "kg, kg.m, kg.m^2"
start = "mm"
end = "mm"
diameter = "mm"'''


def check(name: str) -> int:
    """Compute one body again; 1 if an entry is further off than half a per cent of its scale."""
    with FILE.open("rb") as file:
        kept = tomllib.load(file)["bodies"]
    if name not in kept:
        print(f"unknown body {name!r}; choose from {', '.join(kept)}", file=sys.stderr)
        return 2
    old = np.array(kept[name]["added_mass"], dtype=float)
    size = SIZES.get(name, OTHERS)[-1]
    new = added_mass(*panels(solids()[name], size)) + water_with(name)
    off = float((np.abs(new - old) / by_unit(old)).max())
    print(f"{name}: {100 * off:.3f} % from the file")
    return 0 if off < 5e-3 else 1


if __name__ == "__main__":
    sys.exit(main())
