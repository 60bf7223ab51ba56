"""Compare the silhouettes of the drawn arm with those of another model's meshes.

    python scripts/checks/likeness.py model.urdf --meshes FOLDER [--least 0.88]

The other model is a public URDF of this arm, and FOLDER holds the mesh files that it
names, for example the manufacturer's CAD parts, which are not ours to pass on. Its
base and joints are found by `alpha5_model.compare`. Both arms take the pose ``home``.
Prints the overlap in six views: area of both silhouettes over that of either. Exit
status 1 if their mean is smaller than ``--least``. Meshes are measured, nothing else.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model._support.checks import FloatArray
from alpha5_model._support.paths import URDF_PATH
from alpha5_model.geometry.solid import kernel

#: Directions of view in base_link.
VIEWS = {
    "front": (1.0, 0.0, 0.0),
    "side": (0.0, 1.0, 0.0),
    "top": (0.0, 0.0, 1.0),
    "front left, above": (1.0, 1.0, 1.0),
    "front right, above": (1.0, -1.0, 1.0),
    "front, above": (1.0, 0.0, 1.0),
}
#: Triangles that are merged at a time.
_BATCH = 400
JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")


def main(arguments: list[str] | None = None) -> int:
    """Compare; 1 if the arms are less alike than wanted."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("urdf", type=Path)
    parser.add_argument("--meshes", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--least", type=float, default=0.88, metavar="SHARE")
    chosen = parser.parse_args(arguments)

    shares = likeness(chosen.urdf, chosen.meshes)
    for view, share in shares.items():
        print(f"{view:20}{share:8.3f}")
    mean = float(np.mean(list(shares.values())))
    print(f"{'mean':20}{mean:8.3f}, wanted {chosen.least:g}")
    return 0 if mean >= chosen.least else 1


def likeness(urdf: Path, folder: Path) -> dict[str, float]:
    """View -> area of both silhouettes over that of either.

    Args:
        urdf: Of the other model.
        folder: With its mesh files.

    Raises:
        ValueError: It is another arm.
        FileNotFoundError: A mesh is missing.
    """
    comparison = a5.compare(urdf)
    if not comparison.joints:
        raise ValueError(f"{urdf}: {comparison.findings[0].text}")
    q = a5.named_pose("home")
    positions = dict(zip(JOINTS, comparison.alignment.theirs(q), strict=True))
    theirs = triangles(
        urdf,
        {comparison.joints[name]: value for name, value in positions.items()},
        folder,
    )
    base = comparison.alignment.base
    theirs = theirs @ base[:3, :3].T + base[:3, 3]
    ours = triangles(
        Path(URDF_PATH),
        dict(zip(JOINTS, q, strict=True)),
        Path(URDF_PATH).parents[1] / "meshes",
    )
    return {
        view: overlap(silhouette(ours, direction), silhouette(theirs, direction))
        for view, direction in VIEWS.items()
    }


def triangles(urdf: Path, positions: dict[str, float], folder: Path) -> FloatArray:
    """Corners of all visual meshes in the root's frame, (n, 3, 3) [m].

    Args:
        urdf: The model.
        positions: Joint -> position; others are at zero.
        folder: With the mesh files, by their names without folders.
    """
    import yourdfpy

    def found(fname: str) -> str:
        path = folder / Path(fname.replace("\\", "/")).name
        if not path.exists():
            raise FileNotFoundError(path)
        return str(path)

    robot = yourdfpy.URDF.load(str(urdf), filename_handler=found)
    robot.update_cfg(
        {name: positions.get(name, 0.0) for name in robot.actuated_joint_names}
    )
    meshes = robot.scene.dump(concatenate=False)
    return np.vstack([np.asarray(mesh.triangles, float) for mesh in meshes])


def silhouette(corners: FloatArray, direction: tuple[float, float, float]) -> Any:
    """The outline of triangles, (n, 3, 3) [m], along a direction: a section [mm]."""
    towards = np.asarray(direction) / np.linalg.norm(direction)
    across = np.linalg.svd(towards[None])[2][1:]
    flat = 1e3 * corners @ across.T

    sides = flat[:, 1:] - flat[:, :1]
    area = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    flat[area < 0] = flat[area < 0, ::-1]
    seen = flat[np.abs(area) > 1e-9]

    k = kernel()
    pieces = [
        k.CrossSection(list(seen[start : start + _BATCH]), k.FillRule.NonZero)
        for start in range(0, len(seen), _BATCH)
    ]
    return k.CrossSection.batch_boolean(pieces, k.OpType.Add)


def overlap(one: Any, other: Any) -> float:
    """Area of both sections over that of either."""
    return float((one ^ other).area() / (one + other).area())


if __name__ == "__main__":
    sys.exit(main())
