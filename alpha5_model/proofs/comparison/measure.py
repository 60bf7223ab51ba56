"""Measure how far another model of the arm is off."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from alpha5_model._support.checks import count
from alpha5_model.description.reading import UrdfRobot
from alpha5_model.numbers.parameters import parameters
from alpha5_model.proofs.comparison import arm, findings, reading
from alpha5_model.proofs.comparison.alignment import align, bodies_in_our_frames
from alpha5_model.proofs.comparison.records import BodyDifference, Comparison, Finding
from alpha5_model.proofs.comparison.tool import measure_tool

#: Shapes of axes that lie farther apart than this are not the same arm's: a third of the upper arm.
#: A model of this arm with an offset on the wrong side comes to 40 mm at most.
OTHER_ARM, SAME_SHAPE = 0.05, 0.005  # [m]


def compare(
    path: str | Path,
    joints: Mapping[str, str] | None = None,
    samples: int = 500,
    base: str | None = None,
    packages: Mapping[str, str] | None = None,
    arguments: Mapping[str, str] | None = None,
    xacro: bool = False,
) -> Comparison:
    """Compare another model of this arm with ours.

    The arm is found by the shape of its axes, the bases are aligned by the joint axes, every other
    joint is frozen with the jaws closed, what carries the arm is left out, and each body is
    compared in our link frame with the tables.

    Args:
        path: A URDF, or a xacro file that makes one. Meshes need not be there. A URDF is read as
            it is: nothing in it is executed, and no other file is read.
        joints: Our joint name -> theirs, for those that cannot be found by axes and names.
        samples: Random configurations for the kinematic and dynamic errors.
        base: The first link of the arm, if something carries it; found by its mass if None.
        packages: Of a xacro file: name of each package in ``$(find NAME)`` -> its folder. The
            package that the file is in is found by the ``package.xml`` above it.
        arguments: Of a xacro file: values of its arguments, as text.
        xacro: Expand a xacro file. It is a program, which can read files and run commands: do so
            only if you trust it.

    Returns:
        The comparison; ``agrees`` and ``verdict`` say how it ends. Another arm is no error: the
        verdict says that it is not a Reach Alpha 5, and why.

    Raises:
        MissingFileError, FileFormatError: The file cannot be read, or is a xacro file that is not to
            be expanded; the message says where, and what to do.
        UnknownNameError, InputError: A joint or link is not there, or the joints cannot be mapped.
    """
    other = reading.read_model(path, packages, arguments, xacro)
    return compare_robots(other, joints, samples, Path(path).parent, base)


def compare_robots(
    other: UrdfRobot,
    names: Mapping[str, str] | None = None,
    samples: int = 500,
    folder: Path | None = None,
    base: str | None = None,
) -> Comparison:
    """As `compare`, for a model that is read already; ``folder`` is where its meshes are."""
    q, meant = arm.random_positions(count("samples", samples)), reading.as_meant(other)
    chains = reading.find_chains(meant, names)
    if not chains or not _is_ours(chains[0]):
        return Comparison(other.name, (_another_arm(other, chains),))
    mapped = chains[0].joints
    theirs = arm.reduce_robot(meant, mapped, base)
    alignment = align(theirs)
    way = theirs.base_path[: theirs.base_path.index(alignment.base_link)]
    if base is None and alignment.same_base and not set(way) <= set(theirs.carried):
        # What stands before our base_link carries it, even if it weighs nothing.
        base = alignment.base_link
        theirs = arm.reduce_robot(meant, mapped, base)
    written = arm.reduce_robot(other, tuple(other.joints[j.name] for j in mapped), base)
    com, inertia = bodies_in_our_frames(theirs, alignment)
    exact = bodies_in_our_frames(theirs, alignment.exact or alignment)[0]
    ours, slack = parameters().links, np.linalg.norm(exact - com, axis=1).tolist()
    columns = (theirs.links, theirs.mass.tolist(), com, inertia, ours, slack)
    bodies = tuple(map(BodyDifference, [link.name for link in ours], *columns))
    # Gravity points down in our base frame, wherever the other root stands.
    there, down = alignment.theirs(q), alignment.base[:3, :3].T @ arm.DOWN
    torques, signs = (
        arm.our_arm().gravity_torque(q),
        np.outer(alignment.sign, alignment.sign),
    )
    gravity = written.gravity_torque(there, down) * alignment.sign - torques
    inertias = written.mass_matrix(there) * signs - arm.our_arm().mass_matrix(q)
    found = list(
        findings.all_findings(other, theirs, written, alignment, bodies, folder, q)
    )
    found.sort(key=lambda f: (-round(f.cost, 6), not f.serious))
    # Further chains of the shape of this arm, such as a second arm on the vehicle.
    named = [
        dict(zip(reading.AXES, c.names, strict=True)) for c in chains if _is_ours(c)
    ]
    second = [n for n in named[1:] if set(n.values()).isdisjoint(chains[0].names)]
    mappings = [",".join(map("=".join, n.items())) for n in second]
    found += [findings.finding("second_arm", mapping=mapping) for mapping in mappings]
    carried = {name: other.links[name].mass or 0.0 for name in theirs.carried}
    return Comparison(
        name=other.name,
        findings=tuple(found),
        joints=named[0],
        alignment=alignment,
        bodies=bodies,
        tool=measure_tool(written, theirs, alignment, q),
        gravity_error=np.abs(gravity).max(axis=0),
        mass_matrix_error=float(np.abs(inertias).max()),
        volume=theirs.volume or math.nan,
        carried=carried,
    )


def _is_ours(chain: reading.Chain) -> bool:
    """If more joints follow, as on many arms, the shape has to be just this one."""
    return chain.misfit <= (OTHER_ARM if chain.following < 2 else SAME_SHAPE)


def _another_arm(other: UrdfRobot, chains: list[reading.Chain]) -> Finding:
    """Why a model is not of this arm."""
    turning = sum(
        j.kind in reading.TURNING and j.mimic is None for j in other.joints.values()
    )
    if not chains:
        return findings.finding("another_arm.without_joints", turning=turning)
    best, off = chains[0], chains[0].differences
    words = findings.FINDINGS["another_arm"]["shape"]
    scale = np.repeat([1e3, 180 / math.pi], (4, 3))
    rows = zip(words, best.shape * scale, reading.our_shape() * scale, strict=True)
    texts = [text.format(theirs, ours) for text, theirs, ours in rows]
    worst = ", ".join(
        texts[k] for k in np.argsort(-off, kind="stable")[:3] if off[k] > 1e-3
    )
    names = ", ".join(best.names)
    return findings.finding("another_arm", turning=turning, joints=names, worst=worst)
