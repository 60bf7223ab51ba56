"""Compare public models of this arm: two tables for a page of the documentation.

    python scripts/robots/public_models.py FOLDER [--page docs/public-models.md]

FOLDER holds the models, expanded to URDF, under the names of `MODELS`; they are other
people's and not part of this repository. What is not there is left out of the tables,
which the last line says.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import alpha5_model as a5
from alpha5_model.proofs.comparison.result import Comparison

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from conformance.conformance import insert


class PublicModel(NamedTuple):
    """Where people find a model.

    Attributes:
        repository: As GitHub spells it.
        file: The file or the package there.
    """

    repository: str
    file: str


#: File in the folder -> the model.
MODELS = {
    "evan_palmer_alpha": PublicModel(
        repository="evan-palmer/alpha", file="alpha_description"
    ),
    "hkolano_blue_rov": PublicModel(
        repository="hkolano/UVMS-SysID-with-EAs",
        file="blue_rov_hardware_fixedjaw.urdf",
    ),
    "diff_uvms": PublicModel(
        repository="edxmorgan/diff_uvms", file="alpha_5_robot.urdf"
    ),
}
BEGIN, END = "<!-- public models: begin -->", "<!-- public models: end -->"
HEAD = [
    "model",
    "file",
    "axis_d [N·m]",
    "axis_c [N·m]",
    "M [kg·m²]",
    "tool frame",
    "tip [mm]",
    "matched [mm]",
    "findings",
]
BODIES = [
    "model",
    "body",
    "mass [kg]",
    "Table 2 [kg]",
    "COM off by [mm]",
    "inertia off by [kg·mm²]",
]
#: Findings of a model that are told in words, the costliest first.
TOLD = 4


def tables(compared: dict[str, Comparison]) -> str:
    """Errors of each model, of its bodies, and its costliest findings in words."""
    errors, bodies, words = (
        [HEAD, ["---"] * len(HEAD)],
        [BODIES, ["---"] * len(BODIES)],
        [],
    )
    for name, found in compared.items():
        serious = [finding for finding in found.findings if finding.serious]
        model = MODELS[name]
        tool = found.tool
        if tool is None:
            raise ValueError(f"{name}: {found.verdict}")
        errors.append(
            [
                f"`{model.repository}`",
                f"`{model.file}`",
                *(f"{error:.3g}" for error in found.gravity_error[1:3]),
                f"{found.mass_matrix_error:.1g}",
                f"`{tool.frame}`" if tool.frame else "none",
                f"{found.tip_error * 1e3:.3g}",
                f"{tool.matched_distance.max() * 1e3:.2g}",
                str(len(serious)),
            ]
        )
        for body in found.bodies:
            bodies.append(
                [
                    f"`{model.repository}`",
                    body.name,
                    f"{body.mass:.3g}",
                    f"{body.ours.mass:g}",
                    f"{body.com_error * 1e3:.1f}",
                    f"{body.inertia_error * 1e6:.0f}",
                ]
            )
        words += [
            f"\n`{model.repository}`, the costliest of {len(serious)} findings, "
            "each with the largest torque that it costs alone:\n"
        ]
        words += [f"- {f.where}: {f.text} ({f.cost:.2g} N·m)" for f in serious[:TOLD]]
    lines = ["| " + " | ".join(row) + " |" for row in errors]
    lines += ["", *("| " + " | ".join(row) + " |" for row in bodies), *words, ""]
    if left_out := sorted(set(MODELS) - set(compared)):
        lines += ["", f"Not there: {', '.join(left_out)}.", ""]
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare, print, write; returns the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0] if __doc__ else None
    )
    parser.add_argument("folder", type=Path, help="where the models are")
    parser.add_argument("--page", type=Path, help="insert the tables between its marks")
    chosen = parser.parse_args(arguments)
    paths = {name: chosen.folder / f"{name}.urdf" for name in MODELS}
    compared = {
        name: a5.compare(path) for name, path in paths.items() if path.is_file()
    }
    text = tables(compared)
    print(text)
    if chosen.page:
        insert(chosen.page, text, (BEGIN, END))
    return 0


if __name__ == "__main__":
    sys.exit(main())
